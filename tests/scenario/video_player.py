# VideoPlayer on a display of its own (Xvfb): video_player.py CASE BIN_DIR LIB_DIR. Frames come through its real port; what the screen shows is compared with them.
import json
import os
import random
import signal
import subprocess
import sys

import pixels
from system import System

case, bin_dir, lib_dir = sys.argv[1:]
system = System(bin_dir, lib_dir)
environment = {}


def start_display():
    read, write = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "800x600x24", "-nolisten", "tcp", "-noreset"], pass_fds=[write], stderr=subprocess.DEVNULL)
    server.log_file = os.devnull
    system.running.append(server)
    os.close(write)
    with os.fdopen(read) as answer:
        environment["DISPLAY"] = ":" + answer.readline().strip()
    assert environment["DISPLAY"] != ":", "Xvfb does not start"


def start_player(record_dir="", others=(), **more):
    system.naming()
    host = system.start(f"{bin_dir}/rtcd", "-o", f"corba.nameservers:{system.names}", "-o", f"manager.modules.load_path:{lib_dir}", "-o", "manager.shutdown_auto:NO", "VideoPlayer", "FrameSource", *others,
                        **{"DISPLAY": "", "WAYLAND_DISPLAY": "", **environment, **more})
    system.rtse("wait", "VideoPlayer0", "FrameSource0", "--state", "any", "--timeout", "60")
    system.rtse("con", "FrameSource0:image", "VideoPlayer0:image")
    if record_dir:
        system.rtse("conf", "VideoPlayer0", "set", "record_dir", record_dir)
    system.rtse("act", "VideoPlayer0", "FrameSource0")
    return host


def screen(*words, ok=True, player="VideoPlayer0"):
    done = subprocess.run([f"{bin_dir}/x11_window", player, *words], env={**os.environ, **environment}, capture_output=True, text=True, timeout=60)
    assert not ok or done.returncode == 0, f"{words}: {done.returncode} {done.stderr}"
    return done.stdout.strip() if ok else done.returncode


def shot():
    path = f"{system.work}/shot.ppm"
    screen("shot", path)
    return pixels.ppm(path)


def send(width, height, octets, format="RGB8", bits=24):
    path = f"{system.work}/{len(os.listdir(system.work))}.frame"
    with open(path, "wb") as file:
        file.write(f"{width} {height} {bits} {format}\n".encode() + octets)
    system.rtse("conf", "FrameSource0", "set", "frame", path)


def noise(count, seed):
    return random.Random(seed).randbytes(count)


def shows(width, height, rgb):
    def is_there():
        got = shot()
        assert got[:2] == (width, height), got[:2]
        return got[2] == rgb

    system.until(f"a picture of {width}x{height} on the screen", is_there)


def state():
    return json.loads(system.rtse("--json", "cat", "VideoPlayer0"))["state"]


def says(host, *words):
    system.until(f"a line with {words}", lambda: any(all(word in line for word in words) for line in system.log(host).splitlines()))


# Each format and size as it comes, while the player runs.
def formats():
    start_display()
    start_player()
    system.until("a window", lambda: screen("size"))
    rgb = noise(64 * 48 * 3, 1)
    send(64, 48, rgb)
    shows(64, 48, rgb)
    swapped = bytearray(rgb)
    swapped[0::3], swapped[2::3] = rgb[2::3], rgb[0::3]
    send(48, 64, swapped, "BGR8")
    shows(48, 64, rgb)
    grey = noise(40 * 30, 2)
    send(40, 30, grey, "MONO8", 8)
    shows(40, 30, bytes(v for g in grey for v in (g, g, g)))
    send(20, 30, noise(20 * 30 * 2, 3), "MONO16", 16)
    shows(20, 30, bytes(v for g in noise(20 * 30 * 2, 3)[1::2] for v in (g, g, g)))
    four = noise(50 * 20 * 4, 4)
    send(50, 20, four, "RGBA8", 32)
    shows(50, 20, bytes(v for i in range(0, len(four), 4) for v in four[i : i + 3]))
    mosaic = bytes((200 if x % 2 == 0 else 120) if y % 2 == 0 else (120 if x % 2 == 0 else 40) for y in range(30) for x in range(30))
    send(30, 30, mosaic, "BAYER_RGGB8", 8)
    shows(30, 30, bytes((200, 120, 40)) * 900)
    # Larger than the screen: as much as fits, the same shape.
    send(1600, 3, noise(1600 * 3 * 3, 5))
    system.until("a window that fits the screen", lambda: screen("size").split()[0] == "800")
    send(64, 48, rgb)
    shows(64, 48, rgb)
    system.until("a title", lambda: all(word in screen("title") for word in ("64x48", "frames/s", "t = ", "dropped 0")))


