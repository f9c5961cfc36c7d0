# simctl screenshot and record against a running sim-server: pictures.py BIN_DIR SOURCE_DIR. Every view and every overlay, every bad value, films with an
# encoder (a stand-in), without one and with a broken one.
import json
import os
import stat
import struct
import subprocess
import sys
import tempfile
import time
import zlib

import server_ids

bin_dir, source = sys.argv[1:]
server_id = server_ids.claim()
watchdog = 60  # [s]; a bound on hanging, not on speed
work = tempfile.TemporaryDirectory()


def simctl(*words, path=None):
    environment = dict(os.environ, **({"PATH": path} if path else {}))
    return subprocess.run([f"{bin_dir}/simctl", "-s", server_id, *words], capture_output=True, text=True, timeout=watchdog, env=environment)


def ok(*words, **options):
    done = simctl(*words, **options)
    assert done.returncode == 0, f"{words}: {done.stderr}"
    return done


def refused(*words, code=1, says="", **options):
    done = simctl(*words, **options)
    lines = done.stderr.strip().splitlines()
    assert done.returncode == code and len(lines) == 1 and says in lines[0], f"{words}: exit {done.returncode}, {done.stderr!r}"


def place(name):
    return f"{work.name}/{name}"


# Width, height and rows of (r, g, b) of a PNG of 8 bits without alpha.
def read_png(file):
    data = open(file, "rb").read()
    assert data[:8] == b"\x89PNG\r\n\x1a\n", file
    at, body = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at : at + 8])
        if kind == b"IHDR":
            width, height, depth, color = struct.unpack(">IIBB", data[at + 8 : at + 18])
        if kind == b"IDAT":
            body += data[at + 8 : at + 8 + length]
        at += 12 + length
    channels = {0: 1, 2: 3, 6: 4}[color]
    assert depth == 8
    raw, rows, before, stride = zlib.decompress(body), [], bytes(width * channels), width * channels
    for y in range(height):
        kind, line = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1 : (y + 1) * (stride + 1)])
        for i in range(stride):
            left = line[i - channels] if i >= channels else 0
            up, corner = before[i], before[i - channels] if i >= channels else 0
            if kind == 1:
                line[i] = (line[i] + left) & 255
            elif kind == 2:
                line[i] = (line[i] + up) & 255
            elif kind == 3:
                line[i] = (line[i] + (left + up) // 2) & 255
            elif kind == 4:
                guess = left + up - corner
                a, b, c = abs(guess - left), abs(guess - up), abs(guess - corner)
                line[i] = (line[i] + (left if a <= b and a <= c else up if b <= c else corner)) & 255
        before = bytes(line)
        rows.append([tuple(line[x * channels : x * channels + 3]) for x in range(width)])
    return width, height, rows


def count(rows, is_it):
    return sum(1 for row in rows for p in row if is_it(p))


def screenshot(name, *options, size="160x120"):
    ok("screenshot", place(name), "--size", size, *options)
    width, height, rows = read_png(place(name))
    assert f"{width}x{height}" == size, name
    return rows


# A red and a yellow robot with a laser each, a camera over them, a body whose collision is larger than what is seen, an actor.
def laser_robot(name, x, y, color):
    return f"""
    <model name='{name}'><pose>{x} {y} 0.2 0 0 0</pose><link name='body'>
      <gravity>false</gravity><inertial><mass>5</mass></inertial>
      <visual name='v'><geometry><box><size>0.4 0.4 0.2</size></box></geometry><material><diffuse>{color} 1</diffuse></material></visual>
      <sensor name='laser' type='ray'><pose>0 0 0.2 0 0 0</pose><update_rate>10</update_rate><ray><scan><horizontal><samples>91</samples>
        <min_angle>-1</min_angle><max_angle>1</max_angle></horizontal></scan><range><min>0.05</min><max>2</max></range></ray></sensor></link></model>"""


world = f"""<sdf version='1.9'><world name='pictures'>
  <light type='directional' name='sun'><direction>0.3 0.2 -1</direction><diffuse>0.8 0.8 0.8 1</diffuse><cast_shadows>true</cast_shadows></light>
  <model name='ground'><static>true</static><link name='l'><visual name='v'><geometry><plane><size>40 40</size></plane></geometry>
    <material><diffuse>0.5 0.5 0.5 1</diffuse></material></visual></link></model>
  {laser_robot('leader', 0, 1.5, '1 0 0')}
  {laser_robot('follower', 0, -1.5, '1 1 0')}
  <model name='secret'><static>true</static><pose>-2.5 0 0.5 0 0 0</pose><link name='l'><collision name='c'><geometry><box><size>1 1 1</size></box></geometry></collision>
    <visual name='v'><geometry><sphere><radius>0.05</radius></sphere></geometry></visual></link></model>
  <model name='eye'><static>true</static><pose>0 0 6 0 1.5707963 0</pose><link name='l'>
    <sensor name='camera' type='camera'><update_rate>20</update_rate><camera><horizontal_fov>1</horizontal_fov><image><width>65</width><height>49</height></image></camera></sensor>
    <sensor name='depth' type='depth'><update_rate>20</update_rate><camera><image><width>64</width><height>48</height></image></camera></sensor></link></model>
  <actor name='walker'><pose>2 2 0.5 0 0 0</pose><link name='l'><visual name='v'><geometry><box><size>0.3 0.3 1</size></box></geometry>
    <material><diffuse>0 1 1 1</diffuse></material></visual></link></actor>
</world></sdf>"""


def is_red(p):
    return p[0] > 100 and p[1] < 60 and p[2] < 60


def is_yellow(p):
    return p[0] > 100 and p[1] > 100 and p[2] < 60


def is_orange(p):
    return p[0] > 120 and 60 < p[1] < p[0] - 30 and p[2] < 110 and p[1] > p[2] + 20


def screenshots():
    whole = screenshot("whole.png")
    assert count(whole, is_red) > 5 and count(whole, is_yellow) > 5
    top = screenshot("top.png", "--top")
    near = screenshot("near.png", "--top", "--span", "4", size="160x200")
    assert count(near, is_red) > 1.5 * count(top, is_red) > 0
    aside = screenshot("aside.png", "--top", "--span", "4", "--at", "40 0", size="160x200")
    assert count(aside, is_red) == 0
    assert near == screenshot("middle.png", "--top", "--span", "4", "--at", "0", "0", size="160x200")
    front = screenshot("from.png", "--from", "-3 1.5 1 0 0.25 0")
    assert count(front, is_red) > 20 and count(front, is_yellow) < count(front, is_red)
    assert front == screenshot("words.png", "--from", "-3", "1.5", "1", "0", "0.25", "0")
    wide = screenshot("wide.png", "--from", "-3 1.5 1 0 0.25 0", "--span", "2")
    assert 0 < count(wide, is_red) < count(front, is_red)
    follow = screenshot("follow.png", "--follow", "follower")
    assert count(follow, is_yellow) > 60 > count(follow, is_red)
    walker = screenshot("walker.png", "--follow", "walker")
    assert count(walker, lambda p: p[0] < 80 and p[1] > 60 and p[2] > 60) > 60
    camera = screenshot("camera.png", "--camera", "eye::camera", size="65x49")
    assert count(camera, is_red) > 3 and count(camera, is_yellow) > 3
    screenshot("depth.png", "--camera", "eye::depth")
    screenshot("tiny.png", size="1x1")
    large = screenshot("large.png", "--top", size="700x300")
    assert count(large, is_red) > 20

    # The first scanner is blue, the second green; names are white.
    plain, scans = screenshot("plain.png", "--top", "--span", "8", size="400x300"), screenshot("scans.png", "--top", "--scans", "--span", "8", size="400x300")

    def bluer(p):
        return p[2] > p[0] + 25 and p[2] > p[1] + 8

    def greener(p):
        return p[1] > p[0] + 20 and p[1] > p[2] + 20

    def white(p):
        return min(p) > 235

    for is_it, least in ((bluer, 500), (greener, 500), (white, 30)):
        assert count(scans, is_it) > count(plain, is_it) + least, is_it
    # The leader stands at +y: its fan is in the upper half.
    assert count(scans[:150], bluer) > 5 * count(scans[150:], bluer)
    ok("pose", "leader", "0.5", "1.5", "0.2", "0")
    ok("step", "50")

    # Its trail is where it has driven, in its fan's colour; where it is put, a new one begins.
    def behind_the_leader(*options):
        return count([row[228:285] for row in screenshot("trail.png", "--top", "--span", "8", *options, size="400x300")[72:79]], bluer)

    ok("velocity", "leader", "1", "0", "0")
    ok("step", "1500")
    assert behind_the_leader("--scans") > 50 and behind_the_leader() == 0
    ok("velocity", "leader", "0", "0", "0")
    ok("pose", "leader", "-1", "1.5", "0.2", "3.1416")
    ok("step", "50")
    assert behind_the_leader("--scans") == 0
    ok("pose", "leader", "0.5", "1.5", "0.2", "0")
    ok("step", "50")

    assert count(screenshot("seen.png", "--top"), is_orange) == 0
    shapes = screenshot("shapes.png", "--top", "--span", "10", "--show", "collisions")
    assert 20 < count(shapes, is_orange) < 0.3 * 160 * 120, count(shapes, is_orange)  # not the ground
    assert screenshot("seen2.png", "--top", "--show", "visuals") == screenshot("seen3.png", "--top")
    for view in (["--top"], ["--follow", "leader"], ["--camera", "eye::camera"], ["--from", "-3 1.5 1 0 0.25 0"], []):
        for more in ([], ["--scans"], ["--show", "collisions"], ["--scans", "--show", "collisions"]):
            screenshot("any.png", *view, *more)


def bad_screenshots():
    out = place("bad.png")
    for size in ("0x10", "10", "axb", "10x", "9000x10", "10x10x10"):
        refused("screenshot", out, "--size", size, code=2, says="expected WIDTHxHEIGHT")
    refused("screenshot", out, "--follow", "nobody", says="nobody")
    refused("screenshot", out, "--camera", "nobody::camera", says="nobody::camera")
    refused("screenshot", out, "--camera", "leader::laser", says="leader::laser")
    refused("screenshot", out, "--from", "1 2 3", code=2, says="6 numbers")
    refused("screenshot", out, "--from", "1 2 3 x 5 6", code=2)
    refused("screenshot", out, "--from", "nan 0 0 0 0 0", code=2, says="finite")
    refused("screenshot", out, "--from", "0 0 1 0 0 0", "--span", "3.5", says="3.5")
    refused("screenshot", out, "--span", "3", code=2, says="--span")
    refused("screenshot", out, "--camera", "eye::camera", "--span", "1", code=2)
    refused("screenshot", out, "--top", "--span", "-1", code=2)
    refused("screenshot", out, "--top", "--follow", "leader", code=2)
    refused("screenshot", out, "--top", "--at", "1 2", code=2, says="--span")
    refused("screenshot", out, "--top", "--span", "4", "--at", "1", code=2, says="2 numbers")
    refused("screenshot", out, "--top", "--span", "4", "--at", "1 nan", code=2, says="finite")
    refused("screenshot", out, "--show", "ghosts", code=2, says="ghosts")
    refused("screenshot", place("no/such/folder/x.png"), says="no/such/folder")
    refused("screenshot", code=2)
    for other in "x.jpg", "x.JPEG", "x.tar.gz":
        refused("screenshot", place(other), code=2, says="expected a name that ends in .png")
        assert not os.path.exists(place(other)), other
    refused("screenshot", work.name, says="is a folder")
    assert not os.path.exists(out)
    # What is no file stays what it is; a link stays a link.
    os.mkfifo(place("pipe"))
    refused("screenshot", place("pipe"), "--size", "8x8", says="no ordinary file")
    assert stat.S_ISFIFO(os.stat(place("pipe")).st_mode)
    os.symlink(place("behind.png"), place("link.png"))
    for _ in range(2):
        ok("screenshot", place("link.png"), "--size", "8x8")
        assert os.path.islink(place("link.png")) and read_png(place("behind.png"))[:2] == (8, 8)
        os.truncate(place("behind.png"), 0)


def records():
    ok("run")
    frames = place("frames")
    report = json.loads(ok("--json", "record", "eye::camera", frames, "-n", "3").stdout)
    assert report["frames"] == 3 and sorted(os.listdir(frames)) == [f"frame-{i:06d}.png" for i in (1, 2, 3)], report
    width, height, rows = read_png(f"{frames}/frame-000003.png")
    assert (width, height) == (65, 49) and count(rows, is_red) > 3
    refused("record", "eye::camera", frames, "-n", "1", says="holds frames already")
    ok("record", "eye::camera", place("span"), "--for", "0.2")
    assert 1 <= len(os.listdir(place("span"))) <= 5
    refused("record", "eye::depth", place("d"), "-n", "1", says="eye::depth")
    refused("record", "leader::laser", place("d"), "-n", "1", says="record takes a camera")
    refused("record", "nobody", place("d"), "-n", "1", says="nobody")
    refused("record", "eye::camera", "/proc/nowhere", "-n", "1", says="cannot be made")
    refused("record", "eye::camera", place("d"), "-n", "-1", code=2)

    empty = place("empty")
    os.mkdir(empty)
    done = ok("record", "eye::camera", place("film.mp4"), "-n", "2", path=empty)
    assert "no encoder (ffmpeg) is installed" in done.stderr and len(os.listdir(place("film.mp4.frames"))) == 2, done.stderr
    # An encoder that notes what it is asked for, and one that fails.
    tools = place("tools")
    os.mkdir(tools)
    with open(f"{tools}/ffmpeg", "w") as script:
        script.write('#!/bin/sh\nfor last; do :; done\necho "$@" > "$last"\n')
    os.chmod(f"{tools}/ffmpeg", 0o755)
    ok("record", "eye::camera", place("50%made.mp4"), "-n", "4", path=f"{tools}:{os.environ['PATH']}")
    asked = open(place("50%made.mp4")).read()
    os.mkdir(place("again.mp4.frames"))
    open(place("again.mp4.frames/note"), "w").close()
    ok("record", "eye::camera", place("again.mp4"), "-n", "2", path=f"{tools}:{os.environ['PATH']}")
    assert os.listdir(place("again.mp4.frames")) == ["note"], "only its own frames are its to remove"
    assert "-nostdin" in asked and "-framerate" in asked and "/50%%made.mp4.frames/frame-%06d.png" in asked, asked
    assert not os.path.exists(place("50%made.mp4.frames")), asked
    with open(f"{tools}/ffmpeg", "w") as script:
        script.write("#!/bin/sh\nexit 1\n")
    refused("record", "eye::camera", place("bad.mp4"), "-n", "2", path=f"{tools}:{os.environ['PATH']}", says="could not write")
    assert len(os.listdir(place("bad.mp4.frames"))) == 2


with open(place("world.sdf"), "w") as file:
    file.write(world)
log = open(place("log"), "w+")
server = subprocess.Popen([f"{bin_dir}/sim-server", place("world.sdf"), "-s", server_id, "--paused"], stdout=subprocess.DEVNULL, stderr=log)
try:
    end = time.monotonic() + watchdog
    while simctl("list").returncode != 0:
        assert server.poll() is None and time.monotonic() < end, open(place("log")).read()
        time.sleep(0.02)
    screenshots()
    bad_screenshots()
    records()
    assert server.poll() is None
finally:
    server.terminate()
    server.wait(watchdog)
assert "error" not in open(place("log")).read(), open(place("log")).read()
left = [name for name in os.listdir("/dev/shm") if f"-{server_id}." in name]
assert not left, left
