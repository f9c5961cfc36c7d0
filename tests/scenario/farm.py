# The farm in lock step: a helicopter flies its round above a cow, RTCCamera sends what its camera sees, VideoPlayer writes the frames. The cow is in every picture,
# with her colour and where the poses of both say, for a whole round. Then the helicopter obeys velocity commands that come through its port, and holds its height.
import math
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
import zlib

import server_ids

bin_dir, lib_dir, source = sys.argv[1:]
server_id = server_ids.claim()
with socket.socket() as probe:
    probe.bind(("127.0.0.1", 0))
    names = f"127.0.0.1:{probe.getsockname()[1]}"
work = tempfile.TemporaryDirectory()
running = []


def start(*words):
    running.append(subprocess.Popen(words, stdout=open(f"{work.name}/{len(running)}.log", "w"), stderr=subprocess.STDOUT, env={**os.environ, "RTMSIM_SERVER_ID": server_id}))
    return running[-1]


def call(*words):
    done = subprocess.run(words, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, f"{words}: {done.stderr}"
    return done.stdout


def rtse(*words):
    return call(f"{bin_dir}/rtse", "--ns", names, *words)


def simctl(*words):
    return call(f"{bin_dir}/simctl", "-s", server_id, *words)


def await_(what, ready):
    end = time.monotonic() + 60
    while True:
        try:
            return ready()
        except AssertionError:
            assert time.monotonic() < end, f"{what}: not within a minute"
        time.sleep(0.05)


def pixels(path):
    """Width, height and rows of RGB bytes of an 8-bit RGB picture whose rows are stored as they are."""
    data = open(path, "rb").read()
    at, packed = 8, b""
    while at < len(data):
        length, kind = int.from_bytes(data[at : at + 4], "big"), data[at + 4 : at + 8]
        body = data[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            width, height = int.from_bytes(body[:4], "big"), int.from_bytes(body[4:8], "big")
            assert body[8:10] == b"\x08\x02", f"{path}: expected 8-bit RGB"
        if kind == b"IDAT":
            packed += body
        at += length + 12
    raw, step = zlib.decompress(packed), 3 * width + 1
    assert all(raw[y * step] == 0 for y in range(height)), f"{path}: rows are filtered"
    return width, height, [raw[y * step + 1 : (y + 1) * step] for y in range(height)]


def white_spot(path):
    """Middle and number of the pixels that are as white as the cow's hide; nothing else on the farm is, from above."""
    width, height, rows = pixels(path)
    u = v = count = 0
    for y, row in enumerate(rows):
        for x in range(width):
            r, g, b = row[3 * x : 3 * x + 3]
            if min(r, g, b) > 110 and max(r, g, b) - min(r, g, b) < 40:
                u, v, count = u + x, v + y, count + 1
    assert count > 0, f"{path}: no cow"
    return u / count, v / count, count


def yaw_of(pose):
    w, z = pose[3], pose[6]
    return 2 * math.atan2(z, w)


def projected(cow, helicopter):
    """Where the middle of the cow's back is in the picture of a camera that looks straight down."""
    yaw = yaw_of(helicopter)
    dx, dy = cow[0] - helicopter[0], cow[1] - helicopter[1]
    forward, left = math.cos(yaw) * dx + math.sin(yaw) * dy - 0.42, -math.sin(yaw) * dx + math.cos(yaw) * dy
    focal = 160 / math.tan(1.0472 / 2) / (helicopter[2] - 0.31 - 1.1)
    return 160 - left * focal, 120 - forward * focal


def height():
    return float(simctl("pose", "helicopter").split()[2])


try:
    record, frames = f"{work.name}/record.txt", f"{work.name}/frames"
    start(f"{bin_dir}/sim-server", f"{source}/worlds/farm.sdf", "-s", server_id, "--lockstep", "--paused", "--rtf", "0", "--record", record)
    await_("simulator", lambda: simctl("stats"))
    components = ("RTCCamera0", "VideoPlayer0", "RTCPosition3d0")
    start(f"{bin_dir}/rtcd", "--with-naming", "-o", f"corba.nameservers:{names}", "-o", f"manager.modules.load_path:{lib_dir}", "-o", "manager.modules.preload:SimTimeContext.so",
          "-o", "exec_cxt.periodic.type:SimTimeContext", "-o", "manager.shutdown_auto:NO", *(f"{name[:-1]}?exec_cxt.periodic.rate=5" for name in components))
    rtse("wait", *components, "--state", "any", "--timeout", "60")
    rtse("load", f"{source}/worlds/systems/farm.xml")
    for name in ("RTCCamera0", "RTCPosition3d0"):
        rtse("conf", name, "set", "server_id", server_id)
    rtse("conf", "VideoPlayer0", "set", "record_dir", frames)
    rtse("conf", "VideoPlayer0", "set", "window", "0")
    rtse("act", *components)

    lap = 32  # s, a little more than a round
    simctl("step", str(lap * 1000))
    shown = sorted(name for name in os.listdir(frames) if name.endswith(".png"))
    assert abs(len(shown) - 5 * lap) <= 1, f"{len(shown)} frames in {lap} s at 5 Hz"
    poses = {}
    for line in open(record):
        words = line.split()
        if words[0] not in ("#", "contact"):
            poses.setdefault(words[1], {})[round(float(words[0]), 1)] = [float(w) for w in words[2:]]
    seen = []
    for number in range(0, len(shown), 5):
        t = round(number / 5, 1)
        cow, helicopter = poses["cow"][t], poses["helicopter"][t]
        assert abs(helicopter[2] - 7) < 1e-3, f"height {helicopter[2]} at {t} s"
        u, v, count = white_spot(f"{frames}/{shown[number]}")
        wanted = projected(cow, helicopter)
        assert count > 1000, f"{count} white pixels at {t} s"
        assert math.dist((u, v), wanted) < 22, f"cow seen at {u:.0f} {v:.0f}, expected {wanted[0]:.0f} {wanted[1]:.0f} at {t} s"
        seen.append((u, v))
    spread = math.dist([min(p[k] for p in seen) for k in (0, 1)], [max(p[k] for p in seen) for k in (0, 1)])
    assert spread > 30, f"the cow moves by {spread:.0f} pixels in the picture"
    turn = sum(abs(math.remainder(yaw_of(poses["cow"][t + 1]) - yaw_of(poses["cow"][t]), 2 * math.pi)) for t in map(float, range(lap)))
    assert turn > 6.2, f"the cow turned by {turn} rad: that is no round"

    before = height()
    pilot = start(f"{bin_dir}/rtse", "--ns", names, "inject", "RTCPosition3d0:velocity", "-n", "0", "-r", "20", '{"data": {"vz": 0.5}}')

    def climbs():
        simctl("step", "200")
        assert height() > before + 0.05

    await_("a command that arrives", climbs)
    before = height()
    simctl("step", "1000")
    climbed = height() - before
    assert abs(climbed - 0.5) < 0.05, f"climbed {climbed} m in 1 s at 0.5 m/s"
    pilot.send_signal(signal.SIGINT)
    pilot.wait(20)
    simctl("step", "2000")  # it waits a second for the next command, then stops
    held = height()
    simctl("step", "2000")
    assert abs(height() - held) < 1e-3, "it does not hold its height"
finally:
    for process in reversed(running):
        process.send_signal(signal.SIGTERM)
    for process in running:
        try:
            process.wait(20)
        except subprocess.TimeoutExpired:
            process.kill()
            raise
    if sys.exc_info()[0]:
        for number in range(len(running)):
            print(open(f"{work.name}/{number}.log").read()[-3000:], file=sys.stderr)
