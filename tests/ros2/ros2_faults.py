# Processes that end or sleep, and damaged data: ros2_faults.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import json
import os
import random
import re
import signal
import socket
import struct
import time

from ros2_rig import *


# A gateway that is killed stops the robots that it drove, and nothing else; another one takes its place.
def gateway_ends():
    with Rig() as rig:
        rig.sim(two)
        rig.gateway("--command-timeout", "0", robots=2)
        peer = rig.peer()
        peer.subscribe("/leader/odom", "nav_msgs/Odometry")
        peer.advertise("/leader/cmd_vel", "geometry_msgs/Twist")
        peer.await_matched("/leader/cmd_vel")
        peer.put("/leader/cmd_vel", "geometry_msgs/Twist", wire.twist(0.2, 0.0))
        peer.message("/leader/odom", "nav_msgs/Odometry", lambda m: m["twist"]["twist"]["linear"]["x"] > 0.1)
        rig.kill(rig.process)
        before = rig.seconds()
        await_("the robot stops", lambda: abs(json.loads(rig.simctl("--json", "echo", "leader::position2d", "-n", "1"))["velocity"][0]) < 1e-3)
        assert rig.seconds() > before
        count = len(peer.samples["/leader/odom"])
        rig.gateway(robots=2)
        await_("odometry again", lambda: len(peer.samples["/leader/odom"]) > count + 5)
        # And a simulator that restarts.
        rig.kill(rig.simulator)
        await_("the loss", lambda: "has ended; waiting for it" in rig.log(rig.process))
        rig.sim(two)
        peer.await_matched("/leader/odom")
        count = len(peer.samples["/leader/odom"])
        await_("odometry of the next simulator", lambda: len(peer.samples["/leader/odom"]) > count + 5)


# The library that reads packets may crash: the gateway starts again by itself, and the simulation goes on.
def crash():
    with Rig() as rig:
        rig.sim(two)
        rig.gateway(robots=2)
        peer = rig.peer()
        peer.subscribe("/leader/odom", "nav_msgs/Odometry")
        peer.message("/leader/odom", "nav_msgs/Odometry")
        with open(f"/proc/{rig.process.pid}/task/{rig.process.pid}/children") as file:
            (child,) = (int(word) for word in file.read().split())
        os.kill(child, signal.SIGSEGV)
        await_("the report", lambda: "ended by signal 11" in rig.log(rig.process))
        count = len(peer.samples["/leader/odom"])
        await_("odometry again", lambda: len(peer.samples["/leader/odom"]) > count + 5)
        assert rig.simulator.poll() is None


# Damaged packets of RTPS: the gateway goes on serving, or starts again; the simulation does not notice.
def packets():
    with Rig() as rig:
        rig.sim(two)
        base = 7400 + 250 * int(rig.domain)
        # Participants look for others at the ports of all indices: what they send to one that nobody has is the seed.
        ear = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        ear.bind(("127.0.0.1", base + 10 + 2 * 25))
        ear.settimeout(60)
        rig.gateway(robots=2)
        peer = rig.peer()
        peer.subscribe("/leader/odom", "nav_msgs/Odometry")
        peer.message("/leader/odom", "nav_msgs/Odometry")
        seeds = [ear.recv(65536) for _ in range(6)]
        assert all(seed[:4] == b"RTPS" for seed in seeds)
        seed = os.getpid()
        print("seed", seed)
        chance = random.Random(seed)
        steps = rig.stats()["steps"]
        out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        for i in range(20000):
            data = bytearray(chance.choice(seeds))
            for _ in range(chance.randint(1, 6)):
                if len(data) < 4:
                    break
                way = chance.randrange(4)
                at = chance.randrange(20 if chance.random() < 0.3 else 4, len(data)) if len(data) > 24 else 0
                if way == 0:
                    data[at] = chance.randrange(256)
                elif way == 1:
                    data[at:] = b""
                elif way == 2:
                    data[at:at] = data[at : at + chance.randrange(64)]
                else:
                    data[at : at + 2] = chance.choice((b"\0\0", b"\xff\xff", b"\xff\x7f", b"\1\0"))
            for port in (base + 10, base + 11, base + 12, base + 13):
                out.sendto(bytes(data), ("127.0.0.1", port))
            if i % 200 == 0:
                time.sleep(0.01)  # the queue of a socket is short
        # Whether it has crashed or not, it serves: also a participant that comes now.
        late = rig.peer()
        late.subscribe("/leader/odom", "nav_msgs/Odometry")
        late.message("/leader/odom", "nav_msgs/Odometry")
        count = len(late.samples["/leader/odom"])
        await_("odometry goes on", lambda: len(late.samples["/leader/odom"]) > count + 10)
        assert rig.process.poll() is None and rig.simulator.poll() is None and rig.stats()["steps"] > steps
        print("started again", rig.log(rig.process).count("starting again"), "times")


