# The clock of the wall jumps by minutes, hours and years, for all processes of a driving system together: clocks.py BIN_DIR LIB_DIR SOURCE_DIR [--seconds T] [--seed S]. Everybody goes
# on: simulated time, the robot, calls, and tools that are started after the jump. Waits that began before a jump are not prolonged by more than their time-out.
import argparse
import os
import time

arguments = argparse.ArgumentParser()
arguments.add_argument("folders", nargs=3)
arguments.add_argument("--seconds", type=float, default=0)
arguments.add_argument("--seed", type=int)
given = arguments.parse_args()
bin_dir, lib_dir, source = given.folders
from attacker import seeded
from driving import Driving, System

choice = seeded(given.seed)
hour, year = 3600, 365 * 24 * 3600
with System(bin_dir, lib_dir) as s:
    clock = f"{s.work}/clock"

    def jump(seconds):
        with open(f"{clock}.new", "w") as file:
            file.write(str(seconds))
        os.replace(f"{clock}.new", clock)

    jump(0)
    os.environ.update(LD_PRELOAD=f"{os.path.abspath(bin_dir)}/libclock_jumps.so", RTMSIM_TEST_CLOCK=clock)
    driving = Driving(s, source)
    driving.wire()
    driving.drives()
    jumps, until = [hour, -hour, 10 * year, 0], time.monotonic() + given.seconds
    count = 0
    while jumps or time.monotonic() < until:
        seconds = jumps.pop(0) if jumps else choice.choice((1, -1)) * choice.choice((1, 60, hour, year)) * choice.randrange(1, 20)
        print(f"clock {seconds:+} s", flush=True)
        jump(seconds)
        driving.others_go_on(None)
        driving.drives()
        count += 1
print(f"{count} jumps survived")
