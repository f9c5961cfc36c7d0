# Recordings of a system in lock step, one case per run: recordings.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import base64
import json
import os
import re
import resource
import shutil
import signal
import subprocess
import sys

from recording_rig import ended, file, lines, recorded_run, recording, refused, rig, run_case, seconds, up
from rig import await_


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
    *theirs, tail = foreign(file)
    assert tail == {"attachments": ["world.sdf"], "statistics": len(ours)}, tail
    assert len(theirs) == len(ours)
    for a, b in zip(ours, theirs):
        assert (a["topic"], a["sequence"], round(a["time"] * 1e9)) == (b["topic"], b["sequence"], b["time"]), (a, b)
        assert same(a["value"], b["value"]), (a, b)


# What the readers of others find: a line for each message, and one for the rest.
def foreign(name):
    done = subprocess.run(["node", f"{rig.source}/tests/foreign/read.mjs", name], stdout=subprocess.PIPE, check=True, timeout=120, text=True)
    return [json.loads(line) for line in done.stdout.splitlines()]


# JSON has no infinities; a reader that has them says null. We write octets as base64.
def same(a, b):
    if isinstance(a, str) and isinstance(b, list):
        return list(base64.b64decode(a)) == b
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(same(a[key], b[key]) for key in a)
    if isinstance(a, list):
        return len(a) == len(b) and all(same(x, y) for x, y in zip(a, b))
    return a == b or (a != a and b != b) or (isinstance(a, (int, float)) and isinstance(b, (int, float)) and abs(a - b) <= 1e-6 * max(abs(a), abs(b)))


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


# The same, and a component that answers the same to the bit when it is replayed, as often as RECORDING_REPEATS says, with both processors busy.
def repeated():
    count = int(os.environ.get("RECORDING_REPEATS", "3"))
    run = ["--json", "run", f"{rig.source}/worlds/systems/obstacle_avoidance.xml", "-w", f"{rig.source}/worlds/obstacle_course.sdf", "-d", "5"]
    burners = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(2)]
    try:
        expected = json.loads(rig.rtse(*run).splitlines()[-1])["state_hash"]
        for n in range(count):
            more = ["--one-process-each"] if n % 2 else []
            made = json.loads(rig.rtse(*run, "--record", file, *more).splitlines()[-1])["state_hash"]
            assert made == expected, (n, made, expected)
            again = json.loads(rig.rtse("--json", "replay", file, "--into", "LaserObstacleAvoid0", "--compare"))["outputs"]
            assert [o["different"] for o in again] == [0] and again[0]["samples"] == again[0]["recorded"] == 51, (n, again)
            print(f"{n + 1} of {count} the same", flush=True)
    finally:
        for burner in burners:
            burner.kill()
            burner.wait()


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


# A full disk ends the recorder with one line; the file has what came before, and the system goes on.
def full_disk():
    up()

    def small():
        resource.setrlimit(resource.RLIMIT_FSIZE, (400000, 400000))  # several chunks: one is written each second
    process = subprocess.Popen([f"{rig.bin_dir}/rtse", "--ns", rig.names, "record", "-s", str(rig.server_id), "-o", file, "RTCLaser0:range"],
                               stderr=subprocess.PIPE, text=True, preexec_fn=small)
    assert process.stderr.readline().startswith("recording ")
    for _ in range(100):
        if process.poll() is None:
            seconds(4)
    err = process.communicate(timeout=60)[1]
    assert process.returncode == 1 and err.count("\n") == 1 and "cannot be written: File too large; earlier samples are in it" in err, err
    kept = json.loads(rig.try_rtse("--json", "recording", "info", file).stdout)["samples"]
    repaired = rig.rtse("recording", "repair", file)
    assert kept > 0 and repaired == f"{kept} samples kept, 0 bytes lost\n", (kept, repaired)
    seconds(1)


