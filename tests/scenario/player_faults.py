# player-gateway when its simulator or its clients misbehave, one case per run: player_faults.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import math
import random
import re
import signal
import socket
import struct

from player_rig import *
from system import await_, is_stopped


# The gateway dies: the robot stops. The gateway is told to end: the same, and exit code 0.
def gateway_ends():
    for how, subtype, command in (("kill", 1, velocity(0.3, 0, 0)), ("terminate", 1, velocity(0.3, 0, 0)), ("kill", 2, pose_command(2.5, 0, 0))):
        with started() as rig:
            client = Client(rig.ports[0])
            client.subscribe(POSITION2D)
            client.command(POSITION2D, 0, subtype, command)
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
            client.command(POSITION2D, 0, 2, pose_command(9, 0, 0))  # ends with its simulator
            moves(client)
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
            for _ in range(3):
                client.read_until(LASER)
            assert abs(Position(client.read_until(POSITION2D)).velocity[0]) < 0.01
            client.command(POSITION2D, 0, 1, velocity(0.3, 0, 0))
            client.read_until(POSITION2D, good=lambda p: Position(p).velocity[0] > 0.25)
        assert len(rig.lines()) == 2, rig.lines()


# The simulator hangs: who asks it something is refused before a client's patience is over, everybody else is served as ever.
def hung():
    with started() as rig:
        asking, other = Client(rig.ports[0]), Client(rig.ports[0])
        asking.subscribe(SIMULATION)
        other.subscribe(POSITION2D)
        other.read()
        rig.simulator.send_signal(signal.SIGSTOP)
        await_("a simulator that hangs", lambda: is_stopped(rig.simulator))
        asking.send(message(SIMULATION, 0, REQ, 1, text("first") + bytes(24)))
        for _ in range(100):
            other.demand(POSITION2D, 0, 1)
            assert len(other.devices()) == 6
        asking.socket.settimeout(5)  # as long as libplayerc waits
        got = asking.next()
        assert (got.kind, got.key()) == (NACK, (SIMULATION, 0, 1)), got
        rig.simulator.send_signal(signal.SIGCONT)
        other.read()
        asking.demand(SIMULATION, 0, 1, text("first") + bytes(24))


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
        # A robot keeps its port when the one before it goes.
        second = Client(ports[1])
        second.subscribe(POSITION2D)
        rig.simctl("delete", "first")
        await_("a port that is empty too", lambda: client.devices() == [])
        second.command(POSITION2D, 0, 1, velocity(0.3, 0, 0))
        second.read_until(POSITION2D, good=lambda p: Position(p).velocity[0] > 0.25)
        assert rig.driven("second") > 0.2


def nonsense(seed):
    return random.Random(seed).randbytes(200)


