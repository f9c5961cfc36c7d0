#!/usr/bin/env python3
"""The Python module rtmsim against the simulator alone, in one run; prints each number with its limit beside it. The best of several rounds
counts, because other programs only make a round slower.

usage: PYTHONPATH=build/release/python python_bench.py
"""
import os
import pathlib
import sys
import time

import rtmsim

course = str(pathlib.Path(__file__).resolve().parents[2] / "worlds" / "obstacle_course.sdf")
rounds = 7


def row(what, value, unit, limit):
    print(f"{what:<72} {value:>10.2f} {unit:<10} limit {limit}", flush=True)


def best(work, count):
    shortest = float("inf")
    for _ in range(rounds):
        began = time.perf_counter()
        work()
        shortest = min(shortest, time.perf_counter() - began)
    return count / shortest


def turn(world):
    world.scan("pioneer2dx::laser")
    drive = world.drive("pioneer2dx")
    drive.velocity(0.1, va=0.3)
    world.step(1000)
    return drive


def loop(world, drive, count):
    for _ in range(count):
        drive.velocity(0.1, va=0.3)
        world.step(1)
        world.scan("pioneer2dx::laser")
        drive.odometry


def reset_time(world):
    shortest = float("inf")
    for seed in range(30):
        world.step(100)
        began = time.perf_counter()
        world.reset(seed)
        world.scan("pioneer2dx::laser")
        shortest = min(shortest, time.perf_counter() - began)
    return shortest


with rtmsim.World(course) as world:
    drive = turn(world)
    alone = best(lambda: world.step(20000), 20000)
    row("the simulator alone, a robot that drives and scans", alone, "steps/s", "-")
    row("step(1), command, scan and odometry as numpy", best(lambda: loop(world, drive, 2000), 2000), "steps/s", ">= 25000")
    row("step(1)", best(lambda: [world.step(1) for _ in range(2000)], 2000), "steps/s", "-")
    hundreds = best(lambda: [world.step(100) for _ in range(100)], 10000)
    row("step(100) to the simulator alone", hundreds / alone, "", ">= 0.9")
    row("reset after 100 steps, and the first scan", 1e3 * reset_time(world), "ms", "<= 3")
    row("scan of 682 beams", 1e6 / best(lambda: [world.scan("pioneer2dx::laser") for _ in range(5000)], 5000), "us", "-")


def processor_time(world):
    """Seconds on a processor, and those that a thread was ready and had none."""
    times = [file.read_text().split() for file in pathlib.Path(f"/proc/{world._line().pid}/task").glob("*/schedstat")]
    return sum(int(one[0]) for one in times) / 1e9, sum(int(one[1]) for one in times) / 1e9


def cost(work, worlds, count):
    """CPU time and waiting per step: the lowest CPU time of several rounds."""
    found = []
    for _ in range(rounds):
        before = [processor_time(world) for world in worlds]
        work()
        after = [processor_time(world) for world in worlds]
        found.append(tuple(sum(b[i] - a[i] for a, b in zip(before, after)) / count for i in (0, 1)))
    return min(found)


class Task(rtmsim.Env):
    def __init__(self):
        super().__init__(course, physics_steps=10)
        self.drive = self.world.drive("pioneer2dx")

    def act(self, world, action):
        self.drive.velocity(0.1, va=action)

    def observe(self, world):
        return world.scan("pioneer2dx::laser")

    def judge(self, world, observation):
        return 0.0, False


with Task() as env:
    env.reset(seed=1)
    row("Env.step of 10 physics steps", best(lambda: [env.step(0.3) for _ in range(1000)], 1000), "1/s", ">= 5000")

worlds = [rtmsim.World(course, options=["--threads", "1"]) for _ in range(8)]
for world in worlds:
    turn(world)
one = best(lambda: worlds[0].step(5000), 5000)
eight = best(lambda: rtmsim.step_all(worlds, 5000), 40000)
row("8 worlds in parallel to one world, two cores", eight / one, "", ">= 1.7 if idle")
# Beside other programs: what a step costs, with the other seven and without. Waiting for a processor is not part of it.
one, _ = cost(lambda: worlds[0].step(20000), worlds[:1], 20000)
eight, waiting = cost(lambda: rtmsim.step_all(worlds, 5000), worlds, 40000)
row("the same by CPU time, two cores", 2 * one / eight, "", ">= 1.7")
row("waiting of the 8 simulators for a processor, to their CPU time", waiting / eight, "", "3 if idle")
for world in worlds:
    world.close()


def started(text):
    shortest = float("inf")
    for _ in range(20):
        process = os.posix_spawn(sys.executable, [sys.executable, "-c", text], os.environ)
        used = os.wait4(process, 0)[2]
        shortest = min(shortest, used.ru_utime + used.ru_stime)
    return shortest


# Above the interpreter's own start, by CPU time: the wall clock of a loaded machine says little.
bare = started("pass")
for module in ("rtmsim", "OpenRTM_aist"):
    row(f"import {module}", 1e3 * (started(f"import {module}") - bare), "ms", "<= 30")