# Two runs are equal sample by sample; another parameter is found at its first effect.
def compared():
    files = []
    up()
    for name in ("a", "b", "c"):
        files.append(rig.path(f"{name}.mcap"))
        if name == "c":
            rig.rtse("conf", "LaserObstacleAvoid0", "set", "speed_gain", "0.01")
        process = recording("RTCLaser0:range", "LaserObstacleAvoid0:velocity", to=files[-1])
        seconds(4)
        ended(process)
        rig.simctl("reset")
    assert rig.rtse("recording", "compare", files[0], files[1]).startswith("equal: ")
    process = recording("RTCLaser0:range", to=file)
    seconds(1)
    ended(process)
    lonely = rig.try_rtse("recording", "compare", files[0], file)
    assert lonely.returncode == 1 and lonely.stdout == f"channel /LaserObstacleAvoid0/velocity is in {files[0]} only\n", lonely
    done = rig.try_rtse("recording", "compare", files[0], files[2])
    assert done.returncode == 1 and re.match(r"first difference at time [\d.]+ s, tick \d+: /LaserObstacleAvoid0/velocity data.vx: \S+ and \S+\n", done.stdout), done


# What was recorded drives another component, as if its peer were there.
def played():
    up()
    process = recording("LaserObstacleAvoid0:velocity")
    seconds(3)
    ended(process)
    sent = len(lines("cat", file))
    done = rig.try_rtse("play", file, "LaserObstacleAvoid0:velocity=RTCPosition2d0:velocity", "--rate", "1000")
    assert done.returncode == 0 and f"sent {sent} samples" in done.stdout, done
    # Where it went in the run, without being told; the connection says what it is. What is not there is named.
    looped = subprocess.Popen([f"{rig.bin_dir}/rtse", "--ns", rig.names, "play", file, "--loop", "--rate", "100"], stdout=subprocess.PIPE, text=True)
    await_("the InPort has a connection that plays", lambda: "rtmsim.play.topic" in rig.rtse("cat", "-l", "RTCPosition2d0:velocity"))
    looped.send_signal(signal.SIGINT)
    assert re.fullmatch(r"sent \d+ samples\n", looped.communicate(timeout=60)[0]) and looped.returncode == 0
    views = rig.path("views.mcap")
    shown = subprocess.Popen([f"{rig.bin_dir}/rtse", "--ns", rig.names, "record", "-s", str(rig.server_id), "-o", views, "--views"], stderr=subprocess.PIPE, text=True)
    assert shown.stderr.readline().startswith("recording ")
    seconds(1)
    ended(shown)
    refused("play", views, "/tf=RTCPosition2d0:velocity", says="takes IDL:RTC/TimedVelocity2D:1.0, /tf was tf2_msgs/msg/TFMessage")
    done = rig.try_rtse("play", file, "--from", "1000", "--loop")
    assert done.returncode == 1 and "has no sample of these channels in the time that is to be played" in done.stderr, done
    # The same by simulated time: it takes part, and ends when time has come to its last sample.
    player = subprocess.Popen([f"{rig.bin_dir}/rtse", "--ns", rig.names, "play", file, "LaserObstacleAvoid0:velocity=RTCPosition2d0:velocity",
                               "--sim-time", "-s", str(rig.server_id)], stdout=subprocess.PIPE, text=True)
    await_("the player takes part", lambda: "play " in rig.simctl("participants"))
    seconds(2)
    assert player.poll() is None
    seconds(2)
    assert f"sent {sent} samples" in player.communicate(timeout=60)[0] and player.returncode == 0


