# The clock, and simulated time that waits for nodes: ros2_time.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import json
import os
import re
import subprocess
import tempfile
import threading
import time

from ros2_rig import *


# While the simulation is paused the clock goes on coming, and each step is seen at once.
def paused():
    with Rig() as rig:
        rig.sim(two, "--paused")
        rig.gateway(robots=2)
        peer = rig.peer()
        peer.subscribe("/clock", "rosgraph_msgs/Clock", "best_effort")
        assert wire.seconds(peer.message("/clock", "rosgraph_msgs/Clock")["clock"]) == 0
        await_("the clock again", lambda: len(peer.samples["/clock"]) > 2)
        step = rig.stats()["step"] if "step" in rig.stats() else 0.001
        rig.simctl("step", "1")
        peer.message("/clock", "rosgraph_msgs/Clock", lambda m: 0 < wire.seconds(m["clock"]) <= step * 1.001)
        rig.simctl("reset")
        await_("the clock of the reset", lambda: wire.seconds(peer.messages("/clock", "rosgraph_msgs/Clock")[-1]["clock"]) == 0)


# Of two gateways in a domain the older one has the clock; the other one takes it over.
def two_clocks():
    with Rig() as rig:
        rig.sim(two)
        rig.gateway(robots=2)
        first = rig.process
        peer = rig.peer()
        peer.subscribe("/clock", "rosgraph_msgs/Clock", "best_effort")
        peer.message("/clock", "rosgraph_msgs/Clock")
        rig.gateway(robots=2)
        line = "another node publishes /clock: "
        await_("the report", lambda: line in rig.log(rig.process))
        count = len(peer.samples["/clock"])
        await_("the clock of the first one", lambda: len(peer.samples["/clock"]) > count + 100)
        assert line not in rig.log(first), rig.log(first)
        first.terminate()
        assert first.wait(20) == 0
        count = len(peer.samples["/clock"])
        await_("the clock of the second one", lambda: len(peer.samples["/clock"]) > count + 100)


# A simulator without readers makes several steps at once. A reader gets the clock of each step.
def steps():
    def is_watched():
        return next(one["subscribers"] for one in json.loads(rig.simctl("--json", "list")) if one["type"] == "simulation") > 0

    with Rig() as rig:
        rig.sim(two)
        rig.gateway("--clock-rate", "1000", robots=2)
        assert not is_watched()
        peer = rig.peer()
        peer.subscribe("/clock", "rosgraph_msgs/Clock", "best_effort")
        peer.message("/clock", "rosgraph_msgs/Clock")
        await_("the simulator is watched", is_watched)
        peer.end()
        rig.peers.remove(peer)
        await_("the simulator rests", lambda: not is_watched())


# In lock step, a clock without a rate has one message for each step, whatever its length.
def every_step():
    for step in ("0.0005", "0.0002", "0.003", "0.000333333333"):
        with Rig() as rig:
            rig.sim(f'<sdf version="1.9"><world name="w"><physics name="p" type="ode"><max_step_size>{step}</max_step_size></physics></world></sdf>', "--lockstep", "--paused")
            rig.gateway("--lockstep", "--clock-rate", "0", robots=0)
            peer = rig.peer()
            peer.subscribe("/clock", "rosgraph_msgs/Clock")
            await_("the gateway joins", lambda: any(one["name"] == "ros2-gateway" for one in rig.participants()))
            peer.message("/clock", "rosgraph_msgs/Clock")
            rig.simctl("step", "40")
            nanoseconds = round(float(step) * 1e9)

            def shown():
                times = [one["clock"] for one in peer.messages("/clock", "rosgraph_msgs/Clock")]
                return sorted({one["sec"] * 10**9 + one["nanosec"] for one in times})

            await_("the last step", lambda: shown()[-1] == 40 * nanoseconds)
            assert shown() == [i * nanoseconds for i in range(41)], (step, shown())


