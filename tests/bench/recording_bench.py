# What recordings cost: recording_bench.py BIN_DIR LIB_DIR SOURCE_DIR [PART...]. The obstacle run with and without its recording, the same run again to a moment, a component alone, a
# place in a one-hour file, the scans and odometry of a hundred robots, a camera. Beside each number its limit; exit 1 when one is missed. Wall time says little on a busy machine: beside it
# stands the processor time (user and system) of all processes of the measurement, whose ratios hold there, too.
import ctypes
import json
import os
import re
import resource
import signal
import statistics
import subprocess
import sys
import time

bin_dir, lib_dir, source, *chosen = sys.argv[1:]
sys.path.insert(0, f"{source}/tests/scenario")
from rig import Rig  # noqa: E402

rig = Rig(bin_dir, lib_dir, source)
system = [f"{source}/worlds/systems/obstacle_avoidance.xml", "--world", f"{source}/worlds/obstacle_course.sdf"]
missed = 0


def row(what, value, unit, limit, is_good):
    global missed
    missed += not is_good
    print(f"| {what:<58} | {value:9.1f} {unit:<3} | {limit:<12} | {'ok' if is_good else 'MISS':<4} |", flush=True)


# Of children that have ended [s].
def used():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


# Wall time, processor time, output.
def timed(*words):
    before, start = used(), time.perf_counter()
    out = rig.rtse(*words)
    return time.perf_counter() - start, used() - before, out


def best(runs, *words):
    made = [timed(*words)[:2] for _ in range(runs)]
    return min(wall for wall, _ in made), min(cpu for _, cpu in made)


def obstacle_run():
    file = rig.path("run.mcap")
    run = ("--json", "run", *system, "--duration", "57")
    bare = best(3, *run)
    kept = best(3, *run, "--record", file)
    row("obstacle run of 57 s, all of it recorded, wall time more by", 1000 * (kept[0] - bare[0]), "ms", "-", True)
    row("the same, processor time more by", 1000 * (kept[1] - bare[1]), "ms", "-", True)
    there = best(3, "goto", file, "57", "--then", "true")
    row("goto 57 s, wall time", 1000 * there[0], "ms", "<= 1500 ms", there[0] <= 1.5)
    row("the same, processor time", 1000 * there[1], "ms", "<= 1500 ms", there[1] <= 1.5)
    alone = [timed("--json", "replay", file, "--into", "LaserObstacleAvoid0", "--compare") for _ in range(5)]
    factor = max(r["simulated"] / r["wall"] for r in (json.loads(out) for *_, out in alone))
    row("replay of LaserObstacleAvoid, times real time", factor, "x", ">= 500 x", factor >= 500)
    factor = 57 / min(cpu for _, cpu, _ in alone)
    row("the same by processor time, start and end of programs too", factor, "x", "-", True)


def one_hour():
    file = rig.path("hour.mcap")
    subprocess.run([f"{bin_dir}/mcap_bench", "--hour", file], check=True)
    begin = best(9, "recording", "cat", file, "/scan", "-n", "1")
    late = best(9, "recording", "cat", file, "/scan", "--from", "3000", "-n", "1")
    row("a sample at 3000 s of an hour, program and all, wall time", 1000 * late[0], "ms", "-", True)
    row("the same, more than the first sample of the file", 1000 * (late[0] - begin[0]), "ms", "<= 50 ms", late[0] - begin[0] <= 0.05)
    row("the same, processor time", 1000 * (late[1] - begin[1]), "ms", "<= 50 ms", late[1] - begin[1] <= 0.05)


