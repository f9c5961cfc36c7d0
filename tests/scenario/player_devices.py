# Which iface is which device of Player, what scanners can be told, and sensors beyond the usual: player_devices.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import math
import random
import struct
import zlib

from player_rig import *

scanner = """<sensor name="{name}" type="gpu_lidar"><pose>{x} 0 0.3 0 0 0</pose><update_rate>20</update_rate><lidar><scan><horizontal><samples>181</samples><resolution>1</resolution>
<min_angle>-1.5707963</min_angle><max_angle>1.5707963</max_angle></horizontal></scan><range><min>0.1</min><max>{reach}</max><resolution>0.01</resolution></range></lidar></sensor>"""

post = f"""<sdf version="1.9"><world name="posts"><model name="post"><static>true</static><link name="l">
{scanner.format(name="zeta", x=0.1, reach=8)}{scanner.format(name="alpha", x=-0.1, reach=4)}{scanner.format(name="m" * 70, x=0, reach=2)}</link></model>
<model name="wall"><static>true</static><pose>2.1 0 0.3 0 0 0</pose><link name="l"><collision name="c"><geometry><box><size>0.2 12 0.6</size></box></geometry></collision>
<visual name="v"><geometry><box><size>0.2 12 0.6</size></box></geometry></visual></link></model></world></sdf>"""

meters = f"""<sdf version="1.9"><world name="meters"><magnetic_field>2e-5 1e-6 -4e-5</magnetic_field><include><uri>{source}/worlds/models/ground_plane</uri></include>
<model name="mast"><pose>0 0 2 0 0 0</pose>
<link name="base"><inertial><mass>5</mass></inertial>
 <sensor name="pressure" type="air_pressure"><update_rate>20</update_rate></sensor>
 <sensor name="height" type="altimeter"><update_rate>20</update_rate></sensor>
 <sensor name="imu" type="imu"><update_rate>20</update_rate></sensor>
 <sensor name="field" type="magnetometer"><update_rate>20</update_rate></sensor>
 <sensor name="compass" type="magnetometer"><update_rate>20</update_rate></sensor>
 <sensor name="depth" type="depth_camera"><pose>0 0 0 0 0.5236 0</pose><update_rate>10</update_rate><camera><horizontal_fov>1</horizontal_fov><image><width>32</width><height>24</height></image>
  <clip><near>0.1</near><far>50</far></clip></camera></sensor></link>
<link name="arm"><pose>0 0 0.5 0 0 0</pose><inertial><mass>2</mass></inertial></link>
<joint name="fix" type="fixed"><parent>world</parent><child>base</child></joint>
<joint name="wrist" type="fixed"><parent>base</parent><child>arm</child><sensor name="wrist" type="force_torque"><update_rate>20</update_rate></sensor></joint></model></world></sdf>"""


def started_with(world, *options):
    rig = Rig()
    path = f"{rig.work}/devices.sdf"
    with open(path, "w") as file:
        file.write(world)
    rig.sim(*options, world=path)
    rig.gateway(robots=1)
    return rig


# Lasers have the order of the world file, and the line of the port, the driver's name and a property say which is which.
def identity():
    with started_with(post) as rig:
        long_name = "m" * 70
        words = rig.lines()[0][2].split()
        assert words[:3] == ["laser:0=post::zeta", "laser:1=post::alpha", f"laser:2=post::{long_name}"], words
        assert words[3:] == ["ranger:0=post::zeta", "ranger:1=post::alpha", f"ranger:2=post::{long_name}", "simulation:0=world"], words
        client = Client(rig.ports[0])
        assert [client.driver(LASER, index) for index in (0, 1)] == [b"rtm-sim post::zeta\0", b"rtm-sim post::alpha\0"]
        assert client.driver(LASER, 2) == b"rtm-sim ..." + b"m" * 51 + b"\0"
        assert client.driver(SIMULATION, 0) == b"rtm-sim world\0"
        for index, reach in ((0, 8), (1, 4)):
            client.subscribe(LASER, index)
            assert Laser(client.read_until(LASER, index=index)).max_range == reach
        # Refusals are told once each.
        for _ in range(3):
            for device in ((POSITION2D, 0), (LASER, 3), (77, 0)):
                assert not client.access(*device, OPEN)
        log = rig.log(rig.process)
        assert log.count("subscription refused: there is no position2d:0; there are laser:0 laser:1") == 1, log
        assert log.count("there is no laser:3;") == 1 and log.count("interface 77 is not served;") == 1, log
        for index in range(3, 100):
            assert not client.access(LASER, index, OPEN)
        assert rig.log(rig.process).count("subscription refused") == 20


def laser_config(min_angle=0, max_angle=0, resolution=0, range_resolution=0, intensity=1, rate=0, max_range=math.nan):
    return struct.pack(">5fIf", min_angle, max_angle, resolution, max_range, range_resolution, intensity, rate)


