# player-gateway before a peer of another make (player_peer.py), one case per run: player.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import math
import re
import struct
import sys

from player_peer import *
from system import System, await_

case, bin_dir, lib_dir, source = sys.argv[1:]

world = f"""<sdf version="1.9"><world name="two">
  <physics name="default" type="ode"><max_step_size>0.002</max_step_size></physics>
  <include><uri>{source}/worlds/models/ground_plane</uri></include>
  <include><uri>{source}/worlds/models/pioneer2dx_sick</uri><name>first</name><pose>0 0 0 0 0 0</pose></include>
  <include><uri>{source}/worlds/models/pioneer2dx_sick</uri><name>second</name><pose>0 4 0 0 0 0</pose></include>
  <model name="wall"><static>true</static><pose>3 0 0.3 0 0 0</pose><link name="link"><collision name="c"><geometry><box><size>0.2 12 0.6</size></box></geometry></collision></link></model>
</world></sdf>"""


class Rig(System):
    def __init__(self):
        super().__init__(bin_dir, lib_dir)
        self.world = f"{self.work}/two.sdf"
        with open(self.world, "w") as file:
            file.write(world)

    def sim(self, *options, world=None):
        self.simulator = self.server(world or self.world, *options)
        return self.simulator

    # With any free ports; ports[i] is that of the i-th robot.
    def gateway(self, *options, robots=2):
        self.process = self.start(f"{bin_dir}/player-gateway", *(options or ("--port", "0")))
        self.ports = await_("the gateway", lambda: self.shown(robots))
        return self.ports

    def lines(self):
        return re.findall(r"^port (\d+): (.*?):((?: \w+:\d+)*)$", self.log(self.process), re.M)

    def shown(self, robots):
        assert self.process.poll() is None, self.log(self.process)
        ports = {}
        for port, _, _ in self.lines():
            ports[int(port)] = None
        assert len(ports) >= robots
        return list(ports)

    def is_alive(self):
        assert self.process.poll() is None, self.log(self.process)

    def truth(self, model="first"):
        return [float(word) for word in self.simctl("pose", model).split()[:3]]

    def is_subscribed(self, iface):
        import json

        return any(one["name"] == iface and one["subscribers"] > 0 for one in json.loads(self.simctl("--json", "list")))

    def driven(self, model="first"):
        import json

        return json.loads(self.simctl("--json", "echo", f"{model}::position2d", "-n", "1"))["velocity"][0]


def started(*options, robots=2):
    rig = Rig()
    rig.sim(*options)
    rig.gateway(robots=robots)
    return rig


def listing():
    with started() as rig:
        names = [name for _, name, _ in rig.lines()]
        assert names == ["first", "second"], names
        client = Client(rig.ports[0])
        expected = [(POSITION2D, 0), (LASER, 0), (SONAR, 0), (RANGER, 0), (RANGER, 1), (SIMULATION, 0)]
        assert client.devices() == expected, client.devices()
        for device in expected:
            name = client.driver(*device)
            assert name.startswith(b"rtm-sim ") and name.endswith(b"\0"), name
        client.refused(PLAYER, 0, 2, devaddr(LASER, 7) + struct.pack(">II", 0, 0))
        client.refused(PLAYER, 0, 7, struct.pack(">II", 0, 0))  # AUTH
        client.refused(LASER, 0, 255, struct.pack(">II", 1, 1))  # CAPABILITIES
        client.refused(LASER, 3, 1)
        client.refused(66, 0, 1)


