#!/usr/bin/env python3
"""Whole systems in lock step against the same world without components, in one run; prints each number with its limit beside it.

usage: system_bench.py [BUILD_DIR]      (default: build/release)
"""
import os
import pathlib
import signal
import statistics
import subprocess
import sys
import tempfile
import time

source = pathlib.Path(__file__).resolve().parents[2]
build = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else source / "build/release").resolve()
sys.path.insert(0, str(source / "tests/scenario"))
from system import System

bin_dir, lib_dir = str(build / "bin"), str(build / "lib")
rounds = 3


def row(what, value, unit, limit):
    print(f"{what:<78} {value:>9.2f} {unit:<10} limit {limit}", flush=True)


def timed_steps(s, steps):
    began = time.perf_counter()
    s.simctl("step", str(steps))
    return time.perf_counter() - began


# [s] of processor time that the processes have used.
def processor_time(*processes):
    ticks = 0
    for process in processes:
        with open(f"/proc/{process.pid}/stat") as file:
            ticks += sum(int(number) for number in file.read().rsplit(")", 1)[1].split()[11:13])
    return ticks / os.sysconf("SC_CLK_TCK")


# Robots that drive and scan, nothing else: [s] for `steps` steps.
def bare(world, robots, steps):
    with System(bin_dir, lib_dir) as s:
        s.server(world, "--paused", "--rtf", "0")
        for robot in robots:
            s.start(f"{bin_dir}/simctl", "-s", s.server_id, "--json", "echo", f"{robot}::laser")
            s.start(f"{bin_dir}/simctl", "-s", s.server_id, "velocity", f"{robot}::position2d", "0.1", "0", "0.3")
        s.until("subscribers", lambda: s.stats()["subscribed"] == len(robots))  # of the lasers; commands need no subscription
        timed_steps(s, 1000)
        return timed_steps(s, steps)


# The same with RTCLaser, LaserObstacleAvoid and RTCPosition2d for each robot. `apart`: a process for each component, else one per robot.
def with_components(world, robots, steps, apart):
    with System(bin_dir, lib_dir) as s:
        s.naming()
        s.server(world, "--paused", "--rtf", "0", "--lockstep")
        names = []
        for i, robot in enumerate(robots):
            device = f"exec_cxt.periodic.rate=10&conf.default.server_id={s.server_id}&conf.default.device_id={robot}"
            mine = [f"Laser{i}", f"Avoid{i}", f"Drive{i}"]
            arguments = [f"RTCLaser?instance_name={mine[0]}&{device}::laser", f"LaserObstacleAvoid?instance_name={mine[1]}&exec_cxt.periodic.rate=10",
                         f"RTCPosition2d?instance_name={mine[2]}&{device}::position2d"]
            if apart:
                for argument in arguments:
                    s.host(argument)
            else:
                s.host(*arguments)
            names += mine
        s.rtse("wait", *names, "--state", "any", "--timeout", "60")
        for i in range(len(robots)):
            s.rtse("con", f"Laser{i}:range", f"Avoid{i}:range", "-p", "dataport.subscription_type=flush")
            s.rtse("con", f"Avoid{i}:velocity", f"Drive{i}:velocity", "-p", "dataport.subscription_type=flush")
        s.rtse("act", *names)
        s.until("participants", lambda: len(s.participants()) == len(names))
        timed_steps(s, 1000)
        seconds = timed_steps(s, steps)
        if len(robots) == 1:
            print("  tick of each component: " + ", ".join(f"{p['name']} {p['mean_us']:.0f} us" for p in s.participants()), flush=True)
        return seconds


# Three components that send to each other, each in a process of its own, at 10 Hz. kind: ours (on simulated time by themselves), joined (the same
# components on contexts of their own, as if of another make), python (of another make indeed).
def three_processes(world, steps, kind):
    with System(bin_dir, lib_dir) as s:
        s.naming()
        s.server(world, "--paused", "--rtf", "0", "--lockstep")
        names = ["First", "Second", "Third"]
        for phase, name in enumerate(names):
            relay = f"Relay?instance_name={name}&exec_cxt.periodic.rate=10&exec_cxt.sim_time.phase={phase}&conf.default.source={int(phase == 0)}"
            if kind == "ours":
                s.host(relay)
            elif kind == "joined":
                s.rtcd(relay)
            else:
                s.start(sys.executable, "-B", f"{source}/tests/scenario/foreign_component.py", name, "--names", s.names, *(["--source"] if phase == 0 else []))
        s.rtse("wait", *names, "--state", "any", "--timeout", "60")
        for a, b in zip(names, names[1:]):
            s.rtse("con", f"{a}:out", f"{b}:in", "-p", "dataport.subscription_type=flush")
        for phase, name in enumerate(names if kind != "ours" else []):
            s.rtse("join", name, "--rate", "10", "--phase", str(phase), "--server-id", s.server_id)
        s.rtse("act", *names)
        s.until("participants", lambda: len(s.participants()) == len(names))
        timed_steps(s, 1000)
        seconds = timed_steps(s, steps)
        print(f"  {kind}, tick of each component: " + ", ".join(f"{p['name']} {p['mean_us']:.0f} us" for p in s.participants()), flush=True)
        for name in names if kind != "ours" else []:
            s.rtse("leave", name)
        return seconds