# What Configure of LaserProxy and RangerProxy sends: done, or refused. max_range is what was in the client's memory.
def configure():
    degree = math.pi / 180
    with started_with(post) as rig:
        client, other = Client(rig.ports[0]), Client(rig.ports[0])
        for one in (client, other):
            one.subscribe(LASER)
        whole = Laser(client.read_until(LASER))
        assert len(whole.ranges) == 181 == len(whole.intensities)
        said = struct.unpack(">5fIf", client.demand(LASER, 0, 2, laser_config(-45 * degree, 45 * degree, 2 * degree, 0, 0, 10)))
        assert abs(said[0] + 45 * degree) < 1e-4 and abs(said[1] - 45 * degree) < 1e-4 and abs(said[2] - 2 * degree) < 1e-4 and said[3] == 8, said
        assert said[5:] == (0, 10), said
        assert client.demand(LASER, 0, 3) == struct.pack(">5fIf", *said)
        for one in (client, other):
            part = Laser(one.read_until(LASER, good=lambda p: len(Laser(p).ranges) == 46))
            assert abs(part.min_angle + 45 * degree) < 1e-4 and abs(part.resolution - 2 * degree) < 1e-4 and part.intensities == b""
            assert all(abs(a - b) < 0.03 for a, b in zip(part.ranges, whole.ranges[45:136:2])), part.ranges
        before = client.stamps[(LASER, 0, 1)]
        for _ in range(4):
            client.read_until(LASER)
        # One of every two scans; which of them, when the gateway comes late to one.
        assert client.stamps[(LASER, 0, 1)] - before > 0.34
        for wrong in (laser_config(-2, 2), laser_config(resolution=0.5 * degree), laser_config(resolution=1.5 * degree), laser_config(rate=30), laser_config(rate=-1),
                      laser_config(range_resolution=0.001), laser_config(1, -1), laser_config(math.nan, 1), laser_config(rate=math.inf), laser_config()[:-4], b"", bytes(60)):
            client.refused(LASER, 0, 2, wrong)
        assert client.demand(LASER, 0, 3) == struct.pack(">5fIf", *said)  # as it was
        # What was read can be written again.
        assert client.demand(LASER, 0, 2, struct.pack(">5fIf", *said)) == struct.pack(">5fIf", *said)

        # The ranger of the same laser has settings of its own, and answers with them.
        client.subscribe(RANGER)
        assert len(Fields(client.read_until(RANGER)).many("d")) == 181
        wanted = struct.pack(">7d", -30 * degree, 30 * degree, 1 * degree, 0.1, 1.5, 0.5, 20)
        got = struct.unpack(">7d", client.demand(RANGER, 0, 4, wanted))
        assert all(abs(a - b) < 1e-3 for a, b in zip(got, struct.unpack(">7d", wanted))), got
        ranges = Fields(client.read_until(RANGER, good=lambda p: Fields(p).count() == 61)).many("d")
        assert set(ranges) == {1.5}, ranges  # the wall is further away
        client.refused(RANGER, 0, 4, struct.pack(">7d", 0, 0, 0, 0, 9, 0, 0))

        # It ends with the last client.
        client.close()
        other.unsubscribe(LASER)
        other.subscribe(LASER)
        other.read_until(LASER, good=lambda p: len(Laser(p).ranges) == 181 == len(Laser(p).intensities))


# Altimeter, air pressure, force and torque, magnetometers, and what a depth camera sees.
def meters_and_depths():
    with started_with(meters) as rig:
        words = dict(word.split("=") for word in rig.lines()[0][2].split())
        names = {name.split("::")[-1]: device for device, name in words.items() if device.startswith("aio")}
        assert words["imu:0"].startswith("mast::imu+mast::field") and words["imu:1"] == "mast::compass" and len(names) == 3, words
        client = Client(rig.ports[0])

        def inputs(which):
            index = int(names[which].split(":")[1])
            client.subscribe(AIO, index)
            values = Fields(client.read_until(AIO, index=index)).many("f")
            client.unsubscribe(AIO, index)
            return values

        height = inputs("height")
        assert len(height) == 2 and all(abs(value) < 0.01 for value in height), height
        pressure = inputs("pressure")
        assert len(pressure) == 1 and abs(pressure[0] - 101301) < 30, pressure
        force = inputs("wrist")
        assert len(force) == 6 and abs(abs(force[2]) - 2 * 9.8) < 0.1, force

        for index in (0, 1):
            client.subscribe(IMU, index)
            values = struct.unpack(">9f3d", client.read_until(IMU, subtype=4, index=index, good=lambda p: struct.unpack(">9f3d", p)[8] != 0))
            assert all(abs(a - b) < 1e-7 for a, b in zip(values[6:9], (2e-5, 1e-6, -4e-5))), values
            assert abs(values[2] - (9.8 if index == 0 else 0)) < 0.1, values
            client.unsubscribe(IMU, index)

        # 30 degrees down from 2 m: the middle of the picture is 4 m away.
        client.subscribe(CAMERA)
        fields = Fields(client.read_until(CAMERA))
        assert fields.take("6I") == (32, 24, 16, 2, 1, 0)
        depths = struct.unpack(">768H", fields.raw())
        fields.finish()
        assert abs(depths[12 * 32 + 16] - 4000) < 150, depths[12 * 32 + 16]
        assert depths[0] > depths[-1] > 2000, (depths[0], depths[-1])
        client.subscribe(POINTCLOUD3D)
        fields = Fields(client.read_until(POINTCLOUD3D))
        points = [fields.take("3d4I") for _ in range(fields.count())]
        fields.finish()
        assert len(points) == 768 and all(point[3:] == (255, 255, 255, 255) for point in points)
        # Each lies on the ground: 2 m below along an axis tilted by 30 degrees.
        assert all(abs(x * 0.5 - z * math.cos(math.pi / 6) - 2) < 0.02 for x, _, z, *_ in points), points[:3]
        assert min(y for _, y, *_ in points) < -1 and max(y for _, y, *_ in points) > 1
        assert client.request(AIO, 0, 255, struct.pack(">II", DATA, 1))[0] == ACK and client.request(POINTCLOUD3D, 0, 1)[0] == NACK


