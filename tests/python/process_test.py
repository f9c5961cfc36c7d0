# rtmsim.World and the simulator's process: its end, that of Python, interrupts, threads, attaching.
import os
import pathlib
import signal
import subprocess
import sys
import threading

import pytest
import rtmsim
from conftest import course, segments_of, source, until

sys.path.insert(0, str(source / "tests" / "scenario"))
import server_ids  # noqa: E402

sim_server = pathlib.Path(os.environ["RTMSIM_BIN_DIR"]) / "sim-server"


def is_running(pid):
    try:
        return pathlib.Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def python(text):
    return subprocess.Popen([sys.executable, "-c", text], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def test_a_world_that_closes_leaves_no_process_and_no_shared_memory():
    world = rtmsim.World(course)
    server_id, pid = world.server_id, world._simulator.pid
    world.scan("pioneer2dx::laser")
    assert segments_of(server_id)
    world.close()
    assert not is_running(pid)
    assert segments_of(server_id) == []


@pytest.mark.parametrize("end", ["os.kill(os.getpid(), 9)", "os._exit(3)", "sys.exit(4)", "pass"])
def test_a_simulator_ends_with_python_however_that_ends(end):
    child = python(f"import os, sys, rtmsim\nw = rtmsim.World({course!r})\nprint(w.server_id, w._simulator.pid, flush=True)\n{end}")
    server_id, pid = child.stdout.readline().split()
    child.communicate(timeout=60)
    until(lambda: not is_running(pid))
    until(lambda: segments_of(server_id) == [])


def test_a_simulator_that_was_killed_is_an_exception_of_one_line():
    with rtmsim.World(course) as world:
        world.step(10)
        scan = world.scan("pioneer2dx::laser")
        os.kill(world._simulator.pid, signal.SIGKILL)
        for call in (lambda: world.step(1), lambda: world.pose("pioneer2dx"), lambda: world.scan("pioneer2dx::laser")):
            with pytest.raises(rtmsim.ServerDied) as caught:
                call()
            assert "killed by signal 9" in str(caught.value) and "\n" not in str(caught.value)
        assert scan.sum() == scan.sum()
        server_id = world.server_id
    assert segments_of(server_id) == []


def test_a_simulator_that_dies_while_it_steps_is_an_exception():
    with rtmsim.World(course) as world:
        pid = world._simulator.pid
        timer = threading.Timer(0.3, os.kill, (pid, signal.SIGKILL))
        timer.start()
        with pytest.raises(rtmsim.ServerDied):
            world.step(10**9)
        timer.join()


def test_ctrl_c_ends_a_step_and_the_world_goes_on():
    child = python(f"""
import os, signal, threading, rtmsim
with rtmsim.World({course!r}) as w:
    w.step(1)
    threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
    try:
        w.step(10**9)
    except KeyboardInterrupt:
        print("interrupted")
    before = w.steps
    w.step(5)
    print(w.steps - before, w.is_paused)
""")
    out, err = child.communicate(timeout=120)
    assert out.split() == ["interrupted", "5", "True"], err


def test_a_stopped_simulator_is_a_timeout():
    with rtmsim.World(course) as world:
        world.timeout = 1.0
        pid = world._simulator.pid
        os.kill(pid, signal.SIGSTOP)
        try:
            with pytest.raises(rtmsim.TimedOut, match="simulated time stands at 0 s"):
                world.step(10)
            with pytest.raises(rtmsim.TimedOut, match="get-pose: no answer within 1 s"):
                world.pose("pioneer2dx")
        finally:
            os.kill(pid, signal.SIGCONT)
        assert world.step(10) > 0


def test_other_threads_of_python_run_while_a_step_waits():
    with rtmsim.World(course) as world:
        stepping = threading.Thread(target=world.step, args=(20000,))
        stepping.start()
        with pytest.raises(rtmsim.Error, match="one World per thread"):
            while stepping.is_alive():
                world.pose("pioneer2dx")
        stepping.join()
        assert world.pose("pioneer2dx")


def test_a_forked_child_leaves_the_world_of_its_parent_alone():
    with rtmsim.World(course) as world:
        world.drive("pioneer2dx").velocity(0.3)
        world.step(10)
        child = os.fork()
        if child == 0:
            code = 1
            try:
                try:
                    world.step(1)
                except rtmsim.Error as problem:
                    code = 0 if "parent process" in str(problem) else 2
                world.close()
            finally:
                os._exit(code)
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
        world.advance(1)
        assert world.drive("pioneer2dx").measured_velocity[0] > 0.2


def test_a_running_simulator_is_attached_to_and_runs_on():
    server_id = server_ids.claim()
    server = subprocess.Popen([sim_server, course, "-s", server_id, "--rtf", "0"], stderr=subprocess.DEVNULL)
    try:
        until(lambda: segments_of(server_id) and _attached(server_id))
        with rtmsim.World(server_id=int(server_id)) as world:
            assert not world.is_paused
            first = world.wait("pioneer2dx::laser", timeout=30)
            assert world.wait("pioneer2dx::laser", timeout=30)["sequence"] > first["sequence"]
            world.pause()
            world.step(10)
            world.run()
            assert not world.is_paused
        assert server.poll() is None
        world = rtmsim.World(server_id=int(server_id))
        server.terminate()
        server.wait(30)
        with pytest.raises(rtmsim.ServerDied):
            world.step(1)
    finally:
        server.kill()
        server.wait()


def _attached(server_id):
    try:
        rtmsim.World(server_id=int(server_id)).close()
        return True
    except rtmsim.Error:
        return False


def test_a_world_that_cannot_be_read_is_one_line():
    with pytest.raises(rtmsim.Error, match="no_such.sdf") as caught:
        rtmsim.World("/no_such.sdf")
    assert "\n" not in str(caught.value)
    with pytest.raises(rtmsim.Error):
        rtmsim.World("<sdf version='1.9'><wor")
    with pytest.raises(rtmsim.Error, match="expected a world"):
        rtmsim.World()
    with pytest.raises(rtmsim.Error, match="4711"):
        rtmsim.World(server_id=4711)


def test_importing_the_module_loads_neither_numpy_nor_a_subprocess():
    child = python("import sys, rtmsim; print([m for m in ('numpy', 'subprocess', 'pytest', 'typing') if m in sys.modules])")
    out, err = child.communicate(timeout=60)
    assert out.strip() == "[]", err


def test_the_option_wants_a_pipe_as_standard_input():
    done = subprocess.run([sim_server, course, "-s", server_ids.claim(), "--ends-with-input"], stdin=subprocess.DEVNULL, capture_output=True,
                          text=True, timeout=60)
    assert done.returncode == 2
    assert "expected a pipe as standard input" in done.stderr
