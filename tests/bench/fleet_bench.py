#!/usr/bin/env python3
"""A fleet: how long it takes to create, wire, activate, list and save its components, and its speed in lock step against the same world without
components; prints each number with its limit beside it.

usage: fleet_bench.py [ROBOTS [HOSTS]] [--steps N] [--rounds N] [--build DIR]      (default: 100 robots in 4 hosts)
"""
import argparse
import ctypes
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

source = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(source / "tests/scenario"))
from system import System

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("robots", nargs="?", type=int, default=100)
parser.add_argument("hosts", nargs="?", type=int, default=4)
parser.add_argument("--steps", type=int, default=2000, help="of 5 ms")
parser.add_argument("--rounds", type=int, default=3)
parser.add_argument("--build", default=str(source / "build/release"))
options = parser.parse_args()
build = pathlib.Path(options.build).resolve()
bin_dir, lib_dir = str(build / "bin"), str(build / "lib")
robots, step = options.robots, 0.005
kinds = ("RTCLaser", "LaserObstacleAvoid", "RTCPosition2d")
template = str(source / "worlds/systems/fleet.xml")
fleet = ["--for", f"robot=pioneer_0..pioneer_{robots - 1}"]


def row(what, value, unit, limit=""):
    print(f"{what:<78} {value:>9.2f} {unit:<6}{'limit ' + limit if limit else ''}", flush=True)


def timed(call):
    began = time.perf_counter()
    call()
    return time.perf_counter() - began


# Processor time [s] and memory [MiB] of processes.
def cpu(*processes):
    fields = [pathlib.Path(f"/proc/{process.pid}/stat").read_text().rsplit(")", 1)[1].split() for process in processes]
    return sum(int(one[11]) + int(one[12]) for one in fields) / os.sysconf("SC_CLK_TCK")


def switches(*processes):
    tasks = [task for process in processes for task in pathlib.Path(f"/proc/{process.pid}/task").iterdir()]
    return sum(int(count) for task in tasks for count in re.findall(r"voluntary_ctxt_switches:\s+(\d+)", (task / "status").read_text()))


def memory(*processes):
    return sum(int(re.search(r"Pss:\s+(\d+)", pathlib.Path(f"/proc/{process.pid}/smaps_rollup").read_text()).group(1)) for process in processes) / 1024


def run_steps(s):
    s.simctl("step", "400")
    return timed(lambda: s.simctl("step", str(options.steps)))


# The lasers and drives of the robots work as long as the library's handles live; nobody reads them.
def subscribe(server_id):
    library = ctypes.CDLL(f"{lib_dir}/librtmsim_iface.so")
    library.rtmsim_open.restype = ctypes.c_void_p
    library.rtmsim_type.argtypes = [ctypes.c_char_p]
    for i in range(robots):
        for kind, name in ((b"laser", "laser"), (b"position2d", "position2d")):
            iface = library.rtmsim_open(ctypes.c_uint32(int(server_id)), library.rtmsim_type(kind), f"pioneer_{i}::{name}".encode())
            assert iface and library.rtmsim_subscribe(ctypes.c_void_p(iface)) == 0, (i, name)
            yield lambda iface=iface: library.rtmsim_close(ctypes.c_void_p(iface))


# The same robots, which drive and scan, without components.
def alone(world, *options_of_server):
    with System(bin_dir, lib_dir) as s:
        sim = s.server(world, "--paused", "--rtf", "0", *options_of_server)
        for i in range(robots):
            s.start(f"{bin_dir}/simctl", "-s", s.server_id, "velocity", f"pioneer_{i}::position2d", "0.1", "0", "0.3")
        closers = list(subscribe(s.server_id))
        used = cpu(sim)
        seconds = run_steps(s)
        used = cpu(sim) - used
        for close in closers:
            close()
        return seconds, used


def creations(host):
    for i in range(host, robots, options.hosts):
        yield from (f"{kind}?instance_name={kind}_pioneer_{i}&exec_cxt.periodic.rate=10" for kind in kinds)