# ---- arms ----


class Actuators:
    """position, speed, acceleration, current, state of each; and whether there is power."""

    def __init__(self, payload):
        fields = Fields(payload)
        self.all = fields.many("4fI")
        self.power = fields.take("I")
        fields.finish()
        self.positions = [one[0] for one in self.all]


IDLE, MOVING, BRAKED, STALLED = 1, 2, 4, 8


def positions(client, wanted, index=0, tolerance=0.005):
    good = lambda p: all(abs(a - b) < tolerance for a, b in zip(Actuators(p).positions, wanted)) and all(one[4] == IDLE for one in Actuators(p).all)
    return Actuators(client.read_until(ACTARRAY, index=index, good=good))


def numbers(values):
    return struct.pack(f">II{len(values)}f", len(values), len(values), *values)


def arm_rig():
    rig = Rig()
    rig.sim(world=f"{source}/worlds/arm.sdf")
    rig.gateway(robots=2)
    return rig


# An array of six joints and a gripper on one port, a pan and a tilt on the next; commands of one joint, of all, home; brakes, power; the bad ones are lines.
def actarray():
    with arm_rig() as rig:
        assert [(name, words.split()[:-1]) for _, name, words in rig.lines()] == [
            ("arm", ["actarray:0=arm::joints", "limb:0=arm::joints", "gripper:0=arm::joints"]), ("eye", ["camera:0=eye::camera", "actarray:0=eye::joints", "ptz:0=eye::joints", "blobfinder:0=eye::camera"])], rig.lines()
        client = Client(rig.ports[0])
        # Before anybody is subscribed, and with data always: clients do not see a refusal.
        fields = Fields(client.demand(ACTARRAY, 0, 3))
        joints = [fields.take("If6d5fI") for _ in range(fields.count())]
        base = fields.take("6d")
        fields.finish()
        assert [joint[0] for joint in joints] == [2] * 6 and all(joint[-1] == 1 for joint in joints), joints
        assert [round(joint[8], 3) for joint in joints] == [-2.9, -1.9, -0.3, -3.1, -2.1, -4.7] and [round(joint[10], 3) for joint in joints] == [2.9, 1.9, 2.6, 3.1, 2.1, 4.7], joints
        assert abs(joints[1][1] - 0.35) < 1e-6 and joints[1][5:8] == (0, 1, 0) and abs(joints[2][11] - 1.75) < 1e-6 and joints[0][12] == 2, joints
        assert abs(base[2] - 0.1) < 0.06, base
        client.subscribe(ACTARRAY)
        first = Actuators(client.read_until(ACTARRAY))
        assert len(first.all) == 6 and first.power == 1 and abs(first.positions[2] - 1.75) < 0.05, first.all
        client.command(ACTARRAY, 0, 1, struct.pack(">if", 0, 0.5))
        client.command(ACTARRAY, 0, 1, struct.pack(">if", 3, -0.4))  # both count, however near they come
        positions(client, (0.5, 0, 1.75, -0.4, 1.3916, 0))
        client.command(ACTARRAY, 0, 2, numbers((0.2, 0.1, 1.5)))  # of fewer joints than there are
        positions(client, (0.2, 0.1, 1.5, -0.4, 1.3916, 0))
        client.demand(ACTARRAY, 0, 4, struct.pack(">if", 0, 0.1))
        client.command(ACTARRAY, 0, 1, struct.pack(">if", 0, 1.0))
        client.read_until(ACTARRAY, good=lambda p: Actuators(p).all[0][4] == MOVING)
        fastest = max(abs(Actuators(client.read_until(ACTARRAY)).all[0][1]) for _ in range(20))
        assert 0.05 < fastest < 0.12, fastest
        client.demand(ACTARRAY, 0, 4, struct.pack(">if", -1, 1.0))
        client.command(ACTARRAY, 0, 3, struct.pack(">if", 5, 0.5))
        client.read_until(ACTARRAY, good=lambda p: abs(Actuators(p).all[5][1] - 0.5) < 0.02)
        client.command(ACTARRAY, 0, 4, numbers((0, 0, 0, 0, 0, -0.5)))
        client.read_until(ACTARRAY, good=lambda p: abs(Actuators(p).all[5][1] + 0.5) < 0.02)
        client.command(ACTARRAY, 0, 6, struct.pack(">if", 5, 0.01))
        client.read_until(ACTARRAY, good=lambda p: abs(Actuators(p).all[5][3] - 0.01) < 1e-6)
        client.command(ACTARRAY, 0, 5, struct.pack(">i", -1))
        positions(client, (0, 0, 1.75, 0, 1.3916, 0))

        client.demand(ACTARRAY, 0, 2, struct.pack(">I", 1))
        client.read_until(ACTARRAY, good=lambda p: all(one[4] == BRAKED for one in Actuators(p).all))
        client.command(ACTARRAY, 0, 1, struct.pack(">if", 0, 1.0))
        await_("a refusal", lambda: "actarray:0: the brakes are on; commands are ignored" in rig.log(rig.process))
        client.demand(ACTARRAY, 0, 2, struct.pack(">I", 0))
        client.demand(ACTARRAY, 0, 1, struct.pack(">I", 0))
        client.read_until(ACTARRAY, good=lambda p: Actuators(p).power == 0)
        client.demand(ACTARRAY, 0, 1, struct.pack(">I", 1))
        client.read_until(ACTARRAY, good=lambda p: Actuators(p).power == 1)

        nan = math.nan
        for subtype, payload in ((1, struct.pack(">if", 9, 0)), (1, struct.pack(">if", 0, nan)), (1, struct.pack(">if", 0, 99)), (2, numbers([0] * 7)), (3, struct.pack(">if", 0, 1000)),
                                 (2, struct.pack(">II", 2, 3)), (5, b""), (1, b"abc"), (6, struct.pack(">if", -2, 0))):
            for _ in range(3):
                client.command(ACTARRAY, 0, subtype, payload)
        lines = ("there is no joint 9, only 0 to 5", "joint waist: a position must be within -2.9 and 2.9, got nan", "joint waist: a position must be within -2.9 and 2.9, got 99",
                 "a command has 7 values for 6 joints", "joint waist: a speed must be within -2 and 2, got 1000", "there is no joint -2, only 0 to 5")
        await_("a line for each", lambda: all(rig.log(rig.process).count(line) == 1 for line in lines))
        for subtype, payload in ((4, struct.pack(">if", 0, 0)), (4, struct.pack(">if", 7, 1)), (5, struct.pack(">if", 0, nan)), (1, b""), (99, b"")):
            client.refused(ACTARRAY, 0, subtype, payload)
        positions(client, (0, 0, 1.75, 0, 1.3916, 0))

        # Who commands and goes leaves the joints to their brakes; who only looks does not.
        other = Client(rig.ports[0])
        other.subscribe(ACTARRAY)
        other.read_until(ACTARRAY)
        client.command(ACTARRAY, 0, 3, struct.pack(">if", 0, 0.5))
        client.read_until(ACTARRAY, good=lambda p: Actuators(p).all[0][1] > 0.4)
        client.close()
        other.read_until(ACTARRAY, good=lambda p: Actuators(p).all[0][4] == BRAKED and abs(Actuators(p).all[0][1]) < 1e-3)
        rig.is_alive()


