# player-gateway before a peer of another make (player_peer.py), one case per run: player.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import math
import socket
import struct

from player_rig import *
from system import await_


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
        assert abs(geometry[0] + 0.045) < 0.01 and abs(geometry[1]) < 0.001, geometry  # its body reaches further back
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
        client.demand(POSITION2D, 0, 4, struct.pack(">I", 1))
        client.refused(POSITION2D, 0, 4)


# Capabilities, properties of drivers and what tunes a drive: each request is answered, and says what is true.
def properties():
    with started() as rig:
        client = Client(rig.ports[0])

        def can(interface, kind, subtype):
            return client.request(interface, 0, 255, struct.pack(">II", kind, subtype))[0] == ACK

        assert all(can(POSITION2D, CMD, subtype) for subtype in (1, 2, 3, 4)) and not can(POSITION2D, CMD, 5)
        assert all(can(POSITION2D, REQ, subtype) for subtype in range(1, 10)) and not can(POSITION2D, REQ, 10)
        assert can(LASER, DATA, 1) and not can(LASER, DATA, 2) and not can(LASER, REQ, 6) and not can(LASER, CMD, 1)
        assert can(SIMULATION, CMD, 1) and not can(SIMULATION, DATA, 1)
        assert can(SONAR, REQ, 255) and not can(SONAR, 0, 0) and not can(SONAR, 0x103, 1) and not can(SONAR, REQ, 0x101)
        client.refused(POSITION2D, 0, 255)
        client.refused(POSITION2D, 0, 255, struct.pack(">IIII", REQ, 1, 1, 1))
        client.refused(PLAYER, 0, 255, struct.pack(">II", REQ, 1))
        # Each with the type of value that it has.
        key, number = text("speed"), text("speed") + struct.pack(">d", 0)
        assert client.demand(POSITION2D, 0, 252, number) == key + struct.pack(">d", 0.4)
        client.demand(POSITION2D, 0, 251, key + struct.pack(">d", 0.3))
        assert client.demand(POSITION2D, 0, 252, number) == key + struct.pack(">d", 0.3)
        for bad in (0.0, -1.0, math.nan, math.inf):
            client.refused(POSITION2D, 0, 251, key + struct.pack(">d", bad))
        client.refused(POSITION2D, 0, 254, key + struct.pack(">i", 0))
        client.refused(POSITION2D, 0, 253, key + struct.pack(">i", 1))
        client.refused(POSITION2D, 0, 248, key + struct.pack(">I", 1))
        client.refused(POSITION2D, 0, 252, text("colour") + struct.pack(">d", 0))
        client.refused(POSITION2D, 0, 252, struct.pack(">II", 0xFFFFFFFF, 0xFFFFFFFF))
        client.refused(POSITION2D, 0, 252)
        assert client.demand(LASER, 0, 250, text("iface") + struct.pack(">II", 0, 0)) == text("iface") + text("first::laser")
        client.refused(LASER, 0, 249, text("iface") + text("second::laser"))
        for pid in (7, 8):
            client.demand(POSITION2D, 0, pid, struct.pack(">3f", 1, 0.1, 0.01))
            client.refused(POSITION2D, 0, pid, struct.pack(">3f", 1, math.nan, 0))
            client.refused(POSITION2D, 0, pid)
        client.demand(POSITION2D, 0, 9, struct.pack(">2f", 0.25, 1))
        assert client.demand(POSITION2D, 0, 252, number) == key + struct.pack(">d", 0.25)
        client.refused(POSITION2D, 0, 9, struct.pack(">2f", 0, 1))
        client.refused(POSITION2D, 0, 9, struct.pack(">2f", 1, math.inf))


