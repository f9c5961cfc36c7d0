# What the scenarios of sim-server and simctl share: a server with an id of its own, clients of it, and their end.
import json
import os
import signal
import subprocess
import sys
import tempfile
import time

import server_ids

case, bin_dir, source = sys.argv[1:]
server_id = server_ids.claim()
course = f"{source}/worlds/obstacle_course.sdf"
robot = "pioneer2dx"
work = tempfile.TemporaryDirectory()
running = []
watchdog = 60  # [s]; a bound on hanging, not on speed


def server(*options, world=course):
    log = open(f"{work.name}/{len(running)}.log", "w+")
    process = subprocess.Popen([f"{bin_dir}/sim-server", world, "-s", server_id, *options], stdout=subprocess.PIPE, stderr=log, text=True)
    process.log = log
    running.append(process)
    return process


def client(*words):
    running.append(subprocess.Popen([f"{bin_dir}/simctl", "-s", server_id, *words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))
    return running[-1]


def simctl(*words):
    return subprocess.run([f"{bin_dir}/simctl", "-s", server_id, *words], capture_output=True, text=True, timeout=watchdog)


def ok(*words):
    done = simctl(*words)
    assert done.returncode == 0, f"{words}: {done.stderr}"
    return done.stdout


def read(*words):
    return json.loads(ok("--json", *words))


def refused(*words, code=1, says=""):
    done = simctl(*words)
    lines = done.stderr.strip().splitlines()
    assert done.returncode == code and len(lines) == 1 and says in lines[0], f"{words}: exit {done.returncode}, {done.stderr!r}"


def await_(what, ready):
    end = time.monotonic() + watchdog
    while not ready():
        assert time.monotonic() < end, f"{what}: not within {watchdog} s"
        time.sleep(0.02)


def is_there(process):
    assert process.poll() is None, f"the server ended with {process.returncode}: {open(process.log.name).read()}"
    return simctl("--json", "stats").returncode == 0


def started(*options, **more):
    process = server(*options, **more)
    await_("server", lambda: is_there(process))
    return process


def segments():
    return [name for name in os.listdir("/dev/shm") if name.startswith(f"rtmsim-{os.getuid()}-{server_id}.")]


def position(model):
    return read("pose", model)["position"]


def near(got, wanted, tolerance=1e-6):
    assert all(abs(a - b) <= tolerance for a, b in zip(got, wanted, strict=True)), f"expected {wanted}, got {got}"


def stop(process, with_signal=signal.SIGTERM):
    process.send_signal(with_signal)
    assert process.wait(watchdog) == 0, process.returncode
    assert not segments(), segments()


def final_hash(*options, **more):
    out, _ = server("--rtf", "0", "--duration", "2", "--hash", *options, **more).communicate(timeout=watchdog)
    assert running[-1].returncode == 0
    return out.strip()


def state():
    return read("stats")["hash"]


def run(*cases):
    try:
        {function.__name__: function for function in cases}[case]()
    finally:
        # In an orderly way: also a failed case leaves nothing in shared memory.
        for process in reversed(running):
            if process.poll() is None:
                process.terminate()
        for process in running:
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
    leftover = segments()
    assert not leftover, leftover
    print("ok")
