# What recordings cost: recording_bench.py BIN_DIR LIB_DIR SOURCE_DIR. The obstacle run with and without its recording, the same run again to a moment, a component alone, a place in a
# one-hour file, and the scans and odometry of a hundred robots. Beside each number its limit; exit 1 when one is missed.
import json
import signal
import subprocess
import sys
import time

bin_dir, lib_dir, source = sys.argv[1:]
sys.path.insert(0, f"{source}/tests/scenario")
from rig import Rig  # noqa: E402

rig = Rig(bin_dir, lib_dir, source)
system = [f"{source}/worlds/systems/obstacle_avoidance.xml", "--world", f"{source}/worlds/obstacle_course.sdf"]
missed = 0


def row(what, value, unit, limit, is_good):
    global missed
    missed += not is_good
    print(f"| {what:<58} | {value:9.1f} {unit:<3} | {limit:<12} | {'ok' if is_good else 'MISS':<4} |", flush=True)


def timed(*words):
    start = time.perf_counter()
    out = rig.rtse(*words)
    return time.perf_counter() - start, out


def best(runs, *words):
    return min(timed(*words)[0] for _ in range(runs))


def obstacle_run():
    file = rig.path("run.mcap")
    run = ("--json", "run", *system, "--duration", "57")
    bare = best(3, *run)
    kept = best(3, *run, "--record", file)
    row("obstacle run of 57 s, recorded, slower by", 100 * (kept / bare - 1), "%", "-", True)
    there = best(3, "goto", file, "57", "--then", "true")
    row("goto 57 s", 1000 * there, "ms", "<= 1500 ms", there <= 1.5)
    alone = max((json.loads(rig.rtse("--json", "replay", file, "--into", "LaserObstacleAvoid0", "--compare")) for _ in range(3)),
                key=lambda r: r["simulated"] / r["wall"])
    factor = alone["simulated"] / alone["wall"]
    row("replay of LaserObstacleAvoid, times real time", factor, "x", ">= 500 x", factor >= 500)


def one_hour():
    file = rig.path("hour.mcap")
    rig.rtse("run", *system, "--duration", "3600", "--record", file)
    begin = best(5, "recording", "cat", file, "/RTCLaser0/range", "-n", "1")
    late = best(5, "recording", "cat", file, "/RTCLaser0/range", "--from", "3000", "-n", "1")
    row("a sample at 3000 s of an hour, program and all", 1000 * late, "ms", "-", True)
    row("the same, more than the first sample of the file", 1000 * (late - begin), "ms", "<= 50 ms", late - begin <= 0.05)


# Wall time of two simulated seconds of a hundred robots.
def hundred(*words):
    server = rig.server("--lockstep", "--rtf", "0", "--paused", world=f"{source}/worlds/hundred.sdf")
    recorder = None
    if words:
        recorder = subprocess.Popen([f"{bin_dir}/rtse", "record", "-s", str(rig.server_id), "-o", rig.path("hundred.mcap"), *words],
                                    stderr=subprocess.PIPE, text=True)
        assert recorder.stderr.readline().startswith("recording ")
    rig.simctl("step", "200")
    start = time.perf_counter()
    rig.simctl("step", "2000")
    took = time.perf_counter() - start
    if recorder:
        recorder.send_signal(signal.SIGINT)
        recorder.communicate(timeout=60)
        assert recorder.returncode == 0
    server.terminate()
    server.wait(20)
    return took


def robots():
    read = hundred("--views", "--rate", "0.001")
    kept = hundred("--views")
    row("scans and odometry of a hundred robots, kept, slower by", 100 * (kept / read - 1), "%", "<= 5 %", kept <= 1.05 * read)


with rig:
    for part in (obstacle_run, one_hour, robots):
        part()
sys.exit(1 if missed else 0)
