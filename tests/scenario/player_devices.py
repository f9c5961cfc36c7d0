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
        assert log.count("subscription rejected: there is no position2d:0; there are laser:0 laser:1") == 1, log
        assert log.count("there is no laser:3;") == 1 and log.count("interface 77 is not served;") == 1, log
        for index in range(3, 100):
            assert not client.access(LASER, index, OPEN)
        assert rig.log(rig.process).count("subscription rejected") == 20


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


run(seen, identity, configure, power, estimates, settings, meters_and_depths, storm, map_tiles)
