#!/usr/bin/env python3
"""What ros2-gateway costs: its processor time for a clock of 1 kHz, for images of 1 MiB, for scans of 100 robots, and what a suspended
subscriber costs a simulation in lock step with it; prints each number with its limit beside it. A peer by another maker of DDS subscribes.

usage: ros2_bench.py [ROW...] [--seconds N] [--steps N] [--build DIR]
"""
import argparse
import os
import pathlib
import re
import signal
import sys
import time

source = pathlib.Path(__file__).resolve().parents[2]
parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("rows", nargs="*", help="clock, images, scans, suspended; default: all")
parser.add_argument("--seconds", type=float, default=5, help="of each measurement")
parser.add_argument("--steps", type=int, default=4000, help="in lock step")
parser.add_argument("--build", default=str(source / "build/release"))
options = parser.parse_args()
build = pathlib.Path(options.build).resolve()
sys.argv = [sys.argv[0], "", str(build / "bin"), str(build / "lib"), str(source)]
sys.path.insert(0, str(source / "tests/ros2"))
from ros2_rig import Rig, await_

two = f"{source}/worlds/leader_follower.sdf"
camera = """<sdf version="1.9"><world name="w"><physics name="p" type="ode"><max_step_size>0.01</max_step_size></physics><model name="eye"><static>true</static><link name="l">
<sensor name="cam" type="camera"><update_rate>10</update_rate><camera><horizontal_fov>1</horizontal_fov><image><width>683</width><height>512</height></image></camera></sensor>
</link></model></world></sdf>"""


def row(what, value, unit, limit=""):
    print(f"{what:<78} {value:>9.3f} {unit:<6}{'limit ' + limit if limit else ''}", flush=True)


def cpu(*pids):
    threads = [thread for pid in pids for thread in pathlib.Path(f"/proc/{pid}/task").iterdir()]
    return sum(int((thread / "schedstat").read_text().split()[0]) for thread in threads) / 1e9


# The process that serves, not the one that starts it again.
def server_of(rig):
    pid = rig.process.pid
    return int(pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text().split()[0])


# How often the event loop has gone to sleep.
def switches(pid):
    status = pathlib.Path(f"/proc/{pid}/task/{pid}/status").read_text()
    return int(re.search(r"^voluntary_ctxt_switches:\s+(\d+)", status, re.M).group(1))


# Processor time per second, and messages, while `count` goes on.
def used(rig, count):
    pid = server_of(rig)
    time.sleep(1)  # the discovery is over
    began, messages, seconds = cpu(pid), count(), time.perf_counter()
    time.sleep(options.seconds)
    return (cpu(pid) - began) / (time.perf_counter() - seconds), (count() - messages) / (time.perf_counter() - seconds)


# A busy machine steps in bursts, and the clock shows the last step of each: what counts there is the price of a message.
def clock():
    for kind, words in (("real time", ()), ("lock step", ("--lockstep",))):
        with Rig() as rig:
            rig.sim(two, *words)
            rig.gateway("--clock-rate", "1000", *words, robots=2)
            idle, _ = used(rig, lambda: 0)
            peer = rig.peer()
            peer.subscribe("/clock", "rosgraph_msgs/Clock", "best_effort")
            peer.message("/clock", "rosgraph_msgs/Clock")
            share, messages = used(rig, lambda: len(peer.samples["/clock"]))
            row(f"gateway without subscribers, {kind}: processor time / one core", idle, "")
            row(f"--clock-rate 1000, {kind}, one subscriber, {messages:.0f} messages a second: the same", share, "", "" if words else "0.03")
            row("the same for 1000 messages a second", share * 1000 / messages, "")
            # The same with nothing but a futex and a packet; for the same simulator, so the gateway gives way.
            peer.end()
            rig.peers.remove(peer)
            rig.kill(rig.process)
            bare = rig.call(f"{build}/bin/bare_clock", str(rig.server_id), str(round(options.seconds)), *(["lockstep"] if words else []))
            each = float(re.search(r"([0-9.]+) us each", bare).group(1))
            row(f"bare loop, {kind}: processor time / one core for 1000 packets a second", each / 1000, "")
            row("gateway / bare loop, for a message", share * 1e6 / messages / each, "")


