# Frames on their way from the simulator to programs, with readers that are slow, stopped or killed, and simulators that are killed and started anew: cameras.py CASE
# BIN_DIR LIB_DIR. The camera's noise depends on nothing but the time, so the frames of one time are the same for everybody, byte by byte, in every run: a torn one is not.
import json
import os
import signal
import struct
import subprocess
import sys
import zlib

import pixels
from system import System, is_stopped

case, bin_dir, lib_dir = sys.argv[1:]
system = System(bin_dir, lib_dir)
world = f"{system.work}/w.sdf"
camera = "<camera><image><width>160</width><height>120</height></image><noise><type>gaussian</type><stddev>0.1</stddev></noise></camera>"
with open(world, "w") as file:
    file.write(f"""<sdf version='1.9'><world name='w'><physics type='ode'><max_step_size>0.01</max_step_size></physics>
<model name='wall'><static>true</static><pose>3 0 0 0 0 0</pose><link name='l'><visual name='v'><geometry><box><size>0.2 2 1</size></box></geometry></visual></link></model>
<model name='robot'><static>true</static><link name='l'>
<sensor name='eye' type='camera'><update_rate>20</update_rate>{camera}</sensor>
<sensor name='other' type='camera'><update_rate>20</update_rate>{camera}</sensor></link></model></world></sdf>""")


class Reader:
    def __init__(self, *options, name="robot::eye"):
        self.process = system.start(f"{bin_dir}/camera_reader", system.server_id, "camera", name, *options, input=subprocess.PIPE)
        system.until("a reader", lambda: self.says("looks"))

    def lines(self):
        return system.log(self.process).split("\n")[:-1]

    def says(self, word):
        return word in self.lines()

    # Sequence, time [ns], crc, resets, dropped; those after the last word `since`.
    def frames(self, since="looks"):
        lines = self.lines()
        begin = len(lines) - lines[::-1].index(since)
        return [list(map(int, line.split()[1:])) for line in lines[begin:] if line.startswith("frame ")]

    def more(self, count, since="looks"):
        before = len(self.frames(since))
        system.until(f"{count} more frames", lambda: len(self.frames(since)) >= before + count)

    def kill(self):
        self.process.kill()
        self.process.wait()

    def end(self):
        self.process.stdin.close()
        assert self.process.wait(60) == 0


def gaps(frames):
    return sum(b[0] - a[0] - 1 for a, b in zip(frames, frames[1:]))


def agree(one, other, least):
    """Frames of the same time are equal; how many both have seen."""
    mine, others = {f[1]: f[2] for f in one}, {f[1]: f[2] for f in other}
    common = mine.keys() & others.keys()
    assert len(common) >= least, f"only {len(common)} frames of the same time"
    assert len({mine[t] for t in common}) == len(common), "two frames are equal: the noise does not tell them apart"
    differ = [t for t in common if mine[t] != others[t]]
    assert not differ, f"frames of the same time differ: {differ}"


def listed(name="robot::eye"):
    return next(one for one in json.loads(system.simctl("--json", "list")) if one["name"] == name)


# A reader that keeps every frame it can for long. Time goes on, the others get what is left, drops are counted, and what it holds stays whole.
def slow_reader():
    system.server(world)
    fast, slow = Reader(), Reader("4", "500")
    slow.more(8)
    system.until("dropped frames", lambda: fast.frames()[-1][4] > 0)
    before = system.seconds()
    fast.more(10)
    assert system.seconds() > before, "time stands still"
    assert not slow.says("torn") and not fast.says("torn")
    agree(fast.frames(), slow.frames(), 4)
    # Killed while it holds all slots: they are free again, and every frame comes.
    slow.kill()
    system.until("a lease taken back", lambda: listed()["subscribers"] == 1)
    dropped = fast.frames()[-1][4]
    fast.more(20)
    last = fast.frames()[-20:]
    assert last[-1][4] - dropped <= 1, "frames are still dropped"
    fast.end()


