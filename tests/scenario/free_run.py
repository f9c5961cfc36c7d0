# A user's first drive: real time, ordinary execution contexts, wired by hand. The commander of the robot is killed: the robot stops. It is started again, wired
# again by the saved file, and the robot drives on, in the same world.
import json
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time

bin_dir, lib_dir, source = sys.argv[1:]
server_id = str(1000 + os.getpid() % 9000)
with socket.socket() as probe:
    probe.bind(("127.0.0.1", 0))
    names = f"127.0.0.1:{probe.getsockname()[1]}"
work = tempfile.TemporaryDirectory()
running = []


def start(*words):
    running.append(subprocess.Popen(words, stdout=open(f"{work.name}/{len(running)}.log", "w"), stderr=subprocess.STDOUT))
    return running[-1]


def call(*words, check=True):
    done = subprocess.run(words, capture_output=True, text=True, timeout=60)
    assert not check or done.returncode == 0, f"{words}: {done.stderr}"
    return done.stdout


def rtse(*words, **more):
    return call(f"{bin_dir}/rtse", "--ns", names, *words, **more)


def simctl(*words, **more):
    return call(f"{bin_dir}/simctl", "-s", server_id, *words, **more)


def await_(what, ready):
    end = time.monotonic() + 60
    while True:
        try:
            if ready():
                return
        except (AssertionError, ValueError, KeyError):
            pass  # not there yet
        assert time.monotonic() < end, f"{what}: not within a minute"
        time.sleep(0.05)


def robot():
    return json.loads(simctl("--json", "echo", "pioneer2dx::position2d", "-n", "1"))


def speed():
    return robot()["velocity"][0]


def host(*components):
    # Several hosts share the naming service that the first one started.
    return start(f"{bin_dir}/rtcd", "-o", f"corba.nameservers:{names}", "-o", f"manager.modules.load_path:{lib_dir}", "-o", "manager.shutdown_auto:NO", *components)


try:
    start(f"{bin_dir}/sim-server", f"{source}/worlds/obstacle_course.sdf", "-s", server_id)
    await_("simulator", lambda: simctl("--json", "stats"))
    device = f"conf.default.server_id={server_id}"
    running_names = start("omniNames", "-start", names.split(":")[1], "-datadir", work.name, "-ORBendPoint", f"giop:tcp:{names}")
    host(f"RTCLaser?{device}", "LaserObstacleAvoid")
    driver = host(f"RTCPosition2d?{device}")
    components = ("RTCLaser0", "LaserObstacleAvoid0", "RTCPosition2d0")
    rtse("wait", *components, "--state", "any", "--timeout", "60")
    rtse("con", "RTCLaser0:range", "LaserObstacleAvoid0:range")
    rtse("con", "LaserObstacleAvoid0:velocity", "RTCPosition2d0:velocity")
    rtse("act", *components)
    await_("a driving robot", lambda: speed() > 0.1)
    saved = f"{work.name}/system.xml"
    rtse("save", saved)
    rtse("check", saved, "--state", "Active")

    driver.send_signal(signal.SIGKILL)
    driver.wait()
    await_("a robot without commander that stands", lambda: abs(speed()) < 0.01)
    assert robot()["commanded"] is False

    host(f"RTCPosition2d?{device}")
    await_("the component again", lambda: rtse("cat", "RTCPosition2d0"))
    await_("the connections again", lambda: rtse("load", saved) is not None)
    rtse("start", saved)
    await_("a robot that drives again", lambda: speed() > 0.1)
finally:
    for process in reversed(running):
        if process.poll() is None:
            process.terminate()
    for process in running:
        try:
            process.wait(10)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
leftover = [name for name in os.listdir("/dev/shm") if name.startswith(f"rtmsim-{os.getuid()}-{server_id}.")]
assert not leftover, leftover
print("ok")