# A follower that answers each scan, in lock step: two runs end alike.
def lockstep():
    hashes = []
    for _ in range(2):
        with Rig() as rig:
            rig.sim(two, "--lockstep", "--paused", "--rtf", "0")
            rig.gateway("--lockstep", "--clock-rate", "50", "--wait-for", "/follower/cmd_vel=10Hz", "--wait-timeout", "50", robots=2)
            peer = rig.peer()
            peer.subscribe("/follower/scan", "sensor_msgs/LaserScan")
            peer.advertise("/follower/cmd_vel", "geometry_msgs/TwistStamped")
            peer.await_matched("/follower/cmd_vel")
            peer.await_matched("/follower/scan")
            await_("the gateway joins", lambda: any(one["name"] == "ros2-gateway" for one in rig.participants()))
            stop = threading.Event()

            def follow():
                seen = 0
                while not stop.is_set():
                    scans = peer.samples["/follower/scan"]
                    if len(scans) == seen:
                        time.sleep(0.001)
                        continue
                    scan = wire.decode("sensor_msgs/LaserScan", scans[seen])
                    seen += 1
                    if wire.seconds(scan["header"]["stamp"]) == 0:
                        continue
                    near = min(one for one in scan["ranges"] if one > 0)
                    turn = 0.3 if near < 1 else -0.1
                    peer.put("/follower/cmd_vel", "geometry_msgs/TwistStamped", {"header": scan["header"], "twist": wire.twist(0.2, turn)})

            thread = threading.Thread(target=follow)
            thread.start()
            try:
                steps = round(2 / rig.stats()["step"]) if "step" in rig.stats() else 2000
                rig.simctl("step", str(steps))
            finally:
                stop.set()
                thread.join()
            stats = rig.stats()
            hashes.append((stats["steps"], stats["state_hash"] if "state_hash" in stats else stats["hash"], rig.simctl("pose", "follower")))
            assert rig.process.poll() is None, rig.log(rig.process)
    assert hashes[0] == hashes[1], hashes
    # A simulator that does not wait is named.
    with Rig() as rig:
        rig.sim(two)
        rig.gateway("--lockstep", robots=2)
        await_("the line", lambda: "--lockstep: time does not wait, because the simulator was started without --lockstep" in rig.log(rig.process))
    # Without an answer the gateway ends, and says what it waited for.
    with Rig() as rig:
        rig.sim(two, "--lockstep", "--paused")
        rig.gateway("--lockstep", "--wait-for", "cmd_vel=10Hz", "--wait-timeout", "1", robots=2)
        await_("the gateway joins", lambda: any(one["name"] == "ros2-gateway" for one in rig.participants()))
        rig.simctl("run")
        await_("the end", lambda: rig.process.poll() == 1)
        assert "no command on /follower/cmd_vel, /leader/cmd_vel for the tick at t = 0.1 s" in rig.log(rig.process), rig.log(rig.process)


# The leader by RT components, the follower by a program that speaks only DDS: it keeps its distance, and two runs end alike.
def demo():
    states = []
    for _ in range(2):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([f"{bin_dir}/rtse-demo", "ros2", "--duration", "15", "--output", folder], capture_output=True, text=True, timeout=250)
            assert done.returncode == 0, done.stdout + done.stderr
            with open(f"{folder}/demo-ros2.png", "rb") as file:
                assert file.read(4)[1:] == b"PNG"
            near, far = (float(word) for word in re.search(r"between leader and follower: (\S+) to (\S+) m", done.stdout).groups())
            assert 0.4 < near < far < 3, done.stdout
            assert "follow: leader at" in done.stdout, done.stdout
            states.append(re.search(r"state (\w+)", done.stdout).group(1))
    assert states[0] == states[1], states


# A packet costs one system call: the program answers the call by which Fast DDS sets a send timeout before each packet.
def one_call():
    known = subprocess.run([f"{bin_dir}/ros2-gateway", "--version"], env={**os.environ, "LD_BIND_NOW": "1", "LD_DEBUG": "bindings"}, capture_output=True, text=True, timeout=60)
    assert re.search(r"libfastrtps\S* \S+ to \S*ros2-gateway \S+ normal symbol `setsockopt'", known.stderr), "libfastrtps uses another setsockopt"


globals()[case]()
