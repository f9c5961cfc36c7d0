#!/usr/bin/env python3
"""From a scan's publication to the velocity command in the simulator, through RTCLaser, LaserObstacleAvoid and RTCPosition2d in three processes, beside the same way
gone by bare hops; then the processor time of such a system in real time. Prints each number with its limit beside it.

usage: latency_bench.py [BUILD_DIR]      (default: build/release)
"""
import glob
import os
import pathlib
import sys
import time

source = pathlib.Path(__file__).resolve().parents[2]
build = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else source / "build/release").resolve()
sys.path.insert(0, str(source / "tests/scenario"))
from system import System

bin_dir, lib_dir = str(build / "bin"), str(build / "lib")
rounds, scans = 3, "400"
probe = f"{bin_dir}/latency_probe"


def bare():
    with System(bin_dir, lib_dir) as s:
        return tuple(map(float, s.call(probe, s.server_id, scans, "bare").split()))


# The components as a user starts them: own processes, contexts in real time, connections with `flush`.
def start_components(s, robot):
    s.naming()
    hosts = []
    for component in (f"RTCLaser?conf.default.device_id={robot}::laser", "LaserObstacleAvoid?conf.default.scan_timeout=1", f"RTCPosition2d?conf.default.device_id={robot}::position2d"):
        hosts.append(s.start(f"{bin_dir}/rtcd", "-o", f"corba.nameservers:{s.names}", "-o", f"manager.modules.load_path:{lib_dir}", "-o", "manager.shutdown_auto:NO",
                             f"{component}&conf.default.server_id={s.server_id}"))
    names = ["RTCLaser0", "LaserObstacleAvoid0", "RTCPosition2d0"]
    s.rtse("wait", *names, "--state", "any", "--timeout", "60")
    s.rtse("con", "RTCLaser0:range", "LaserObstacleAvoid0:range", "-p", "dataport.subscription_type=flush")
    s.rtse("con", "LaserObstacleAvoid0:velocity", "RTCPosition2d0:velocity", "-p", "dataport.subscription_type=flush")
    s.rtse("act", *reversed(names))
    return hosts


def components():
    with System(bin_dir, lib_dir) as s:
        measured = s.start(probe, s.server_id, scans)
        start_components(s, "robot")
        s.until("the scans answered", lambda: measured.poll() is not None)
        assert measured.returncode == 0, s.log(measured)
        return tuple(map(float, s.log(measured).split()))


pairs = [(bare(), components()) for _ in range(rounds)]
hops, ours = min(a for a, _ in pairs), min(b for _, b in pairs)
print(f"{'scan to command, three bare hops: median':<64} {hops[0]:>8.1f} us   (90 %: {hops[1]:.1f} us)")
print(f"{'scan to command, three components in three processes: median':<64} {ours[0]:>8.1f} us   (90 %: {ours[1]:.1f} us)   limit < 200")
print(f"{'components / bare hops':<64} {ours[0] / hops[0]:>8.2f}")


# Processor time that a process has used so far [s].
def used(process):
    return sum(int(open(file).read().split()[0]) for file in glob.glob(f"/proc/{process.pid}/task/*/schedstat")) / 1e9


# Percent of one core, of all processes, over ten seconds.
def processor_time(is_driving):
    with System(bin_dir, lib_dir) as s:
        processes = [s.server(str(source / "worlds/obstacle_course.sdf"))]
        processes += start_components(s, "pioneer2dx")
        if not is_driving:
            s.rtse("conf", "RTCPosition2d0", "set", "motors_enabled", "0")
        s.until("scans", lambda: s.stats()["subscribed"] >= 2)
        time.sleep(3)  # the robot comes to rest, or is on its way
        before, start = [used(p) for p in processes], time.monotonic()
        time.sleep(10)
        seconds = time.monotonic() - start
        return [100 * (used(p) - b) / seconds for p, b in zip(processes, before)]


for is_driving in (False, True):
    shares = processor_time(is_driving)
    parts = ", ".join(f"{name} {share:.1f}" for name, share in zip(("sim-server", "RTCLaser", "LaserObstacleAvoid", "RTCPosition2d"), shares))
    what = f"processor, 1 ms steps, 10 Hz laser, {'robot driving' if is_driving else 'robot at rest'}"
    print(f"{what:<64} {sum(shares):>8.1f} %    ({parts}){'' if is_driving else '   limit < 5'}")
