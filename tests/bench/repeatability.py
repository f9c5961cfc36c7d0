#!/usr/bin/env python3
"""Is the same system the same run each time? Six processes: lidar, camera, obstacle avoidance, drive, and two components connected with each other in one
phase by every subscription type and by pull. Each run's whole hash log is compared with the first run's; half of the runs are made under load, with the
priorities and processors of all their processes shuffled all the time. Prints n of n, and the first difference of each run that differs.

Load: so many processes that only burn time. --together: so many runs at once, which hold each other up, the shuffled ones among the others; then all are made
under load, and only as many processes burn time as are missing for --load. A thousand runs want --together 20. --for: no run begins after so many seconds;
what has been made is counted.

usage: repeatability.py [BUILD_DIR] [--runs N] [--duration S] [--load N] [--together N] [--for S]
       (default: build/release, 20 runs of 20 s, load of 20, one at a time, without end)
"""
import argparse
import concurrent.futures
import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import threading
import time

source = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(source / "tests/scenario"))
import chance_system as parts

parser = argparse.ArgumentParser()
parser.add_argument("build", nargs="?", default=str(source / "build/release"))
parser.add_argument("--runs", type=int, default=20)
parser.add_argument("--duration", type=float, default=20)
parser.add_argument("--load", type=int, default=20)
parser.add_argument("--together", type=int, default=1)
parser.add_argument("--for", type=float, default=float("inf"), dest="limit")
options = parser.parse_args()
build = pathlib.Path(options.build).resolve()
rtse = str(build / "bin/rtse")

LASER, CAMERA = "RTC:rtm-sim:simulation:RTCLaser:1.0.0", "RTC:rtm-sim:simulation:RTCCamera:1.0.0"
AVOID, DRIVE = "RTC:rtm-sim:navigation:LaserObstacleAvoid:1.0.0", "RTC:rtm-sim:simulation:RTCPosition2d:1.0.0"


def the_system():
    text = [parts.component("RTCLaser0", 10, LASER, device_id="pioneer2dx::laser"), parts.component("RTCCamera0", 10, CAMERA, device_id="helicopter::camera"),
            parts.component("Avoid0", 10, AVOID), parts.component("RTCPosition2d0", 10, DRIVE, device_id="pioneer2dx::position2d"),
            parts.component("A", 50, start=1), parts.component("B", 50, start=2),
            parts.link("RTCLaser0.range", "Avoid0.range", "IDL:RTC/RangeData:1.0", source_id=LASER, target_id=AVOID),
            parts.link("Avoid0.velocity", "RTCPosition2d0.velocity", "IDL:RTC/TimedVelocity2D:1.0", source_id=AVOID, target_id=DRIVE),
            parts.link("RTCCamera0.image", "A.picture", "IDL:RTC/CameraImage:1.0", source_id=CAMERA, subscription="new"),
            parts.link("A.out", "B.in"), parts.link("B.out", "A.in", subscription="new", publisher__push_policy="all"),
            parts.link("A.loose", "B.in", subscription="periodic", publisher__push_rate="20"), parts.link("B.loose", "A.in", dataflow="pull")]
    return parts.system(*text)


def the_world():
    text = (source / "worlds/obstacle_course.sdf").read_text()
    return text.replace("</world>", "<include><uri>model://helicopter</uri><pose>0 0 3 0 0 0</pose></include></world>")


def descendants(pid):
    children = {}
    for stat in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            parent = int(stat.read_text().rsplit(")", 1)[1].split()[1])
        except (OSError, IndexError):
            continue
        children.setdefault(parent, []).append(int(stat.parent.name))
    found, open_ = [], [pid]
    while open_:
        found.append(open_.pop())
        open_ += children.get(found[-1], [])
    return found


def shuffle(pid, ends):
    processors = sorted(os.sched_getaffinity(0))
    while not ends.wait(0.2):
        for process in descendants(pid):
            try:
                os.setpriority(os.PRIO_PROCESS, process, random.randint(0, 19))
                os.sched_setaffinity(process, random.sample(processors, random.randint(1, len(processors))))
            except OSError:
                pass  # it has just ended


def run(folder, name, loaded):
    words = [rtse, "run", "system.xml", "--world", "world.sdf", "--module-path", str(build / "lib"), "--duration", str(options.duration), "--seed", "7",
             "--one-process-each", "--hash-log", name, "--strict", "--hang-timeout", "600", "--start-timeout", "600"]
    began = time.monotonic()
    process = subprocess.Popen(words, cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    ends = threading.Event()
    shuffler = threading.Thread(target=shuffle, args=(process.pid, ends))
    if loaded:
        shuffler.start()
    try:
        _, err = process.communicate(timeout=3600)
    finally:
        ends.set()
    if loaded:
        shuffler.join()
    return ("" if process.returncode == 0 else err.strip()), time.monotonic() - began


# True: it is the same run as the first one.
def is_same(folder, number, loaded):
    name = f"{number}.hashlog"
    problem, took = run(folder, name, loaded)
    said = problem
    if not problem:
        compared = subprocess.run([rtse, "diff", "0.hashlog", name], cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        problem, said = compared.returncode != 0, (compared.stdout or compared.stderr).strip()
    print(f"run {number}{', shuffled' if loaded else ''}, {took:.0f} s: {said}", flush=True)
    if number > 0:
        (pathlib.Path(folder) / name).unlink(missing_ok=True)
    return not problem


class Load:
    def __init__(self, count):
        self.count = count

    def __enter__(self):
        self.hogs = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(self.count)]

    def __exit__(self, *_):
        for hog in self.hogs:
            hog.send_signal(signal.SIGKILL)
            hog.wait()


with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(options.together) as pool:
    place = pathlib.Path(folder)
    (place / "system.xml").write_text(the_system())
    (place / "world.sdf").write_text(the_world())
    began = time.monotonic()

    # Nothing: it was not made, for want of time.
    def make(number):
        if time.monotonic() - began > options.limit:
            return None
        is_shuffled = number % 2 == 1
        with Load(options.load if is_shuffled and options.together == 1 else 0):
            return is_same(folder, number, is_shuffled), is_shuffled

    verdicts = [(is_same(folder, 0, False), False)]
    with Load(max(0, options.load - options.together) if options.together > 1 else 0):
        verdicts += [verdict for verdict in pool.map(make, range(1, options.runs)) if verdict]
    same = sum(is_good for is_good, _ in verdicts)
    print(f"{same} of {len(verdicts)} runs are the same ({options.duration:g} s simulated each), {sum(was for _, was in verdicts)} of them with shuffled priorities and "
          f"processors, after {time.monotonic() - began:.0f} s")
    sys.exit(0 if same == options.runs else 1)