def work_of_cameras(server):
    """Clock ticks that all threads but the first have worked."""
    ticks = 0
    for task in os.listdir(f"/proc/{server.pid}/task"):
        if int(task) != server.pid:
            with open(f"/proc/{server.pid}/task/{task}/stat") as file:
                ticks += sum(map(int, file.read().rsplit(")", 1)[1].split()[11:13]))
    return ticks


# Nobody looks: nothing is drawn, there is no thread for it. Killed readers count as nobody.
def only_for_readers():
    server = system.server(world)
    threads = lambda: sum(open(f"/proc/{server.pid}/task/{task}/comm").read().strip() == "sim-server" for task in os.listdir(f"/proc/{server.pid}/task"))
    alone = threads()
    at = system.seconds()
    system.until("a second", lambda: system.seconds() > at + 1)
    assert threads() == alone and listed()["sequence"] == 0 and listed("robot::other")["sequence"] == 0
    reader = Reader()
    reader.more(3)
    # Mesa's threads bear our name until they have run once, which those of least priority do late on a busy machine.
    system.until("a camera that is looked through to have a thread of its own", lambda: threads() == alone + 1)
    second = Reader(name="robot::other")
    second.more(3)
    system.until("the second camera to have one too", lambda: threads() == alone + 2)
    second.end()
    reader.kill()
    system.until("leases taken back", lambda: listed()["subscribers"] == 0 and listed("robot::other")["subscribers"] == 0)

    # What was begun is drawn to its end, late on a busy machine, since the threads have the least priority.
    def rests():
        before = listed()["sequence"], work_of_cameras(server)
        at = system.seconds()
        system.until("a second", lambda: system.seconds() > at + 1)
        return before == (listed()["sequence"], work_of_cameras(server))

    system.until("cameras that draw nothing for dead readers", rests)
    third = Reader()
    third.more(3)
    third.end()


# Killed and ended simulators: readers find the next one by themselves; frames of the same time are the same in each.
def restarted_server():
    reader, runs = None, []
    for stop in (signal.SIGKILL, signal.SIGTERM, None):
        server = system.server(world)
        reader = reader or Reader()
        since = "back" if runs else "looks"
        system.until("frames", lambda: reader.lines().count("back") == len(runs) and len(reader.frames(since)) > 15)
        runs.append(reader.frames(since))
        if stop:
            server.send_signal(stop)
            server.wait()
            system.until("a reader that says so", lambda: reader.lines().count("gone") == len(runs))
    for run in runs:
        assert run[0][0] <= 2, f"sequence starts at {run[0][0]}"
    agree(runs[0], runs[1], 1)
    agree(runs[0], runs[2], 1)
    assert not reader.says("torn")
    reader.end()


def start_system(*players):
    system.naming()
    rtcd = [f"{bin_dir}/rtcd", "-o", f"corba.nameservers:{system.names}", "-o", f"manager.modules.load_path:{lib_dir}", "-o", "manager.shutdown_auto:NO"]
    hosts = [system.start(*rtcd, f"RTCCamera?conf.default.server_id={system.server_id}&conf.default.device_id=robot::eye")]
    for name in players:
        hosts.append(system.start(*rtcd, f"VideoPlayer?instance_name={name}&conf.default.window=0&conf.default.record_dir={system.work}/{name}"))
    system.rtse("wait", "RTCCamera0", *players, "--state", "any", "--timeout", "60")
    return hosts


def recorded(player):
    """Simulated times [ns] and crcs of the frames that a player has written."""
    frames = []
    with open(f"{system.work}/{player}/times.txt") as file:
        for line in file.read().split("\n")[:-1]:
            name, time = line.split()
            seconds, nanoseconds = time.split(".")
            frames.append([0, int(seconds) * 10**9 + int(nanoseconds), zlib.crc32(pixels.png(f"{system.work}/{player}/{name}")[2])])
    return frames


def recorded_count(player):
    with open(f"{system.work}/{player}/times.txt") as file:
        return file.read().count("\n")


def more_recorded(player, count):
    before = recorded_count(player)
    system.until(f"{count} more frames of {player}", lambda: recorded_count(player) >= before + count)


def numbers_of(host, word):
    line = [line for line in system.log(host).splitlines() if word in line][-1]
    return [int(w) for w in line.replace(",", "").split() if w.isdigit()]


