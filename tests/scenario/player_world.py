# Player interfaces on ports that name them: maps as lines, ways over the map, two cameras as one, bytes between clients: player_world.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import random

import pixels

from player_rig import *

room = f"""<sdf version="1.9"><world name="room">
  <physics name="default" type="ode"><max_step_size>0.002</max_step_size></physics>
  <include><uri>{source}/worlds/models/ground_plane</uri></include>
  <include><uri>{source}/worlds/models/pioneer2dx_sick</uri><name>rover</name><pose>-2 0 0 0 0 1</pose></include>
  <model name="wall"><static>true</static><pose>0 0 0.5 0 0 0</pose><link name="l">
    <collision name="c"><geometry><box><size>0.2 4 1</size></box></geometry></collision></link></model>
  <model name="box"><static>true</static><pose>0 6 0.5 0 0 0</pose><link name="l">
    <collision name="c"><geometry><box><size>1 1 1</size></box></geometry></collision></link></model>
  <model name="post"><pose>0 -6 0 0 0 0</pose><link name="l"><inertial><mass>1</mass><inertia><ixx>.01</ixx><iyy>.01</iyy><izz>.01</izz></inertia></inertial>
    <collision name="c"><pose>0 0 0.2 0 0 0</pose><geometry><box><size>.4 .4 .4</size></box></geometry></collision>
    <sensor name="bumper" type="contact"><update_rate>20</update_rate><contact><collision>c</collision></contact></sensor></link></model>
</world></sdf>"""


def named(*devices, world=room, rtf="1"):
    rig = Rig()
    with open(f"{rig.work}/room.sdf", "w") as file:
        file.write(world)
    with open(f"{rig.work}/ports.yaml", "w") as file:
        file.write("ports:\n  - port: 0\n    devices: {" + ", ".join(devices) + "}\n")
    rig.sim("--rtf", rtf, world=f"{rig.work}/room.sdf")
    rig.gateway("--config", f"{rig.work}/ports.yaml", robots=1)
    return rig


def layer(name):
    return text(name) + struct.pack(">II", 0, 0)


# The outlines of a wall and a box are eight lines, as segments of the map and as well known binary of the only layer.
def lines_of_the_map():
    with named("'map:0': world", "'vectormap:0': world") as rig:
        client = Client(rig.ports[0])
        client.subscribe(MAP)
        client.subscribe(VECTORMAP)
        fields = Fields(client.demand(MAP, 0, 3))
        extent = fields.take("4f")
        lines = fields.many("4d")
        fields.finish()
        assert all(abs(a - b) < 1e-5 for a, b in zip(extent, (-0.5, 0.5, -2, 6.5))), extent
        assert len(lines) == 8 and abs(sum(math.hypot(x1 - x0, y1 - y0) for x0, y0, x1, y1 in lines) - (8.4 + 4)) < 1e-3, lines
        client.refused(VECTORMAP, 0, 3, layer("roofs"))
        fields = Fields(client.demand(VECTORMAP, 0, 1))
        assert fields.take("I") == 0 and fields.count() == 1 and fields.raw() == b"walls\0"
        extent = fields.take("4d")
        assert fields.take("4d") == extent and extent[0] < -0.5 < 0.5 < extent[2] and extent[1] < -2 < 6.5 < extent[3], extent
        fields.finish()
        fields = Fields(client.demand(VECTORMAP, 0, 3, layer("walls")))
        assert fields.raw() == b"walls\0"
        found = []
        for _ in range(fields.count()):
            assert fields.raw() == b"wall\0"
            binary = fields.raw()
            assert fields.raw() == b"\0" and struct.unpack_from("<BII", binary) == (1, 2, 2) and len(binary) == 41
            found.append(struct.unpack_from("<4d", binary, 9))
        fields.finish()
        assert sorted(found) == sorted(lines)
        for wrong in (b"", bytes(3), bytes(400), layer("walls")[:-4], text("walls") + struct.pack(">II", 5, 5)):
            client.refused(VECTORMAP, 0, 3, wrong)
        client.refused(VECTORMAP, 0, 2)
        client.refused(VECTORMAP, 0, 4, layer("walls"))