def keys():
    start_display()
    host = start_player(f"{system.work}/frames")
    first, second, third = (noise(32 * 24 * 3, seed) for seed in (1, 2, 3))
    send(32, 24, first)
    shows(32, 24, first)
    screen("key", "space")
    system.until("a title that says so", lambda: "paused" in screen("title"))
    send(32, 24, second)
    shows(32, 24, first)
    screen("key", "s")
    saved = f"{system.work}/frames/picture-000001.png"
    system.until("a saved picture", lambda: pixels.png(saved) == (32, 24, first))
    assert not os.path.exists(f"{system.work}/frames/frame-000002.png"), "records while it pauses"
    screen("key", "space")
    system.until("a title that says so", lambda: "paused" not in screen("title"))
    send(32, 24, third)
    shows(32, 24, third)
    system.until("the next number", lambda: pixels.png(f"{system.work}/frames/frame-000002.png") == (32, 24, third))
    screen("key", "q")
    system.until("no window", lambda: screen("size", ok=False) == 3)
    assert state() == "Active", "it still records"
    send(32, 24, second)
    system.until("a recorded frame", lambda: pixels.png(f"{system.work}/frames/frame-000003.png") == (32, 24, second))
    system.rtse("deact", "VideoPlayer0")
    says(host, "3 frames shown", "0 rejected, 1 passed while it paused")
    system.rtse("conf", "VideoPlayer0", "set", "record_dir", "")
    # Nothing to do without window and records: each way to close the window ends it, and it can start again.
    for close in (("key", "q"), ("key", "Escape"), ("close",)):
        system.rtse("act", "VideoPlayer0")
        system.until("a window", lambda: screen("size"))
        send(32, 24, first)
        shows(32, 24, first)
        screen(*close)
        system.until("no window", lambda: screen("size", ok=False) == 3)
        system.until("a component that has ended", lambda: state() == "Inactive")
    assert host.poll() is None


def resize():
    start_display()
    start_player()
    rgb = noise(60 * 40 * 3, 1)
    send(60, 40, rgb)
    shows(60, 40, rgb)
    screen("resize", "120", "80")
    rows = [rgb[180 * y : 180 * (y + 1)] for y in range(40)]
    doubled = b"".join(2 * b"".join(2 * row[i : i + 3] for i in range(0, 180, 3)) for row in rows)
    shows(120, 80, doubled)
    # Another shape: the picture in the middle, black beside it.
    screen("resize", "200", "80")
    wide = b"".join(bytes(3 * 40) + doubled[360 * y : 360 * (y + 1)] + bytes(3 * 40) for y in range(80))
    shows(200, 80, wide)
    # The next frame of that size keeps what the user chose.
    send(60, 40, bytes(60 * 40 * 3))
    shows(200, 80, bytes(200 * 80 * 3))


def bad_images():
    start_display()
    host = start_player()
    rgb = noise(32 * 24 * 3, 1)
    send(32, 24, rgb)
    shows(32, 24, rgb)
    send(32, 24, rgb[:-1])
    says(host, "32x24", "2304 bytes, got 2303")
    send(0, 0, b"")
    says(host, "0x0", "cannot be shown")
    send(65535, 65535, b"")
    says(host, "65535x65535", "cannot be shown")
    send(32, 24, rgb, "YUV422", 16)
    says(host, "YUV422", "not known, expected RGB8")
    send(8, 8, noise(100, 2), "JPEG")
    says(host, "not a JPEG image")
    send(32, 24, rgb[:6], "DEPTH32F", 32)
    says(host, "DEPTH32F", "3072 bytes, got 6")
    assert state() == "Active"
    shows(32, 24, rgb)
    send(24, 32, rgb)
    shows(24, 32, rgb)
    system.rtse("deact", "VideoPlayer0")
    says(host, "2 frames shown", "6 rejected")


