# Files of meshes and pictures that are damaged, hostile, or read again and again, one case per run: server_meshes.py CASE BIN_DIR SOURCE_DIR.
import contextlib
import os
import pathlib
import shutil
import signal
import subprocess
import threading
import time

from server_rig import *

folder = pathlib.Path(work.name)
damaged = sorted(pathlib.Path(f"{source}/tests/worlds/damaged_meshes").iterdir())
crate = f"{source}/tests/worlds/models/crate/meshes/crate.dae"
reasons = ("is damaged: its reader ended with", "is damaged: its header", "is damaged: mesh", "is damaged: a face", "is damaged: a triangle", "processor time to read", "is too large for the memory", "was not read")


def model(mesh, name="m", texture=None):
    material = f"<material><pbr><metal><albedo_map>{texture}</albedo_map></metal></pbr></material>" if texture else ""
    shape = f"<geometry><mesh><uri>{mesh}</uri></mesh></geometry>"
    return f"<model name='{name}'><link name='l'><collision name='c'>{shape}</collision><visual name='v'>{shape}{material}</visual></link></model>"


def world(*models):
    path = folder / f"{len(list(folder.iterdir()))}.sdf"
    path.write_text(f"<sdf version='1.9'><world name='w'>{''.join(models)}</world></sdf>")
    return str(path)


def spawned(mesh, name, texture=None):
    return simctl("spawn", f"<sdf version='1.9'>{model(mesh, name, texture)}</sdf>")


def log_of(process):
    return open(process.log.name).read()


def readers(process):
    children = []
    for task in os.listdir(f"/proc/{process.pid}/task"):
        try:
            children += open(f"/proc/{process.pid}/task/{task}/children").read().split()
        except FileNotFoundError:
            pass  # the thread has ended
    return [int(pid) for pid in children]


def descriptors(process):
    return len(os.listdir(f"/proc/{process.pid}/fd"))


def is_running(pid):
    try:
        return open(f"/proc/{pid}/stat").read().rsplit(")", 1)[1].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


def steps():
    return read("stats")["steps"]


# Each damaged file costs one line, although collision and image both miss it; the rest of the world is there.
def damaged_in_a_world():
    for mesh in damaged:
        done = subprocess.run([f"{bin_dir}/sim-server", "--check", "-s", server_id, world(model(mesh))], capture_output=True, text=True, timeout=watchdog)
        lines = done.stderr.strip().splitlines()
        assert done.returncode == 1 and len(lines) == 1, f"{mesh}: exit {done.returncode}, {lines}"
        assert all(str(mesh) in line and any(reason in line for reason in reasons) for line in lines), lines


# A running simulator survives them all, and leaves no process and no descriptor behind.
def damaged_and_spawned():
    process = started()
    assert spawned(crate, "first").returncode == 0
    before = descriptors(process)
    for round in range(2):
        for i, mesh in enumerate(damaged):
            done = spawned(mesh, f"bad{round}{i}")
            assert done.returncode == 0, f"{mesh}: {done.stderr}"
            assert f"collision l::c: mesh {mesh}: " in log_of(process), log_of(process)
    assert len(readers(process)) <= 1 and descriptors(process) <= before, (readers(process), before, descriptors(process))
    assert spawned(crate, "last").returncode == 0 and "crate.dae" not in log_of(process)
    stop(process)


# Steps are made and other clients are served while the files of a model are read.
def time_goes_on_while_a_model_is_read():
    process = started()
    assert spawned(crate, "first").returncode == 0
    before = steps()
    begun = time.monotonic()
    results = []
    thread = threading.Thread(target=lambda: results.append(spawned(next(m for m in damaged if m.name == "endless.dae"), "slow")))
    thread.start()
    served = 0
    while not results:
        ok("list")
        served += 1
    thread.join()
    made, took = steps() - before, time.monotonic() - begun
    print(f"{made} steps and {served} requests in {took:.1f} s")
    assert results[0].returncode == 0 and made > 100 and served > 1, (results[0].stderr, made, served)
    # As the files are known, it is read at once the next time.
    assert spawned(crate, "second").returncode == 0
    stop(process)


# In lock step a model comes at the step at which it was asked for, however long its files take.
def lock_step_waits_for_a_model():
    process = started("-u", "--lockstep")
    hashes = []
    for _ in range(2):
        ok("step", "100")
        assert spawned(crate, "crate").returncode == 0
        ok("step", "300")
        hashes.append(state())
        ok("reset")
    assert hashes[0] == hashes[1], hashes
    stop(process)
    # A reader that is held makes the model late, and time stands meanwhile.
    process = started("--lockstep")
    assert spawned(crate, "first").returncode == 0
    reader, = readers(process)
    os.kill(reader, signal.SIGSTOP)
    copy = folder / "copy.dae"
    shutil.copy(crate, copy)
    results = []
    thread = threading.Thread(target=lambda: results.append(spawned(copy, "late")))
    thread.start()
    await_("time to stand", lambda: steps() == (time.sleep(0.3), steps())[1])
    at = steps()
    ok("list")
    os.kill(reader, signal.SIGCONT)
    thread.join()
    assert results[0].returncode == 0, results[0].stderr
    await_("time to go on", lambda: steps() > at)
    stop(process)