def with_components(world, prints):
    with System(bin_dir, lib_dir) as s:
        s.naming()
        sim = s.server(world, "--paused", "--rtf", "0", "--lockstep")
        hosts = []
        names = [f"{kind}_pioneer_{i}" for i in range(robots) for kind in kinds]

        def create():
            hosts.extend(s.host("-o", "exec_cxt.sim_time.own_thread:NO", *creations(host)) for host in range(options.hosts))
            s.rtse("wait", *names, "--state", "any", "--timeout", "120")

        times = [timed(create), timed(lambda: s.rtse("load", template, *fleet)), timed(lambda: s.rtse("start", template, *fleet))]
        listing = timed(lambda: s.rtse("ls"))
        saving = timed(lambda: s.rtse("save", f"{s.work}/saved.xml"))
        again = timed(lambda: s.rtse("load", f"{s.work}/saved.xml"))
        s.until("participants", lambda: len(s.participants()) == len(names))
        used, switched, simulated = cpu(*hosts), switches(*hosts), cpu(sim)
        seconds = run_steps(s)
        simulated = cpu(sim) - simulated
        if prints:
            ticks = 3 * robots * (options.steps + 400) * step * 10
            row(f"{len(names)} components in {options.hosts} hosts created", times[0], "s")
            row(f"  wired and configured by rtse load ({2 * robots} connections)", times[1], "s")
            row("  activated by rtse start", times[2], "s")
            row("  together", sum(times), "s", "3 (100 robots)")
            row("rtse ls", listing, "s", "1 (3000 components)")
            row("rtse save", saving, "s", "5 (3000 connections)")
            row("rtse load of what is there", again, "s", "5 (3000 connections)")
            row("memory of all hosts", memory(*hosts), "MiB", "3072 (3000 components)")
            row("  of the simulator", memory(sim), "MiB", "1024 (1000 robots)")
            row("processor time of a tick of a component", (cpu(*hosts) - used) / ticks * 1e6, "us")
            row("switches of a tick of a component", (switches(*hosts) - switched) / ticks, "")
        return seconds, simulated, cpu(*hosts) - used


# Stage's own figure of its defaults, where it is installed: 2D, kinematic, steps of 100 ms.
def stage(work):
    program = shutil.which("stage")
    if not program:
        return
    poses = "\n".join(f"pioneer2dx(pose [{i % 32 * 3 - 47} {i // 32 * 3 - 47} 0 0] sicklaser() ctrl \"wander\")" for i in range(robots))
    pathlib.Path(f"{work}/fleet.world").write_text(f'include "pioneer.inc"\ninclude "sick.inc"\nquit_time 60\n{poses}\n')
    seconds = timed(lambda: subprocess.run([program, "-g", f"{work}/fleet.world"], capture_output=True, timeout=600))
    row("Stage, the same number of robots: times real time", 60 / seconds, "x")


with tempfile.TemporaryDirectory() as work:
    world = f"{work}/fleet.sdf"
    subprocess.run([sys.executable, str(source / "worlds/make_arena.py"), str(robots), world], check=True)
    os.environ["RTMSIM_RESOURCE_PATH"] = str(source / "worlds")
    pairs = [(alone(world), with_components(world, i == 0), alone(world, "--rolling", "on")) for i in range(options.rounds)]
    bare, together, rolling = (min(pair[i][0] for pair in pairs) for i in (0, 1, 2))
    simulated, all_simulated = options.steps * step, (options.steps + 400) * step
    row("times real time, the simulation alone", simulated / bare, "x")
    row("  with the rolling step", simulated / rolling, "x", "40 (100 robots), 5 (1000 robots)")
    row("  with the components", simulated / together, "x", "10 (100 robots)")
    row("  speed / alone", bare / together, "", ">= 0.9")
    # On a busy machine these say more.
    used = [min(pair[0][1] for pair in pairs), *(min(pair[1][i] for pair in pairs) for i in (1, 2))]
    row("processor time of a simulated second: the simulation alone", used[0] / all_simulated, "s")
    row("  with the rolling step", min(pair[2][1] for pair in pairs) / all_simulated, "s")
    row("  the simulator with the components", used[1] / all_simulated, "s")
    row("  all hosts", used[2] / all_simulated, "s")
    row("  the simulation alone / simulator and hosts", used[0] / (used[1] + used[2]), "")
    stage(work)
