# Recordings of a system in lock step, one case per run: recordings.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import json
import signal
import subprocess
import sys

from rig import Rig, await_

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


def recorder(*words):
    return subprocess.Popen([f"{rig.bin_dir}/rtse", "--ns", rig.names, "record", "-s", str(rig.server_id), "-o", file, *words],
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


# Until its connections stand: it says so.
def recording(*words):
    process = recorder(*words)
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


# Each sample of each port is there with the time of its tick, and other people's readers find the same.
def whole_run():
    up()
    process = recording("RTCLaser0:range", "LaserObstacleAvoid0:velocity", "RTCPosition2d0:odometry")
    seconds(5)
    assert "samples of 3 channels" in ended(process)
    info = json.loads(rig.rtse("--json", "recording", "info", file))
    assert info["run"]["clock"] == "simulated" and info["run"]["lockstep"] == "yes", info["run"]
    assert [a["name"] for a in info["attachments"]] == ["world.sdf"], info
    scans = lines("cat", file, "RTCLaser0:range")
    assert abs(len(scans) - 50) <= 1, len(scans)
    assert all(abs(s["time"] - (s["value"]["tm"]["sec"] + s["value"]["tm"]["nsec"] * 1e-9)) < 1e-9 for s in scans), scans[0]
    assert [c["missing"] for c in info["channels"]] == [0, 0, 0], info["channels"]
    ours = lines("cat", file)
    done = subprocess.run(["node", f"{rig.source}/tests/foreign/read.mjs", file], stdout=subprocess.PIPE, check=True, timeout=120, text=True)
    *theirs, tail = [json.loads(line) for line in done.stdout.splitlines()]
    assert tail == {"attachments": ["world.sdf"], "statistics": len(ours)}, tail
    assert len(theirs) == len(ours)
    for a, b in zip(ours, theirs):
        assert (a["topic"], a["sequence"], round(a["time"] * 1e9)) == (b["topic"], b["sequence"], b["time"]), (a, b)
        assert same(a["value"], b["value"]), (a, b)


# JSON has no infinities; a reader that has them says null.
def same(a, b):
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(same(a[key], b[key]) for key in a)
    if isinstance(a, list):
        return len(a) == len(b) and all(same(x, y) for x, y in zip(a, b))
    return a == b or (isinstance(a, (int, float)) and isinstance(b, (int, float)) and abs(a - b) <= 1e-6 * max(abs(a), abs(b)))


# The run is the same with a recorder as without.
def same_run():
    hashes = []
    up()
    for with_recorder in (False, True):
        process = recording("--all") if with_recorder else None
        seconds(5)
        hashes.append(rig.stats()["hash"])
        if process:
            ended(process)
        rig.simctl("reset")
    assert hashes[0] == hashes[1] and int(hashes[0], 16) != 0, hashes


# A recorder that is killed costs the system nothing, and its file has what came before.
def killed():
    up()
    process = recording("RTCLaser0:range")
    seconds(3)
    await_("the scans are in the file", lambda: json.loads(rig.try_rtse("--json", "recording", "info", file).stdout)["samples"] >= 30)
    process.kill()
    process.wait()
    seconds(3)
    done = rig.try_rtse("recording", "info", file)
    assert done.returncode == 0 and "its writer did not close it" in done.stderr, done
    kept = int(rig.rtse("recording", "repair", file).split()[0])
    assert kept >= 30, kept
    done = rig.try_rtse("recording", "info", file)
    assert done.returncode == 0 and done.stderr == "", done


# Two runs are equal sample by sample; another parameter is found at its first effect.
def compared():
    global file
    files = []
    up()
    for name in ("a", "b", "c"):
        file = rig.path(f"{name}.mcap")
        files.append(file)
        if name == "c":
            rig.rtse("conf", "LaserObstacleAvoid0", "set", "speed_gain", "0.01")
        process = recording("RTCLaser0:range", "LaserObstacleAvoid0:velocity")
        seconds(4)
        ended(process)
        rig.simctl("reset")
    assert rig.rtse("recording", "compare", files[0], files[1]).startswith("equal: ")
    done = rig.try_rtse("recording", "compare", files[0], files[2])
    assert done.returncode == 1 and "/LaserObstacleAvoid0/velocity data.vx:" in done.stdout, done


# What was recorded drives another component, as if its peer were there.
def played():
    up()
    process = recording("LaserObstacleAvoid0:velocity")
    seconds(3)
    ended(process)
    sent = len(lines("cat", file))
    done = rig.try_rtse("play", file, "LaserObstacleAvoid0:velocity=RTCPosition2d0:velocity", "--rate", "1000")
    assert done.returncode == 0 and f"sent {sent} samples" in done.stdout, done


# `rtse run` records from before the first step on; two runs are equal, and equal to the run without.
def of_a_run():
    call = ["--json", "run", f"{rig.source}/worlds/systems/obstacle_avoidance.xml", "--world", f"{rig.source}/worlds/obstacle_course.sdf", "--duration", "5"]
    hashes = []
    for more in ([], ["--record", rig.path("a.mcap")], ["--record", rig.path("b.mcap"), "--one-process-each"]):
        hashes.append(json.loads(rig.rtse(*call, *more).splitlines()[-1])["state_hash"])
    assert len(set(hashes)) == 1, hashes
    assert rig.rtse("recording", "compare", rig.path("a.mcap"), rig.path("b.mcap")).startswith("equal: ")
    info = json.loads(rig.rtse("--json", "recording", "info", rig.path("a.mcap")))
    assert sorted(a["name"] for a in info["attachments"]) == ["system.xml", "world.sdf"], info["attachments"]
    velocity = next(c for c in info["channels"] if c["topic"] == "/LaserObstacleAvoid0/velocity")
    assert velocity["missing"] == 0 and velocity["first"] <= 0.2 and velocity["last"] >= 4.8, velocity
    done = rig.try_rtse(*call, "--record", "/no/such/folder/a.mcap")
    assert done.returncode == 1 and "/no/such/folder" in done.stderr, done


def refused(*words, says):
    done = rig.try_rtse(*words)
    assert done.returncode == 1 and says in done.stderr and done.stderr.count("\n") == 1, done


def bad_input():
    up()
    refused("record", "-o", file, "RTCPosition2d0:velocity", says="record reads OutPorts")
    refused("record", "-o", "/no/such/folder/x.mcap", "RTCLaser0:range", says="cannot be written")
    refused("recording", "info", "/no/such/file", says="cannot be read: No such file or directory")
    with open(file, "w") as out:
        out.write("no recording")
    refused("recording", "cat", file, says="is no MCAP file")
    refused("play", file, "A:b=RTCPosition2d0:velocity", says="is no MCAP file")
    assert rig.try_rtse("record", "RTCLaser0:range").returncode == 2
    assert rig.try_rtse("record", "-o", file).returncode == 2


with rig:
    globals()[case]()
print("ok")