# kill -9 of the reader, idle or at work, costs nothing but a new one.
def reader_is_killed():
    process = started()
    assert spawned(crate, "first").returncode == 0
    for i in range(5):
        copy = folder / f"copy{i}.dae"
        shutil.copy(crate, copy)
        reader, = readers(process)
        os.kill(reader, signal.SIGKILL if i % 2 else signal.SIGSTOP)
        results = []
        thread = threading.Thread(target=lambda: results.append(spawned(copy, f"m{i}")))
        thread.start()
        if i % 2 == 0:  # in the middle of a request
            time.sleep(0.2)
            os.kill(reader, signal.SIGKILL)
        thread.join()
        assert results[0].returncode == 0 and "copy" not in log_of(process), (results[0].stderr, log_of(process))
        assert reader not in readers(process) and len(readers(process)) == 1
    stop(process)


# However the simulator ends, its reader ends, also in the middle of a file.
def reader_ends_with_its_server():
    for with_signal in (signal.SIGTERM, signal.SIGKILL):
        process = started()
        assert spawned(crate, "first").returncode == 0
        reader, = readers(process)
        thread = threading.Thread(target=lambda: spawned(next(m for m in damaged if m.name == "endless.dae"), "slow"))
        thread.start()
        time.sleep(0.5)
        process.send_signal(with_signal)
        process.wait(watchdog)
        await_("the reader to end", lambda: not is_running(reader))
        thread.join()
        simctl("clean")
    process = started()
    assert spawned(crate, "first").returncode == 0
    reader, = readers(process)
    process.kill()
    process.wait(watchdog)
    await_("the idle reader to end", lambda: not is_running(reader))
    simctl("clean")


# Only a world that has meshes or pictures has a reader.
def primitives_need_no_reader():
    process = started()
    assert readers(process) == []
    stop(process)


# Pipes, devices and pseudo-files are not read, by whatever link.
def special_files():
    os.mkfifo(folder / "pipe.dae")
    (folder / "zero.stl").symlink_to("/dev/zero")
    (folder / "kmsg.obj").symlink_to("/proc/kmsg")
    (folder / "status.ply").symlink_to("/proc/self/status")
    os.mkfifo(folder / "pipe.png")
    (folder / "kmsg.png").symlink_to("/proc/kmsg")
    process = started()
    for name in ("pipe.dae", "zero.stl", "kmsg.obj", "status.ply"):
        done = spawned(folder / name, name)
        assert done.returncode == 0 and name in log_of(process), (name, done.stderr, log_of(process))
    assert spawned(crate, "crate").returncode == 0 and "crate.dae" not in log_of(process)
    stop(process)
    for name in ("pipe.png", "kmsg.png"):
        done = subprocess.run([f"{bin_dir}/sim-server", "--check", "-s", server_id, world(model(crate, texture=folder / name))], capture_output=True, text=True, timeout=watchdog)
        assert done.returncode in (0, 1) and done.stderr.strip(), (name, done.stderr)


# What is unchanged is read once; a file that has changed is read again, and what is there keeps its shape.
def changed_file_is_read_again():
    def box(size):
        corners = [(x, y, z) for x in (0, size) for y in (0, size) for z in (0, size)]
        faces = ["1 2 4", "1 4 3", "5 7 8", "5 8 6", "1 5 6", "1 6 2", "3 4 8", "3 8 7", "1 3 7", "1 7 5", "2 6 8", "2 8 4"]
        return "".join(f"v {x} {y} {z}\n" for x, y, z in corners) + "".join(f"f {face}\n" for face in faces)

    def read_bytes(pid):
        return int(dict(line.split(": ") for line in open(f"/proc/{pid}/io").read().splitlines())["rchar"])

    process = started("-u", world=world("<model name='floor'><static>1</static><link name='l'><collision name='c'><geometry><box><size>9 9 0.2</size></box></geometry></collision></link></model>"))
    mesh = folder / "box.obj"
    mesh.write_text(box(0.5))
    await_("the file to be older than the clock of files is coarse", lambda: time.time() - mesh.stat().st_ctime > 0.1)
    assert spawned(mesh, "a").returncode == 0
    reader, = readers(process)
    before = read_bytes(reader)
    for name in ("b", "c", "d"):
        assert spawned(mesh, name).returncode == 0
    assert read_bytes(reader) == before, "an unchanged file is read again"
    # The same content in another file is the same mesh: it is read, and nothing is made of it again.
    mesh.write_text(box(0.5))
    assert spawned(mesh, "e").returncode == 0
    def seen(name):
        ok("screenshot", str(folder / name), "--top", "--span", "6", "--size", "120x120")
        return (folder / name).read_bytes()

    small, before = seen("small.png"), read_bytes(reader)
    mesh.write_text(box(1.5))
    for name in ("a", "b", "c", "d", "e"):
        ok("delete", name)
    assert spawned(mesh, "a").returncode == 0 and read_bytes(reader) > before
    assert seen("big.png") != small, "the changed mesh is not shown"
    stop(process)


