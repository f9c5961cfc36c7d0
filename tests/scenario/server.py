# sim-server and simctl as processes, one case per run: server.py CASE BIN_DIR SOURCE_DIR. Each run has a server id of its own.
import json
import mmap
import os
import random
import re
import signal
import struct
import subprocess
import sys
import tempfile
import time

import server_ids

case, bin_dir, source = sys.argv[1:]
server_id = server_ids.claim()
course = f"{source}/worlds/obstacle_course.sdf"
robot = "pioneer2dx"
work = tempfile.TemporaryDirectory()
running = []
watchdog = 60  # [s]; a bound on hanging, not on speed


def server(*options, world=course):
    log = open(f"{work.name}/{len(running)}.log", "w+")
    process = subprocess.Popen([f"{bin_dir}/sim-server", world, "-s", server_id, *options], stdout=subprocess.PIPE, stderr=log, text=True)
    process.log = log
    running.append(process)
    return process


def client(*words):
    running.append(subprocess.Popen([f"{bin_dir}/simctl", "-s", server_id, *words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))
    return running[-1]


def simctl(*words):
    return subprocess.run([f"{bin_dir}/simctl", "-s", server_id, *words], capture_output=True, text=True, timeout=watchdog)


def ok(*words):
    done = simctl(*words)
    assert done.returncode == 0, f"{words}: {done.stderr}"
    return done.stdout


def read(*words):
    return json.loads(ok("--json", *words))


def refused(*words, code=1, says=""):
    done = simctl(*words)
    lines = done.stderr.strip().splitlines()
    assert done.returncode == code and len(lines) == 1 and says in lines[0], f"{words}: exit {done.returncode}, {done.stderr!r}"


def await_(what, ready):
    end = time.monotonic() + watchdog
    while not ready():
        assert time.monotonic() < end, f"{what}: not within {watchdog} s"
        time.sleep(0.02)


def is_there(process):
    assert process.poll() is None, f"the server ended with {process.returncode}: {open(process.log.name).read()}"
    return simctl("--json", "stats").returncode == 0


def started(*options, **more):
    process = server(*options, **more)
    await_("server", lambda: is_there(process))
    return process


def segments():
    return [name for name in os.listdir("/dev/shm") if name.startswith(f"rtmsim-{os.getuid()}-{server_id}.")]


def position(model):
    return read("pose", model)["position"]


def near(got, wanted, tolerance=1e-6):
    assert all(abs(a - b) <= tolerance for a, b in zip(got, wanted, strict=True)), f"expected {wanted}, got {got}"


def stop(process, with_signal=signal.SIGTERM):
    process.send_signal(with_signal)
    assert process.wait(watchdog) == 0, process.returncode
    assert not segments(), segments()


def final_hash(*options, **more):
    out, _ = server("--rtf", "0", "--duration", "2", "--hash", *options, **more).communicate(timeout=watchdog)
    assert running[-1].returncode == 0
    return out.strip()


def state():
    return read("stats")["hash"]


def requests():
    process = started("-u")
    assert read("step", "5")["steps"] == 5
    ok("pose", robot, "1", "0.5", "0.3")
    near(position(robot)[:2], (1, 0.5))
    assert abs(read("pose", robot)["yaw"] - 0.3) < 1e-6
    ok("run")
    before = read("stats")["sim_time"]
    await_("running time", lambda: read("stats")["sim_time"] > before)
    ok("pause")
    paused_at = read("stats")["sim_time"]
    assert read("stats")["sim_time"] == paused_at
    near([read("step", "3")["sim_time"] - paused_at], [3 * read("info", "simulation:world")["step"]], 1e-9)
    ok("reset")
    assert read("stats")["sim_time"] == 0
    start = position(robot)

    box = "<sdf version='1.9'><model name='crate'><link name='l'><collision name='c'><geometry><box><size>.3 .3 .3</size></box></geometry></collision></link></model></sdf>"
    assert read("spawn", box, "--name", "crate", "--pose", "-1", "-1", "0.15", "0")["name"] == "crate"
    near(position("crate"), (-1, -1, 0.15))
    assert read("spawn", "sick_lms200", "--pose", "0", "0", "3", "0")["name"] == "sick_lms200"  # by its name alone
    ok("delete", "sick_lms200")
    refused("spawn", box, "--name", "crate", says="crate")
    assert read("spawn", box)["name"] == "crate_1"  # nobody asked for the name of the file
    ok("delete", "crate_1")
    refused("spawn", box, "--name", "x" * 300, says="at most 200 bytes")
    ok("delete", "crate")
    refused("pose", "crate", says="crate")
    near(position(robot), start)
    drive = client("velocity", f"{robot}::position2d", "0.3", "0", "0")
    ok("run")
    await_("a driving robot", lambda: read("stats")["sim_time"] > 1 and position(robot)[0] != start[0])
    drive.send_signal(signal.SIGKILL)
    drive.wait()
    await_("a robot without commander that stands", lambda: abs(read("echo", f"{robot}::position2d", "-n", "1")["velocity"][0]) < 0.01)
    stop(process)


def motion():
    process = started("-u")
    ok("step", "1500")  # until it rests
    step = read("info", "simulation:world")["step"]
    ok("velocity", robot, "0.1", "-0.2", "0")
    near(read("velocity", robot)["linear"], (0.1, -0.2, 0))
    ok("velocity", robot, "0", "0", "0.5", "0", "0", "0.4")
    near(read("velocity", robot)["linear"], (0, 0, 0.5))
    near(read("velocity", robot)["angular"], (0, 0, 0.4))
    assert "0.4" in ok("velocity", f"{robot}::chassis")
    ok("reset", "--poses")
    near(read("velocity", robot)["linear"] + read("velocity", robot)["angular"], [0] * 6)
    near([read("stats")["steps"]], [1500])  # time goes on

    # In the air: what a force does in a time; gravity does the rest.
    box = ("<sdf version='1.9'><model name='crate'><link name='l'><inertial><mass>2</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>"
           "<collision name='c'><geometry><box><size>.3 .3 .3</size></box></geometry></collision></link></model></sdf>")
    ok("spawn", box, "--name", "crate", "--pose", "0", "0", "50", "0")
    ok("wrench", "crate", "4", "0", "0", "0", "0", "3", "--for", "0.1")
    ok("step", "200")
    velocity = read("velocity", "crate")
    near(velocity["linear"], (4 / 2 * 0.1, 0, -9.8 * 200 * step), 1e-3)
    near(velocity["angular"], (0, 0, 3 * 0.1), 1e-3)
    ok("wrench", "crate::l", "0", "6", "0")
    ok("step")
    near(read("velocity", "crate")["linear"][1:2], [6 / 2 * step], 1e-4)

    ok("odometry", f"{robot}::position2d", "3", "2", "0.5")
    near(read("echo", f"{robot}::position2d", "-n", "1")["odometry"], (3, 2, 0.5), 1e-3)
    ok("motors", f"{robot}::position2d", "off")
    assert not read("echo", f"{robot}::position2d", "-n", "1")["motors_enabled"]
    ok("motors", f"{robot}::position2d", "on")
    ok("rtf", "4")
    assert read("stats")["rtf_wanted"] == 4
    for words in (["wrench", "nobody", "1", "0", "0"], ["wrench", "wall_north", "1", "0", "0"], ["wrench", "crate", "nan", "0", "0"], ["velocity", "nobody"],
                  ["velocity", "crate", "1e308", "nan", "0"], ["odometry", f"{robot}::laser"], ["motors", "nobody", "on"], ["drop", "nobody"]):
        refused(*words)
    refused("wrench", "crate", "1", "0", "0", "4", code=2)
    refused("motors", f"{robot}::position2d", "perhaps", code=2)
    refused("rtf", "-1", code=2)
    stop(process)


# Faults come and go by command, the same each time, and are those that the server's option names.
def faults():
    laser, drive = f"{robot}::laser", f"{robot}::position2d"

    def ahead():
        return read("echo", laser, "-n", "1")["ranges"][90]

    process = started("-u")
    assert ok("fault") == "no faults\n" and read("fault")["faults"] == []
    ok("step", "10")
    free = ahead()
    ok("fault", laser, "bias", "-1", "--for", "2")
    ok("fault", drive, "weak")
    both = [{key: one[key] for key in ("iface", "kind", "amount", "on")} for one in read("fault")["faults"]]
    assert sorted(both, key=lambda one: one["kind"]) == [{"iface": laser, "kind": "bias", "amount": -1.0, "on": True},
                                                         {"iface": drive, "kind": "weak", "amount": 0.5, "on": True}], both
    assert [one["kind"] for one in read("fault", laser)["faults"]] == ["bias"]
    assert re.search(rf"{laser} +bias +-1 +0\.0\d+ +2\.0\d+\n", ok("fault", laser)), ok("fault", laser)
    near([ahead()], [free - 1], 0.2)
    assert read("fault", laser, "--end")["ended"] == 1 and read("fault", laser, "--end")["ended"] == 0
    near([ahead()], [free], 0.2)
    assert read("fault", "--end")["ended"] == 1 and read("fault")["faults"] == []

    states = []
    for _ in range(2):
        ok("reset")
        ok("fault", drive, "halted")
        ok("fault", laser, "noise", "0.3")
        ok("step", "300")
        ok("fault", laser, "noise", "--end")
        ok("step", "300")
        states.append((state(), [one["kind"] for one in read("fault")["faults"]]))
    assert states[0] == states[1] and states[0][1] == ["halted"], states
    before = state()
    for words, says in [(["nobody", "off"], "no iface nobody"), ([laser, "weak"], "it is no position2d"), ([drive, "missing"], "only lasers and sonars have beams"),
                        (["nobody", "--end"], "no iface nobody"), (["nobody"], "no iface nobody")]:
        refused("fault", *words, says=says)
    for words, says in [([laser, "odd"], "odd"), ([laser, "dropout", "2"], "must be from 0 to 1, got 2"), ([laser, "bias", "nan"], "expected a number"),
                        ([laser, "off", "1"], "has none"), ([laser, "--for", "1"], "goes with IFACE KIND"), ([laser, "off", "--for", "-1"], "-1")]:
        refused("fault", *words, code=2, says=says)
    assert state() == before
    stop(process)

    process = started("-u", "--fault", f"bias:0:1:-1:{laser}", "--fault", f"off:5:0::{drive}")
    kinds = [(one["kind"], one["on"], one["until"]) for one in read("fault")["faults"]]
    assert sorted(kinds) == [("bias", True, 1.0), ("off", False, None)], kinds
    assert "to come" in ok("fault", drive)
    assert read("fault", "--end")["ended"] == 2
    ok("reset")
    assert len(read("fault")["faults"]) == 2  # as at the start
    stop(process)
    refused_start = subprocess.run([f"{bin_dir}/sim-server", course, "--fault", "dropout:0:0:2:x"], capture_output=True, text=True)
    assert refused_start.returncode == 2 and "must be from 0 to 1, got 2" in refused_start.stderr, refused_start


def bad_requests():
    process = started("-u")
    before = state()
    for words in (["pose", "nobody"], ["pose", "nobody", "1", "2", "0"], ["delete", "nobody"], ["contacts", "nobody"], ["echo", "nobody"],
                  ["info", "nobody"], ["velocity", "nobody", "1", "0", "0"], ["pose", robot, "nan", "0", "0"], ["pose", robot, "inf", "0", "0"],
                  ["velocity", f"{robot}::position2d", "nan", "0", "0"], ["spawn", "<sdf version='1.9'><model"], ["spawn", "/no/such/file.sdf"],
                  ["velocity", f"{robot}::position2d", "1e308", "0", "0"], ["pose", robot, "1e9", "0", "0"],
                  ["spawn", "<sdf version='1.9'><model name='m'><pose>nan 0 0 0 0 0</pose><link name='l'/></model></sdf>"]):
        refused(*words)
    refused("screenshot", f"{work.name}/x.png", "--from", "1 2 3", code=2, says="expected 6 numbers")
    refused("spawn", course, "--pose", "1 2", code=2, says="expected X Y YAW")
    refused("pose", robot, "1", code=2)
    refused("step", "-1", code=2)
    refused("step", "many", code=2)
    refused("velocity", robot, "1", code=2)
    refused("rtf", "nan", code=2)
    refused("echo", f"{robot}::position2d", "-n", "-1", code=2, says="-1")
    seeded = subprocess.run([f"{bin_dir}/sim-server", course, "--seed", "-1"], capture_output=True, text=True)
    assert seeded.returncode == 2 and len(seeded.stderr.splitlines()) == 1 and "not negative, got -1" in seeded.stderr, seeded
    refused("screenshot", f"{work.name}/x.png", "--size", "0x0", code=2)
    refused("nosuch", code=2, says='unknown command "nosuch"')
    nobody = subprocess.run([f"{bin_dir}/simctl", "-s", "999", "--json", "list"], capture_output=True, text=True)  # tests have ids from 1000 on
    assert nobody.returncode == 1 and json.loads(nobody.stdout) == [], nobody
    assert state() == before, "a refused request changed the world"
    stop(process)


# Boxes that fall over each other in several places: resting robots would be equal too easily.
def heaps():
    shape = "<geometry><box><size>.3 .3 .3</size></box></geometry>"
    models = "".join(
        f"<model name='b{i}'><pose>{6 * (i % 4) + 0.03 * i} {0.02 * i} {0.4 + 0.35 * (i // 4)} 0.{i} 0.2 0</pose>"
        f"<link name='l'><collision name='c'>{shape}</collision></link></model>" for i in range(24))
    ground = "<model name='g'><static>true</static><link name='l'><collision name='c'><geometry><plane/></geometry></collision></link></model>"
    file_name = f"{work.name}/heaps.sdf"
    with open(file_name, "w") as file:
        file.write(f"<sdf version='1.9'><world name='heaps'>{ground}{models}</world></sdf>")
    return file_name


def same_state():
    world = heaps()
    first = final_hash("--threads", "1", world=world)
    assert len(first) == 16 and first != "0" * 16, first
    assert final_hash("--threads", "1", world=world) == first
    assert final_hash("--threads", "2", world=world) == first, "the state depends on the number of threads"
    process = started("-u", world=world)
    ok("step", "200")
    once = state()
    ok("reset")
    ok("step", "200")
    assert state() == once, "the state differs after a reset"
    stop(process)


# What is looked at while time stands still is there, and the run goes on as if nobody had looked; also with noise, which the laser has.
def looked_at_while_paused():
    for options in (["-u"], ["-u", "--lockstep"], ["--lockstep", "--wait-for", "1"]):
        hashes = []
        for is_looked_at in (False, True):
            process = started(*options)
            is_listened_to = False

            def look(ifaces=("laser", "sonar", "position2d", "laser")):
                samples = [read("echo", f"{robot}::{iface}", "-n", "1") for iface in ifaces] if is_looked_at else []
                now = read("stats")["sim_time"]
                # A laser that somebody listens to keeps to its own times, ten a second: a further scan would reach the listener too.
                for iface, sample in zip(ifaces, samples):
                    allowed = 0.1 if iface == "laser" and is_listened_to else 1e-9
                    assert abs(sample["stamp"]["sim_time"] - now) < allowed, (iface, sample["stamp"], now)
                return samples

            first = look()
            if "--wait-for" in options:
                stop(process)
                continue
            # Somebody listens all the time, in both runs.
            listener = client("echo", f"{robot}::laser")
            await_("a listener", lambda: read("stats")["subscribed"] == 1)
            is_listened_to = True
            ok("step", "1050")
            look()
            ok("pose", robot, "1", "0.5", "0.3")
            moved = look(["position2d"])
            if is_looked_at:
                near(moved[0]["true_pose"]["position"][:2], (1, 0.5), 1e-3)
                assert first[0]["ranges"] == first[3]["ranges"], "looking twice gives two results"
            ok("step", "1050")
            hashes.append(state())
            listener.terminate()
            stop(process)
        assert len(set(hashes)) <= 1, f"{options}: {hashes}"


# A look at any device while time stands still: the run goes on as if nobody had looked.
def looked_at_each_device():
    world = f"{source}/tests/worlds/every_device.sdf"

    def hash_after_a_look(iface=None):
        process = started("-u", world=world)
        names = [f"{one['type']}:{one['name']}" for one in read("list") if one["type"] != "simulation"]
        if iface:
            read("echo", iface, "-n", "1")
        ok("step", "10")
        hashed = state()
        stop(process)
        return hashed, names

    undisturbed, names = hash_after_a_look()
    changed = [name for name in names if hash_after_a_look(name)[0] != undisturbed]
    assert len(names) >= 15 and not changed, f"looking changes the run: {changed} of {names}"


# Names of infos and samples are those of the page on shared memory, for every type.
def shows_every_type():
    with open(f"{source}/docs/shared-memory.md") as file:
        rows = re.findall(r"^\| `(\w+)` \| (.*) \| (.*) \|$", file.read().split("## What `simctl` shows")[1].split("\n## ")[0], re.M)

    def names(cell):
        return re.findall(r"`(\w+)`", cell.split("; of each")[0])

    process = started(world=f"{source}/tests/worlds/every_device.sdf")
    ifaces = {one["type"]: one["name"] for one in read("list")}
    assert ifaces.keys() == {row[0] for row in rows}, (ifaces, rows)
    for kind, info, sample in rows:
        iface = f"{kind}:{ifaces[kind]}"
        assert list(read("info", iface)) == ["type", "name", "server", *names(info)], (iface, read("info", iface))
        shown = read("echo", iface, "-n", "1")
        assert list(shown) == ["stamp", *names(sample)], (iface, shown)
        if kind in ("laser", "sonar"):
            assert len(shown["ranges"]) == (20 if kind == "laser" else 2), shown
    stop(process)


# The world as glTF: a node for each model and link, in their places, whose shapes are in the file; the same again after a spawn, one more.
def exports():
    process = started("-u")

    def exported(*options):
        file = f"{work.name}/world.glb"
        ok("export", file, *options)
        with open(file, "rb") as stream:
            octets = stream.read()
        magic, version, length, json_length, kind = struct.unpack("<4sIII4s", octets[:20])
        assert (magic, version, length, kind) == (b"glTF", 2, len(octets), b"JSON"), octets[:20]
        world = json.loads(octets[20 : 20 + json_length])
        binary = octets[28 + json_length :]
        assert world["buffers"][0]["byteLength"] <= len(binary)
        for view in world["bufferViews"]:
            assert view["byteOffset"] + view["byteLength"] <= len(binary), view
        return world

    def links(world):
        return [world["nodes"][i] for i in world["scenes"][0]["extras"]["links"]]

    world = exported()
    tree = {model["name"]: model for model in read("tree")["models"]}
    models = [n for n in world["nodes"] if n.get("extras", {}).get("model")]
    assert {m["name"] for m in models} == set(tree), tree.keys()
    assert [n["name"] for n in links(world)] == [f"{m}::{l['name']}" for m in (n["name"] for n in models) for l in tree[m]["links"]]
    place = next(n for n in links(world) if n["name"] == f"{robot}::chassis")["translation"]
    near(place, read("pose", f"{robot}::chassis")["position"], 1e-6)
    laser = next(n for n in world["nodes"] if n.get("name") == f"{robot}::laser")
    assert laser["extras"]["iface"] == f"{robot}::laser" and laser["extras"]["kind"] == "ray", laser
    shapes = [n for n in world["nodes"] if "mesh" in n]
    assert len(shapes) > 10 and all(n["mesh"] < len(world["meshes"]) for n in shapes)
    assert world["extensions"]["KHR_lights_punctual"]["lights"][0]["type"] == "directional"
    before = state()
    version = world["scenes"][0]["extras"]["version"]
    assert exported("--show", "collisions")["scenes"][0]["extras"]["version"] == version
    assert state() == before
    ok("spawn", "model://pioneer2dx", "--name", "another", "--pose", "3 3 0")
    more = exported()
    assert more["scenes"][0]["extras"]["version"] != version
    assert len(links(more)) > len(links(world)) and any(n["name"] == "another::chassis" for n in links(more))
    refused("export", f"{work.name}/world.obj", code=2, says=".glb")
    refused("export", f"{work.name}/nowhere/world.glb", says="cannot be written")
    stop(process)


# In a name space of its own with a /dev/shm and a disk of a few pages.
def no_room():
    small = f"{work.name}/small"
    os.mkdir(small)

    def alone(script):
        command = f"mount -t tmpfs -o size=64k tmpfs {small} && {script}"
        return subprocess.run(["unshare", "-m", "sh", "-c", command], capture_output=True, text=True, timeout=watchdog)

    if alone("true").returncode != 0:
        print("skipped: this user may not mount")
        sys.exit(77)
    run = f"{bin_dir}/sim-server {course} -s {server_id} --rtf 0"

    def ends(script, code, says):
        done = alone(f"{script}; echo code $? left $(ls -A /dev/shm)")
        lines = [line for line in done.stderr.splitlines() if line]
        assert done.stdout.strip() == f"code {code} left", (script, done.stdout, done.stderr)
        assert len(lines) == 1 and all(word in lines[0] for word in says), (script, lines)

    for size in ("16k", "64k", "200k", "400k"):  # the first iface does not fit, or one of the later ones
        ends(f"mount -t tmpfs -o size={size} tmpfs /dev/shm && {run} --duration 1", 1, ["no room for", "/dev/shm", "No space left"])
    ends(f"mount -t tmpfs -o ro tmpfs /dev/shm && {run} --duration 1", 1, ["/dev/shm", "Read-only"])
    ends(f"mount -t tmpfs tmpfs /dev/shm && {run} --duration 1000 --record {small}/record", 1, [f"record {small}/record", "No space left"])
    ends(f"mount -t tmpfs tmpfs /dev/shm && {run} --duration 1 --record /no/such/folder/record", 1, ["record /no/such/folder/record", "No such file"])
    # A model whose ifaces do not fit is refused, and the world goes on without it.
    model = f"{source}/worlds/models/pioneer2dx_hokuyo"
    script = f"""
mount -t tmpfs -o size=3m tmpfs /dev/shm
{run} -u & server=$!
until {bin_dir}/simctl -s {server_id} stats >/dev/null 2>&1; do sleep 0.05; done
before=$({bin_dir}/simctl -s {server_id} --json list)
head -c 100m /dev/zero > /dev/shm/filler 2>/dev/null
{bin_dir}/simctl -s {server_id} spawn {model} --name second --pose 1 1 0; echo spawn $?
[ "$before" = "$({bin_dir}/simctl -s {server_id} --json list)" ] && echo unchanged
{bin_dir}/simctl -s {server_id} step 10; echo step $?
rm /dev/shm/filler
{bin_dir}/simctl -s {server_id} screenshot {small}/picture.png --top --size 2000x2000; echo screenshot $?
ls -A {small}
kill $server; wait $server; echo ended $? $(ls -A /dev/shm)"""
    done = alone(script)
    wanted = ["spawn 1", "unchanged", "step 0", "screenshot 1", "ended 0"]
    assert [line.strip() for line in done.stdout.splitlines()] == wanted, (done.stdout, done.stderr)
    assert "no room for" in done.stderr and "picture.png" in done.stderr, done.stderr


# A client that has gone mad writes anything anywhere. The server goes on, or at least ends in order when it is told to.
def scribbled_over():
    seed = random.randrange(1 << 30)
    print("seed", seed)
    draw = random.Random(seed)
    for options in (["--rtf", "0"], ["--lockstep", "--rtf", "0"], ["-u"]):
        for _ in range(3):
            process = started(*options)
            clients = [client("echo", f"{robot}::laser"), client("velocity", f"{robot}::position2d", "0.2", "0", "0.1")]
            maps = []
            for name in segments():
                file = os.open(f"/dev/shm/{name}", os.O_RDWR)
                maps.append(mmap.mmap(file, 0))
                os.close(file)
            end = time.monotonic() + 1.5
            while time.monotonic() < end and process.poll() is None:
                for _ in range(200):
                    memory = draw.choice(maps)
                    size = draw.choice((1, 4, 8, 64, 4096))
                    at = draw.choice((0, draw.randrange(len(memory)), draw.randrange(min(len(memory), 8192)))) // 8 * 8
                    count = min(size, len(memory) - at)
                    what = draw.choice((draw.randbytes(count), bytes(count), b"\xff" * count, (1).to_bytes(4, "little") * (count // 4 + 1)))[:count]
                    memory[at:at + count] = what
            assert process.poll() is None, f"{options}: the server ended with {process.returncode}: {open(process.log.name).read()[-2000:]}"
            for memory in maps:
                memory.close()
            for one in clients:
                one.kill()
                one.wait()
            process.send_signal(signal.SIGTERM)
            assert process.wait(watchdog) == 0, process.returncode
            assert not segments(), segments()


# The server and two clients die at a random moment; the next server starts at once, with nothing cleaned up by hand.
def killed():
    seed = random.randrange(1 << 30)
    print("seed", seed)
    draw = random.Random(seed)
    for _ in range(int(os.environ.get("RTMSIM_KILLS", "20"))):
        process = started("--rtf", "0")
        clients = [client("echo", f"{robot}::position2d"), client("velocity", f"{robot}::position2d", "0.2", "0", "0.1")]
        time.sleep(draw.uniform(0, 0.1))  # the random moment
        victims = [process, *clients]
        draw.shuffle(victims)
        for victim in victims:
            victim.kill()
        for victim in victims:
            victim.wait()
    stop(started())


def living_server_is_refused():
    process = started()
    second = server()
    assert second.wait(watchdog) == 1
    second.log.seek(0)
    message = second.log.read()
    assert server_id in message and str(process.pid) in message, message
    assert is_there(process)
    stop(process)


def ends():
    for with_signal in (signal.SIGTERM, signal.SIGINT):
        stop(started(), with_signal)
        stop(started("-u"), with_signal)
    process = server("--rtf", "0", "--duration", "0.5", "--participant-timeout", "1")
    assert process.wait(watchdog) == 0
    process.log.seek(0)
    assert "--participant-timeout has no effect without --lockstep" in process.log.read()
    assert not segments(), segments()
    # A signal that means nothing is not the last one that is heard.
    process = started()
    process.send_signal(signal.SIGUSR2)
    time.sleep(0.1)
    stop(process)
    # Under nohup the end of the terminal is not the end.
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    process = started()
    signal.signal(signal.SIGHUP, before)
    process.send_signal(signal.SIGHUP)
    time.sleep(0.2)
    stop(process)
    stop(started(), signal.SIGHUP)


# Also while the world is still being read: these meshes take seconds.
def ends_while_it_loads():
    slow = f"{work.name}/slow"
    os.mkdir(slow)
    triangles = 200000
    with open(f"{slow}/big.obj", "w") as file:
        for i in range(triangles):
            file.write(f"v {i % 500} {i // 500} {i % 7}\n")
        for i in range(triangles - 501):
            file.write(f"f {i + 1} {i + 2} {i + 501}\n")
    world = f"{slow}/slow.sdf"
    meshes = "".join(f"<collision name='c{i}'><geometry><mesh><uri>big.obj</uri><scale>{i + 1} 1 1</scale></mesh></geometry></collision>" for i in range(20))
    with open(world, "w") as file:
        file.write(f"<sdf version='1.9'><world name='w'><model name='m'><static>true</static><link name='l'>{meshes}</link></model></world></sdf>")
    process = server(world=world)
    await_("its first iface", segments)
    process.send_signal(signal.SIGTERM)
    assert process.wait(watchdog) == 128 + signal.SIGTERM, process.returncode
    assert not segments(), segments()
    # Also while it makes its ifaces: none is left, and none comes behind the back of what removes them.
    shape = "<link name='l'><collision name='c'><geometry><box/></geometry></collision></link>"
    with open(world, "w") as file:
        models = "".join(f"<model name='m{i}'><pose>{2 * i} 0 1 0 0 0</pose>{shape}</model>" for i in range(4000))
        file.write(f"<sdf version='1.9'><world name='w'>{models}</world></sdf>")
    process = server("-u", world=world)
    await_("some of its ifaces", lambda: len(segments()) > 2000)
    process.send_signal(signal.SIGTERM)
    assert process.wait(watchdog) in (0, 128 + signal.SIGTERM), process.returncode
    assert not segments(), segments()


# A file of shared memory that somebody cuts short: said, and everything else goes on.
def cut_short():
    process = started()
    listener = client("echo", f"{robot}::laser")
    await_("a listener", lambda: read("stats")["subscribed"] == 1)
    os.truncate(f"/dev/shm/rtmsim-{os.getuid()}-{server_id}.laser.{robot}::laser", 0)
    await_("a line about it", lambda: "was cut short" in open(process.log.name).read())
    assert listener.wait(watchdog) == 1
    before = read("stats")["sim_time"]
    await_("running time", lambda: read("stats")["sim_time"] > before)
    near(read("echo", f"{robot}::position2d", "-n", "1")["odometry"], (0, 0, 0), 1e-3)
    stop(process)


def check():
    assert server("--check").wait(watchdog) == 0
    broken = f"{work.name}/broken.sdf"
    with open(broken, "w") as file:
        file.write("<sdf version='1.9'><world name='w'><include><uri>model://no_such_model</uri></include></world></sdf>")
    assert server("--check", world=broken).wait(watchdog) == 1
    # Files of pictures are read although nobody looks.
    with open(f"{work.name}/torn.dae", "w") as file:
        file.write("<COLLADA>")
    with open(broken, "w") as file:
        file.write(
            "<sdf version='1.9'><world name='w'><model name='m'><link name='l'><visual name='v'><geometry><mesh>"
            "<uri>torn.dae</uri></mesh></geometry></visual></link></model></world></sdf>"
        )
    assert server("--check", world=broken).wait(watchdog) == 1
    assert server("--check", world="/no/such/world.sdf").wait(watchdog) == 1
    assert server("--rtf", "-1").wait(watchdog) == 2
    assert not segments(), segments()
    drive = f"{work.name}/drive.sdf"
    with open(drive, "w") as file:
        file.write("<sdf version='1.9'><world name='w'><model name='m'><link name='l'/>"
                   "<plugin name='p' filename='gz-sim-diff-drive-system'><left_joint>no</left_joint><right_joint>no</right_joint></plugin></model></world></sdf>")
    looking = server("--check", world=drive)
    assert looking.wait(watchdog) == 1, "a drive was left out"
    said = open(looking.log.name).read().splitlines()
    assert len(said) == 1 and said[0].count("drive.sdf") == 1, said
    # Who only looks needs no server id of its own.
    process = started("-u")
    assert server("--check").wait(watchdog) == 0
    stop(process)


# What goes wrong in people's names is no reason to refuse their world.
def names():
    world = f"{work.name}/names.sdf"
    imu = "<sensor name='s' type='imu'/>"
    with open(world, "w") as file:
        file.write(f"<sdf version='1.9'><world name='w'><model name='a/b'><link name='x'>{imu}</link><link name='y'>{imu}</link></model>"
                   f"<model name='{'n' * 199}'><link name='l'>{imu}</link></model></world></sdf>")
    process = started("-u", world=world)
    there = {(one["type"], one["name"]) for one in read("list")}
    assert {("imu", "a_b::s"), ("imu", "a_b::s_1"), ("truth", "a_b"), ("truth", "n" * 199)} <= there, there
    tree = read("tree", "a_b")["models"][0]
    assert [link["sensors"][0]["iface"] for link in tree["links"]] == ["a_b::s", "a_b::s_1"], tree
    stop(process)
    assert server("--check", world=world).wait(watchdog) == 1, "a sensor was left out: its name does not fit after the model's"


# The factor that was asked for, by the stamps of the clock. Delays only ever make a stamp late, so the least delayed ones at both ends
# tell the rate on a loaded machine, too. And the warning when it cannot be kept.
def rate():
    for rtf in ("0.5", "3"):
        process = started("--rtf", rtf)

        def least_delayed(count):
            out = ok("--json", "echo", "simulation:world", "-n", str(count))
            stamps = [json.loads(line)["stamp"] for line in out.splitlines()]
            return max((s["sim_time"] - float(rtf) * s["wall_time"], s["sim_time"], s["wall_time"]) for s in stamps)[1:]

        def reached():
            sim_before, wall_before = least_delayed(200)
            time.sleep(9.5)  # what is measured
            sim_after, wall_after = least_delayed(200)
            return (sim_after - sim_before) / (wall_after - wall_before)

        # Time that a machine under load takes away for more than half a second is given up: then it counts again.
        tries = []
        while not tries or abs(tries[-1] / float(rtf) - 1) > 0.01:
            assert len(tries) < 4, f"{tries} times real time, {rtf} was asked for"
            tries.append(reached())
        stop(process)
    process = started("--rtf", "100000")
    await_("a warning", lambda: "100000 was asked for" in open(process.log.name).read())
    stop(process)


# The same as another account sees it, which may use the segments.
def as_stranger(*words):
    def become():
        os.setgroups([])
        os.setgid(65534)
        os.setuid(65534)

    return subprocess.run(words, capture_output=True, text=True, timeout=watchdog, preexec_fn=become, cwd="/")


# A server that others may use lends nobody its rights: it writes no file, and opens none outside of its model path.
def shared():
    with open(f"{work.name}/secret.sdf", "w") as file:
        file.write("<sdf version='1.9'><model name='secret'><link name='l'/></model></sdf>")
    inside = f"{work.name}/inside"
    os.makedirs(f"{inside}/open")
    os.symlink(f"{work.name}/secret.sdf", f"{inside}/link.sdf")
    with open(f"{inside}/open/model.config", "w") as file:
        file.write("<model><name>open</name><sdf>model.sdf</sdf></model>")
    with open(f"{inside}/open/model.sdf", "w") as file:
        file.write("<sdf version='1.9'><model name='open'><link name='l'/></model></sdf>")
    picture = f"{work.name}/picture.png"

    def asks(what, text):
        return subprocess.run([f"{bin_dir}/shm_helper", "ask-once", server_id, what, text], capture_output=True, text=True, timeout=watchdog).stdout

    process = started("-u", "--resource-path", inside)
    answer = asks("screenshot", picture)
    assert answer.startswith("0 ") and os.path.exists(picture), answer
    os.remove(picture)
    assert asks("spawn-path", f"{work.name}/secret.sdf").startswith("0 secret")
    stop(process)

    process = started("-u", "--resource-path", inside, "--shm-mode", "0666")
    answer = asks("screenshot", picture)
    assert answer.startswith("4 ") and "writes no files" in answer and not os.path.exists(picture), answer
    assert asks("screenshot", "").split() == ["0", "PNG"]
    for other in (f"{work.name}/secret.sdf", f"file://{work.name}/secret.sdf", "model://../secret.sdf", "model://open/../../secret.sdf", "model://link.sdf"):
        answer = asks("spawn-path", other)
        assert answer.startswith("1 ") and "is not found" in answer, (other, answer)
        answer = asks("spawn-text", f"<sdf version='1.9'><model name='m'><include><uri>{other}</uri></include></model></sdf>")
        assert "secret" not in ok("tree"), (other, answer)
        for name in ("m", "m_1", "m_2", "m_3", "m_4"):
            simctl("delete", name)
    assert asks("spawn-path", "model://open").startswith("0 open")
    # Our own tool hands over what its user may read, and writes what he may write.
    assert ok("spawn", f"{work.name}/secret.sdf").strip() == "secret"
    ok("screenshot", picture, "--size", "64x48")
    assert open(picture, "rb").read(4) == b"\x89PNG"
    refused("screenshot", f"{work.name}/no/such/x.png", says="no/such")
    if os.geteuid() == 0:
        with tempfile.TemporaryDirectory(dir="/tmp") as theirs:
            os.chown(theirs, 65534, 65534)
            done = as_stranger(f"{bin_dir}/simctl", "-s", server_id, "screenshot", f"{theirs}/x.png", "--size", "64x48")
            assert done.returncode == 0 and os.stat(f"{theirs}/x.png").st_uid == 65534, done.stderr
            os.chmod(work.name, 0o755)
            os.chmod(f"{work.name}/secret.sdf", 0o600)
            done = as_stranger(f"{bin_dir}/simctl", "-s", server_id, "spawn", f"{work.name}/secret.sdf")
            assert done.returncode == 1 and "cannot be read" in done.stderr, done
            done = as_stranger(f"{bin_dir}/simctl", "-s", server_id, "screenshot", f"{work.name}/x.png")
            assert done.returncode == 1 and "Permission denied" in done.stderr, done
    stop(process)


# A paused server does nothing at all but give a sign of life once a second.
def paused_is_idle():
    process = started("-u")

    def used():
        with open(f"/proc/{process.pid}/stat") as file:
            fields = file.read().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    before = used()
    time.sleep(3)  # what is measured
    spent = used() - before
    assert spent <= 0.01, f"{spent} s of processor time in 3 s"
    stop(process)


cases = {f.__name__: f for f in (ends_while_it_loads, cut_short, names, shared, requests, motion, faults, bad_requests, same_state, killed, living_server_is_refused, ends, check, paused_is_idle,
                                  no_room, scribbled_over,
                                  looked_at_while_paused, looked_at_each_device, shows_every_type, exports, rate)}
try:
    cases[case]()
finally:
    # In an orderly way: also a failed case leaves nothing in shared memory.
    for process in reversed(running):
        if process.poll() is None:
            process.terminate()
    for process in running:
        try:
            process.wait(10)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
leftover = segments()
assert not leftover, leftover
print("ok")