# Messages of other encodings, damaged ones and a graph of 100,000 nodes: counted or limited, and the gateway goes on serving.
def damaged():
    with Rig() as rig:
        rig.sim(two)
        rig.gateway("--distro", "jazzy", robots=2)
        peer = rig.peer()
        peer.subscribe("/leader/odom", "nav_msgs/Odometry")
        peer.message("/leader/odom", "nav_msgs/Odometry")
        peer.advertise("/leader/cmd_vel", "geometry_msgs/Twist")
        peer.await_matched("/leader/cmd_vel", 2)
        body = wire.encode("geometry_msgs/Twist", wire.twist(0.2, 0.0))
        damaged = [bytes([0, kind, 0, 0]) + body[4:] for kind in (2, 3, 6, 7, 8, 9, 10, 11, 255)] + [body[:size] for size in (1, 4, 5, 12, len(body) - 8)]
        for data in damaged:
            peer.say(f"put /leader/cmd_vel {data.hex()}")
        await_("the count", lambda: re.search(r"node /leader/robot: \d+ messages or requests could not be read", rig.log(rig.process)))
        assert all(abs(one["twist"]["twist"]["linear"]["x"]) < 1e-3 for one in peer.messages("/leader/odom", "nav_msgs/Odometry"))
        # Big-endian numbers are those of other machines.
        zero = struct.pack(">d", 0)
        peer.say(f"put /leader/cmd_vel {(bytes(4) + struct.pack('>d', 0.2) + zero * 5).hex()}")
        peer.message("/leader/odom", "nav_msgs/Odometry", lambda m: m["twist"]["twist"]["linear"]["x"] > 0.1)
        peer.writer("graph", "ros_discovery_info", wire.type_on_wire("rmw_dds_common/ParticipantEntitiesInfo"), durability="transient", user_data=jazzy_hash)
        peer.await_matched("graph")
        gid = struct.pack("<QQ", 7, 7)
        node = struct.pack("<I4sI4sI16sI16s", 3, b"/n\0\0", 2, b"n\0\0\0", 1, gid, 1, gid)
        for count, nodes in ((100000, node * 100000), (2**32 - 1, node), (2**31 - 1, b"")):
            peer.say(f"put graph {(body[:4] + gid + struct.pack('<I', count) + nodes).hex()}")
        count = len(peer.samples["/leader/odom"])
        await_("odometry goes on", lambda: len(peer.samples["/leader/odom"]) > count + 20)
        assert "starting again" not in rig.log(rig.process), rig.log(rig.process)


# A suspended subscriber delays nothing; what it misses is counted, and its node named.
def slow_subscriber():
    with Rig() as rig:
        rig.sim(two)
        rig.gateway(robots=2)
        slow, quick = rig.peer(), rig.peer()
        for peer in (slow, quick):
            peer.subscribe("/clock", "rosgraph_msgs/Clock")
            peer.message("/clock", "rosgraph_msgs/Clock")
        reader = bytes.fromhex(slow.guids["/clock"])
        slow.writer("own", "ros_discovery_info", wire.type_on_wire("rmw_dds_common/ParticipantEntitiesInfo"), durability="transient", user_data=jazzy_hash)
        node = {"node_namespace": "/", "node_name": "sleeper", "reader_gid_seq": [{"data": reader}], "writer_gid_seq": []}
        slow.put("own", "rmw_dds_common/ParticipantEntitiesInfo", {"gid": {"data": reader[:12] + b"\0\0\1\xc1"}, "node_entities_info_seq": [node]})
        slow.reader("late", "rt/leader/scan", wire.type_on_wire("sensor_msgs/LaserScan"), durability="transient")
        slow.await_matched("own")
        await_("the doubt", lambda: "/leader/scan is offered as volatile, but transient local is requested by a reader" in rig.log(rig.process))
        os.kill(slow.process.pid, signal.SIGSTOP)
        try:
            count = len(quick.samples["/clock"])
            await_("clocks for the other one", lambda: len(quick.samples["/clock"]) > count + 300)
            await_("the count", lambda: "samples were not confirmed in time by every reader" in rig.log(rig.process))
            await_("its name", lambda: "/sleeper" in rig.log(rig.process))
        finally:
            os.kill(slow.process.pid, signal.SIGCONT)


globals()[case]()
