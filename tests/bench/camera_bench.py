#!/usr/bin/env python3
"""A frame of 640x480 from its publication by the simulator to VideoPlayer's buffer, in three processes, over CORBA and over the shared-memory port. Prints each number
with its limit beside it; of several rounds the best.

usage: camera_bench.py [BUILD_DIR]      (default: build/release)
"""
import pathlib
import sys

source = pathlib.Path(__file__).resolve().parents[2]
build = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else source / "build/release").resolve()
sys.path.insert(0, str(source / "tests/scenario"))
from system import System

bin_dir, lib_dir = str(build / "bin"), str(build / "lib")
rounds, frames = 3, "200"
world = """<sdf version='1.9'><world name='w'><physics type='ode'><max_step_size>0.01</max_step_size></physics>
<light name='sun' type='directional'><direction>-0.3 0.2 -1</direction></light>
<model name='ball'><static>true</static><pose>3 0 0 0 0 0</pose><link name='l'><visual name='v'><geometry><sphere><radius>1</radius></sphere></geometry></visual></link></model>
<model name='robot'><static>true</static><link name='l'><sensor name='eye' type='camera'><update_rate>30</update_rate>
<camera><image><width>640</width><height>480</height></image></camera></sensor></link></model></world></sdf>"""


# Median and 90th percentile [us].
def measure(interface):
    with System(bin_dir, lib_dir) as s:
        with open(f"{s.work}/w.sdf", "w") as file:
            file.write(world)
        s.naming()
        s.server(f"{s.work}/w.sdf")
        options = ["-o", f"corba.nameservers:{s.names}", "-o", f"manager.modules.load_path:{lib_dir}", "-o", "manager.shutdown_auto:NO"]
        s.start(f"{bin_dir}/rtcd", *options, f"RTCCamera?conf.default.server_id={s.server_id}&conf.default.device_id=robot::eye")
        player = s.start(f"{bin_dir}/camera_probe", s.server_id, "robot::eye", frames, *options)
        s.rtse("wait", "RTCCamera0", "VideoPlayer0", "--state", "any", "--timeout", "60")
        s.rtse("con", "RTCCamera0:image", "VideoPlayer0:image", "-p", f"dataport.interface_type={interface}", "-p", "dataport.subscription_type=flush")
        s.rtse("act", "VideoPlayer0", "RTCCamera0")
        s.until("the frames", lambda: player.poll() is not None)
        assert player.returncode == 0, s.log(player)
        return tuple(map(float, next(line for line in s.log(player).splitlines() if line.startswith("latency ")).split()[1:]))


for interface, limit in (("corba_cdr", 2000), ("shared_memory", 500)):
    median, most = min(measure(interface) for _ in range(rounds))
    print(f"{'frame 640x480 to the buffer of VideoPlayer, ' + interface + ': median':<72} {median:>8.1f} us   (90 %: {most:.1f} us)   limit < {limit}", flush=True)
