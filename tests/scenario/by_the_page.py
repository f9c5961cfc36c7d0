# A client that knows docs/shared-memory.md and nothing else: reads the clock and a laser, drives a robot. by_the_page.py BIN_DIR SOURCE_DIR
import mmap
import os
import re
import struct
import subprocess
import sys
import time

import server_ids

bin_dir, source = sys.argv[1:]
server_id = server_ids.claim()
watchdog = 60  # [s]; a bound on hanging, not on speed
page = open(f"{source}/docs/shared-memory.md").read()
number = {"int32_t": "i", "uint32_t": "I", "int64_t": "q", "uint64_t": "Q", "double": "d", "float": "f", "uint8_t": "B"}
values = {m[2]: int(m[1]) for m in re.finditer(r"^\| (\d+) \| `(RTMSIM_\w+)` \|", page, re.M)}
structs = {}
for title in re.finditer(r"^### `(\w+)`, (\d+) bytes\n(.*?)(?=^### |\Z)", page, re.S | re.M):
    rows = re.finditer(r"^\| (\d+) \| (\d+) \| `(\w+)` \| (\w+)(\[[^\]]+\])? \|", title[3], re.M)
    structs[title[1]] = (int(title[2]), {row[3]: (int(row[1]), int(row[2]), row[4], row[5]) for row in rows})


def size(name):
    return structs[name][0]


def offset(name, field):
    return structs[name][1][field][0]


class Iface:
    leases = 0  # of this process so far

    def __init__(self, kind, name):
        file = os.open(f"/dev/shm/rtmsim-{os.getuid()}-{server_id}.{kind}.{name}", os.O_RDWR)
        self.memory = mmap.mmap(file, 0)
        os.close(file)
        self.kind = kind
        self.areas = self.get("rtmsim_header", "areas", 0)
        self.lease = None

    def get(self, name, field, base):
        at, length, kind, array = structs[name][1][field]
        if kind == "char":
            return self.memory[base + at:base + at + length].split(b"\0")[0]
        if kind in number:
            count = length // struct.calcsize(number[kind])
            found = struct.unpack_from(f"<{count}{number[kind]}", self.memory, base + at)
            return found if array else found[0]
        found = [self.all(kind, base + at + i) for i in range(0, length, size(kind))]
        return found if array else found[0]

    def all(self, name, base):
        return {field: self.get(name, field, base) for field in structs[name][1]}

    def put(self, name, field, base, value):
        kind = structs[name][1][field][2]
        struct.pack_into(f"<{number[kind]}", self.memory, base + offset(name, field), value)

    def area(self, index, element=0):
        area = self.areas[values[index]]
        assert element < area["count"], index
        return area["offset"] + element * area["stride"]

    def info(self):
        return self.all(f"rtmsim_{self.kind}_info", self.area("RTMSIM_AREA_INFO"))

    # The latest sample and where what follows it lies; none yet: nothing.
    def sample(self):
        while True:
            n = self.get("rtmsim_header", "sequence", 0)
            if n == 0:
                return None
            cell = self.area("RTMSIM_AREA_CELLS", n % self.areas[values["RTMSIM_AREA_CELLS"]]["count"])
            lock = struct.unpack_from("<Q", self.memory, cell)[0]
            copy = self.all(f"rtmsim_{self.kind}_sample", cell + 8)
            if self.kind == "laser":
                copy["ranges"] = struct.unpack_from(f"<{copy['count']}f", self.memory, cell + 8 + size("rtmsim_laser_sample"))
            if lock == struct.unpack_from("<Q", self.memory, cell)[0] == 2 * n + 2:
                return copy

    def subscribe(self):
        for i in range(self.areas[values["RTMSIM_AREA_LEASES"]]["count"]):
            base = self.area("RTMSIM_AREA_LEASES", i)
            if self.get("rtmsim_lease", "owner", base) != 0:
                continue
            self.lease = i
            Iface.leases += 1
            self.put("rtmsim_lease", "owner", base, (os.getpid() << 32) + Iface.leases)
            self.put("rtmsim_lease", "pid_namespace", base, os.stat("/proc/self/ns/pid").st_ino)
            self.put("rtmsim_lease", "start_time", base, int(open("/proc/self/stat").read().rsplit(")", 1)[1].split()[19]))
            self.put("rtmsim_lease", "flags", base, values["RTMSIM_LEASE_SUBSCRIBER"])
            self.put("rtmsim_header", "lease_epoch", 0, self.get("rtmsim_header", "lease_epoch", 0) + 1)
            return
        raise AssertionError("no free lease")

    def let_go(self):
        self.put("rtmsim_lease", "owner", self.area("RTMSIM_AREA_LEASES", self.lease), 0)
        self.put("rtmsim_header", "lease_epoch", 0, self.get("rtmsim_header", "lease_epoch", 0) + 1)

    def command(self, *velocity):
        base = self.area("RTMSIM_AREA_LEASES", self.lease)
        at = base + offset("rtmsim_lease", "command")
        lock = self.get("rtmsim_lease", "command_lock", base)
        self.put("rtmsim_lease", "command_lock", base, lock + 1)
        self.put("rtmsim_command", "kind", at, values["RTMSIM_COMMAND_VELOCITY"])
        count = self.get("rtmsim_header", "command_values", 0)
        struct.pack_into(f"<{count}d", self.memory, at + size("rtmsim_command"), *velocity, *[0.0] * (count - len(velocity)))
        self.put("rtmsim_lease", "command_lock", base, lock + 2)
        before = self.get("rtmsim_header", "command_latest", 0) >> 16
        self.put("rtmsim_header", "command_latest", 0, (before + 1) << 16 | self.lease)