# SYNCH waits for data, also when the request comes first; requests that repeat have one SYNCH; PUSH has none.
def flow():
    with started("--paused") as rig:
        client = Client(rig.ports[0])
        client.subscribe(LASER)
        assert client.read()[0].interface == LASER  # what a sensor shows when somebody comes while time stands still
        client.subscribe(RANGER)  # the same sensor
        assert client.read()[0].interface == RANGER
        client.unsubscribe(RANGER)
        second = Client(rig.ports[0])
        second.subscribe(LASER)
        second.subscribe(LASER)
        assert [one.interface for one in second.read()] == [LASER]
        second.close()
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
        # Paused since its start, but for the step.
        real, paused = (struct.unpack("d", property("world", name, 8))[0] for name in ("real_time", "pause_time"))
        assert 0 < paused <= real + 0.1 and struct.unpack("d", property("world", "real_time", 8))[0] > real, (paused, real)
        client.command(SIMULATION, 0, 3)  # SAVE
        client.command(SIMULATION, 0, 3)
        await_("a line", lambda: rig.log(rig.process).count("SAVE of simulation is ignored") == 1)
        assert property("world", "state", 1) == b"\0"
        assert property("world", "state", 7) == bytes(7)
        client.refused(SIMULATION, 0, 5, text("world") + text("sim_time") + struct.pack(">IIII", 0, 4, 4, 0))
        client.refused(SIMULATION, 0, 5, text("first") + text("color") + struct.pack(">III", 0, 16, 16) + bytes(16))
        client.command(SIMULATION, 0, 1)  # PAUSE turns round
        await_("running", lambda: property("world", "state", 1) == b"\1")
        await_("a pause that is over", lambda: property("world", "pause_time", 8) == property("world", "pause_time", 8))
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


def sensors():
    with Rig() as rig:
        path = f"{rig.work}/flying.sdf"
        with open(path, "w") as file:
            file.write(flying)
        rig.sim("--paused", world=path)
        rig.gateway()
        flyer, faller = Client(rig.ports[0]), Client(rig.ports[1])
        assert flyer.devices() == [(POSITION3D, 0), (CAMERA, 0), (CAMERA, 1), (BLOBFINDER, 0), (BLOBFINDER, 1), (SIMULATION, 0)], flyer.devices()
        assert faller.devices() == [(GPS, 0), (IMU, 0), (BUMPER, 0), (SIMULATION, 0)], faller.devices()
        for device in ((GPS, 0), (IMU, 0), (BUMPER, 0)):
            faller.subscribe(*device)
        assert faller.read_until(BUMPER) == struct.pack(">IIBxxx", 1, 1, 0)  # in the air
        for device in ((POSITION3D, 0), (CAMERA, 0), (CAMERA, 1)):
            flyer.subscribe(*device)
        rig.simctl("run")

        for index, bits, code in ((0, 24, 5), (1, 8, 1)):
            fields = Fields(flyer.read_until(CAMERA, index=index))
            assert fields.take("6I") == (64, 48, bits, code, 1, 0)
            picture = fields.raw()
            fields.finish()
            assert len(picture) == 64 * 48 * bits // 8 and len(set(picture)) > 1
        assert len(flyer.demand(CAMERA, 0, 3)) == 24 + 8 + 64 * 48 * 3
        fields = Fields(flyer.demand(CAMERA, 0, 1))
        assert fields.raw() == b"\0" and fields.take("i") == 0
        flyer.refused(CAMERA, 0, 2, text("PAL") + bytes(4))

        assert len(flyer.demand(POSITION3D, 0, 1)) == 72
        flyer.command(POSITION3D, 0, 1, struct.pack(">6dI", 0, 0, 0.5, 0, 0, 0, 1))
        state = struct.unpack(">12dI", flyer.read_until(POSITION3D, good=lambda p: struct.unpack(">12dI", p)[8] > 0.4))
        assert abs(state[6]) < 0.05 and abs(state[7]) < 0.05
        flyer.demand(POSITION3D, 0, 6, struct.pack(">6d", 100, 0, 0, 0, 0, 0))  # SET_ODOM is 6 here
        flyer.read_until(POSITION3D, good=lambda p: abs(struct.unpack(">12dI", p)[0] - 100) < 1)
        flyer.demand(POSITION3D, 0, 5)
        flyer.read_until(POSITION3D, good=lambda p: abs(struct.unpack(">12dI", p)[0]) < 1)
        flyer.refused(POSITION3D, 0, 6, struct.pack(">6d", math.inf, 0, 0, 0, 0, 0))
        flyer.close()
        await_("a flyer that stands", lambda: all(abs(v) < 0.01 for v in rig.json_echo("flyer::position3d")["velocity"]))

        gps = struct.unpack(">IIiiiddddIIIIdd", faller.read_until(GPS))
        assert abs(gps[2] - 36.06e7) < 1e4 and abs(gps[3] - 140.13e7) < 1e4 and 24000 < gps[4] < 27000, gps
        # Zone 54 has its meridian at 141 degrees: 0.87 degrees west of it.
        assert 42_000_000 < gps[7] < 42_200_000 and 399_000_000 < gps[8] < 399_400_000, gps[7:9]
        assert gps[9] == 1
        assert faller.read_until(BUMPER, good=lambda p: p[8] == 1) == struct.pack(">IIBxxx", 1, 1, 1)  # it has landed
        # A box of 0.4 x 0.3 m, 5 cm before the model's origin: its long side looks to the left.
        shapes = struct.unpack(">II6d2f", faller.demand(BUMPER, 0, 1))
        wanted = (1, 1, 0.05, 0, 0, 0, 0, math.pi / 2, 0.4, 0)
        assert all(abs(got - value) < 1e-6 for got, value in zip(shapes, wanted)), shapes
        for kind, form in ((4, ">9f3d"), (1, ">6d"), (2, ">9f"), (3, ">9f4f"), (5, ">18d")):
            if kind != 4:  # what it is at first
                faller.demand(IMU, 0, 1, struct.pack(">I", kind))
            at_rest = lambda payload: kind in (1, 5) or abs(struct.unpack(form, payload)[2] - 9.8) < 0.3
            values = struct.unpack(form, faller.read_until(IMU, subtype=kind, good=at_rest))
            if kind in (4, 1):
                assert abs(values[11 if kind == 4 else 5] - 0.7) < 0.05, values
        faller.refused(IMU, 0, 1, struct.pack(">I", 6))