# The session of an unmodified laserobstacleavoid, and that its commands drive the robot that belongs to the port.
def drive():
    with started() as rig:
        client = Client(rig.ports[0])
        client.subscribe(POSITION2D)
        client.subscribe(LASER)
        client.demand(POSITION2D, 0, 2, struct.pack(">I", 1))
        geometry = struct.unpack(">9d", client.demand(POSITION2D, 0, 1))
        assert 0.2 < geometry[6] < 0.5 and 0.3 < geometry[7] < 0.6, geometry  # width, length
        scan = Laser(client.read_until(LASER))
        assert len(scan.ranges) == 181 and abs(scan.min_angle + math.pi / 2) < 1e-4 and abs(scan.resolution - math.pi / 180) < 1e-4
        assert abs(scan.ranges[90] - 2.9) < 0.1, scan.ranges[90]  # the wall ahead
        assert scan.ranges[0] == struct.unpack(">f", struct.pack(">f", scan.max_range))[0] or scan.ranges[0] < scan.max_range
        config = struct.unpack(">5fIf", client.demand(LASER, 0, 3))
        assert abs(config[3] - scan.max_range) < 1e-4 and config[6] == 10
        assert len(client.demand(LASER, 0, 1)) == 72
        client.command(POSITION2D, 0, 1, velocity(0.3, 0, 0.2))
        state = Position(client.read_until(POSITION2D, good=lambda p: Position(p).velocity[0] > 0.2))
        assert state.velocity[2] > 0 and state.stall == 0
        moved = Position(client.read_until(POSITION2D, good=lambda p: Position(p).pose[0] > 0.3))
        assert moved.pose[2] > 0
        await_("the true pose", lambda: rig.truth()[0] > 0.2)
        assert abs(rig.truth("second")[0]) < 0.05
        client.demand(POSITION2D, 0, 5, struct.pack(">3d", 10, 20, 0.5))  # SET_ODOM: goes on from there
        Position(client.read_until(POSITION2D, good=lambda p: Position(p).pose[0] > 9.5 and abs(Position(p).pose[1] - 20) < 2))
        client.command(POSITION2D, 0, 1, velocity(0, 0, 0))
        client.read_until(POSITION2D, good=lambda p: abs(Position(p).velocity[0]) < 0.01)
        client.demand(POSITION2D, 0, 6)
        client.read_until(POSITION2D, good=lambda p: abs(Position(p).pose[0]) < 0.1)
        client.demand(POSITION2D, 0, 3, struct.pack(">I", 0))
        client.refused(POSITION2D, 0, 4, struct.pack(">I", 1))  # no position control


# SYNCH waits for data, also when the request comes first; requests that repeat have one SYNCH; PUSH has none.
def flow():
    with started("--paused") as rig:
        client = Client(rig.ports[0])
        client.subscribe(LASER)
        assert client.read()[0].interface == LASER  # what a sensor shows when somebody comes while time stands still
        client.send(message(PLAYER, 0, REQ, 4) * 3)
        for _ in range(3):
            got = client.next()
            assert (got.kind, got.subtype) == (ACK, 4), got
        geometry = client.demand(LASER, 0, 1)  # time stands still: neither data nor SYNCH come before the answer
        assert len(geometry) == 72 and not client.early
        rig.simctl("step", "100")  # 0.2 s: two scans, of which each may be sent at once
        kinds = [client.next().kind, client.next().kind]
        assert kinds == [DATA, SYNCH], kinds
        client.demand(LASER, 0, 1)
        assert not client.early, client.early
        # Newest replaces older: many scans later there is one, the latest.
        client.demand(PLAYER, 0, 10, struct.pack(">5i", -1, -1, DATA, -1, 1))
        rig.simctl("step", "500")
        rounds = client.read()
        assert len(rounds) == 1, rounds
        # The answer, the data and SYNCH leave in one segment.
        client.subscribe(SONAR)

        def comes_whole():  # when the data was there before it was asked for
            rig.simctl("step", "100")
            client.demand(LASER, 0, 1)
            client.send(message(PLAYER, 0, REQ, 4))
            client.buffer = client.socket.recv(1 << 16)
            first, size, kinds = len(client.buffer), 0, []
            while SYNCH not in kinds:
                got = client.next()
                size += 40 + got.size
                kinds.append(got.kind)
            assert kinds[0] == ACK and set(kinds[1:-1]) == {DATA}, kinds
            return size == first

        await_("a round in one segment", comes_whole)
        client.unsubscribe(SONAR)
        # Dropped by a rule.
        client.demand(PLAYER, 0, 10, struct.pack(">5i", -1, -1, DATA, -1, 2))
        client.subscribe(POSITION2D)
        rig.simctl("step", "100")
        client.send(message(PLAYER, 0, REQ, 4))
        assert client.next().kind == ACK
        client.demand(PLAYER, 0, 10, struct.pack(">5i", -1, -1, DATA, -1, 1))
        rig.simctl("step", "100")
        while client.next().kind != SYNCH:
            pass
        # PUSH.
        client.demand(PLAYER, 0, 5, struct.pack(">I", PUSH))
        client.refused(PLAYER, 0, 5, struct.pack(">I", 0))
        client.refused(PLAYER, 0, 5, struct.pack(">I", 3))
        client.demand(PLAYER, 0, 4)
        for _ in range(3):
            rig.simctl("step", "100")
            assert client.next().kind == DATA
        client.demand(PLAYER, 0, 5, struct.pack(">I", PULL))
        # After the device is closed nothing of it comes.
        rig.simctl("step", "100")
        client.unsubscribe(LASER)
        rig.simctl("step", "100")
        assert all(one.interface == POSITION2D for one in client.read())


