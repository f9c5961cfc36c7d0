# Recorded runs that are made again: a component alone, up to a time, as a whole. One case per run: recorded_again.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import json
import os
import subprocess

from recording_rig import ended, file, lines, recorded_run, recording, refused, rig, run_case, seconds, up


# A component alone answers its recorded inputs as in the run, to the bit; with another constant the first tick and member are named.
def replayed():
    path, _ = recorded_run("run.mcap", 10)
    call = ["replay", path, "--into", "LaserObstacleAvoid0", "--compare"]
    done = json.loads(rig.rtse("--json", *call, "--junit", rig.path("good.xml")))
    assert done["outputs"] == [{"topic": "/LaserObstacleAvoid0/velocity", "samples": 101, "recorded": 101, "different": 0, "first": ""}], done
    assert done["ticks"] == 101 and done["inputs"] == 101, done
    assert 'failures="0"' in open(rig.path("good.xml")).read()
    changed = rig.try_rtse(*call, "--set", "speed_gain=0.0011", "--junit", rig.path("bad.xml"))
    assert changed.returncode == 1 and "first difference at tick 0 (0 s): data.vx: 0.2 and 0.22" in changed.stderr, changed
    assert 'failures="1"' in open(rig.path("bad.xml")).read()
    if os.access(f"{rig.bin_dir}/rtse-page", os.X_OK):
        page = rig.path("bad.html")
        done = rig.try_rtse(*call, "--set", "speed_gain=0.0011", "--junit", rig.path("bad.xml"), "--page", page)
        assert f"page {page}: " in done.stdout and f"[[ATTACHMENT|{page}]]" in open(rig.path("bad.xml")).read(), done
        assert 'id="run-index"' in open(page).read()
    near = rig.try_rtse(*call, "--set", "speed_gain=0.0010000001", "--tolerance", "data.vx=1e-3", "--tolerance", "data.va=1e-3")
    assert near.returncode == 0, near
    other = rig.try_rtse(*call, "--module-path", f"{rig.lib_dir}/changed")
    turned = next(s for s in lines("cat", path, "LaserObstacleAvoid0:velocity") if s["value"]["data"]["va"] != 0)
    place = f"first difference at tick {round(turned['time'] * 10)} ({turned['time']:g} s): data.va: "
    assert other.returncode == 1 and place in other.stderr, (place, other)
    # Another module than the one that was asked for says nothing.
    empty = rig.path("empty")
    os.mkdir(empty)
    refused(*call, "--module-path", empty, code=2, says="module LaserObstacleAvoid.so or LaserObstacleAvoid.py is not in --module-path")
    refused("run", f"{rig.source}/worlds/systems/obstacle_avoidance.xml", "-w", f"{rig.source}/worlds/obstacle_course.sdf", "-d", "1", "--module-path", empty,
            says=f'module path "{empty}": holds no modules (*.so, *.py)', code=2)
    refused("replay", path, "--into", "Nobody0", code=2, says="components: RTCLaser0, LaserObstacleAvoid0, RTCPosition2d0")
    refused(*call, "--link", "A:b=range", code=2, says='link "A:b=range": the recording has no channel "/A/b"')
    refused(*call, "--link", "RTCLaser0:range=c", says='has no InPort "c"; it has range')
    refused(*call, "--set", "speed_gain=abc", says='parameter default.speed_gain cannot be "abc", expected a number')
    refused("replay", path, "--into", "RTCLaser0", says="cannot be activated alone; one that uses the simulator's devices finds none")


# Contexts of real time: their ticks are not in the recording, which is said.
def replayed_from_real_time():
    rig.naming()
    rig.server()
    rig.host(rig.device("RTCLaser"), "LaserObstacleAvoid", rig.device("RTCPosition2d"))
    rig.there("RTCLaser0", "LaserObstacleAvoid0", "RTCPosition2d0")
    rig.rtse("con", "RTCLaser0:range", "LaserObstacleAvoid0:range")
    rig.rtse("act", "RTCLaser0", "LaserObstacleAvoid0")
    rig.rtse("record", "-s", str(rig.server_id), "-o", file, "--all", "--only-ports", "-t", "1",
                    "--attach", f"system.xml={rig.source}/worlds/systems/obstacle_avoidance.xml", "-q")
    done = rig.try_rtse("replay", file, "--into", "LaserObstacleAvoid0", "--compare")
    assert "LaserObstacleAvoid0 was recorded outside of lock step: in which tick it read a sample is not known" in done.stderr, done