# Files one behind the other, fewer samples, and the last ones.
def kept():
    up()
    processes = []
    for name, *words in (("split.mcap", "--split", "1s"), ("few.mcap", "--rate", "2"), ("last.mcap", "--last", "1000ms"),
                         ("small.mcap", "--split", "20k", "--views")):
        processes.append(subprocess.Popen([f"{rig.bin_dir}/rtse", "--ns", rig.names, "record", "-s", str(rig.server_id), "-o", rig.path(name),
                                           "RTCLaser0:range", *words], stderr=subprocess.PIPE, text=True))
        assert processes[-1].stderr.readline().startswith("recording ")
    seconds(3.5)
    said = [ended(process) for process in processes]
    assert f'in "{rig.path("split-001.mcap")}" to "{rig.path("split-004.mcap")}"\n' in said[0], said
    def times(name):
        return [round(s["time"], 3) for s in lines("cat", rig.path(name))]
    parts = [times(f"split-00{n}.mcap") for n in range(1, 5)]
    assert [len(part) for part in parts[1:3]] == [10, 10] and all(part[-1] - part[0] < 1 for part in parts), parts
    whole = sum(parts, [])
    assert abs(len(whole) - 35) <= 1 and whole == sorted(set(whole)), whole
    info = [json.loads(rig.rtse("--json", "recording", "info", rig.path(f"split-00{n}.mcap"))) for n in range(1, 5)]
    assert all([a["name"] for a in one["attachments"]] == ["world.sdf"] and one["run"]["lockstep"] == "yes" for one in info), info
    few = times("few.mcap")
    assert len(few) == len({int(t * 2 + 1e-9) for t in whole}) and all(b - a > 0.39 for a, b in zip(few, few[1:])), few
    last = times("last.mcap")
    assert last == [t for t in whole if t >= whole[-1] - 1 - 1e-9], last
    # What every file begins with is larger than a part is to be: each has as much of its own.
    small = [name for name in os.listdir(rig.work) if name.startswith("small-")]
    assert 1 < len(small) < 20, small


# `rtse run` records from before the first step on; two runs are equal, and equal to the run without, also in what passed each port: one that nobody but
# the recorder is connected to has sent nothing that counts.
def of_a_run():
    call = ["--json", "run", f"{rig.source}/worlds/systems/obstacle_avoidance.xml", "--world", f"{rig.source}/worlds/obstacle_course.sdf", "--duration", "5"]
    hashes = []
    for more in ([], ["--record", rig.path("a.mcap")], ["--record", rig.path("b.mcap"), "--one-process-each"]):
        made = json.loads(rig.rtse(*call, "--hash-log", rig.path(f"{len(hashes)}.hashlog"), *more).splitlines()[-1])
        hashes.append((made["state_hash"], made["run_hash"]))
    assert len(set(hashes)) == 1, hashes
    done = rig.try_rtse(*call, "--twice", "--record", rig.path("twice.mcap"))
    assert done.returncode == 0, done
    # Also where only the recorder reads a sensor: the follower's laser is for a client of Player, who is not there.
    done = rig.try_rtse("run", f"{rig.source}/worlds/systems/leader_follower.xml", "--world", f"{rig.source}/worlds/leader_follower.sdf", "--duration", "2",
                        "--twice", "--record", rig.path("other.mcap"))
    assert done.returncode == 0, done
    assert rig.rtse("recording", "compare", rig.path("a.mcap"), rig.path("b.mcap")).startswith("equal: ")
    # A page does not take the place of its recording, whatever name that has.
    os.link(rig.path("b.mcap"), rig.path("c.mcap"))
    for words in (("page", "a.mcap", "-o", "a.mcap"), ("page", "a.mcap", "b.mcap", "-o", "c.mcap"), ("recording", "export", "a.mcap", "--html", "a.mcap")):
        done = rig.try_rtse(*(rig.path(word) if word.endswith(".mcap") else word for word in words))
        assert done.returncode == 1 and "is the recording; expected another file" in done.stderr, done
    with open(rig.path("a.mcap"), "rb") as whole, open(rig.path("cut.mcap"), "wb") as cut:
        cut.write(whole.read()[:-1000])
    assert "what is damaged in the recording: " in rig.rtse("page", rig.path("cut.mcap"), "-o", rig.path("cut.html"))
    info = json.loads(rig.rtse("--json", "recording", "info", rig.path("a.mcap")))
    assert sorted(a["name"] for a in info["attachments"]) == ["system.xml", "world.sdf"], info["attachments"]
    velocity = next(c for c in info["channels"] if c["topic"] == "/LaserObstacleAvoid0/velocity")
    assert velocity["missing"] == 0 and velocity["first"] <= 0.2 and velocity["last"] >= 4.8, velocity
    done = rig.try_rtse(*call, "--record", "/no/such/folder/a.mcap")
    assert done.returncode == 2 and "/no/such/folder" in done.stderr, done