# Each item of what a server has to withstand. After each the gateway lives and serves another client at once.
def bad_input():
    with started() as rig:
        port = rig.ports[0]
        good = Client(port)
        good.subscribe(POSITION2D)
        good.subscribe(LASER)

        def is_served():
            rig.is_alive()
            good.read_until(LASER)

        def is_closed(data):
            wire = Wire(port)
            wire.send(data)
            try:
                while True:
                    wire.next()
            except (Closed, ConnectionResetError):
                is_served()

        # Connections that say nothing, half a header, close before or in the banner.
        silent = [Wire(port) for _ in range(50)]
        Wire(port, banner=False).close()
        Wire(port, banner=False).reset()
        half = Wire(port)
        half.send(header(PLAYER, 0, REQ, 5, 4)[:20])
        cut = Wire(port)
        cut.send(message(PLAYER, 0, REQ, 5, struct.pack(">I", 2))[:41])
        cut.close()
        is_served()
        for _ in range(1000):
            Wire(port, banner=False).close()
        is_served()

        # What is no Player: scanners, headers that cannot be, sizes that are too large.
        is_closed(b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n" + b"x" * 40)
        is_closed(b"\xff" * 40)
        for seed in range(20):
            is_closed(b"\xff" + nonsense(seed))
        for size in (0xFFFFFFFF, 0x7FFFFFFF, 33554433, 1048577):
            is_closed(header(PLAYER, 0, REQ, 1, size) + bytes(1000))
        is_closed(header(PLAYER, 0, 0x103, 5, 4) + bytes(4))
        is_closed(header(PLAYER, 0, REQ, 0x105, 4) + bytes(4))
        is_closed(header(0x10001, 0, REQ, 5, 4) + bytes(4))

        # Byte by byte, and a thousand messages in one write.
        slow = Client(port)
        slow.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        for byte in message(LASER, 0, REQ, 3):
            slow.send(bytes([byte]))
        assert slow.next().kind == ACK
        slow.send(message(LASER, 0, REQ, 3) * 1000)
        for _ in range(1000):
            assert slow.next().kind == ACK

        # Wrong sizes and structures of every request: answered, and the stream stays in step.
        probe = Client(port)
        probe.subscribe(LASER)
        probe.unsubscribe(LASER)
        for subtype in (2, 3, 5, 7, 8, 10, 6, 9, 200):
            for payload in (b"", b"\0", bytes(3), bytes(27), bytes(1000), b"\xff" * 28, b"\xff" * 64):
                probe.refused(PLAYER, 0, subtype, payload)
        for interface in (POSITION2D, LASER, SONAR, RANGER, SIMULATION):
            for subtype in range(256):
                for payload in (b"", bytes(2), b"\xff" * 40):
                    kind, _ = probe.request(interface, 0, subtype, payload)
                    assert kind in (ACK, NACK)
        huge = struct.pack(">II", 0xFFFFFFFF, 0xFFFFFFFF)
        for payload in (huge, huge + bytes(24), struct.pack(">II", 4, 5) + bytes(40), struct.pack(">II", 100, 100) + bytes(8)):
            probe.refused(SIMULATION, 0, 1, payload)
            probe.refused(SIMULATION, 0, 5, payload)
            probe.refused(PLAYER, 0, 3, devaddr(LASER, 0) + struct.pack(">I", 1) + payload)

        # Types that clients do not send are ignored; so are commands to what is not there or not open.
        for kind in (0, DATA, ACK, SYNCH, NACK, 7, 255):
            probe.send(message(PLAYER, 0, kind, 1, bytes(8)) + message(LASER, 0, kind, 1, bytes(8)))
        for interface, index in ((POSITION2D, 0), (POSITION2D, 9), (LASER, 0), (77, 0), (PLAYER, 0), (PLAYER, 3)):
            for subtype in (0, 1, 2, 3, 4, 255):
                for payload in (b"", velocity(0.3, 0, 0), bytes(11)):
                    probe.send(message(interface, index, CMD, subtype, payload))
        probe.demand(LASER, 0, 3)
        probe.refused(PLAYER, 1, 1)

        # Devices: wrong access, closed without open, the player device itself.
        for access in (0, ERROR, 200, 0xFFFFFFFF):
            kind, answer = probe.request(PLAYER, 0, 3, dev_request(LASER, 0, access))
            assert kind == NACK and struct.unpack_from(">I", answer, 16)[0] == ERROR
        assert not probe.access(LASER, 0, CLOSE)
        assert not probe.access(PLAYER, 0, OPEN)
        assert not probe.access(LASER, 1, OPEN)
        assert not probe.access(77, 0, OPEN)

        # Numbers that are none: the robot stays where it is.
        probe.subscribe(POSITION2D)
        for value in (math.nan, math.inf, -math.inf):
            for numbers in ((value, 0, 0), (0, value, 0), (0, 0, value)):
                probe.command(POSITION2D, 0, 1, velocity(*numbers))
            probe.refused(POSITION2D, 0, 5, struct.pack(">3d", 0, value, 0))
        assert abs(rig.driven()) < 0.01
        probe.command(POSITION2D, 0, 1, velocity(1e308, 1e308, -1e308))
        probe.command(POSITION2D, 0, 1, velocity(0, 0, 0))

        # Rules by the thousand, and rules of no kind.
        accepted = sum(probe.request(PLAYER, 0, 10, struct.pack(">5i", -1, i, -1, -1, 1))[0] == ACK for i in range(2000))
        assert 0 < accepted < 2000
        probe.refused(PLAYER, 0, 10, struct.pack(">5i", -1, -1, -1, -1, 7))
        is_served()
        for wire in silent:
            wire.close()


# A client that never reads: its data and answers are bounded and delay nobody; one that vanishes in the middle of a picture too.
def stuck():
    with Rig() as rig:
        path = f"{rig.work}/eye.sdf"
        with open(path, "w") as file:
            file.write("""<sdf version="1.9"><world name="eye"><model name="eye"><static>true</static><link name="l"><sensor name="big" type="camera"><update_rate>20</update_rate>
<camera><image><width>640</width><height>480</height></image></camera></sensor></link></model></world></sdf>""")
        rig.sim(world=path)
        rig.gateway(robots=1)
        lazy, greedy, reader = Client(rig.ports[0], pull=False), Client(rig.ports[0]), Client(rig.ports[0])
        for client in (lazy, reader):
            client.subscribe(CAMERA)
        greedy.socket.settimeout(0.5)
        try:
            while True:  # until the gateway no longer listens to who does not read
                greedy.send(message(PLAYER, 0, REQ, 1) * 100)
        except TimeoutError:
            pass
        for _ in range(60):
            reader.read_until(CAMERA)
        with open(f"/proc/{rig.process.pid}/status") as file:
            resident = int(re.search(r"VmRSS:\s+(\d+)", file.read())[1])
        assert resident < 600_000, f"{resident} kB"  # a build with a sanitizer has half of that anyway
        # The lazy one reads at last: what comes is whole, and after what the sockets held comes the present.
        newest = reader.stamps[(CAMERA, 0, 1)]
        while True:
            got = lazy.next()
            lazy.check_data(got)
            assert len(got.payload) == 640 * 480 * 3 + 32
            if got.stamp >= newest:
                break
        # Gone in the middle of a picture.
        for _ in range(20):
            gone = Client(rig.ports[0], pull=False)
            gone.subscribe(CAMERA)
            gone.take(100)
            gone.reset()
        reader.read_until(CAMERA)
        rig.is_alive()


run(gateway_ends, restart, hung, late_and_changing, bad_input, stuck)