def no_display():
    frames = f"{system.work}/frames"
    host = start_player(frames)
    says(host, "no window: there is no display", frames)
    rgb = noise(32 * 24 * 3, 1)
    for number in (1, 2, 3):
        send(32, 24, rgb)
        system.until("a frame", lambda: os.path.exists(f"{frames}/frame-00000{number}.png") and pixels.png(f"{frames}/frame-00000{number}.png") == (32, 24, rgb))
    with open(f"{frames}/times.txt") as file:
        assert [line.split()[0] for line in file] == [f"frame-00000{n}.png" for n in (1, 2, 3)]
    system.rtse("deact", "VideoPlayer0")
    system.rtse("conf", "VideoPlayer0", "set", "record_dir", "")
    system.rtse("act", "VideoPlayer0")
    says(host, "no window: there is no display", "set record_dir")


def wrong_display():
    host = start_player(DISPLAY=":29999")
    says(host, "no window: the display cannot be used")
    assert state() == "Active"


# The X server dies: the frames go on into the folder; a player without one ends; the process lives.
def killed_display():
    start_display()
    frames = f"{system.work}/frames"
    host = start_player(frames, others=["VideoPlayer"])
    first, second = noise(32 * 24 * 3, 1), noise(32 * 24 * 3, 2)
    send(32, 24, first)
    shows(32, 24, first)
    system.rtse("act", "VideoPlayer1")  # its window lies over the other
    system.until("a second window", lambda: screen("title", player="VideoPlayer1"))
    display = next(process for process in system.running if process.args[0] == "Xvfb")
    system.running.remove(display)
    display.kill()
    display.wait()
    says(host, "VideoPlayer0", "the display is lost; the frames go to", frames)
    says(host, "VideoPlayer1", "the display is lost; set record_dir")
    system.until("the player without a folder has ended", lambda: json.loads(system.rtse("--json", "cat", "VideoPlayer1"))["state"] == "Inactive")
    send(32, 24, second)
    system.until("a recorded frame", lambda: pixels.png(f"{frames}/frame-000002.png") == (32, 24, second))
    assert state() == "Active"
    system.rtse("deact", "VideoPlayer0")
    system.rtse("act", "VideoPlayer0")
    says(host, "no window: the display of this process is lost; the frames go to")
    system.rtse("exit", "VideoPlayer1")
    assert host.poll() is None
    host.terminate()
    assert host.wait(60) == 0, host.returncode


# What one activation recorded or saved stays; the next ones go on behind it, each sequence with its own numbers and without gaps.
def kept_records():
    start_display()
    frames = f"{system.work}/frames"
    start_player(frames)
    pictures = [noise(32 * 24 * 3, seed) for seed in range(5)]
    is_file = lambda name, rgb: system.until(name, lambda: pixels.png(f"{frames}/{name}") == (32, 24, rgb))
    send(32, 24, pictures[0])
    is_file("frame-000001.png", pictures[0])
    screen("key", "s")
    is_file("picture-000001.png", pictures[0])
    send(32, 24, pictures[1])
    is_file("frame-000002.png", pictures[1])
    system.rtse("deact", "VideoPlayer0")
    system.rtse("act", "VideoPlayer0")
    system.until("a window", lambda: screen("size"))
    send(32, 24, pictures[2])
    is_file("frame-000003.png", pictures[2])
    shows(32, 24, pictures[2])
    screen("key", "s")
    is_file("picture-000002.png", pictures[2])
    # Another folder while it is active; the first one again later.
    system.rtse("conf", "VideoPlayer0", "set", "record_dir", f"{frames}/more")
    system.until("the other folder", lambda: os.path.exists(f"{frames}/more/times.txt"))
    send(32, 24, pictures[3])
    is_file("more/frame-000001.png", pictures[3])
    system.rtse("deact", "VideoPlayer0")
    system.rtse("conf", "VideoPlayer0", "set", "record_dir", frames)
    system.rtse("act", "VideoPlayer0")
    system.until("a window", lambda: screen("size"))
    send(32, 24, pictures[4])
    is_file("frame-000004.png", pictures[4])
    for number in (0, 1, 2):
        is_file(f"frame-00000{number + 1}.png", pictures[number])
    is_file("picture-000001.png", pictures[0])
    with open(f"{frames}/times.txt") as file:
        assert [line.split()[0] for line in file] == [f"frame-00000{n}.png" for n in (1, 2, 3, 4)]