# A mapping file: two robots on one port, and single devices.
def config():
    with Rig() as rig:
        path = f"{rig.work}/ports.yaml"
        with open(path, "w") as file:
            file.write("ports:\n- port: 0\n  robots: [second, first]\n- port: 0\n  devices:\n    laser:2: first::laser\n    ranger:0: sonar:first::sonar\n    camera:0: first::eye\n")
        rig.sim()
        rig.process = rig.start(f"{bin_dir}/player-gateway", "--config", path)
        ports = await_("ports", lambda: rig.shown(2))
        await_("a complaint", lambda: 'camera:0 of port 0: no iface "first::eye"' in rig.log(rig.process))
        both, single = Client(ports[0]), Client(ports[1])
        assert [d for d in both.devices() if d[0] == POSITION2D] == [(POSITION2D, 0), (POSITION2D, 1)]
        assert single.devices() == [(LASER, 2), (RANGER, 0), (SIMULATION, 0)], single.devices()
        both.subscribe(POSITION2D, 1)
        both.command(POSITION2D, 1, 1, velocity(0.3, 0, 0))
        both.read_until(POSITION2D, index=1, good=lambda p: Position(p).velocity[0] > 0.25)
        assert abs(rig.driven("second")) < 0.01
        single.subscribe(LASER, 2)
        single.read_until(LASER, index=2)
        taken = rig.try_gateway("--port", str(ports[0]))
        assert taken.returncode == 1 and f"port {ports[0]}" in taken.stderr and len(taken.stderr.splitlines()) == 1, taken.stderr
        for words in (("--port", "70000"), ("--port", "x"), ("--port", "1", "--config", path), ("--nonsense",)):
            wrong = rig.try_gateway(*words)
            assert wrong.returncode == 2 and len(wrong.stderr.splitlines()) == 1, wrong
        wrong = rig.try_gateway("--config", f"{rig.work}/none.yaml")
        assert wrong.returncode == 2 and "none.yaml" in wrong.stderr
        wrong = rig.try_gateway("--address", "nowhere", "--port", "0")
        assert wrong.returncode == 1 and "nowhere" in wrong.stderr


run(listing, drive, properties, flow, rate, two_clients, simulation, rangers, sensors, config)