# A map that takes long to make delays nobody else: other devices answer meanwhile.
def maps_delay_nobody():
    ring = "".join(f'<model name="p{i}"><static>true</static><pose>{150 * math.cos(i)} {150 * math.sin(i)} 0.3 0 0 {i}</pose><link name="l"><collision name="c"><geometry><sphere>'
                   f'<radius>{3 + i % 7}</radius></sphere></geometry></collision></link></model>' for i in range(60))
    with named("'map:0': world", "'laser:0': rover::laser", world=room.replace("</world>", ring + "</world>")) as rig:
        client, other = Client(rig.ports[0]), Client(rig.ports[0])
        client.subscribe(MAP)
        other.subscribe(LASER)
        client.send(message(MAP, 0, REQ, 1))
        answers = 0
        client.socket.settimeout(0.001)
        got = None
        while got is None:
            other.demand(LASER, 0, 1)
            answers += 1
            try:
                got = client.next()
            except TimeoutError:
                pass
        assert got.kind == ACK and answers > 20, (got, answers)
        scale, width, height = struct.unpack_from(">fII", got.payload)
        assert max(width, height) <= 4096 and scale >= 0.05, (scale, width, height)


class Plan:
    def __init__(self, payload):
        values = struct.unpack(">II9diI", payload)
        self.valid, self.done, self.pose, self.goal, self.waypoint = values[0], values[1], values[2:5], values[5:8], values[8:11]
        self.index, self.count = values[11:]


# The robot goes round a wall to the goal that it is given in the world; the way is straight legs; disabled it stands; a goal in the wall has no way.
def planner():
    with named("'planner:0': rover::position2d", "'position2d:0': rover::position2d", rtf="4") as rig:
        client = Client(rig.ports[0])
        client.subscribe(PLANNER)
        idle = Plan(client.read_until(PLANNER))
        assert (idle.valid, idle.done, idle.index, idle.count) == (0, 0, -1, 0) and math.dist(idle.pose, (-2, 0, 1)) < 0.05, idle.pose
        for wrong in (b"", bytes(20), struct.pack(">3d", math.nan, 0, 0), struct.pack(">3d", 0, math.inf, 0)):
            client.command(PLANNER, 0, 1, wrong)
        client.command(PLANNER, 0, 1, struct.pack(">3d", 0, 1, 0))
        await_("the reason", lambda: "planner of rover::position2d: the goal (0, 1) is nearer than" in rig.log(rig.process))
        client.command(PLANNER, 0, 1, struct.pack(">3d", 1e300, 0, 0))
        await_("the reason", lambda: "planner of rover::position2d: the goal is more than 10000 m away" in rig.log(rig.process))
        client.command(PLANNER, 0, 1, struct.pack(">3d", 2, 0, -0.5))
        plan = Plan(client.read_until(PLANNER, good=lambda p: Plan(p).valid and Plan(p).index == 0))
        assert plan.goal == (2, 0, -0.5) and 3 <= plan.count <= 8, (plan.goal, plan.count)
        fields = Fields(client.demand(PLANNER, 0, 1))
        length = fields.take("d")
        points = fields.many("3d")
        fields.finish()
        assert len(points) == plan.count and points[-1] == (2, 0, -0.5) and max(abs(y) for _, y, _ in points) > 2.3 and 2 < length < 8, (length, points)
        client.demand(PLANNER, 0, 2, struct.pack(">I", 0))
        stopped = lambda: rig.json_echo("rover::position2d")["velocity"]
        await_("the robot to stand", lambda: max(map(abs, stopped())) < 0.01)
        client.demand(PLANNER, 0, 2, struct.pack(">I", 1))
        client.refused(PLANNER, 0, 2, b"")
        done = Plan(client.read_until(PLANNER, good=lambda p: Plan(p).done))
        assert math.dist(done.pose[:2], (2, 0)) < 0.05 and abs(done.pose[2] + 0.5) < 0.05 and done.index == -1, done.pose
        # A client that goes stops the robot that it has sent away.
        client.command(PLANNER, 0, 1, struct.pack(">3d", -2, 0, 0))
        client.read_until(PLANNER, good=lambda p: Plan(p).valid and not Plan(p).done and math.dist(Plan(p).pose[:2], (2, 0)) > 0.3)
        client.close()
        await_("the robot to stand", lambda: max(map(abs, stopped())) < 0.01)