# A player that is stopped for a while: every frame is accounted for, and none is torn.
def stopped_player():
    system.server(world)
    reader = Reader()
    camera, player = start_system("player0")
    system.rtse("con", "RTCCamera0:image", "player0:image", "-p", "dataport.subscription_type=flush")
    system.rtse("act", "player0", "RTCCamera0")
    more_recorded("player0", 10)
    player.send_signal(signal.SIGSTOP)
    system.until("a player that stands", lambda: is_stopped(player))
    reader.more(6)  # 0.3 s: less than the time-out of a call
    player.send_signal(signal.SIGCONT)
    more_recorded("player0", 10)
    system.rtse("deact", "RTCCamera0")
    system.rtse("deact", "player0")
    system.until("its last words", lambda: "frames shown" in system.log(player) and "frames sent" in system.log(camera))
    sent, missed = numbers_of(camera, "frames sent")[-2:]
    shown, dropped, refused = numbers_of(player, "frames shown")[-3:]
    assert missed >= 3 or dropped >= 3, f"missed {missed}, dropped {dropped}: a player that stood for six frames"
    assert refused == 0 and shown + dropped == sent, f"sent {sent}, shown {shown}, dropped {dropped}"
    frames = recorded("player0")
    assert len(frames) == shown and [f[1] for f in frames] == sorted(f[1] for f in frames)
    agree(reader.frames(), frames, 15)
    reader.end()


# Two players, one of them killed; then the simulator. Who is left goes on; who is started anew joins in.
def killed_player_and_server():
    server = system.server(world)
    camera, one, two = start_system("player0", "player1")
    for player in ("player0", "player1"):
        system.rtse("con", f"RTCCamera0:image", f"{player}:image", "-p", "dataport.subscription_type=new")
    system.rtse("act", "player0", "player1", "RTCCamera0")
    more_recorded("player0", 5)
    more_recorded("player1", 5)
    two.kill()
    two.wait()
    more_recorded("player0", 20)
    os.rename(f"{system.work}/player1", f"{system.work}/before")
    rtcd = [f"{bin_dir}/rtcd", "-o", f"corba.nameservers:{system.names}", "-o", f"manager.modules.load_path:{lib_dir}", "-o", "manager.shutdown_auto:NO"]
    system.start(*rtcd, f"VideoPlayer?instance_name=player1&conf.default.window=0&conf.default.record_dir={system.work}/player1")
    system.until("a player started anew", lambda: json.loads(system.rtse("--json", "cat", "player1"))["state"] == "Inactive")
    system.rtse("con", "RTCCamera0:image", "player1:image", "-p", "dataport.subscription_type=new")
    system.rtse("act", "player1")
    more_recorded("player1", 5)
    server.kill()
    server.wait()
    system.until("a camera that says so", lambda: "is lost" in system.log(camera))
    system.server(world)
    more_recorded("player0", 10)
    more_recorded("player1", 10)
    assert "is there again" in system.log(camera) and system.log(camera).count("is lost") == 1
    # The second run repeats the first.
    frames = recorded("player0")
    restart = next(i for i in range(1, len(frames)) if frames[i][1] < frames[i - 1][1])
    agree(frames[:restart], frames[restart:], 1)
    system.rtse("deact", "RTCCamera0", "player0", "player1")
    numbers = lambda: numbers_of(one, "frames shown")
    system.until("its last words", lambda: "frames shown" in system.log(one))
    assert numbers()[-1] == 0, f"refused frames: {numbers()}"


