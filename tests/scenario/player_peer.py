# A client of Player that shares nothing with ours: it encodes and decodes by itself and behaves as libplayerc does. One recv of 32 bytes within two seconds for
# the banner, PULL at once, one request at a time with a time-out of 5 s, reads that end with SYNCH, structures demanded in answers that real clients look into.
import socket
import struct

DATA, CMD, REQ, ACK, SYNCH, NACK = 1, 2, 3, 4, 5, 6
GRIPPER, PTZ, ACTARRAY, LIMB = 3, 8, 53, 54
POWER, WIFI, LOCALIZE, RFID = 2, 23, 25, 56
BLOBFINDER, FIDUCIAL = 7, 10
MAP = 42
DIO, PLANNER, OPAQUE, GRAPHICS2D, GRAPHICS3D, VECTORMAP, STEREO = 20, 44, 51, 55, 58, 63, 65
PLAYER, POSITION2D, SONAR, LASER, GPS, BUMPER, AIO, POSITION3D, SIMULATION, CAMERA, IMU, POINTCLOUD3D, RANGER = 1, 4, 5, 6, 13, 14, 21, 30, 31, 40, 60, 61, 62
OPEN, CLOSE, ERROR = 1, 2, 3
PUSH, PULL = 1, 2


def header(interface, index, kind, subtype, size, stamp=0.0):
    return struct.pack(">IIIIIIdII", 0, 0, interface, index, kind, subtype, stamp, 0, size)


def message(interface, index, kind, subtype, payload=b""):
    return header(interface, index, kind, subtype, len(payload)) + payload


def text(value):
    raw = value.encode() + b"\0"
    return struct.pack(">II", len(raw), len(raw)) + raw + b"\0" * (-len(raw) % 4)


def devaddr(interface, index):
    return struct.pack(">IIII", 0, 0, interface, index)


def dev_request(interface, index, access):
    return devaddr(interface, index) + struct.pack(">III", access, 0, 0)


def velocity(vx, vy, va, state=1):
    return struct.pack(">3dI", vx, vy, va, state)


class Fields:
    """Takes a payload apart; finish() demands that nothing is left."""

    def __init__(self, payload):
        self.payload, self.at = payload, 0

    def take(self, form):
        values = struct.unpack_from(">" + form, self.payload, self.at)
        self.at += struct.calcsize(">" + form)
        return values[0] if len(values) == 1 else values

    def count(self):
        first, second = self.take("II")
        assert first == second, f"counts {first} and {second}"
        return first

    def many(self, form):
        values = [self.take(form) for _ in range(self.count())]
        return values

    def raw(self):
        size = self.count()
        value = self.payload[self.at : self.at + size]
        assert len(value) == size
        self.at += size + -size % 4
        return value

    def finish(self):
        assert self.at == len(self.payload), f"{len(self.payload) - self.at} bytes too many"


class Message:
    def __init__(self, head, payload):
        self.host, self.robot, self.interface, self.index, self.kind, self.subtype, self.stamp, self.seq, self.size = struct.unpack(">IIIIIIdII", head)
        self.payload = payload

    def key(self):
        return self.interface, self.index, self.subtype

    def __repr__(self):
        return f"{self.interface}:{self.index} type {self.kind} subtype {self.subtype} at {self.stamp:.3f}, {len(self.payload)} bytes"


class Closed(Exception):
    pass


class Wire:
    """The bare connection: what hostile peers use."""

    def __init__(self, port, banner=True, timeout=20.0):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=timeout)
        self.buffer = b""
        if banner:
            self.socket.settimeout(2.0)
            hello = self.socket.recv(32)  # once, as libplayerc does
            assert len(hello) == 32 and hello.startswith(b"Player v.") and hello.endswith(b"\0"), hello
            self.socket.settimeout(timeout)

    def send(self, data):
        self.socket.sendall(data)

    def take(self, size):
        while len(self.buffer) < size:
            piece = self.socket.recv(1 << 16)
            if not piece:
                raise Closed
            self.buffer += piece
        taken, self.buffer = self.buffer[:size], self.buffer[size:]
        return taken

    def next(self):
        head = self.take(40)
        size = struct.unpack_from(">I", head, 36)[0]
        return Message(head, self.take(size))

    def close(self):
        self.socket.close()

    def reset(self):
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        self.socket.close()


