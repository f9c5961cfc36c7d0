# sim-server and simctl as processes, one case per run: server.py CASE BIN_DIR SOURCE_DIR.
import json
import os
import pathlib
import re
import signal
import struct
import subprocess
import time

from server_rig import *


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
    assert {"name": "sick_lms200"} in read("models")["models"], "what can be spawned by its name"
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
    drive = client("velocity", f"{robot}::position2d", "0.3", "0", "0")
    await_("a driving robot", lambda: read("echo", f"{robot}::position2d", "-n", "1")["velocity"][0] > 0.1)
    ok("delete", robot)
    assert drive.wait(watchdog) == 1, "who commands what is deleted ends"
    stop(process)


# Whoever prints without an end ends with its output.
def output_that_takes_no_more():
    process = started()
    for words in (["echo", f"{robot}::laser"], ["--json", "echo", f"{robot}::laser"], ["echo", f"{robot}::position2d"], ["echo", "simulation:world"]):
        call = [f"{bin_dir}/simctl", "-s", server_id, *words]
        with open("/dev/full", "w") as full:
            done = subprocess.run(call, stdout=full, stderr=subprocess.PIPE, text=True, timeout=watchdog)
        assert done.returncode == 1 and done.stderr == "the output cannot be written\n", done
        with subprocess.Popen(call, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as read_once:
            read_once.stdout.readline()
            read_once.stdout.close()
            assert read_once.communicate(timeout=watchdog)[1] == "", words
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
    ok("wrench", "crate", "--persistent", "-4", "0", "0")
    ok("step", "100")
    near(read("velocity", "crate")["linear"][0:1], [0.2 - 4 / 2 * 100 * step], 1e-3)
    ok("wrench", "crate", "--clear")
    ok("step", "100")
    near(read("velocity", "crate")["linear"][0:1], [0.2 - 4 / 2 * 100 * step], 1e-3)
    # A joint, beside what its motor does; a link may have its name.
    swing = ("<sdf version='1.9'><model name='swing'><link name='base'/><joint name='hold' type='fixed'><parent>world</parent><child>base</child></joint><link name='arm'>"
             "<inertial><inertia><ixx>1</ixx><iyy>1</iyy><izz>0.5</izz></inertia></inertial></link><joint name='arm' type='revolute'><parent>base</parent><child>arm</child>"
             "<axis><xyz>0 0 1</xyz></axis></joint></model></sdf>")
    ok("spawn", swing, "--name", "swing", "--pose", "3", "0", "50", "0")
    ok("wrench", "swing", "--joint", "arm", "2", "--for", "0.1")
    ok("step", "200")
    near(read("velocity", "swing::arm")["angular"], (0, 0, 2 / 0.5 * 0.1), 1e-3)
    ok("wrench", "swing", "--joint", "arm", "--persistent", "-2")
    ok("step", "100")
    ok("wrench", "swing", "--joint", "arm", "--clear")
    near(read("velocity", "swing::arm")["angular"], (0, 0, 0.4 - 4 * 100 * step), 1e-3)
    refused("wrench", "swing", "--joint", "elbow", "1", says="no joint swing::elbow; joints: swing::hold, swing::arm")
    refused("wrench", "swing", "--joint", "hold", "1", says="joint hold neither turns nor slides")
    refused("wrench", "swig", "--joint", "arm", "1", says="no model or link swig")
    for words in (["1", "0", "0"], [], ["--clear", "1"]):
        refused("wrench", "swing", "--joint", "arm", *words, code=2)
    for words in (["--clear", "1", "0", "0"], ["--persistent"], ["--persistent", "--for", "1", "1", "0", "0"]):
        refused("wrench", "crate", *words, code=2)

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


# A reader writes a tag that it has in its reach.
def tags():
    process = started("-u", world=f"{source}/worlds/devices.sdf")
    data = lambda: [(tag["id"], tag["data"]) for tag in read("echo", "rover::rfid", "-n", "1")["tags"]]
    assert data() == [("E200-0017", "shelf 3")]
    ok("tag", "rover::rfid", "E200-0017", "shelf 42")
    ok("step", "200")
    assert data() == [("E200-0017", "shelf 42")]
    refused("tag", "rover::rfid", "E200-9", "x", says='has no tag "E200-9" in reach; it has E200-0017')
    refused("tag", "rover::rfid", "E200-0017", "two\nlines", says="must have no line breaks")
    refused("tag", "rover::rfid", "E200-0017", "x" * 128, says="must have at most 127 bytes, got 128")
    refused("tag", "rover::ins", "E200-0017", "x", says="is no reader of RFID tags")
    refused("tag", "rover::rfd", "E200-0017", "x", says="; did you mean rover::rfid?")
    refused("tag", "rover::rfid", "E200-0017", code=2)
    ok("reset")
    assert data() == [("E200-0017", "shelf 3")]
    stop(process)


# A name with a slip has the one that was meant in its message.
def suggestions():
    process = started("-u")
    for words, meant in ((["pose", "pionner2dx"], robot), (["velocity", "pioneer2dx::chasis"], f"{robot}::chassis"), (["delete", "pioner2dx"], robot), (["contacts", "Pioneer2DX"], robot),
                         (["motors", f"{robot}::positon2d", "off"], f"{robot}::position2d"), (["fault", "lasr", "off"], f"{robot}::laser"), (["echo", f"{robot}::lasr"], f"{robot}::laser"),
                         (["info", "position2"], f"{robot}::position2d"), (["spawn", "pionner2dx"], robot), (["spawn", "model://sick_lms20"], "sick_lms200"),
                         (["screenshot", f"{work.name}/x.png", "--follow", "pioneer2x"], robot)):
        refused(*words, says=f"; did you mean {meant}?")
    refused("pose", "something_else", says="no model or link something_else")
    refused("lits", code=2, says="; did you mean list?")
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
    ok("reset", "--seed", "7")
    ok("step", "200")
    seventh = state()
    assert seventh != once, "the seed is in the state"
    stop(process)
    process = started("-u", "--seed", "7", world=world)
    ok("step", "200")
    assert state() == seventh, "a reset with a seed differs from a start with it"
    refused = simctl("reset", "--seed", "-1")
    assert refused.returncode == 2 and "not negative" in refused.stderr, refused
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
    assert server("--check", world="/no/such/world.sdf").wait(watchdog) == 2
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
    # The same as JSON: what there is, and what URIs mean.
    crate = f"{work.name}/crate.sdf"
    with open(crate, "w") as file:
        file.write("<sdf version='1.9'><model name='crate'><link name='l'><collision name='c'><pose>0 0 1 0 0 0</pose><geometry><box><size>1 2 3</size></box></geometry></collision></link></model></sdf>")
    with open(broken, "w") as file:
        file.write("<sdf version='1.9'><world name='w'><include><uri>crate.sdf</uri><pose>4 0 0 0 0 0</pose></include></world></sdf>")
    looking = server("--check", "--json", "--spawn", crate, "--spawn", "model://nowhere", world=broken)
    said = json.loads(looking.communicate(timeout=watchdog)[0])
    assert looking.returncode == 0
    assert [(one["uri"], one["file"]) for one in said["found"]] == [("crate.sdf", crate)], said["found"]
    model = said["models"][0]
    assert (model["name"], model["static"], model["pose"][0]) == ("crate", False, 4), model
    assert {key: model["links"][0]["collisions"][0][key] for key in ("shape", "pose", "size")} == {"shape": "box", "pose": [0, 0, 1, 1, 0, 0, 0], "size": [1, 2, 3]}, model
    assert said["spawned"][0] == {"model": crate, "files": [crate]} and "not found" in said["spawned"][1]["error"], said["spawned"]
    assert server("--json").wait(watchdog) == 2
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


# A model for each value of a list, in a square grid whose first is at --pose.
def fleet():
    process = started("-u", world=f"{source}/worlds/empty.sdf")
    assert ok("spawn", "model://pioneer2dx", "--for", "robot=r0..r4", "--pose", "1 2 0", "--spacing", "1.5").split() == [f"r{i}" for i in range(5)]
    for name, place in (("r0", (1, 2)), ("r2", (4, 2)), ("r4", (2.5, 3.5))):
        near(position(name)[:2], place)
    assert read("spawn", "model://pioneer2dx", "--for", "robot=2", "--name", "x_{robot#}", "--pose", "-5 -5 0")["names"] == ["x_0", "x_1"]
    stop(process)


def waits():
    waiting = [subprocess.Popen([f"{bin_dir}/simctl", "-s", server_id, "wait", *ifaces], stderr=subprocess.PIPE, text=True)
               for ifaces in ([], [f"{robot}::laser", f"position2d:{robot}::position2d"])]
    running.extend(waiting)
    refused("wait", "--timeout", "0.1", says="is not there after 0.1 s")
    assert all(one.poll() is None for one in waiting), "nobody is there to wait for"
    process = started("-u")
    for one in waiting:
        assert one.wait(watchdog) == 0, one.stderr.read()
    refused("wait", "laser:nobody", "nobody::else", f"{robot}::laser", "--timeout", "0.1", says="has no laser:nobody, nobody::else after 0.1 s")
    refused("wait", "--timeout", "-1", code=2, says="--timeout")
    stop(process)


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


# A paused server does nothing but give a sign of life once a second: it is counted how often its threads wake. Its processor time would depend on the
# machine, and has a wide limit here, for a thread that never sleeps.
def paused_is_idle():
    process = started("-u")

    def woken_and_used():
        switches, spent = 0, 0
        for task in pathlib.Path(f"/proc/{process.pid}/task").iterdir():
            switches += int(re.search(r"^voluntary_ctxt_switches:\s+(\d+)", (task / "status").read_text(), re.M)[1])
            spent += int((task / "schedstat").read_text().split()[0])
        return switches, spent / 1e9

    before = woken_and_used()
    time.sleep(3)  # what is measured
    woken, used = (after - start for after, start in zip(woken_and_used(), before))
    print(f"woken {woken} times in 3 s, {used * 1e3:.2f} ms of processor time")
    most = 60 if "RTMSIM_SANITIZED" in os.environ else 10  # the thread sanitizer has a thread of its own, which wakes ten times a second
    assert woken <= most, f"woken {woken} times in 3 s"
    assert used <= 0.5, f"{used} s of processor time in 3 s"
    stop(process)


run(requests, output_that_takes_no_more, motion, tags, suggestions, same_state, looked_at_while_paused, looked_at_each_device, shows_every_type, exports, check, names, fleet, waits, rate, paused_is_idle)