# At 100 scans a second each is delivered once and in order: nothing waits for acknowledgements of TCP.
def rate():
    with Rig() as rig:
        with open(f"{source}/worlds/models/sick_lms200/model.sdf") as file:
            fast = file.read().replace("<update_rate>10</update_rate>", "<update_rate>100</update_rate>")
        start, end = fast.index("<model"), fast.index("</sdf>")
        path = f"{rig.work}/fast.sdf"
        with open(path, "w") as file:
            file.write(f'<sdf version="1.9"><world name="fast">{fast[start:end]}</world></sdf>')
        rig.sim("--rtf", "1", world=path)
        rig.gateway(robots=1)
        client = Client(rig.ports[0])
        client.subscribe(LASER)
        client.subscribe(RANGER)
        ids = []
        while len(ids) < 300:
            data = client.read()
            ids += [Laser(one.payload).id for one in data if one.interface == LASER]
            client.command(LASER, 0, 9, b"")  # a small write before the next request, as commands are
        assert ids == sorted(set(ids))
        missed = ids[-1] - ids[0] + 1 - len(ids)
        # Waiting for TCP's acknowledgements lets through 22 scans of 100.
        assert missed < len(ids), f"{missed} scans were replaced before they were read, {len(ids)} were read"


# Two clients on one robot: each gets all data; the robot stops when the one whose command it follows vanishes.
def two_clients():
    with started() as rig:
        driver, watcher = Client(rig.ports[0]), Client(rig.ports[0])
        for client in (driver, watcher):
            client.subscribe(POSITION2D)
        assert rig.is_subscribed("first::position2d")
        driver.command(POSITION2D, 0, 1, velocity(0.3, 0, 0))
        for client in (driver, watcher):
            client.read_until(POSITION2D, good=lambda p: Position(p).velocity[0] > 0.25)
        driver.reset()
        watcher.read_until(POSITION2D, good=lambda p: abs(Position(p).velocity[0]) < 0.01)
        # Letting go in an orderly way stops it too, and opened twice is closed twice.
        driver = Client(rig.ports[0])
        driver.subscribe(POSITION2D)
        driver.subscribe(POSITION2D)
        driver.command(POSITION2D, 0, 1, velocity(0.3, 0, 0))
        watcher.read_until(POSITION2D, good=lambda p: Position(p).velocity[0] > 0.25)
        assert driver.access(POSITION2D, 0, CLOSE)
        driver.command(POSITION2D, 0, 1, velocity(0.2, 0, 0))
        watcher.read_until(POSITION2D, good=lambda p: 0.19 < Position(p).velocity[0] < 0.21)
        assert driver.access(POSITION2D, 0, CLOSE)
        watcher.read_until(POSITION2D, good=lambda p: abs(Position(p).velocity[0]) < 0.01)
        assert not driver.access(POSITION2D, 0, CLOSE)
        driver.command(POSITION2D, 0, 1, velocity(0.3, 0, 0))  # no longer subscribed
        for _ in range(10):
            watcher.read_until(POSITION2D, good=lambda p: abs(Position(p).velocity[0]) < 0.01)
        # The last command wins, whoever gives it.
        driver.subscribe(POSITION2D)
        driver.command(POSITION2D, 0, 1, velocity(0.3, 0, 0))
        driver.demand(POSITION2D, 0, 1)
        watcher.command(POSITION2D, 0, 1, velocity(-0.2, 0, 0))
        watcher.read_until(POSITION2D, good=lambda p: Position(p).velocity[0] < -0.15)
        driver.close()  # its command is no longer followed
        for _ in range(10):
            watcher.read_until(POSITION2D, good=lambda p: Position(p).velocity[0] < -0.15)
        watcher.close()
        await_("a sensor that nobody reads", lambda: not rig.is_subscribed("first::position2d"))
        await_("a robot that stands", lambda: abs(rig.driven()) < 0.01)


