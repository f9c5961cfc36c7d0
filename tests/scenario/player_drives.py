# Poses and headings that Player clients send robots to: player_drives.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import math
import struct

from player_rig import *


# CMD_POS: poses of the odometry are reached, at the speed that is asked for, and everything that ends the way ends it.
def position():
    with started("--rtf", "3") as rig:
        client = Client(rig.ports[0])
        client.subscribe(POSITION2D)
        client.command(POSITION2D, 0, 2, pose_command(1.0, 0.5, -1.0))
        reached(client, 1.0, 0.5, -1.0)
        x, y, yaw = rig.truth()[0], rig.truth()[1], float(rig.simctl("pose", "first").split()[-1])
        assert math.hypot(x - 1.0, y - 0.5) < 0.05 and abs(yaw + 1.0) < 0.05, (x, y, yaw)
        # As GoTo in a loop: each is the same goal; and slower.
        fastest, state = 0, None
        while state is None or math.hypot(state.pose[0] + 0.5, state.pose[1]) > 0.02 or abs(state.pose[2] - 3.0) > 0.02:
            client.command(POSITION2D, 0, 2, pose_command(-0.5, 0, 3.0, 0.2, 0.6))
            state = Position(client.read_until(POSITION2D))
            fastest = max(fastest, state.velocity[0])
            assert abs(state.velocity[2]) < 0.65, state.velocity
        assert 0.18 < fastest < 0.21, fastest
        # A speed profile is the speed of what follows, and a velocity ends a way.
        client.demand(POSITION2D, 0, 9, struct.pack(">ff", 0.15, 0.5))
        client.command(POSITION2D, 0, 2, pose_command(2.5, 0, 0))
        assert moves(client, 0.14).velocity[0] < 0.16
        client.command(POSITION2D, 0, 1, velocity(0, 0, 0.3))
        client.read_until(POSITION2D, good=lambda p: abs(Position(p).velocity[2] - 0.3) < 0.01 and Position(p).velocity[0] < 0.01)
        assert Position(client.read_until(POSITION2D)).velocity[0] < 0.01
        # What is no command changes nothing.
        for bad in (pose_command(math.nan, 0, 0), pose_command(0, 0, 0, math.inf), pose_command(1, 1, 1)[:-4], struct.pack(">3dI", 1e300, 0, 0, 1)):
            client.command(POSITION2D, 0, 2, bad)
        assert abs(Position(client.read_until(POSITION2D)).velocity[2] - 0.3) < 0.01
        # Ends too: state 0, a new odometry, another client's command, one from elsewhere, a reset.
        for end in (
            lambda: client.command(POSITION2D, 0, 2, pose_command(0, 0, 0, state=0)),
            lambda: client.demand(POSITION2D, 0, 5, struct.pack(">3d", 0, 0, 0)),
            lambda: client.demand(POSITION2D, 0, 6),
            lambda: other_command(rig),
            lambda: rig.simctl("velocity", "first::position2d", "0", "0", "0", "--for", "0.1"),
            lambda: rig.simctl("reset"),
        ):
            here = Position(client.read_until(POSITION2D)).pose
            client.command(POSITION2D, 0, 2, pose_command(here[0] + 9 * math.cos(here[2]), here[1] + 9 * math.sin(here[2]), 0))
            moves(client)
            end()
            stands(client)
            rig.simctl("step", "300")
            rig.simctl("run")
            stands(client)
        # Not reachable any more: the client lets go, and is gone.
        for leave in (lambda one: one.unsubscribe(POSITION2D), lambda one: one.reset()):
            second = Client(rig.ports[0])
            second.subscribe(POSITION2D)
            here = Position(second.read_until(POSITION2D)).pose
            second.command(POSITION2D, 0, 2, pose_command(here[0] - 9, here[1], 0))
            second.read_until(POSITION2D, good=lambda p: max(map(abs, Position(p).velocity)) > 0.1)
            leave(second)
            stands(client)
            second.close()


def other_command(rig):
    other = Client(rig.ports[0])
    other.subscribe(POSITION2D)
    other.command(POSITION2D, 0, 1, velocity(0, 0, 0))
    other.demand(POSITION2D, 0, 1)
    other.close()


# VEL_HEAD turns to the heading by the shorter way and keeps it while driving.
def heading():
    with started("--rtf", "3") as rig:
        client = Client(rig.ports[0])
        client.subscribe(POSITION2D)
        client.demand(POSITION2D, 0, 5, struct.pack(">3d", 0, 0, 3.0))
        client.command(POSITION2D, 0, 4, struct.pack(">dd", 0.2, -2.5))
        first = Position(client.read_until(POSITION2D, good=lambda p: abs(Position(p).velocity[2]) > 0.3))
        assert first.velocity[2] > 0, first.velocity
        client.read_until(POSITION2D, good=lambda p: abs(Position(p).pose[2] + 2.5) < 0.01)
        state = Position(client.read_until(POSITION2D, good=lambda p: abs(Position(p).velocity[2]) < 0.01))
        assert abs(state.pose[2] + 2.5) < 0.02 and abs(state.velocity[0] - 0.2) < 0.01, (state.pose, state.velocity)
        client.unsubscribe(POSITION2D)
        watcher = Client(rig.ports[0])
        watcher.subscribe(POSITION2D)
        stands(watcher)


def wheel(name, parent, x, y):
    return f"""<link name='{name}'><pose>{x} {y} 0.2 -1.5708 0 0</pose><inertial><mass>3</mass><inertia><ixx>.04</ixx><iyy>.04</iyy><izz>.06</izz></inertia></inertial>
<collision name='c'><geometry><cylinder><radius>0.2</radius><length>0.1</length></cylinder></geometry></collision></link>
<joint name='{name}_joint' type='revolute'><parent>{parent}</parent><child>{name}</child><axis><xyz>0 0 1</xyz></axis></joint>"""