# A component whose inputs were not recorded: it is said which.
def replayed_without_inputs():
    up()
    process = recording("LaserObstacleAvoid0:velocity", "--attach", f"system.xml={rig.source}/worlds/systems/obstacle_avoidance.xml")
    seconds(2)
    ended(process)
    done = rig.try_rtse("replay", file, "--into", "LaserObstacleAvoid0")
    assert done.returncode == 0, done
    assert "input LaserObstacleAvoid0:range: missing, the recording has no /RTCLaser0/range" in done.stderr, done
    refused("replay", rig.path("nothing.mcap"), "--into", "A", code=2, says="no such file")
    os.remove(file)
    process = recording("RTCLaser0:range", "--attach", f"system.xml={rig.source}/worlds/systems/obstacle_avoidance.xml")
    seconds(2)
    ended(process)
    report = rig.path("nothing.xml")
    done = rig.try_rtse("replay", file, "--into", "LaserObstacleAvoid0", "--compare", "--junit", report)
    assert done.returncode == 1 and "cannot compare: the recording has no outputs of LaserObstacleAvoid0" in done.stderr, done
    with open(report) as text:
        assert "cannot compare" in text.read()


# The run is made again up to a moment, and is the same there; a condition is found in the tick in which the recording has it.
def gone_to():
    path, whole = recorded_run("run.mcap", 6)
    state = f"{rig.bin_dir}/simctl --json stats"
    there = rig.rtse("--json", "goto", path, "6", "--then", state).split("\n", 1)
    assert json.loads(there[0])["time"] == 6 and len(json.loads(there[0])["processes"]) == 3, there
    stats = json.loads(there[1])
    assert stats["hash"] == whole and stats["sim_time"] == 6, (stats["hash"], whole)
    with open(rig.path("said.txt"), "w+") as said:  # what the command says stands behind what was said before, and is followed
        done = subprocess.run([f"{rig.bin_dir}/rtse", "--json", "goto", path, "1", "--then", "echo one; echo two"], stdout=said, timeout=120)
        said.seek(0)
        said_lines = said.read().splitlines()
    assert done.returncode == 0 and json.loads(said_lines[0])["time"] == 1 and said_lines[1:3] == ["one", "two"], said_lines
    fast = next(s for s in lines("cat", path, "LaserObstacleAvoid0:velocity") if s["value"]["data"]["va"] < -0.1)
    call = ["--json", "goto", path, "--break", "LaserObstacleAvoid0:velocity.data.va < -0.1", "--then", state]
    stands = json.loads(rig.rtse(*call).split("\n", 1)[0])
    assert abs(stands["time"] - fast["time"]) < 1e-9, (stands, fast)
    before = json.loads(rig.rtse(*call, "--back", "2").split("\n", 1)[0])
    assert abs(before["time"] - (fast["time"] - 0.2)) < 1e-9, (before, fast)
    refused("goto", path, "--break", "LaserObstacleAvoid0:velocity.data.vx >", code=2, says="expected a value")
    refused("goto", path, "1", "--break", "time > 7", says="does not hold up to 1 s\n")
    refused("goto", path, "1", "--break", "LaserObstacleAvoid0:velocity.data.foo > 7", says="1 s; LaserObstacleAvoid0:velocity has no number data.foo\n")
    refused("goto", f"{rig.source}/worlds/systems/obstacle_avoidance.xml", "1", code=2, says="is not a recording; for a system profile, give its world: -w WORLD")
    assert "rtse: the recorded run ended at 6 s\n" == rig.try_rtse("goto", path, "7", "--then", "true").stderr
    done = subprocess.run([f"{rig.bin_dir}/rtse", "--json", "goto", path, "1"], input="n\nb 2\nt 0.5\nq\n", stdout=subprocess.PIPE, timeout=120, text=True)
    times = [json.loads(line)["time"] for line in done.stdout.splitlines()]
    assert times == [1, 1.1, 0.9, 0.5] and done.returncode == 0, done


# The processes of others are started again from what the recording says, are named, and stand at the same moment.
def gone_to_with_others():
    os.environ["PATH"] = f"{rig.bin_dir}:{os.environ['PATH']}"
    path, whole = recorded_run("run.mcap", 3, "--run-file", f"{rig.source}/worlds/systems/obstacle_avoidance.run.yaml")
    there, stats = rig.rtse("--json", "goto", path, "3", "--then", f"{rig.bin_dir}/simctl --json stats").split("\n", 1)
    processes = {process["what"]: process["pid"] for process in json.loads(there)["processes"]}
    assert processes.get("process of LaserObstacleAvoid0", 0) > 0, processes
    assert json.loads(stats)["hash"] == whole and json.loads(stats)["sim_time"] == 3, (stats, whole)


# The run of a recording, again.
def like():
    path, whole = recorded_run("run.mcap", 3)
    again = json.loads(rig.rtse("--json", "run", "--like", path).splitlines()[-1])
    assert again["state_hash"] == whole and again["simulated"] == 3, again
    other = json.loads(rig.rtse("--json", "run", "--like", path, "--seed", "5", "--duration", "2").splitlines()[-1])
    assert other["seed"] == 5 and other["simulated"] == 2, other


run_case(globals())