# The tip goes to poses, places, along directions, home, and stops; power, brakes, speed; what cannot be done is a line.
def limb():
    with arm_rig() as rig:
        client = Client(rig.ports[0])
        assert abs(Fields(client.demand(LIMB, 0, 3)).take("3d")[2] - 0.1) < 0.06
        client.subscribe(LIMB)
        idle, braked, moving, out_of_reach = 1, 2, 3, 4
        state = lambda p: struct.unpack(">9dI", p)
        seen = lambda wanted: lambda p: state(p)[9] == wanted
        at = lambda *place, tolerance=0.002: lambda p: state(p)[9] == idle and all(abs(a - b) < tolerance for a, b in zip(state(p), place))
        first = state(client.read_until(LIMB, good=seen(idle)))
        down = (0, 0, -1, 0, 1, 0)  # approach, then orientation
        client.command(LIMB, 0, 3, struct.pack(">9d", 0.45, 0.1, 0.3, *down))
        client.read_until(LIMB, good=seen(moving))
        client.read_until(LIMB, good=at(0.45, 0.1, 0.3, *down))
        client.command(LIMB, 0, 4, struct.pack(">3d", 0.45, -0.1, 0.3))
        client.read_until(LIMB, good=at(0.45, -0.1, 0.3, *down))
        client.command(LIMB, 0, 5, struct.pack(">3df", 0, 0, 5, 0.1))
        client.read_until(LIMB, good=at(0.45, -0.1, 0.4, *down))
        client.demand(LIMB, 0, 4, struct.pack(">f", 0.05))
        client.command(LIMB, 0, 4, struct.pack(">3d", 0.45, 0.3, 0.4))
        client.read_until(LIMB, good=lambda p: state(p)[1] > -0.05)
        client.command(LIMB, 0, 2)
        stopped = state(client.read_until(LIMB, good=seen(idle)))
        assert -0.06 < stopped[1] < 0.1, stopped
        client.demand(LIMB, 0, 4, struct.pack(">f", 0.5))
        client.command(LIMB, 0, 1)
        client.read_until(LIMB, good=at(*first[:9], tolerance=0.03))

        client.command(LIMB, 0, 3, struct.pack(">9d", 3, 0, 0.3, *down))
        client.read_until(LIMB, good=seen(out_of_reach))
        for subtype, payload in ((3, struct.pack(">9d", math.nan, 0, 0.3, *down)), (3, struct.pack(">9d", 0.45, 0, 0.3, 0, 0, -1, 0, 0, 1)), (5, struct.pack(">3df", 0, 0, 0, 1))):
            for _ in range(3):
                client.command(LIMB, 0, subtype, payload)
        lines = ("limb:0: the arm cannot reach the pose; the command is ignored", "limb:0: a pose must be finite, its axes orthonormal; the command is ignored",
                 "limb:0: a direction must be finite and not zero; the command is ignored")
        await_("a line for each", lambda: all(rig.log(rig.process).count(line) == 1 for line in lines))
        for subtype, payload in ((4, struct.pack(">f", 0)), (4, struct.pack(">f", math.nan)), (4, b""), (2, b"ab"), (1, b""), (99, b"")):
            client.refused(LIMB, 0, subtype, payload)
        client.command(LIMB, 0, 3, b"short")

        client.demand(LIMB, 0, 2, struct.pack(">I", 1))
        client.read_until(LIMB, good=seen(braked))
        client.command(LIMB, 0, 1)
        await_("a refusal", lambda: "limb:0: the brakes are on; the command is ignored" in rig.log(rig.process))
        client.demand(LIMB, 0, 1, struct.pack(">I", 0))
        client.demand(LIMB, 0, 2, struct.pack(">I", 0))
        client.read_until(LIMB, good=seen(braked))
        client.demand(LIMB, 0, 1, struct.pack(">I", 1))
        client.command(LIMB, 0, 4, struct.pack(">3d", 0.45, 0, 0.4))
        client.read_until(LIMB, good=at(0.45, 0, 0.4))
        client.close()
        other = Client(rig.ports[0])
        other.subscribe(ACTARRAY)
        other.read_until(ACTARRAY, good=lambda p: Actuators(p).all[0][4] == BRAKED)
        rig.is_alive()