# What the simulator shows, in messages that other people's readers know: one of each kind of device, field for field.
def views():
    rig.server("--lockstep", "--rtf", "0", "--paused", world=f"{rig.source}/tests/worlds/every_device.sdf")
    process = recording("--views", "--raw-pictures")
    seconds(0.5)
    ended(process)
    info = json.loads(rig.rtse("--json", "recording", "info", file))
    kinds = {c["type"].split("/")[-1] for c in info["channels"]}
    assert kinds == {"TFMessage", "Clock", "LaserScan", "Range", "Image", "CameraInfo", "PointCloud2", "MarkerArray", "Imu", "NavSatFix", "Float64",
                     "MagneticField", "FluidPressure", "WrenchStamped", "Odometry", "JointState", "BatteryState", "TwistWithCovarianceStamped", "TwistStamped", "String",
                     "PoseWithCovarianceStamped", "Detection2DArray"}, kinds
    assert all(c["samples"] > 0 and c["missing"] == 0 for c in info["channels"]), info["channels"]
    ours, theirs = lines("cat", file), foreign(file)[:-1]
    assert len(ours) == len(theirs)
    for a, b in zip(ours, theirs):
        assert a["topic"] == b["topic"] and same(a["value"], b["value"]), (a, b)
    scan = json.loads(rig.simctl("--json", "echo", "rig::laser", "-n", "1"))
    last = [s for s in ours if s["topic"] == "/sim/laser/rig/laser"][-1]
    assert last["value"]["header"]["frame_id"] == "rig::laser" and len(last["value"]["ranges"]) == len(scan["ranges"]), last
    pictures = sum(s["topic"] == "/sim/camera/rig/eyes/image" for s in ours)
    assert f"{pictures} pictures" in rig.rtse("recording", "export", file, "/sim/camera/rig/eyes/image", "--png", "-o", rig.path("png"))
    drawn = sorted(os.listdir(rig.path("png/sim.camera.rig.eyes.image")))
    assert len(drawn) == pictures > 10, drawn
    assert open(rig.path(f"png/sim.camera.rig.eyes.image/{drawn[-1]}"), "rb").read(24)[-8:] == bytes([0, 0, 0, 16, 0, 0, 0, 12]), drawn
    moving = {t["child_frame_id"] for s in ours if s["topic"] == "/tf" for t in s["value"]["transforms"]}
    assert {"rover", "flyer"} <= moving, moving
    looks_like_the_world(ours, moving)


# Every link has a frame, and a marker for each shape; joints are where the simulator says.
def looks_like_the_world(samples, moving):
    fixed = {t["child_frame_id"] for s in samples if s["topic"] == "/tf_static" for t in s["value"]["transforms"]}
    first, *shapes = next(s for s in samples if s["topic"] == "/sim/shapes")["value"]["markers"]
    assert first["action"] == 3 and shapes, first
    models = json.loads(rig.simctl("--json", "tree"))["models"]
    links = {f"{m['name']}::{link['name']}" for m in models for link in m["links"]}
    assert links <= fixed | moving and not (links & fixed & moving), (links, fixed, moving)
    assert {s["header"]["frame_id"] for s in shapes} <= links, shapes
    assert all(s["type"] == 11 and s["points"] and len(s["points"]) % 3 == 0 and s["color"]["a"] > 0 for s in shapes)
    assert len({(s["ns"], s["id"]) for s in shapes}) == len(shapes)
    jointed = [m for m in models if not m["static"] and any(j["type"] not in ("fixed", "ball", "gearbox") for j in m["joints"])]
    for model in jointed:
        state = [s for s in samples if s["topic"] == f"/sim/joints/{model['name']}"][-1]["value"]
        places = dict(zip(state["name"], state["position"]))
        assert all(abs(places[j["name"]] - j["position"]) < 1e-5 for j in model["joints"] if j["name"] in places), (state, model["joints"])
    assert jointed