# The arm of worlds/arm.sdf stacks boxes: RTCManipulator in every step, BoxStacker at 100 Hz, RTCPTZ at 20 Hz, in one process. Wall-clock
# time and processor time of simulator and components [s].
def stacking_arm(steps):
    with System(bin_dir, lib_dir) as s:
        s.naming()
        simulator = s.server(str(source / "worlds/arm.sdf"), "--paused", "--rtf", "0", "--lockstep")
        names = ["RTCManipulator0", "BoxStacker0", "RTCPTZ0"]
        server = f"conf.default.server_id={s.server_id}"
        host = s.host(f"RTCManipulator?exec_cxt.periodic.rate=1000&{server}&conf.default.force=15", "BoxStacker?exec_cxt.periodic.rate=100", f"RTCPTZ?exec_cxt.periodic.rate=20&{server}")
        s.rtse("wait", *names, "--state", "any", "--timeout", "60")
        for port in ("common", "middle"):
            s.rtse("con", f"BoxStacker0:{port}", f"RTCManipulator0:{port}")
        s.rtse("act", *names)
        s.until("participants", lambda: len(s.participants()) == len(names))
        before = processor_time(simulator, host)
        seconds = timed_steps(s, steps)
        used = processor_time(simulator, host) - before
        print("  tick of each component: " + ", ".join(f"{p['name']} {p['mean_us']:.0f} us" for p in s.participants()), flush=True)
        return seconds, used


def compare(world, robots, steps, apart):
    pairs = [(bare(world, robots, steps), with_components(world, robots, steps, apart)) for _ in range(rounds)]
    return min(a for a, _ in pairs), min(b for _, b in pairs)


with tempfile.TemporaryDirectory() as work:
    one = f"{work}/one.sdf"
    text = (source / "worlds/obstacle_course.sdf").read_text().replace("model://pioneer2dx_hokuyo", "model://pioneer2dx_sick")
    pathlib.Path(one).write_text(text)
    os.environ["RTMSIM_RESOURCE_PATH"] = str(source / "worlds")
    steps = 60000
    alone, together = compare(one, ["pioneer2dx"], steps, True)
    row("one Pioneer, 181 beams at 10 Hz, 3 components in 3 processes, 1 ms: speed / bare", alone / together, "", ">= 0.90")
    row("  times real time", steps * 0.001 / together, "x", ">= 100")
    row("  times real time without components", steps * 0.001 / alone, "x", "")
    steps = 20000
    alone = min(bare(one, ["pioneer2dx"], steps) for _ in range(rounds))
    for kind, what, limit in (("ours", "of our own", ""), ("joined", "of others (C++), joined", ">= 50"), ("python", "of others (Python), joined", ">= 50")):
        seconds = min(three_processes(one, steps, kind) for _ in range(rounds))
        row(f"three processes {what}, 10 Hz, 1 ms: times real time", steps * 0.001 / seconds, "x", limit)
        row("  speed / bare, whose robot drives and scans as well", alone / seconds, "", "")
    steps = 20000
    seconds, used = (min(times) for times in zip(*(stacking_arm(steps) for _ in range(rounds))))
    row("an arm that stacks boxes, 6 axes, gripper, 3 components, 1 ms: times real time", steps * 0.001 / seconds, "x", ">= 40")
    row("  by the processor time of simulator and components", steps * 0.001 / used, "x", ">= 40")
    ten = f"{work}/ten.sdf"
    subprocess.run([sys.executable, str(source / "worlds/make_arena.py"), "10", ten], check=True)
    steps = 6000
    alone, together = compare(ten, [f"pioneer_{i}" for i in range(10)], steps, False)
    row("10 robots, 30 components in 10 processes, 5 ms: times real time", steps * 0.005 / together, "x", ">= 10")
    row("  speed / bare", alone / together, "", "")
