#!/usr/bin/env python3
"""What the whole tree of hashes (docs/hash-logs.md) costs: 100 robots, driven by 300 components in ten processes, in lock step. Two such systems stand side by
side, one with hash logs, and are stepped in turns, a little at a time, so that other work on the machine holds up both alike. Processor time of all processes
of each, and time on the wall; prints the ratios with their limit beside them: the median of all turns, and with it the ratio of the sums. Where the memory of a
process lies makes it faster or slower by some percent for all of its life: both are started anew several times, the one first and then the other. On a machine
that does nothing else the wall tells: processors that are free are also used to look for news, by whichever system finds them free.

usage: hash_bench.py [BUILD_DIR] [--robots N] [--steps N] [--rounds N] [--starts N]      (default: build/release, 100 robots, 6 starts, 20 turns each of 100 steps of 5 ms)
"""
import argparse
import contextlib
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

source = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(source / "tests/scenario"))
import chance_system as parts
from system import System

parser = argparse.ArgumentParser()
parser.add_argument("build", nargs="?", default=str(source / "build/release"))
parser.add_argument("--robots", type=int, default=100)
parser.add_argument("--steps", type=int, default=100)
parser.add_argument("--rounds", type=int, default=20)
parser.add_argument("--starts", type=int, default=6)
options = parser.parse_args()
build = pathlib.Path(options.build).resolve()
robots_per_host = 10
driven = options.robots

LASER, AVOID, DRIVE = "RTC:rtm-sim:simulation:RTCLaser:1.0.0", "RTC:rtm-sim:navigation:LaserObstacleAvoid:1.0.0", "RTC:rtm-sim:simulation:RTCPosition2d:1.0.0"


def the_system():
    text = []
    for i in range(driven):
        text += [parts.component(f"Laser{i}", 10, LASER), parts.component(f"Avoid{i}", 10, AVOID), parts.component(f"Drive{i}", 10, DRIVE),
                 parts.link(f"Laser{i}.range", f"Avoid{i}.range", "IDL:RTC/RangeData:1.0", source_id=LASER, target_id=AVOID),
                 parts.link(f"Avoid{i}.velocity", f"Drive{i}.velocity", "IDL:RTC/TimedVelocity2D:1.0", source_id=AVOID, target_id=DRIVE)]
    return parts.system(*text)


# [s] of all threads of these processes.
def processor_time(processes):
    total = 0
    for process in processes:
        for task in pathlib.Path(f"/proc/{process.pid}/task").iterdir():
            with contextlib.suppress(FileNotFoundError, ProcessLookupError):  # a thread that has ended meanwhile
                total += int((task / "schedstat").read_text().split()[0])
    return total * 1e-9


# A system that stands ready, 200 steps after its start.
@contextlib.contextmanager
def running(world, system, folder, with_hashes):
    with System(str(build / "bin"), str(build / "lib")) as s:
        s.naming()
        s.server(world, "--paused", "--rtf", "0", "--lockstep", *(["--hash-log", f"{folder}/world.hashlog"] if with_hashes else []))
        names = []
        for first in range(0, driven, robots_per_host):
            words = []
            for i in range(first, min(first + robots_per_host, driven)):
                device = f"exec_cxt.periodic.rate=10&conf.default.server_id={s.server_id}&conf.default.device_id=pioneer_{i}"
                words += [f"RTCLaser?instance_name=Laser{i}&{device}::laser&exec_cxt.sim_time.phase=0", f"LaserObstacleAvoid?instance_name=Avoid{i}&exec_cxt.periodic.rate=10",
                          f"RTCPosition2d?instance_name=Drive{i}&{device}::position2d&exec_cxt.sim_time.phase=2"]
                names += [f"Laser{i}", f"Avoid{i}", f"Drive{i}"]
            s.host(*(["-o", f"exec_cxt.sim_time.hash_log:{folder}"] if with_hashes else []), *words)
        s.rtse("wait", *names, "--state", "any", "--timeout", "60")
        s.rtse("load", system)
        s.rtse("act", *names)
        s.until("participants", lambda: len(s.participants()) == len(names))
        s.simctl("step", "200")
        yield s


# [s] of processor time for a turn, and of time on the wall.
def turn(s):
    before, began = processor_time(s.running), time.perf_counter()
    s.simctl("step", str(options.steps))
    wall = time.perf_counter() - began
    return processor_time(s.running) - before, wall


with tempfile.TemporaryDirectory() as work:
    world, system, logs = f"{work}/world.sdf", f"{work}/system.xml", f"{work}/logs"
    os.mkdir(logs)
    subprocess.run([sys.executable, str(source / "worlds/make_arena.py"), str(options.robots), world], check=True)
    os.environ["RTMSIM_RESOURCE_PATH"] = str(source / "worlds")
    pathlib.Path(system).write_text(the_system())
    turns, walls, octets = [], [], 0
    for start in range(options.starts):
        with contextlib.ExitStack() as both:
            systems = {is_hashed: both.enter_context(running(world, system, logs, is_hashed)) for is_hashed in ((False, True) if start % 2 == 0 else (True, False))}
            for i in range(options.rounds):
                took = {is_hashed: turn(systems[is_hashed]) for is_hashed in ((False, True) if i % 2 == 0 else (True, False))}
                turns.append((took[False][0], took[True][0]))
                walls.append((took[False][1], took[True][1]))
            octets = sum(file.stat().st_size for file in pathlib.Path(logs).iterdir())
        for file in pathlib.Path(logs).iterdir():
            file.unlink()
    without, together = (sum(times) for times in zip(*turns))
    a_start = options.rounds * options.steps * 0.005
    seconds = a_start * options.starts
    print(f"{options.robots} robots, {3 * driven} components: processor time for each simulated second {without / seconds:.3f} s, with hashes {together / seconds:.3f} s; "
          f"{octets / (a_start + 1) / 1e6:.2f} MB of hash logs")
    print(f"{'  with hashes / without, median of the turns':<78} {statistics.median(b / a for a, b in turns):>9.3f}            limit < 1.03")
    print(f"{'  the same, of the sums':<78} {together / without:>9.3f}")
    print(f"{'  time on the wall with hashes / without, median of the turns':<78} {statistics.median(b / a for a, b in walls):>9.3f}            limit < 1.03")
    print(f"{'  the same, of the sums':<78} {sum(b for _, b in walls) / sum(a for a, _ in walls):>9.3f}", flush=True)