# The gateway dies: the robot stops. The gateway is told to end: the same, and exit code 0.
def gateway_ends():
    for how in ("kill", "terminate"):
        with started() as rig:
            client = Client(rig.ports[0])
            client.subscribe(POSITION2D)
            client.command(POSITION2D, 0, 1, velocity(0.3, 0, 0))
            client.read_until(POSITION2D, good=lambda p: Position(p).velocity[0] > 0.25)
            getattr(rig.process, how)()
            code = rig.process.wait(20)
            assert how == "kill" or code == 0, code
            await_("a robot that stands", lambda: abs(rig.driven()) < 0.01)
            try:
                while True:
                    client.next()
            except (Closed, ConnectionResetError):
                pass


# The simulator is reset, dies and comes back: clients stay connected, time goes only forward, sensors and commands work again.
def restart():
    with started() as rig:
        client = Client(rig.ports[0])
        client.subscribe(POSITION2D)
        client.subscribe(LASER)
        client.read_until(LASER)
        rig.simctl("reset")
        for _ in range(5):
            client.read_until(LASER)  # stamps are checked in each read
        for way in (rig.kill, lambda process: (process.terminate(), process.wait(20))):
            client.command(POSITION2D, 0, 1, velocity(0.1, 0, 0))
            way(rig.simulator)
            await_("a simulator that is missed", lambda: "has ended" in rig.log(rig.process))
            await_("refusals", lambda: client.request(POSITION2D, 0, 1)[0] == NACK)
            assert client.devices() == []
            client.command(POSITION2D, 0, 1, velocity(0.3, 0, 0))
            assert not client.access(SONAR, 0, OPEN)
            client.send(message(PLAYER, 0, REQ, 4))
            rig.sim()
            while client.next().kind != SYNCH:  # the round that was asked for before
                pass
            client.read_until(LASER)
            client.command(POSITION2D, 0, 1, velocity(0.3, 0, 0))
            client.read_until(POSITION2D, good=lambda p: Position(p).velocity[0] > 0.25)
        assert len(rig.lines()) == 2, rig.lines()


# Started before the simulator, the gateway waits; a model that comes later gets a port, one that goes leaves it without devices.
def late_and_changing():
    with Rig() as rig:
        rig.process = rig.start(f"{bin_dir}/player-gateway", "--port", "0")
        await_("a gateway that waits", lambda: "waiting for simulator" in rig.log(rig.process))
        rig.sim()
        ports = await_("ports", lambda: rig.shown(2))
        client = Client(ports[0])
        client.subscribe(LASER)
        client.read_until(LASER)
        rig.simctl("spawn", f"{source}/worlds/models/pioneer2dx_sick", "--name", "third", "--pose", "0", "-4", "0")
        ports = await_("a third port", lambda: rig.shown(3))
        third = Client(ports[2])
        third.subscribe(LASER)
        third.read_until(LASER)
        rig.simctl("delete", "third")
        await_("an empty port", lambda: third.devices() == [])
        client.read_until(LASER)
        assert third.access(LASER, 0, CLOSE)