def knuckle(side, y):
    return f"""<link name='{side}_knuckle'><pose>1 {y} 0.2 0 0 0</pose><inertial><mass>1</mass><inertia><ixx>.01</ixx><iyy>.01</iyy><izz>.01</izz></inertia></inertial></link>
<joint name='{side}_steering' type='revolute'><parent>body</parent><child>{side}_knuckle</child><axis><xyz>0 0 1</xyz><limit><lower>-0.8</lower><upper>0.8</upper></limit></axis></joint>"""


car = f"""<sdf version="1.9"><world name="car"><include><uri>{source}/worlds/models/ground_plane</uri></include><model name="car">
<link name='body'><pose>0.5 0 0.35 0 0 0</pose><inertial><mass>60</mass><inertia><ixx>4</ixx><iyy>8</iyy><izz>10</izz></inertia></inertial>
<collision name='c'><geometry><box><size>1.4 0.5 0.2</size></box></geometry></collision></link>
{knuckle("left", 0.4)}{knuckle("right", -0.4)}{wheel("front_left", "left_knuckle", 1, 0.4)}{wheel("front_right", "right_knuckle", 1, -0.4)}
{wheel("rear_left", "body", 0, 0.4)}{wheel("rear_right", "body", 0, -0.4)}
<plugin filename='libgazebo_ros_ackermann_drive.so' name='drive'><front_left_joint>front_left_joint</front_left_joint><front_right_joint>front_right_joint</front_right_joint>
<rear_left_joint>rear_left_joint</rear_left_joint><rear_right_joint>rear_right_joint</rear_right_joint><left_steering_joint>left_steering</left_steering_joint>
<right_steering_joint>right_steering</right_steering_joint><max_steer>0.6458</max_steer><max_speed>20</max_speed></plugin></model></world></sdf>"""


# A car has no poses, but headings, and takes car commands: a speed and a steering angle.
def cars():
    with Rig() as rig:
        path = f"{rig.work}/car.sdf"
        with open(path, "w") as file:
            file.write(car)
        rig.sim("--rtf", "3", world=path)
        rig.gateway(robots=1)
        client = Client(rig.ports[0])
        client.subscribe(POSITION2D)
        client.refused(POSITION2D, 0, 4, struct.pack(">I", 1))
        client.demand(POSITION2D, 0, 4, struct.pack(">I", 0))
        client.command(POSITION2D, 0, 1, velocity(0.5, 0, 0))
        moves(client, 0.4)
        client.command(POSITION2D, 0, 2, pose_command(-3, 0, 0))
        start = Position(client.read_until(POSITION2D)).pose[0]
        client.read_until(POSITION2D, good=lambda p: Position(p).pose[0] > start + 1)  # as if nothing had been said
        assert Position(client.read_until(POSITION2D)).velocity[0] > 0.4
        client.command(POSITION2D, 0, 4, struct.pack(">dd", 0.5, 1.2))
        client.read_until(POSITION2D, good=lambda p: abs(Position(p).pose[2] - 1.2) < 0.02 and abs(Position(p).velocity[2]) < 0.02)
        client.command(POSITION2D, 0, 3, struct.pack(">dd", 1, 0.3))  # a wheel base of 1 m
        client.read_until(POSITION2D, good=lambda p: abs(Position(p).velocity[2] - 0.309) < 0.01 and abs(Position(p).velocity[0] - 1) < 0.02)
        client.close()
        watcher = Client(rig.ports[0])
        watcher.subscribe(POSITION2D)
        stands(watcher)


# CMD_POS in 3D: a pose of the odometry, and what ends the way to it.
def flight():
    with Rig() as rig:
        path = f"{rig.work}/flying.sdf"
        with open(path, "w") as file:
            file.write(flying)
        rig.sim("--rtf", "3", world=path)
        rig.gateway()
        client, watcher = Client(rig.ports[0]), Client(rig.ports[0])
        for one in (client, watcher):
            one.subscribe(POSITION3D)
        client.demand(POSITION3D, 0, 4, struct.pack(">I", 1))

        def state(payload):
            return struct.unpack(">12dI", payload)

        # The state of such commands is 0, as client libraries send it.
        def fly(x, y, z, yaw):
            client.command(POSITION3D, 0, 2, struct.pack(">12dI", x, y, z, 0, 0, yaw, *(6 * [0]), 0))

        def is_still(payload):
            return max(map(abs, state(payload)[6:12])) < 0.01

        def flies(payload):
            return max(map(abs, state(payload)[6:9])) > 0.3

        fly(1, -0.5, 0.7, 1)
        there = (1, -0.5, 0.7, 0, 0, 1)
        client.read_until(POSITION3D, good=lambda p: is_still(p) and all(abs(a - b) < 0.03 for a, b in zip(state(p), there)))
        fly(math.nan, 0, 0, 0)
        for end in (
            lambda: client.demand(POSITION3D, 0, 6, struct.pack(">6d", 100, 0, 0, 0, 0, 0)),
            lambda: client.demand(POSITION3D, 0, 5),
            lambda: client.command(POSITION3D, 0, 1, struct.pack(">6dI", *(6 * [0]), 1)),
            client.close,
        ):
            at = state(watcher.read_until(POSITION3D))
            fly(at[0] + 30, at[1], at[2], 0)
            watcher.read_until(POSITION3D, good=flies)
            end()
            watcher.read_until(POSITION3D, good=is_still)


run(position, heading, cars, flight)