def gripper():
    with arm_rig() as rig:
        client = Client(rig.ports[0])
        client.subscribe(GRIPPER)
        client.subscribe(ACTARRAY)
        fields = Fields(client.demand(GRIPPER, 0, 1))
        numbers_of = fields.take("12d2I")
        fields.finish()
        assert abs(numbers_of[6] - 0.08) < 1e-6 and numbers_of[-2:] == (0, 0), numbers_of
        state = lambda wanted: lambda p: struct.unpack(">3I", p) == (wanted, 0, 0)
        client.read_until(GRIPPER, good=state(1))
        # Over the green box, down, and up again with it.
        client.command(ACTARRAY, 0, 2, struct.pack(">II6f", 6, 6, 0, 0.8384, 1.73, 0, 0.5732, 0))
        positions(client, (0, 0.8384, 1.73, 0, 0.5732, 0))
        client.command(GRIPPER, 0, 2)
        client.read_until(GRIPPER, good=state(2))
        client.command(ACTARRAY, 0, 1, struct.pack(">if", 1, 0.0))
        await_("a box in the air", lambda: float(rig.simctl("pose", "green_box").split()[2]) > 0.85)
        client.read_until(GRIPPER, good=state(2))
        client.command(GRIPPER, 0, 3)  # stop: holds on
        client.read_until(GRIPPER, good=state(2))
        client.command(GRIPPER, 0, 1)
        await_("the box on its way down", lambda: float(rig.simctl("pose", "green_box").split()[2]) < 0.8)
        client.read_until(GRIPPER, good=state(1))
        client.refused(GRIPPER, 0, 2)
        client.command(GRIPPER, 0, 4)  # store: there is none
        rig.is_alive()


def ptz():
    with arm_rig() as rig:
        client = Client(rig.ports[1])
        client.subscribe(PTZ)
        fields = Fields(client.demand(PTZ, 0, 4))
        fields.take("9d")
        fields.finish()
        assert client.demand(PTZ, 0, 5) == struct.pack(">I", 0)
        at = lambda pan, tilt: lambda p: abs(struct.unpack(">5fI", p)[0] - pan) < 0.005 and abs(struct.unpack(">5fI", p)[1] - tilt) < 0.005
        pan, tilt, zoom, *_, status = struct.unpack(">5fI", client.read_until(PTZ, good=at(0, 0.5)))
        assert abs(zoom - 1.0) < 1e-6 and status == 0, zoom
        client.command(PTZ, 0, 1, struct.pack(">5f", 0.6, -0.3, 0, 0, 0))
        client.read_until(PTZ, good=at(0.6, -0.3))
        client.command(PTZ, 0, 1, struct.pack(">5f", -1.2, -0.3, 0, 0.2, 0))  # no faster than that
        client.read_until(PTZ, good=lambda p: struct.unpack(">5fI", p)[3] < -0.15)
        assert min(struct.unpack(">5fI", client.read_until(PTZ))[3] for _ in range(20)) > -0.25
        assert client.demand(PTZ, 0, 2, struct.pack(">I", 0)) == struct.pack(">I", 0)
        client.command(PTZ, 0, 1, struct.pack(">5f", 0, 0, 0, 0.5, 0))
        client.read_until(PTZ, good=lambda p: abs(struct.unpack(">5fI", p)[3] - 0.5) < 0.05)
        client.demand(PTZ, 0, 2, struct.pack(">I", 1))
        client.refused(PTZ, 0, 2, struct.pack(">I", 7))
        client.refused(PTZ, 0, 1, b"")
        client.command(PTZ, 0, 1, struct.pack(">5f", 0.2, 9, 0, 0, 0))
        await_("a refusal", lambda: "ptz:0: joint tilt: a position must be within -0.8 and 1.2, got 9" in rig.log(rig.process))
        client.read_until(PTZ, good=lambda p: abs(struct.unpack(">5fI", p)[0] - 0.2) < 0.005)