def said(samples, topic, member):
    return [s["value"][member] for s in samples if s["topic"] == topic]


# What components say of themselves is in the recording, at its tick; a replay does to the component what was done to it in the run.
def lives():
    up()
    profile = f"system.xml={rig.source}/worlds/systems/obstacle_avoidance.xml"
    process = recording("--all", "--attach", profile)
    part = rig.path("part.mcap")
    ring = recording("--all", "--attach", profile, "--last", "3", to=part)
    seconds(2)
    rig.rtse("conf", "LaserObstacleAvoid0", "set", "speed_gain", "0.002")
    seconds(1)
    rig.rtse("deact", "LaserObstacleAvoid0")
    seconds(1)
    rig.rtse("act", "LaserObstacleAvoid0")
    seconds(2)
    ended(process)
    ended(ring)
    ours, theirs = lines("cat", file), foreign(file)[:-1]
    assert len(ours) == len(theirs) and all(a["topic"] == b["topic"] and same(a["value"], b["value"]) for a, b in zip(ours, theirs))
    states = [s for s in ours if s["topic"] == "/rtc/LaserObstacleAvoid0/state"]
    assert [s["value"]["state"] for s in states] == ["Active", "Inactive", "Active"] and states[1]["time"] <= 3.1 and states[2]["time"] >= 4, states
    first, *changes = [s for s in ours if s["topic"] == "/rtc/LaserObstacleAvoid0/configuration"]
    assert not first["value"]["is_change"] and first["value"]["values"]["speed_gain"] == "0.001", first
    changed = next(s for s in changes if s["value"]["values"].get("speed_gain") == "0.002")
    assert 2 < changed["time"] <= 2.1 and changed["value"]["is_in_tick"], changed
    seen = [{one["name"]: (one["message"], {v["key"]: v["value"] for v in one["values"]}) for one in status} for status in said(ours, "/diagnostics", "status")]
    assert len(seen) >= 5 and seen[2]["RTCLaser0"] == ("Active", {"intensities [Hz]": "10", "range [Hz]": "10"}), seen
    assert any(one["LaserObstacleAvoid0"][0] == "Inactive" for one in seen), seen
    done = json.loads(rig.rtse("--json", "replay", file, "--into", "LaserObstacleAvoid0", "--compare"))
    assert done["changes"] >= 3 and done["outputs"][0]["different"] == 0 and done["outputs"][0]["recorded"] > 40, done
    # A part begins with the values that hold then, though they were set before.
    done = json.loads(rig.rtse("--json", "replay", part, "--into", "LaserObstacleAvoid0", "--compare"))
    assert done["outputs"][0]["different"] == 0 and done["outputs"][0]["recorded"] > 10, done
    other = rig.try_rtse("replay", file, "--into", "LaserObstacleAvoid0", "--compare", "--set", "speed_gain=0.001")
    assert other.returncode == 1 and "(2.1 s): data.vx: 0.4 and 0.2" in other.stderr, other


# What is excluded has no channel either.
def excluded():
    up()
    process = recording("--all", "--exclude", "RTCLaser*:*", "--exclude", "/sim/laser/*", "--exclude", "/tf")
    seconds(1)
    ended(process)
    topics = {c["topic"]: c["samples"] for c in json.loads(rig.rtse("--json", "recording", "info", file))["channels"]}
    assert not [t for t in topics if t in ("/RTCLaser0/range", "/tf") or t.startswith("/sim/laser/")], topics
    assert topics["/LaserObstacleAvoid0/velocity"] > 0 and topics["/clock"] > 0 and topics["/tf_static"] == 1, topics