def simulation():
    with started("--paused") as rig:
        client = Client(rig.ports[0])
        client.subscribe(SIMULATION)
        pose = lambda name: struct.unpack(">3d", client.demand(SIMULATION, 0, 1, text(name) + bytes(24))[-24:])
        assert abs(pose("second")[1] - 4) < 0.01
        client.demand(SIMULATION, 0, 2, text("second") + struct.pack(">3d", 1, 2, 0.5))
        assert all(abs(a - b) < 1e-6 for a, b in zip(pose("second"), (1, 2, 0.5)))
        client.demand(SIMULATION, 0, 4, text("second") + struct.pack(">6d", 1, -2, 0.5, 0, 0, -1) + bytes(8))
        fields = Fields(client.demand(SIMULATION, 0, 3, text("second") + bytes(56)))
        assert fields.raw() == b"second\0"
        got = fields.take("6d")
        assert all(abs(a - b) < 1e-6 for a, b in zip(got, (1, -2, 0.5, 0, 0, -1))), got
        rig.simctl("step", "500")
        after = Fields(client.demand(SIMULATION, 0, 3, text("second") + bytes(56)))
        after.raw()
        after.take("6d")
        assert after.take("d") == 1e6  # microseconds
        after.finish()
        for wrong in ("nobody", "", "a/b", "%s%n", "second::"):
            client.refused(SIMULATION, 0, 1, text(wrong) + bytes(24))
        client.refused(SIMULATION, 0, 2, text("second") + struct.pack(">3d", math.nan, 0, 0))
        unterminated = struct.pack(">II", 6, 6) + b"second\0\0" + bytes(24)
        assert abs(struct.unpack(">3d", client.demand(SIMULATION, 0, 1, unterminated)[-24:])[0] - 1) < 0.01
        client.refused(SIMULATION, 0, 1, struct.pack(">II", 4, 4) + b"\xff\xfe\xfd\xfc" + bytes(24))

        def property(name, what, size):
            fields = Fields(client.demand(SIMULATION, 0, 5, text(name) + text(what) + struct.pack(">III", 0, size, size) + bytes(size + -size % 4)))
            fields.raw(), fields.raw(), fields.take("I")
            value = fields.raw()
            fields.finish()
            assert len(value) == size
            return value

        assert struct.unpack("d", property("world", "sim_time", 8))[0] == 1.0
        assert struct.unpack("Q", property("first", "time", 8))[0] == 1000000
        assert property("world", "state", 1) == b"\0"
        assert property("world", "state", 7) == bytes(7)
        client.refused(SIMULATION, 0, 5, text("world") + text("sim_time") + struct.pack(">IIII", 0, 4, 4, 0))
        client.refused(SIMULATION, 0, 5, text("first") + text("color") + struct.pack(">III", 0, 16, 16) + bytes(16))
        client.command(SIMULATION, 0, 1)  # PAUSE turns round
        await_("running", lambda: property("world", "state", 1) == b"\1")
        client.command(SIMULATION, 0, 1)
        await_("paused", lambda: property("world", "state", 1) == b"\0")
        client.command(SIMULATION, 0, 2)
        await_("reset", lambda: abs(pose("second")[1] - 4) < 0.01)


def rangers():
    with started() as rig:
        client = Client(rig.ports[0])
        for device in ((SONAR, 0), (RANGER, 0), (RANGER, 1)):
            client.subscribe(*device)
        fields = Fields(client.demand(SONAR, 0, 1))
        poses = [fields.take("6d") for _ in range(fields.count())]
        fields.finish()
        assert len(poses) == 16 and abs(poses[0][5] - math.pi / 2) < 1e-3
        ranges = Fields(client.read_until(SONAR)).many("f")
        assert len(ranges) == 16 and all(0 <= r <= 5 for r in ranges) and 2 < ranges[3] < 3.2, ranges
        for index, elements in ((0, 1), (1, 16)):
            fields = Fields(client.demand(RANGER, index, 1))
            fields.take("9d")
            assert fields.count() == elements
            fields.take(f"{6 * elements}d")
            assert fields.count() == elements
            fields.take(f"{3 * elements}d")
            fields.finish()
            config = struct.unpack(">7d", client.demand(RANGER, index, 5))
            assert config == struct.unpack(">7d", client.demand(RANGER, index, 4, bytes(56)))
            client.demand(RANGER, index, 2, struct.pack(">I", 1))
        assert len(Fields(client.read_until(RANGER, index=1)).many("d")) == 16
        scan = Fields(client.read_until(RANGER)).many("d")
        assert len(scan) == 181 and abs(scan[90] - 2.9) < 0.1
        client.demand(RANGER, 0, 3, struct.pack(">I", 1))
        assert len(Fields(client.read_until(RANGER, subtype=3)).many("d")) == 181
        client.refused(RANGER, 1, 3, struct.pack(">I", 1))


{function.__name__: function for function in (listing, drive, flow, rate, two_clients, gateway_ends, restart, late_and_changing, simulation, rangers)}[case]()
