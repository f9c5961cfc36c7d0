# sim-server and simctl as processes, one case per run: server.py CASE BIN_DIR SOURCE_DIR. Each run has a server id of its own.
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time

case, bin_dir, source = sys.argv[1:]
server_id = str(1000 + os.getpid() % 9000)
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


def requests():
    process = started("-u")
    assert read("step", "5")["steps"] == 5
    ok("pose", robot, "1", "0.5", "0.3")
    near(position(robot)[:2], (1, 0.5))
    assert abs(read("pose", robot)["yaw"] - 0.3) < 1e-6
    ok("run")
    before = read("stats")["sim_time"]
    await_("running time", lambda: read("stats")["sim_time"] > before)
    ok("pause")
    paused_at = read("stats")["sim_time"]
    assert read("stats")["sim_time"] == paused_at
    near([read("step", "3")["sim_time"] - paused_at], [3 * read("info", "simulation:world")["step"]], 1e-9)
    ok("reset")
    assert read("stats")["sim_time"] == 0
    start = position(robot)

    box = "<sdf version='1.9'><model name='crate'><link name='l'><collision name='c'><geometry><box><size>.3 .3 .3</size></box></geometry></collision></link></model></sdf>"
    assert read("spawn", box, "--name", "crate", "--pose", "-1", "-1", "0.15", "0")["name"] == "crate"
    near(position("crate"), (-1, -1, 0.15))
    refused("spawn", box, "--name", "crate", says="crate")
    ok("delete", "crate")
    refused("pose", "crate", says="crate")
    near(position(robot), start)
    drive = client("velocity", f"{robot}::position2d", "0.3", "0", "0")
    ok("run")
    await_("a driving robot", lambda: read("stats")["sim_time"] > 1 and position(robot)[0] != start[0])
    drive.send_signal(signal.SIGKILL)
    drive.wait()
    await_("a robot without commander that stands", lambda: abs(read("echo", f"{robot}::position2d", "-n", "1")["velocity"][0]) < 0.01)
    stop(process)


def bad_requests():
    process = started("-u")
    before = state()
    for words in (["pose", "nobody"], ["pose", "nobody", "1", "2", "0"], ["delete", "nobody"], ["contacts", "nobody"], ["echo", "nobody"],
                  ["info", "nobody"], ["velocity", "nobody", "1", "0", "0"], ["pose", robot, "nan", "0", "0"], ["pose", robot, "inf", "0", "0"],
                  ["velocity", f"{robot}::position2d", "nan", "0", "0"], ["spawn", "<sdf version='1.9'><model"], ["spawn", "/no/such/file.sdf"]):
        refused(*words)
    refused("screenshot", f"{work.name}/x.png", "--from", "1 2 3", code=2, says="expected 6 numbers")
    refused("spawn", course, "--pose", "1 2", code=2, says="expected X Y YAW")
    refused("pose", robot, "1", code=2)
    refused("step", "-1", code=2)
    refused("step", "many", code=2)
    assert state() == before, "a refused request changed the world"
    stop(process)


# Boxes that fall over each other in several places: resting robots would be equal too easily.
def heaps():
    shape = "<geometry><box><size>.3 .3 .3</size></box></geometry>"
    models = "".join(
        f"<model name='b{i}'><pose>{6 * (i % 4) + 0.03 * i} {0.02 * i} {0.4 + 0.35 * (i // 4)} 0.{i} 0.2 0</pose>"
        f"<link name='l'><collision name='c'>{shape}</collision></link></model>" for i in range(24))
    ground = "<model name='g'><static>true</static><link name='l'><collision name='c'><geometry><plane/></geometry></collision></link></model>"
    file_name = f"{work.name}/heaps.sdf"
    with open(file_name, "w") as file:
        file.write(f"<sdf version='1.9'><world name='heaps'>{ground}{models}</world></sdf>")
    return file_name


def same_state():
    world = heaps()
    first = final_hash("--threads", "1", world=world)
    assert len(first) == 16 and first != "0" * 16, first
    assert final_hash("--threads", "1", world=world) == first
    assert final_hash("--threads", "2", world=world) == first, "the state depends on the number of threads"
    process = started("-u", world=world)
    ok("step", "200")
    once = state()
    ok("reset")
    ok("step", "200")
    assert state() == once, "the state differs after a reset"
    stop(process)


# The server and two clients die at a random moment; the next server starts at once, with nothing cleaned up by hand.
def killed():
    seed = random.randrange(1 << 30)
    print("seed", seed)
    draw = random.Random(seed)
    for _ in range(20):
        process = started("--rtf", "0")
        clients = [client("echo", f"{robot}::position2d"), client("velocity", f"{robot}::position2d", "0.2", "0", "0.1")]
        time.sleep(draw.uniform(0, 0.1))  # the random moment
        victims = [process, *clients]
        draw.shuffle(victims)
        for victim in victims:
            victim.kill()
        for victim in victims:
            victim.wait()
    stop(started())


def living_server_is_refused():
    process = started()
    second = server()
    assert second.wait(watchdog) == 1
    second.log.seek(0)
    message = second.log.read()
    assert server_id in message and str(process.pid) in message, message
    assert is_there(process)
    stop(process)


def ends():
    for with_signal in (signal.SIGTERM, signal.SIGINT):
        stop(started(), with_signal)
        stop(started("-u"), with_signal)
    process = server("--rtf", "0", "--duration", "0.5")
    assert process.wait(watchdog) == 0
    assert not segments(), segments()


def check():
    assert server("--check").wait(watchdog) == 0
    broken = f"{work.name}/broken.sdf"
    with open(broken, "w") as file:
        file.write("<sdf version='1.9'><world name='w'><include><uri>model://no_such_model</uri></include></world></sdf>")
    assert server("--check", world=broken).wait(watchdog) == 1
    assert server("--check", world="/no/such/world.sdf").wait(watchdog) == 1
    assert server("--rtf", "-1").wait(watchdog) == 2
    assert not segments(), segments()


# Housekeeping ten times a second is all that a paused server does: below one percent of a core.
def paused_is_idle():
    process = started("-u")

    def used():
        with open(f"/proc/{process.pid}/stat") as file:
            fields = file.read().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    before = used()
    time.sleep(3)  # what is measured
    spent = used() - before
    assert spent <= 0.03, f"{spent} s of processor time in 3 s"
    stop(process)


cases = {f.__name__: f for f in (requests, bad_requests, same_state, killed, living_server_is_refused, ends, check, paused_is_idle)}
try:
    cases[case]()
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