# Another mapping: joints by name, and those of a model that the simulator takes for no device.
def joints_by_name():
    with Rig() as rig:
        path = f"{rig.work}/arm.yaml"
        with open(path, "w") as file:
            file.write("ports:\n  - port: 0\n    devices:\n      actarray:0: [arm::joints, elbow, waist]\n      actarray:1: arm::joints\n      gripper:3: [arm::joints, left_finger]\n"
                       "      ptz:0: eye::joints\n      actarray:2: [arm::joints, nose]\n")
        rig.sim(world=f"{source}/worlds/arm.sdf")
        rig.gateway("--config", path, robots=1)
        client = Client(rig.ports[0])
        for index, count in ((0, 2), (1, 6)):
            client.subscribe(ACTARRAY, index)
            assert len(Actuators(client.read_until(ACTARRAY, index=index)).all) == count
        client.command(ACTARRAY, 0, 2, numbers((1.5, 0.3)))
        client.read_until(ACTARRAY, index=1, good=lambda p: abs(Actuators(p).positions[0] - 0.3) < 0.005 and abs(Actuators(p).positions[2] - 1.5) < 0.005)
        client.subscribe(GRIPPER, 3)
        client.read_until(GRIPPER, index=3)
        assert 'iface arm::joints has no joint "nose"; it has waist, shoulder' in rig.log(rig.process)
        empty = Fields(client.demand(ACTARRAY, 2, 3))
        assert empty.count() == 0


# Requests, commands and nonsense of all kinds to all devices, in streams that are cut anywhere: all that is good is answered, and the gateway lives.
def storm():
    seed = random.randrange(1 << 32)
    print("seed", seed)
    dice = random.Random(seed)
    numbers = (0, 1, -1, 0.5, math.pi, 1e308, -1e308, math.inf, math.nan, 1e-310)

    def payload():
        kind = dice.randrange(6)
        if kind == 0:
            return dice.randbytes(dice.randrange(100))
        if kind == 1:
            return struct.pack(f">{n}d", *(dice.choice(numbers) for _ in range(n))) + bytes(4) if (n := dice.randrange(13)) else b""
        if kind == 2:
            return struct.pack(f">{n}f", *(dice.uniform(-5, 5) for _ in range(n))) if (n := dice.randrange(9)) else b""
        if kind == 3:
            return text(dice.choice(("mast", "world", "speed", "", "x" * 4000, "a::b", "%n"))) + dice.randbytes(dice.choice((0, 4, 24, 56)))
        if kind == 4:
            return struct.pack(">II", *(dice.choice((0, 1, 5, 0x7FFFFFFF, 0xFFFFFFFF)) for _ in range(2))) + dice.randbytes(8)
        return dev_request(dice.randrange(70), dice.randrange(4), dice.choice((OPEN, OPEN, CLOSE, 7)))

    with started_with(meters) as rig:
        good = Client(rig.ports[0])
        good.subscribe(AIO)
        devices = [(PLAYER, 0), *good.devices()]
        for _ in range(12):
            client = Client(rig.ports[0], pull=dice.random() < 0.5)
            client.open_devices = set(devices)
            for device in devices[1:]:
                if dice.random() < 0.5 and device[0] != SIMULATION:
                    client.request(PLAYER, 0, 3, dev_request(*device, OPEN))
            for _ in range(150):
                interface, index = dice.choice(devices)
                subtype = dice.choice((*range(11), *range(247, 256)))
                if interface == SIMULATION and subtype in (1, 2):
                    continue  # a pause would stop what is looked for below
                if dice.random() < 0.3:
                    client.command(interface, index, subtype, payload())
                else:
                    client.send(message(interface, index, REQ, subtype, payload()))
                    while client.next().kind not in (ACK, NACK):
                        pass
            stream = b"".join(message(*dice.choice(devices), dice.randrange(8), dice.randrange(256), payload()) for _ in range(20))
            stream = stream[: dice.randrange(len(stream))] + dice.randbytes(dice.randrange(50))
            try:
                client.send(stream)
                client.close()
            except (BrokenPipeError, ConnectionResetError):
                pass
            good.read_until(AIO)
        rig.is_alive()