# The hashes of a run's ticks are a channel: those of the hash log.
def hashed():
    path = rig.path("run.mcap")
    done = json.loads(rig.rtse("--json", "run", f"{rig.source}/worlds/systems/obstacle_avoidance.xml", "-w", f"{rig.source}/worlds/obstacle_course.sdf",
                               "-d", "2", "--record", path, "--hash-log", rig.path("run.hashlog")).splitlines()[-1])
    ticks = lines("cat", path, "/hashes")
    assert ticks[-1]["value"]["so_far"] == done["run_hash"] != "", (ticks[-1], done)
    assert [t["value"]["tick"] for t in ticks] == list(range(len(ticks))) and len(ticks) == 21, len(ticks)  # as components are called, whoever records
    leaves = set().union(*(t["value"]["leaves"] for t in ticks))
    assert any("LaserObstacleAvoid0:velocity" in leaf for leaf in leaves), leaves
    assert [t["value"] for t in foreign(path)[:-1] if t["topic"] == "/hashes"] == [t["value"] for t in ticks]
    # A run without a hash log is the same run; one without a port is not.
    without, _ = recorded_run("without.mcap", 2)
    done = rig.try_rtse("recording", "compare", path, without)
    assert done.returncode == 0 and done.stderr == f"rtse: channel /hashes is in {path} only, and is left out\n", done
    done = rig.try_rtse("recording", "compare", path, without, "--channel", "/*/velocity", "--channel", "/hashes")
    assert done.returncode == 2 and 'has no channel "/hashes"' in done.stderr, done


# The end of the simulator is the end of a recording of what it shows, and is said.
def simulator_ends():
    server = rig.server("--lockstep", "--rtf", "0", "-u")
    process = recording("--views")
    seconds(1)
    server.terminate()
    out, err = process.communicate(timeout=60)
    assert process.returncode == 1 and "record: the simulator has ended, and the recording with it" in err and "recorded " in err, (out, err)
    assert len([s for s in lines("cat", file) if s["topic"] == "/clock"]) >= 49
    done = rig.try_rtse("recording", "info", file)
    assert done.returncode == 0 and done.stderr == "", done


def bad_input():
    # rtse without the program that knows recordings says so, whatever follows the verb.
    os.makedirs(rig.path("alone/bin"))
    shutil.copy(f"{rig.bin_dir}/rtse", rig.path("alone/bin"))
    os.symlink(rig.lib_dir, rig.path("alone/lib"))
    for words in (("recording", "info", file), ("record", "--all", "-o", file), ("run", "--like", file)):
        done = subprocess.run([rig.path("alone/bin/rtse"), *words], text=True, capture_output=True, timeout=30)
        assert done.returncode == 1 and done.stderr.endswith("rtse-recorder: cannot be started; expected it beside rtse\n"), done
    up()
    refused("record", "-o", file, "--all", "--exclude", "*", says="--exclude leaves none of the 5 OutPorts")
    refused("record", "-o", file, "RTCPosition2d0:velocity", says="record reads OutPorts")
    refused("record", "-o", "/no/such/folder/x.mcap", "RTCLaser0:range", says="cannot be written")
    refused("recording", "info", "/no/such/file", code=2, says='"/no/such/file": no such file; there is no folder "/no/such"')
    with open(file, "w") as out:
        out.write("no recording")
    refused("recording", "cat", file, code=2, says="is not an MCAP file")
    refused("play", file, "A:b=RTCPosition2d0:velocity", code=2, says="is not an MCAP file")
    assert rig.try_rtse("record", "RTCLaser0:range").returncode == 2
    assert rig.try_rtse("record", "-o", file).returncode == 2


run_case(globals())