# Left and right picture of the same time, and what they tell of distances: a mark at 3.5 m is 8 pixels apart.
def stereo():
    with Rig() as rig:
        rig.sim(world=f"{source}/worlds/devices.sdf")
        rig.gateway(robots=1)
        port, words = next((port, words) for port, robot, words in rig.lines() if robot == "mast")
        assert "stereo:0=mast::stereo::left+mast::stereo::right" in words.split(), words
        client = Client(int(port))
        client.subscribe(STEREO)
        for _ in range(3):
            fields = Fields(client.read_until(STEREO))
            pictures = []
            for bits in (24, 24, 16):
                head = fields.take("6I")
                pictures.append(fields.raw())
                assert head[:3] == (320, 240, bits) and len(pictures[-1]) == 320 * 240 * bits // 8, head
            points = [fields.take("3f3I") for _ in range(fields.count())]
            assert fields.take("I") == 0
            fields.finish()
        sixteenths = struct.unpack(f">{320 * 240}H", pictures[2])
        on_mark = lambda point: abs(point[1] - 0.2 + 0.06) < 0.09 and abs(point[2] + 0.1) < 0.09 and point[0] < 4
        depths = sorted(point[0] for point in points if on_mark(point))
        assert len(points) == sum(value > 0 for value in sixteenths) > 1000 and len(depths) > 20, (len(points), len(depths))
        assert abs(depths[len(depths) // 2] - 3.5) < 0.1, depths
        assert all(max(point[3:]) <= 255 for point in points)
        # What is near is further left in the right picture: the blue ball at 2.6 m by 17 pixels.
        def middle(picture):
            blue = [i % 320 for i in range(320 * 240) if picture[3 * i + 2] > 60 and picture[3 * i + 2] > 2 * picture[3 * i]]
            return sum(blue) / len(blue)
        assert abs(middle(pictures[0]) - middle(pictures[1]) - 233.9 * 0.12 / 2.6) < 2, (middle(pictures[0]), middle(pictures[1]))
        client.refused(STEREO, 0, 1)


# Two cameras that see different pictures of different size are no pair: nobody can subscribe, and a line says why.
def stereo_of_no_pair():
    with Rig() as rig:
        with open(f"{rig.work}/ports.yaml", "w") as file:
            file.write("ports:\n  - port: 0\n    devices: {'stereo:0': [mast::stereo::left, mast::camera], 'stereo:1': [mast::stereo::right, mast::stereo::left], 'stereo:2': [mast::camera, mast::thermal]}\n")
        rig.sim(world=f"{source}/worlds/devices.sdf")
        rig.gateway("--config", f"{rig.work}/ports.yaml", robots=1)
        client = Client(rig.ports[0])
        for index, line in enumerate(("stereo of mast::stereo::left and mast::camera: the images have 320 x 240 and 640 x 480 pixels; expected the same size",
                                      "in the first one's frame; expected it to the right, at 0, -BASE, 0",
                                      "stereo of mast::camera and mast::thermal: the images show colours and temperatures; expected the same")):
            assert not client.access(STEREO, index, OPEN)
            await_("a line", lambda: line in rig.log(rig.process))


# What a client says the others hear, and it does not hear itself; nonsense is no data.
def opaque():
    with named("'opaque:0': world") as rig:
        clients = [Client(rig.ports[0]) for _ in range(3)]
        for client in clients:
            client.subscribe(OPAQUE)
        said = random.randbytes(1001)
        pack = lambda data: struct.pack(">II", len(data), len(data)) + data + bytes(-len(data) % 4)
        for wrong in (b"", bytes(3), struct.pack(">II", 5, 5), struct.pack(">II", 0xFFFFFFFF, 0xFFFFFFFF), pack(said) + bytes(4)):
            clients[0].command(OPAQUE, 0, 1, wrong)
        clients[0].command(OPAQUE, 0, 1, pack(said))
        for client in clients[1:]:
            assert client.read_until(OPAQUE) == pack(said)
        clients[1].command(OPAQUE, 0, 1, pack(b""))
        assert clients[0].read_until(OPAQUE) == pack(b"")


# The bit of a bumper follows what touches it.
def dio():
    with named("'dio:0': post::bumper") as rig:
        client = Client(rig.ports[0])
        client.subscribe(DIO)
        client.read_until(DIO, good=lambda p: p == struct.pack(">II", 1, 1))
        rig.simctl("pose", "post", "0", "-6", "2", "0")
        client.read_until(DIO, good=lambda p: p == struct.pack(">II", 1, 0))


def view(rig):
    path = f"{rig.work}/view.png"
    rig.simctl("screenshot", path, "--top", "--size", "300x300")
    width, height, data = pixels.png(path)
    return [data[i : i + 3] for i in range(0, 3 * width * height, 3)]


def count(picture, wanted):
    return sum(1 for rgb in picture if all(abs(a - b) < 60 for a, b in zip(rgb, wanted)))


def shape(points, *colors, filled=None):
    flat = [value for point in points for value in point]
    return struct.pack(f">II{len(flat)}d", len(points), len(points), *flat) + b"".join(struct.pack(">4I", *color) for color in colors) + (b"" if filled is None else struct.pack(">I", filled))


# What clients draw is a model that pictures show and scanners do not: in 2D and 3D, of a robot where the robot is; cleared, and gone with its client.
def graphics():
    with named("'graphics2d:0': rover::position2d", "'graphics3d:0': world", "'laser:0': rover::laser") as rig:
        models = lambda: re.findall(r"player_\S+", rig.simctl("tree"))
        part_count = lambda: rig.simctl("tree").count("drawing")
        client = Client(rig.ports[0])
        client.subscribe(LASER)
        before = Laser(client.read_until(LASER)).ranges
        client.subscribe(GRAPHICS2D)
        client.subscribe(GRAPHICS3D)
        red, green = (255, 255, 0, 0), (0, 0, 255, 0)
        for wrong in (b"", bytes(7), shape([(0, 0)], red)[:-4], struct.pack(">II", 0xFFFFFFFF, 0xFFFFFFFF), shape([(0, 0)], (0, 0, 256, 0)), shape([(math.nan, 0)], red), shape([(1e300, 0), (0, 0)], red)):
            client.command(GRAPHICS2D, 0, 2, wrong)
            client.command(GRAPHICS2D, 0, 3, wrong)
            client.command(GRAPHICS3D, 0, 2, struct.pack(">I", 3) + wrong)
            client.command(GRAPHICS3D, 0, 4, wrong)
        client.command(GRAPHICS2D, 0, 4, shape([(0.5, -1), (2.5, -1), (2.5, 1), (0.5, 1)], red, red, filled=1))  # before the laser
        client.command(GRAPHICS2D, 0, 3, shape([(0, 0), (1, 0), (1, 1)], red))
        client.command(GRAPHICS2D, 0, 5, shape([(0, 0), (1, 0), (1, 1)], red))
        client.command(GRAPHICS2D, 0, 2, shape([(0, 0), (1, 0), (1, 1)], red))
        pose = await_("the drawing", lambda: rig.truth([one for one in models() if "graphics2d" in one][-1]))  # each change draws a new one, and deletes the old one
        assert all(abs(a - b) < 0.05 for a, b in zip(pose, rig.truth("rover"))), (pose, rig.truth("rover"))
        client.command(GRAPHICS3D, 0, 5)
        client.command(GRAPHICS3D, 0, 3, struct.pack(">3d", -3, -3, 1))
        client.command(GRAPHICS3D, 0, 4, struct.pack(">4d", math.pi / 2, 0, 0, 1))
        for mode in range(10):
            client.command(GRAPHICS3D, 0, 2, struct.pack(">I", mode) + shape([(0, 0, 0), (2, 0, 0), (0, 2, 0), (2, 2, 0)], green))
        client.command(GRAPHICS3D, 0, 6)
        client.command(GRAPHICS3D, 0, 6)
        await_("a green square", lambda: count(view(rig), (0, 255, 0)) > 100)
        assert count(view(rig), (255, 0, 0)) > 50
        after = Laser(client.read_until(LASER)).ranges
        assert all(abs(a - b) < 0.05 for a, b in zip(before, after))
        client.command(GRAPHICS2D, 0, 1)
        await_("no drawing in 2D", lambda: not [one for one in models() if "graphics2d" in one])
        await_("one drawing in 3D", lambda: len([one for one in models() if "graphics3d" in one]) == 1)
        client.command(GRAPHICS3D, 0, 2, struct.pack(">I", 0) + shape([(i % 40, i // 40, 1) for i in range(1100)], green))
        await_("a limit", lambda: "graphics3d:0: more than 1000 points, lines and faces are not drawn" in rig.log(rig.process))
        client.close()
        await_("no drawing", lambda: not models())
        rig.is_alive()


run(lines_of_the_map, maps_delay_nobody, planner, stereo, stereo_of_no_pair, opaque, dio, graphics)