def images():
    with Rig() as rig:
        rig.sim(camera)
        rig.gateway()
        peer = rig.peer()
        topic = "/eye/cam/image_raw"
        peer.subscribe(topic, "sensor_msgs/Image")
        await_("an image", lambda: peer.samples[topic])

        def count():
            peer.samples[topic][:-1] = [None] * (len(peer.samples[topic]) - 1)
            return len(peer.samples[topic])

        share, images_a_second = used(rig, count)
        row(f"image of 1 MiB, {images_a_second:.1f} a second: processor time of the gateway for each", 1000 * share / images_a_second, "ms", "2 ms")


def scans():
    with Rig() as rig:
        rig.sim(f"{source}/worlds/hundred.sdf")
        rig.gateway(robots=100)
        peer = rig.peer()
        for i in range(100):
            peer.subscribe(f"/pioneer_{i}/scan", "sensor_msgs/LaserScan", "best_effort")
        await_("scans of all", lambda: all(peer.samples[f"/pioneer_{i}/scan"] for i in range(100)))
        share, scans_a_second = used(rig, lambda: sum(len(peer.samples[f"/pioneer_{i}/scan"]) for i in range(100)))
        row(f"100 robots, {scans_a_second:.0f} scans a second: processor time of the gateway / one core", share, "", "0.30")
        if scans_a_second > 0:
            row("the same for 1000 scans a second", share * 1000 / scans_a_second, "", "0.30")


def suspended():
    times, sleeps = {True: [], False: []}, {True: [], False: []}
    with Rig() as rig:
        rig.sim(two, "--lockstep", "--paused", "--rtf", "0")
        rig.gateway("--lockstep", "--clock-rate", "1000", robots=2)
        peer, slow = rig.peer(), rig.peer()
        for one in (peer, slow):
            for topic, kind in (("/leader/odom", "nav_msgs/Odometry"), ("/leader/scan", "sensor_msgs/LaserScan"), ("/clock", "rosgraph_msgs/Clock")):
                one.subscribe(topic, kind)
                one.await_matched(topic)
        await_("the gateway joins", lambda: any(one["name"] == "ros2-gateway" for one in rig.participants()))
        rig.simctl("step", "200")
        for is_suspended in (False, True) * 7:
            if is_suspended:
                os.kill(slow.process.pid, signal.SIGSTOP)
            began, slept = time.perf_counter(), switches(server_of(rig))
            rig.simctl("step", str(options.steps))
            times[is_suspended].append(time.perf_counter() - began)
            sleeps[is_suspended].append((switches(server_of(rig)) - slept) / options.steps)
            if is_suspended:
                os.kill(slow.process.pid, signal.SIGCONT)
        await_("the report of losses", lambda: "The longest write took" in rig.log(rig.process))
        longest = max(float(one) for one in re.findall(r"The longest write took (\S+) ms", rig.log(rig.process)))
    print(" ".join(f"{one:.2f}" for one in times[False]), "|", " ".join(f"{one:.2f}" for one in times[True]))
    ratio = min(times[True]) / min(times[False])
    row(f"{options.steps} steps in lock step, one subscriber suspended / all running", ratio, "", "1.10")
    for is_suspended, words in ((False, "all running"), (True, "one suspended")):
        row(f"times that the event loop sleeps in a tick, {words}: one between ticks, none in a write", max(sleeps[is_suspended]), "", "1.1")
    row("longest write of a topic whose subscriber was suspended", longest, "ms")


for name in options.rows or ("clock", "images", "scans", "suspended"):
    globals()[name]()