def await_(what, ready):
    end = time.monotonic() + watchdog
    while not ready():
        assert time.monotonic() < end, f"{what}: not within {watchdog} s"
        time.sleep(0.02)


def opened(kind, name):
    try:
        return Iface(kind, name)
    except FileNotFoundError:
        return None


server = subprocess.Popen([f"{bin_dir}/sim-server", f"{source}/worlds/obstacle_course.sdf", "-s", server_id])
try:
    await_("the last iface", lambda: opened("truth", "pioneer2dx"))
    clock, laser, drive = opened("simulation", "world"), opened("laser", "pioneer2dx::laser"), opened("position2d", "pioneer2dx::position2d")
    assert clock.get("rtmsim_header", "magic", 0) == b"RTMSIM\r\n" and clock.get("rtmsim_header", "layout_version", 0) == 2
    assert clock.get("rtmsim_header", "state", 0) == values["RTMSIM_STATE_LIVE"]
    assert clock.all("rtmsim_header", 0)["server"]["pid"] == server.pid
    assert clock.info()["world"] == b"obstacle_course", clock.info()
    await_("running time", lambda: clock.sample() and clock.sample()["stamp"]["sim_time_ns"] > 0)
    assert clock.sample()["models"] == 30 and clock.sample()["parts"][2]["name"] == b"physics", clock.sample()

    assert laser.info()["beams"] == 682 and laser.info()["model"] == b"pioneer2dx", laser.info()
    assert laser.sample() is None, "nobody has subscribed"
    laser.subscribe()
    await_("a scan", laser.sample)
    scan = laser.sample()
    assert scan["stamp"]["valid"] == 1 and scan["count"] == 682
    assert abs(scan["ranges"][0] - 1.55) < 0.1 and float("inf") in scan["ranges"], scan["ranges"][:10]

    drive.subscribe()
    drive.command(0.2, 0.0, 0.3)

    def follows(field, tolerance):
        sample = drive.sample()
        return sample is not None and sample["commanded"] == 1 and all(abs(a - b) < tolerance for a, b in zip(sample[field], (0.2, 0.0, 0.3)))

    await_("a driving robot", lambda: follows("command", 1e-6) and follows("velocity", 0.01))
    drive.let_go()
    drive.subscribe()
    await_("a robot without commander that stands", lambda: drive.sample()["commanded"] == 0 and abs(drive.sample()["velocity"][0]) < 0.01)
finally:
    server.terminate()
    assert server.wait(watchdog) == 0
assert clock.get("rtmsim_header", "state", 0) == values["RTMSIM_STATE_CLOSED"]
print("ok")
