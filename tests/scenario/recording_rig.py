# A system in lock step and its recorders: what the scenarios of recordings share. The words of the program are CASE BIN_DIR LIB_DIR SOURCE_DIR.
import json
import signal
import subprocess
import sys

from rig import Rig

case, *folders = sys.argv[1:]
rig = Rig(*folders)
file = rig.path("run.mcap")


# The obstacle system in lock step, wired and active, before its first step.
def up():
    rig.naming()
    rig.server("--lockstep", "--rtf", "0", "-u", "--wait-for", "3")
    host = rig.host(rig.device("RTCLaser"), "LaserObstacleAvoid", rig.device("RTCPosition2d"), options=(
        "-o", "manager.modules.preload:SimTimeContext.so", "-o", "exec_cxt.periodic.type:SimTimeContext"))
    rig.there("RTCLaser0", "LaserObstacleAvoid0", "RTCPosition2d0")
    rig.rtse("con", "RTCLaser0:range", "LaserObstacleAvoid0:range")
    rig.rtse("con", "LaserObstacleAvoid0:velocity", "RTCPosition2d0:velocity")
    rig.rtse("act", "RTCLaser0", "LaserObstacleAvoid0", "RTCPosition2d0")
    return host


def recorder(*words, to=file, **more):
    return subprocess.Popen([f"{rig.bin_dir}/rtse", "--ns", rig.names, "record", "-s", str(rig.server_id), "-o", to, *words],
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **more)


# Until its connections stand: it says so.
def recording(*words, **more):
    process = recorder(*words, **more)
    line = process.stderr.readline()
    assert line.startswith("recording "), line
    return process


def ended(process):
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 0, (process.returncode, out, err)
    return err


def seconds(count):
    rig.simctl("step", str(round(count * 1000)))


def lines(*words):
    return [json.loads(line) for line in rig.rtse("recording", *words).splitlines()]


# With one line.
def refused(*words, says, code=1):
    done = rig.try_rtse(*words)
    assert done.returncode == code and says in done.stderr and done.stderr.count("\n") == 1, done


# A run of the obstacle system: its recording, the hash of its state at the end.
def recorded_run(name, duration, *words):
    path = rig.path(name)
    done = json.loads(rig.rtse("--json", "run", f"{rig.source}/worlds/systems/obstacle_avoidance.xml", "--world", f"{rig.source}/worlds/obstacle_course.sdf",
                               "--duration", str(duration), "--record", path, *words).splitlines()[-1])
    return path, done["state_hash"]


# As a program: the case that it is called with.
def run_case(cases):
    rig.run_case(case, cases)