# All sensors of a simulator work as long as this one lives; nobody reads them.
class Subscribed:
    def __init__(self, server_id):
        self.library = ctypes.CDLL(f"{lib_dir}/librtmsim_iface.so")
        self.library.rtmsim_open.restype = ctypes.c_void_p
        self.library.rtmsim_type.argtypes = [ctypes.c_char_p]
        found = []
        visitor = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_uint32, ctypes.c_char_p, ctypes.c_char_p)
        each = visitor(lambda _, server, kind, name: found.append((kind, name)) or 0)
        assert self.library.rtmsim_list(ctypes.c_int64(server_id), each, None) > 0
        self.ifaces = []
        for kind, name in found:
            iface = self.library.rtmsim_open(ctypes.c_uint32(server_id), self.library.rtmsim_type(kind), name)
            if iface and kind != b"simulation":
                assert self.library.rtmsim_subscribe(ctypes.c_void_p(iface)) == 0, name
            self.ifaces.append(iface)

    def end(self):
        for iface in self.ifaces:
            self.library.rtmsim_close(ctypes.c_void_p(iface))


# Wall and processor time of some simulated seconds of a world, of simulator and recorder, if there is one.
def simulated(world, seconds, words):
    server = rig.server("--lockstep", "--rtf", "0", "--paused", world=world)
    recorder = None
    sensors = Subscribed(int(rig.server_id))
    if words:
        recorder = subprocess.Popen([f"{bin_dir}/rtse", "record", "-s", str(rig.server_id), "-o", rig.path("world.mcap"), *words],
                                    stderr=subprocess.PIPE, text=True)
        assert recorder.stderr.readline().startswith("recording ")
    rig.simctl("step", "200")
    processes = [server.pid] + ([recorder.pid] if recorder else [])
    before, start = sum(map(processor_time, processes)), time.perf_counter()
    rig.simctl("step", str(seconds * 1000))
    took = time.perf_counter() - start, sum(map(processor_time, processes)) - before
    if recorder:
        recorder.send_signal(signal.SIGINT)
        recorder.communicate(timeout=60)
        assert recorder.returncode == 0
    sensors.end()
    server.terminate()
    server.wait(20)
    return took


# Of a process that runs [s].
def processor_time(pid):
    with open(f"/proc/{pid}/stat") as file:
        fields = file.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


# The same run with all sensors at work and nobody who reads them, in turns; the median of the pairs, since a neighbour of the machine slows
# both of a pair.
def compared(what, world, seconds, *words, runs=9):
    pairs = [(simulated(world, seconds, []), simulated(world, seconds, words)) for _ in range(runs)]
    for name, n, limit in (("wall time", 0, "<= 5 %"), ("processor time", 1, "-")):
        more = statistics.median(kept[n] / bare[n] for bare, kept in pairs) - 1
        row(f"{what}, {name} more by", 100 * more, "%", limit, limit == "-" or more <= 0.05)


def robots():
    compared("scans and odometry of a hundred robots", f"{source}/worlds/hundred.sdf", 10, "--views", *wanted("laser", "position2d"))


# Nothing but these sensors.
def wanted(*kinds):
    others = ("/clock", "/tf", "/tf_static", "/sim/joints/*", "/sim/shapes", "/sim/position2d/*/origin",
              *(f"/sim/{kind}/*" for kind in ("laser", "position2d", "position3d", "sonar", "camera") if kind not in kinds))
    return [word for pattern in others for word in ("--exclude", pattern)]


def camera():
    world = rig.path("camera.sdf")
    with open(f"{source}/worlds/farm.sdf") as file:
        text = file.read()
    with open(world, "w") as file:
        file.write(re.sub(r"<width>\d+</width>", "<width>640</width>", re.sub(r"<height>\d+</height>", "<height>480</height>", text)))
    os.environ["RTMSIM_RESOURCE_PATH"] = f"{source}/worlds:{source}/worlds/models"
    compared("a camera of 640x480 at 30 Hz", world, 8, "--views", *wanted("camera"))


with rig:
    for part in (obstacle_run, one_hour, robots, camera):
        if not chosen or part.__name__ in chosen:
            part()
sys.exit(1 if missed else 0)