def eye_world():
    shutil.copytree(os.path.dirname(os.path.dirname(crate)), folder / "seen", dirs_exist_ok=True)
    seen = next((folder / "seen").rglob("crate.dae"))
    camera = "<camera><image><width>64</width><height>48</height></image></camera>"
    return world(model(crate, "solid"), f"<model name='seen'><static>1</static><pose>3 0 0 0 0 0</pose><link name='l'><visual name='v'><geometry><mesh><uri>{seen}</uri></mesh></geometry></visual></link></model>",
                 f"<model name='robot'><static>1</static><link name='l'><sensor name='eye' type='camera'><update_rate>20</update_rate>{camera}</sensor></link></model>")


class Eye:
    def __init__(self):
        self.log = open(folder / f"eye{len(running)}.log", "w")
        self.process = subprocess.Popen([f"{bin_dir}/camera_reader", server_id, "camera", "robot::eye"], stdin=subprocess.PIPE, stdout=self.log, stderr=self.log)
        running.append(self.process)
        await_("a subscriber", lambda: "looks\n" in open(self.log.name).read())

    # Time [ns] and checksum.
    def frames(self):
        return [tuple(line.split()[2:4]) for line in open(self.log.name).read().split("\n")[:-1] if line.startswith("frame ")]

    def end(self):
        self.process.stdin.close()
        assert self.process.wait(watchdog) == 0


# The first picture has its files read beside the simulation, whoever asks for it: steps are made and clients are served meanwhile.
def first_picture_is_read_beside_the_simulation():
    path = eye_world()
    for look in ("screenshot", "export", "camera"):
        process = started(world=path)
        reader, = readers(process)
        os.kill(reader, signal.SIGSTOP)
        results = []
        file = folder / (look + (".png" if look == "screenshot" else ".glb"))
        eye = Eye() if look == "camera" else None
        thread = threading.Thread(target=lambda: results.append(simctl(look, str(file)) if eye is None else None))
        thread.start()
        if eye:
            thread.join()
        before = steps()
        await_("further steps", lambda: steps() > before + 200)
        assert eye or not results, f"{look}: is there before its files"
        assert not (eye and eye.frames()), "a picture is there before its files"
        os.kill(reader, signal.SIGCONT)
        thread.join()
        if eye:
            await_("a picture", lambda: len(eye.frames()) > 2)
            eye.end()
        else:
            assert results[0].returncode == 0 and file.stat().st_size > 0, results[0].stderr
        assert "stands in" not in log_of(process), log_of(process)
        stop(process)


# In lock step time waits for the files of the first picture: pictures do not depend on how fast they are read.
def lock_step_waits_for_the_first_picture():
    path = eye_world()
    seen = []
    for is_held in (False, True):
        process = started("-u", "--lockstep", world=path)
        reader, = readers(process)
        if is_held:
            os.kill(reader, signal.SIGSTOP)
        eye = Eye()
        if is_held:
            time.sleep(0.5)  # for what would happen without the files
            os.kill(reader, signal.SIGCONT)
        ok("step", "1")
        await_("the first picture", eye.frames)
        ok("step", "499")
        await_("the last picture", lambda: eye.frames()[-1][0] == "500000000")
        seen.append(dict(eye.frames()))  # a slow subscriber misses some in between
        eye.end()
        stop(process)
    common = seen[0].keys() & seen[1].keys()
    assert {"0", "500000000"} <= common and all(seen[0][at] == seen[1][at] for at in common), seen


# However long the first picture takes, the simulator ends at once.
def simulator_ends_while_its_first_picture_is_read():
    slow = next(m for m in damaged if m.name == "endless.dae")
    path = world(model(crate, "solid"), f"<model name='seen'><link name='l'><visual name='v'><geometry><mesh><uri>{slow}</uri></mesh></geometry></visual></link></model>")
    for options in ((), ("--lockstep",)):
        process = started(*options, world=path)
        reader, = readers(process)
        os.kill(reader, signal.SIGSTOP)
        thread = threading.Thread(target=lambda: simctl("screenshot", str(folder / "never.png")))
        thread.start()
        time.sleep(0.3)  # for the request to arrive
        stop(process)
        thread.join()
        with contextlib.suppress(ProcessLookupError):
            os.kill(reader, signal.SIGKILL)  # it was stopped


