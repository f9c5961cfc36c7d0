#!/usr/bin/env python3
"""From a scan's publication to the velocity command in the simulator, through RTCLaser, LaserObstacleAvoid and RTCPosition2d in three processes, beside the same way
gone by bare hops; prints each number with its limit beside it.

usage: latency_bench.py [BUILD_DIR]      (default: build/release)
"""
import pathlib
import sys

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
def components():
    with System(bin_dir, lib_dir) as s:
        s.naming()
        measured = s.start(probe, s.server_id, scans)
        for component in ("RTCLaser?conf.default.device_id=robot::laser", "LaserObstacleAvoid", "RTCPosition2d?conf.default.device_id=robot::position2d"):
            s.start(f"{bin_dir}/rtcd", "-o", f"corba.nameservers:{s.names}", "-o", f"manager.modules.load_path:{lib_dir}", "-o", "manager.shutdown_auto:NO",
                    f"{component}{'&' if '?' in component else '?'}conf.default.server_id={s.server_id}")
        names = ["RTCLaser0", "LaserObstacleAvoid0", "RTCPosition2d0"]
        s.rtse("wait", *names, "--state", "any", "--timeout", "60")
        s.rtse("con", "RTCLaser0:range", "LaserObstacleAvoid0:range", "-p", "dataport.subscription_type=flush")
        s.rtse("con", "LaserObstacleAvoid0:velocity", "RTCPosition2d0:velocity", "-p", "dataport.subscription_type=flush")
        s.rtse("act", *reversed(names))
        s.until("the scans answered", lambda: measured.poll() is not None)
        assert measured.returncode == 0, s.log(measured)
        return tuple(map(float, s.log(measured).split()))


pairs = [(bare(), components()) for _ in range(rounds)]
hops, ours = min(a for a, _ in pairs), min(b for _, b in pairs)
print(f"{'scan to command, three bare hops: median':<64} {hops[0]:>8.1f} us   (90 %: {hops[1]:.1f} us)")
print(f"{'scan to command, three components in three processes: median':<64} {ours[0]:>8.1f} us   (90 %: {ours[1]:.1f} us)   limit < 200")
print(f"{'components / bare hops':<64} {ours[0] / hops[0]:>8.2f}")