# What does not look: a battery, a charger, tags, transmitters, an estimate; the ports are those of a configuration file of Player.
def power():
    with Rig() as rig:
        rig.sim("--rtf", "4", world=f"{source}/worlds/devices.sdf")
        with open(f"{rig.work}/robots.cfg", "w") as file:
            file.write('''
driver ( name "stage" provides ["0:simulation:0"] plugin "stageplugin" worldfile "power.world" )
driver ( name "stage" provides ["0:position2d:0" "0:power:0"] model "rover" )
driver ( name "amcl" provides ["localize:1"] requires ["position2d:0"] )
''')
        port = rig.gateway("--config", f"{rig.work}/robots.cfg", robots=1)[0]
        assert 'driver "amcl" is not started here; not served: localize:1' in rig.log(rig.process), rig.log(rig.process)
        client, driver = Client(port), Client(port)
        client.subscribe(POWER)
        state = lambda payload: struct.unpack(">I4fi", payload)
        valid, volts, percent, joules, watts, charging = state(client.read_until(POWER))
        assert valid == 31 and abs(percent - 100 * 1.18 / 1.2009) < 0.01 and abs(volts - 12.592) < 1e-3 and charging == -1 and watts == 0, (volts, percent)
        driver.subscribe(POSITION2D)
        driver.command(POSITION2D, 0, 1, velocity(0.1, 0, 0))
        used = state(client.read_until(POWER, good=lambda p: state(p)[2] < percent - 0.01 and state(p)[4] < -5))
        assert used[3] < joules, (used, joules)
        client.refused(POWER, 0, 1, struct.pack(">II", 1, 0))  # the output cannot be switched off
        client.refused(POWER, 0, 1, b"")
        client.demand(POWER, 0, 1, struct.pack(">II", 1, 1))
        client.read_until(POWER, good=lambda p: state(p)[5] == 1 and state(p)[4] > 0)
        client.unsubscribe(POWER)
        client.subscribe(POWER)
        client.read_until(POWER, good=lambda p: state(p)[5] == -1)


def estimates():
    with Rig() as rig:
        rig.sim(world=f"{source}/worlds/devices.sdf")
        rig.gateway(robots=3)
        port, words = next((int(port), dict(word.split("=") for word in words.split())) for port, robot, words in rig.lines() if robot == "rover")
        assert words["power:0"] == "rover::battery" and words["gps:0"] == "rover::ins" and words["aio:0"] == "rover::wheels", words
        client = Client(port)
        for interface in (LOCALIZE, RFID, WIFI, GPS, AIO):
            client.subscribe(interface)
        fields = Fields(client.read_until(LOCALIZE))
        assert fields.take("I") == 0 and fields.take("d") > 0
        hypotheses = [fields.take("3d6dd") for _ in range(fields.count())]
        fields.finish()
        assert len(hypotheses) == 3 and abs(sum(one[9] for one in hypotheses) - 1) < 1e-9, hypotheses
        assert all(abs(one[0] + 4) < 0.6 and abs(one[3] - 0.01) < 1e-9 and abs(one[5] - 0.0025) < 1e-9 for one in hypotheses), hypotheses
        assert len(client.demand(LOCALIZE, 0, 2)) == 32 + 8 + 3 * 32
        client.refused(LOCALIZE, 0, 1, struct.pack(">9d", *range(9)))
        fields = Fields(client.read_until(RFID))
        assert fields.count() == 1 and fields.take("I") == 0 and fields.raw() == b"E200-0017"
        fields.finish()
        fields = Fields(client.read_until(WIFI))
        assert fields.count() == 1 and fields.raw() == b"access_point::radio\0" and fields.raw() == b"\0" and fields.raw() == b"lab\0"
        _, frequency, _, _, level, _ = fields.take("6I")
        distance = math.dist((-12, 0, 2), (-4, 0, 0.3))
        assert frequency == 2442 and abs(level - 256 - (19.5 - 20 * math.log10(4 * math.pi * distance * 2.442e9 / 299792458))) < 1, level
        assert abs(struct.unpack(">2I2i", client.read_until(GPS)[:16])[2] - 36.06e7) < 200
        assert len(Fields(client.read_until(AIO)).many("f")) == 2


# The occupancy map, on the port that names it: a box of 1 m at (2, 3) fills 400 cells, and a row on each side at most.
def map_tiles():
    with Rig() as rig:
        with open(f"{rig.work}/map.sdf", "w") as file:
            file.write("""<sdf version="1.9"><world name="w"><model name="box"><static>true</static><pose>2 3 0.5 0 0 0</pose><link name="l"><collision name="c">
<geometry><box><size>1 1 1</size></box></geometry></collision></link></model></world></sdf>""")
        with open(f"{rig.work}/map.yaml", "w") as file:
            file.write("ports:\n  - port: 0\n    devices: {'map:0': world}\n")
        rig.sim(world=f"{rig.work}/map.sdf")
        client = Client(rig.gateway("--config", f"{rig.work}/map.yaml", robots=1)[0])
        client.subscribe(MAP)
        request = lambda column, row, width, height: struct.pack(">4I3I", column, row, width, height, 0, 0, 0)
        client.refused(MAP, 0, 2, request(0, 0, 1, 1))  # no map was made yet
        scale, width, height, x, y, angle = struct.unpack(">fIIddd", client.demand(MAP, 0, 1))
        assert abs(scale - 0.05) < 1e-6 and width == height == 40 and abs(x - 1) < 0.06 and abs(y - 2) < 0.06 and angle == 0, (scale, width, height, x, y)
        fields = Fields(client.demand(MAP, 0, 2, request(0, 0, width, height)))
        assert fields.take("4I") == (0, 0, width, height)
        count, reach, length = fields.take("3I")
        packed = fields.payload[fields.at : fields.at + length]
        assert count == length and reach == 1 and len(fields.payload) == fields.at + length + -length % 4
        cells = zlib.decompress(packed)
        assert len(cells) == width * height and 400 <= cells.count(1) <= 22 * 22 and cells[20 * width + 20] == 1 and cells[0] != 1, cells.count(1)
        client.refused(MAP, 0, 2, request(1, 0, width, 1))
        client.refused(MAP, 0, 2, b"")
        client.refused(MAP, 0, 4)


