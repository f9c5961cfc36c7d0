# Arms, grippers and heads as devices of Player, one case per run: player_arms.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import math
import signal
import struct

from player_rig import *

IDLE, MOVING, BRAKED, STALLED = 1, 2, 4, 8


class Actuators:
    """position, speed, acceleration, current, state of each; and whether there is power."""

    def __init__(self, payload):
        fields = Fields(payload)
        self.all = fields.many("4fI")
        self.power = fields.take("I")
        fields.finish()
        self.positions = [one[0] for one in self.all]


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
        assert 0.05 < fastest < 0.2, fastest
        # A gateway that was held up for a while does not hurry after what it missed.
        at = lambda: rig.json_echo("arm::joints")["stamp"]["sim_time"]
        rig.process.send_signal(signal.SIGSTOP)
        before = at()
        await_("half a second", lambda: at() > before + 0.5)
        rig.process.send_signal(signal.SIGCONT)
        fastest = max(abs(Actuators(client.read_until(ACTARRAY)).all[0][1]) for _ in range(20))
        assert fastest < 0.2, fastest
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


run(actarray, limb, gripper, ptz, joints_by_name)