# Frames that come faster than they can be written: they are dropped and counted; keys, configuration and the end go on working.
def slow_recording():
    start_display()
    frames = f"{system.work}/frames"
    host = start_player(frames)
    send(1600, 1200, noise(1600 * 1200 * 3, 1))
    system.rtse("conf", "FrameSource0", "set", "repeat", "1")
    system.until("recorded frames", lambda: os.path.exists(f"{frames}/frame-000005.png"))
    system.until("a title with dropped frames", lambda: int(screen("title").split("dropped ")[1].split()[0]) > 0)
    screen("key", "space")
    system.until("a title that says so", lambda: "paused" in screen("title"))
    at = screen("title").split("t = ")[1].split()[0]
    system.until("no frames in the title", lambda: " 0.0 frames/s" in screen("title"))
    assert screen("title").split("t = ")[1].split()[0] == at, "the time of the picture that is shown"
    screen("key", "space")
    system.until("a title that says so", lambda: "paused" not in screen("title"))
    system.rtse("conf", "VideoPlayer0", "set", "record_dir", f"{frames}/more")
    system.until("the other folder", lambda: os.path.exists(f"{frames}/more/frame-000001.png"))
    system.rtse("deact", "VideoPlayer0")
    says(host, "frames shown", "dropped", "0 rejected")
    assert state() == "Inactive"


# An X server that is stopped holds the component up for a while, not for ever; when it goes on so do the windows. A process ends without it.
def stopped_display():
    start_display()
    host = start_player()
    display = next(process for process in system.running if process.args[0] == "Xvfb")
    first, second = noise(32 * 24 * 3, 1), noise(32 * 24 * 3, 2)
    send(32, 24, first)
    shows(32, 24, first)
    display.send_signal(signal.SIGSTOP)
    system.rtse("deact", "VideoPlayer0")
    says(host, "the window: the display does not answer")
    system.until("an inactive player", lambda: state() == "Inactive")
    system.rtse("act", "VideoPlayer0")
    says(host, "no window: the display does not answer; set record_dir")
    assert state() == "Active"
    system.rtse("deact", "VideoPlayer0")
    display.send_signal(signal.SIGCONT)
    system.until("no window", lambda: screen("size", ok=False) == 3)

    def has_window():
        system.rtse("deact", "VideoPlayer0")
        system.rtse("act", "VideoPlayer0")
        return "no window" not in system.log(host).splitlines()[-1] and system.until("a window", lambda: screen("size"))

    system.until("a window again", has_window)
    send(32, 24, second)
    shows(32, 24, second)
    display.send_signal(signal.SIGSTOP)
    host.terminate()
    assert host.wait(60) == 0, host.returncode
    assert system.log(host).count("the window: the display does not answer") == 2, system.log(host)


# Players in one process share the display; what is typed reaches the one that is typed to.
def two_players():
    start_display()
    start_player(others=["VideoPlayer"])
    title = lambda number: screen("title", player=f"VideoPlayer{number}")
    system.rtse("act", "VideoPlayer1")
    system.until("a second window", lambda: title(1))
    screen("key", "space", player="VideoPlayer1")
    system.until("a title that says so", lambda: "paused" in title(1))
    assert "paused" not in title(0), title(0)
    screen("key", "q", player="VideoPlayer1")
    system.until("one window less", lambda: screen("size", ok=False, player="VideoPlayer1") == 3)
    rgb = noise(16 * 16 * 3, 1)
    send(16, 16, rgb)
    shows(16, 16, rgb)
    assert state() == "Active"
    # The last one closes, and another display's thread begins with the next.
    screen("close")
    system.until("no window", lambda: screen("size", ok=False) == 3)
    system.rtse("act", "VideoPlayer1")
    system.until("a window", lambda: title(1))


cases = {f.__name__: f for f in (formats, keys, resize, bad_images, two_players, no_display, wrong_display, killed_display, kept_records, slow_recording, stopped_display)}
with system:
    cases[case]()
print("ok")