# Resets of an imu's orientation, JPEG of a camera, and what can be set of the world.
def settings():
    with started_with(meters.replace('type="depth_camera"', 'type="camera"')) as rig:
        client = Client(rig.ports[0])
        client.subscribe(IMU)
        angles = lambda payload: struct.unpack(">9f3d", payload)[9:]
        client.demand(IMU, 0, 3, struct.pack(">6d", 0, 0, 0, 0.1, -0.2, 1.5))
        client.read_until(IMU, subtype=4, good=lambda p: all(abs(a - b) < 1e-3 for a, b in zip(angles(p), (0.1, -0.2, 1.5))))
        client.demand(IMU, 0, 2, struct.pack(">I", 0))
        client.read_until(IMU, subtype=4, good=lambda p: all(abs(a) < 1e-3 for a in angles(p)))
        client.refused(IMU, 0, 3, struct.pack(">6d", 0, 0, 0, math.nan, 0, 0))

        client.subscribe(CAMERA)
        raw = client.read_until(CAMERA)
        assert struct.unpack(">6I", raw[:24]) == (32, 24, 24, 5, 1, 0)
        client.demand(CAMERA, 0, 253, text("compression") + struct.pack(">i", 1))
        fields = Fields(client.read_until(CAMERA, good=lambda p: struct.unpack(">6I", p[:24])[5] == 1))
        assert fields.take("6I")[:5] == (32, 24, 24, 5, 1) and fields.raw()[:3] == b"\xff\xd8\xff"
        client.refused(CAMERA, 0, 253, text("quality") + struct.pack(">i", 101))

        def set_property(name, value):
            return client.request(SIMULATION, 0, 6, text("world") + text(name) + struct.pack(">I", 0) + struct.pack(">II", len(value), len(value)) + value + b"\0" * (-len(value) % 4))[0]

        paused = lambda: json.loads(rig.simctl("--json", "stats"))["paused"]
        assert set_property("state", b"\0") == ACK and paused()
        assert set_property("state", b"\1") == ACK and not paused()
        assert set_property("real_time_factor", struct.pack("=d", 2)) == ACK
        assert set_property("real_time_factor", struct.pack("=d", math.nan)) == NACK and set_property("gravity", b"\0") == NACK
        client.subscribe(SIMULATION)
        client.command(SIMULATION, 0, 3)
        await_("the refusal", lambda: "SAVE of simulation is ignored" in rig.log(rig.process))


# Marks of a detector, and a coloured ball and the boxes of labelled things as blobs.
def seen():
    with Rig() as rig:
        rig.sim(world=f"{source}/worlds/devices.sdf")
        rig.gateway(robots=1)
        port = next(port for port, robot, _ in rig.lines() if robot == "mast")
        words = next(words for _, robot, words in rig.lines() if robot == "mast").split()
        client = Client(int(port))
        index_of = lambda device: next(int(word.split(":")[1].split("=")[0]) for word in words if word.startswith(device.split("=")[0]) and word.endswith("=" + device.split("=")[1]))
        client.subscribe(FIDUCIAL, index_of("fiducial=mast::marks"))
        fields = Fields(client.read_until(FIDUCIAL, index=index_of("fiducial=mast::marks")))
        marks = fields.many("i12d")
        fields.finish()
        assert sorted(mark[0] for mark in marks) == [0, 1, 2], marks
        first = next(mark for mark in marks if mark[0] == 0)
        assert abs(first[1] - 3.5) + abs(first[2] - 0.2) + abs(first[3] + 0.1) < 0.1 and abs(first[7] - 0.005) < 1e-9, first
        kind, view = client.request(FIDUCIAL, index_of("fiducial=mast::marks"), 2)
        assert kind == ACK and [round(one, 4) for one in struct.unpack(">3f", view)] == [0, 6, 1.2]
        camera = index_of("blobfinder=mast::camera")
        client.subscribe(BLOBFINDER, camera)
        fields = Fields(client.read_until(BLOBFINDER, index=camera))
        assert fields.take("II") == (640, 480)
        blobs = fields.many("9If")
        fields.finish()
        ball = next(blob for blob in blobs if blob[1] == 0x0000ff)  # the ball of 0.2 m is at (2.6, -0.6, 0.2)
        assert abs(ball[3] - (320 + 467.7 * 0.6 / 2.6)) < 6 and abs(ball[4] - (240 + 467.7 * 0.7 / 2.6)) < 10, ball


run(seen, identity, configure, power, estimates, settings, meters_and_depths, storm, actarray, limb, gripper, ptz, joints_by_name, map_tiles)