# A file with another extension than the name that it is asked for by, as version control keeps large files: the name says the format.
def mesh_behind_a_link_to_another_name():
    store = folder / "store"
    store.mkdir()
    shutil.copy(crate, store / "0123abcd")
    (folder / "linked").mkdir()
    (folder / "linked/box.dae").symlink_to("../store/0123abcd")
    process = started()
    assert spawned(folder / "linked/box.dae", "linked").returncode == 0
    assert "mesh" not in log_of(process), log_of(process)
    stop(process)


# A world cannot have a library loaded, another file's text taken in, or a file written, by whatever it names.
def worlds_are_data():
    library = folder / "libplugin.so"
    shutil.copy(f"{bin_dir}/../lib/librtmsim_base.so", library)
    secret, never = folder / "secret.txt", folder / "never.png"
    secret.write_text("open sesame")
    path = folder / "data.sdf"
    path.write_text(f"""<?xml version='1.0'?><!DOCTYPE sdf [<!ENTITY secret SYSTEM "file://{secret}"><!ENTITY a "{'x' * 1000}"><!ENTITY b "{'&a;' * 1000}"><!ENTITY c "{'&b;' * 1000}">]>
<sdf version='1.9' xmlns:xi='http://www.w3.org/2001/XInclude'><world name='w'><plugin filename='{library}' name='w::W'/><plugin filename='libplugin.so' name='W'/>
<xi:include href='{secret}' parse='text'/><include><uri>file://{secret}</uri></include><gui><plugin filename='{library}' name='g'/></gui>
<model name='m&secret;'><plugin filename='{library}' name='m::M'><save>{never}</save></plugin><link name='l&c;'><collision name='c'><geometry><box><size>1 1 1</size></box></geometry></collision>
<sensor name='eye' type='camera'><always_on>1</always_on><camera><save enabled='true'><path>{folder}/saved</path></save><image><width>8</width><height>8</height></image></camera>
<plugin filename='{library}' name='s'/></sensor></link></model></world></sdf>""")
    before = sorted(folder.iterdir())
    process = started(world=str(path))
    ok("step", "200")
    assert simctl("spawn", f"<sdf version='1.9'><model name='n'><plugin filename='{library}' name='n'/><link name='l'/></model></sdf>").returncode == 0
    assert "libplugin" not in open(f"/proc/{process.pid}/maps").read(), "a library of the world is loaded"
    assert "sesame" not in ok("tree") + log_of(process), "the world has another file's text"
    stop(process)
    new = set(folder.iterdir()) - set(before)
    assert all(one.suffix == ".log" for one in new), new


# What the simulator writes about files and models of others controls no terminal, also if it comes out of a mesh.
def names_control_no_terminal():
    name = "evil\u009b31m\u202e"
    (folder / f"{name}.ply").write_text("no mesh")
    (folder / "t.obj").write_text("mtllib t.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nusemtl m\nf 1/1 2/2 3/3\n")
    (folder / "t.mtl").write_text(f"newmtl m\nmap_Kd {name}.png\n")
    path = world(model(f"{name}.ply", name), model("t.obj", "t"))
    terminal, line = os.openpty()
    os.set_blocking(terminal, False)
    done = subprocess.Popen([f"{bin_dir}/sim-server", "-v", "3", "--check", "-s", server_id, path], stdout=line, stderr=line)
    written = b""

    def is_over():
        nonlocal written
        try:
            written += os.read(terminal, 65536)
            return False
        except BlockingIOError:
            return done.poll() is not None

    await_("the end of the check", is_over)
    process = started("-v", "3", world=path)
    ok("screenshot", str(folder / "picture.png"))
    assert spawned(folder / f"{name}.ply", name).returncode == 0
    stop(process)
    for text in (written, open(process.log.name, "rb").read()):
        assert b".ply" in text and b"m\\xe2\\x80\\xae.png" in text, text
        assert not any(bad in text for bad in (b"\x1b", b"\xc2\x9b", "\u202e".encode())), text


run(damaged_in_a_world, damaged_and_spawned, time_goes_on_while_a_model_is_read, lock_step_waits_for_a_model, reader_is_killed, reader_ends_with_its_server,
    primitives_need_no_reader, special_files, changed_file_is_read_again, first_picture_is_read_beside_the_simulation, lock_step_waits_for_the_first_picture,
    simulator_ends_while_its_first_picture_is_read, mesh_behind_a_link_to_another_name, worlds_are_data,
    names_control_no_terminal)