class Client(Wire):
    """As libplayerc: PULL from the start."""

    def __init__(self, port, pull=True):
        super().__init__(port)
        self.early = []  # data that came while an answer was awaited
        self.stamps = {}
        self.open_devices = set()
        if pull:
            self.demand(PLAYER, 0, 5, struct.pack(">I", PULL))

    def request(self, interface, index, subtype, payload=b""):
        """Kind and payload of the answer."""
        self.send(message(interface, index, REQ, subtype, payload))
        while True:
            got = self.next()
            if got.kind in (DATA, SYNCH):
                self.check_data(got)
                self.early.append(got)
                continue
            assert got.kind in (ACK, NACK), got
            assert got.key() == (interface, index, subtype), f"wrong kind of reply: {got}"
            return got.kind, got.payload

    def demand(self, interface, index, subtype, payload=b""):
        kind, answer = self.request(interface, index, subtype, payload)
        assert kind == ACK, f"NACK for {interface}:{index} subtype {subtype}"
        return answer

    def refused(self, interface, index, subtype, payload=b""):
        kind, _ = self.request(interface, index, subtype, payload)
        assert kind == NACK, f"ACK for {interface}:{index} subtype {subtype}"

    def access(self, interface, index, access):
        kind, answer = self.request(PLAYER, 0, 3, dev_request(interface, index, access))
        fields = Fields(answer)
        assert fields.take("4I")[2:] == (interface, index)
        granted = fields.take("I")
        driver = fields.raw()
        fields.finish()
        assert len(driver) < 64
        assert granted == (access if kind == ACK else ERROR), f"granted {granted}"
        if kind == ACK:
            assert driver.endswith(b"\0") and len(driver) > 1
        return kind == ACK

    def subscribe(self, interface, index=0):
        assert self.access(interface, index, OPEN), f"{interface}:{index} cannot be opened"
        self.open_devices.add((interface, index))

    def unsubscribe(self, interface, index=0):
        assert self.access(interface, index, CLOSE)
        self.open_devices.discard((interface, index))
        self.early = [one for one in self.early if (one.interface, one.index) != (interface, index)]

    def devices(self):
        fields = Fields(self.demand(PLAYER, 0, 1))
        found = [fields.take("4I")[2:] for _ in range(fields.count())]
        fields.finish()
        return found

    def driver(self, interface, index):
        fields = Fields(self.demand(PLAYER, 0, 2, devaddr(interface, index) + struct.pack(">II", 0, 0)))
        assert fields.take("4I")[2:] == (interface, index)
        name = fields.raw()
        fields.finish()
        return name

    def check_data(self, got):
        if got.kind == SYNCH:
            return
        assert (got.interface, got.index) in self.open_devices, f"data of a device that is not open: {got}"
        assert got.stamp > self.stamps.get(got.key(), 0.0), f"{got} after {self.stamps.get(got.key())}"
        self.stamps[got.key()] = got.stamp
        if got.interface == LASER:
            scan = Laser(got.payload)
            assert all(r >= 0 for r in scan.ranges), "libplayerc aborts"
            assert len(scan.intensities) in (0, len(scan.ranges))

    def read(self):
        """One round of PULL: the messages up to SYNCH. Blocks as libplayerc does."""
        self.send(message(PLAYER, 0, REQ, 4))
        got = self.next()
        assert (got.kind, got.key()) == (ACK, (PLAYER, 0, 4)), got
        data = []
        while True:
            got = self.next()
            if got.kind == SYNCH:
                assert got.key() == (PLAYER, 0, 1) and got.size == 0, got
                assert data, "SYNCH without data: libplayerc returns NULL"
                return data
            assert got.kind == DATA, got
            self.check_data(got)
            data.append(got)

    def read_until(self, interface, subtype=1, index=0, good=lambda payload: True):
        """The payload of the next such data that is good; it must come within a minute of simulated time."""
        first = None
        while True:
            for got in self.read():
                if got.key() == (interface, index, subtype) and good(got.payload):
                    return got.payload
                first = first or got.stamp
                assert got.stamp < first + 60, f"{interface}:{index} has no such data; the last was {got}: {got.payload[:52].hex()}"

    def command(self, interface, index, subtype, payload=b""):
        self.send(message(interface, index, CMD, subtype, payload))


class Laser:
    def __init__(self, payload):
        fields = Fields(payload)
        self.min_angle, self.max_angle, self.resolution, self.max_range = fields.take("4f")
        self.ranges = list(struct.unpack_from(f">{fields.count()}f", payload, fields.at))
        fields.at += 4 * len(self.ranges)
        self.intensities = fields.raw()
        self.id = fields.take("I")
        fields.finish()


class Position:
    def __init__(self, payload):
        fields = Fields(payload)
        self.pose, self.velocity = fields.take("3d"), fields.take("3d")
        self.stall = fields.take("I")
        fields.finish()