# Pictures as long as the largest cameras take, from one host to another without any setting: a port that takes images lets them in.
def large_frames():
    sizes = {"hd": (1920, 1080), "uhd": (3840, 2160)}
    eyes = "".join(f"<sensor name='{name}' type='camera'><update_rate>5</update_rate><camera><image><width>{w}</width><height>{h}</height></image></camera></sensor>"
                   for name, (w, h) in sizes.items())
    with open(world, "w") as file:
        file.write(f"<sdf version='1.9'><world name='w'><model name='robot'><static>true</static><link name='l'>{eyes}</link></model></world></sdf>")
    system.server(world)
    system.naming()
    patience = ("-o", "corba.call_timeout:60")  # of a machine that does much else; nothing is said of sizes
    system.rtcd(*patience, *(f"RTCCamera?instance_name={name}&conf.default.server_id={system.server_id}&conf.default.device_id=robot::{name}" for name in sizes))
    system.rtcd(*patience, *(f"VideoPlayer?instance_name=of_{name}&conf.default.window=0&conf.default.record_dir={system.work}/of_{name}" for name in sizes))
    system.rtse("wait", *sizes, *(f"of_{name}" for name in sizes), "--state", "any", "--timeout", "60")
    for name, size in sizes.items():
        system.rtse("con", f"{name}:image", f"of_{name}:image", "-p", "dataport.interface_type=corba_cdr", "-p", "dataport.subscription_type=flush")
        system.rtse("act", name, f"of_{name}")
        more_recorded(f"of_{name}", 2)
        system.rtse("deact", name)
        with open(f"{system.work}/of_{name}/times.txt") as times, open(f"{system.work}/of_{name}/" + times.readline().split()[0], "rb") as picture:
            assert struct.unpack(">II", picture.read(24)[16:]) == size, name


# simctl record writes every format as a PNG that anybody can look at.
def recorded_formats():
    names = ("R8G8B8", "B8G8R8", "RGBA_INT8", "BGRA_INT8", "L8", "L16", "BAYER_RGGB8", "BAYER_BGGR8", "BAYER_GBRG8", "BAYER_GRBG8")
    eyes = "".join(f"<sensor name='{name}' type='camera'><camera><image><width>20</width><height>12</height><format>{name}</format></image></camera></sensor>" for name in names)
    with open(world, "w") as file:
        file.write(f"""<sdf version='1.9'><world name='w'><model name='wall'><static>true</static><pose>3 0 0 0 0 0</pose><link name='l'><visual name='v'>
<geometry><box><size>0.2 40 40</size></box></geometry><material><lighting>false</lighting><diffuse>0 0 0 1</diffuse><emissive>1 0.502 0 1</emissive></material></visual></link></model>
<model name='robot'><static>true</static><link name='l'>{eyes}</link></model></world></sdf>""")
    system.server(world)
    for name in names:
        system.simctl("record", f"robot::{name}", f"{system.work}/{name}", "--count", "1")
        picture = f"{system.work}/{name}/frame-000001.png"
        if name == "L16":  # luminance at full depth, in whatever order PNG has
            luminance = ((19595 * 255 + 38470 * 128) * 257 + 32768) >> 16
            assert luminance % 256 not in (0, 151), "its octets must differ"
            assert pixels.png(picture, 1, bits=16) == (20, 12, luminance.to_bytes(2, "big") * 240), pixels.png(picture, 1, bits=16)[2][:12]
            continue
        pixel = (151,) if name == "L8" else (255, 128, 0, 255) if "A_INT8" in name else (255, 128, 0)
        width, height, octets = pixels.png(picture, len(pixel))
        assert (width, height, octets) == (20, 12, bytes(pixel) * 240), f"{name}: {octets[:12]}"


# A simulator that dies before all is recorded: what came is kept, and the line and the exit status say that it is not all.
def recorded_end():
    server = system.server(world)
    frames = f"{system.work}/frames"
    words = [f"{bin_dir}/simctl", "-s", system.server_id, "record", "robot::eye", frames, "-n", "100000"]
    recorder = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        system.until("frames", lambda: os.path.exists(f"{frames}/frame-000003.png"))
        server.kill()
        server.wait()
        out, err = recorder.communicate(timeout=60)
    finally:
        recorder.kill()
        recorder.wait()
    assert recorder.returncode == 1 and "the simulator has exited after" in err and "frames, " in out, f"{recorder.returncode} {out} {err}"
    system.simctl("clean")


cases = {f.__name__: f for f in (slow_reader, only_for_readers, restarted_server, stopped_player, killed_player_and_server, large_frames, recorded_formats, recorded_end)}
with system:
    cases[case]()
print("ok")
