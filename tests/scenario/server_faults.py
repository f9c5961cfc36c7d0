# sim-server and simctl when something goes wrong, one case per run: server_faults.py CASE BIN_DIR SOURCE_DIR.
import json
import mmap
import os
import random
import re
import signal
import subprocess
import sys
import tempfile
import time

from server_rig import *


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
                        ([laser, "off", "1"], "takes no AMOUNT"), ([laser, "--for", "1"], "goes with IFACE KIND"), ([laser, "off", "--for", "-1"], "-1"),
                        ([laser, "latency", "2.5"], "must be a whole number of samples, got 2.5"), ([laser, "off", "--for", "0"], "--for")]:
        refused("fault", *words, code=2, says=says)
    assert state() == before
    stop(process)

    # Of joints: all of an iface, or one.
    process = started("-u", world=f"{source}/worlds/arm.sdf")
    ok("fault", "arm::joints", "weak")
    ok("fault", "arm::joints::elbow", "bias", "0.2")
    assert sorted((one["iface"], one["kind"]) for one in read("fault", "arm::joints")["faults"]) == [("arm::joints", "weak"), ("arm::joints::elbow", "bias")]
    assert [one["kind"] for one in read("fault", "arm::joints::elbow")["faults"]] == ["bias"]
    refused("fault", "arm::joints::elbw", "weak", says='there is no joint "elbw", only waist, shoulder, elbow')
    assert read("fault", "arm::joints::elbow", "--end")["ended"] == 1 and read("fault", "arm::joints", "--end")["ended"] == 1
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
                  ["velocity", f"{robot}::position2d", "nan", "0", "0"], ["spawn", "<sdf version='1.9'><model"],
                  ["velocity", f"{robot}::position2d", "1e308", "0", "0"], ["pose", robot, "1e9", "0", "0"],
                  ["spawn", "<sdf version='1.9'><model name='m'><pose>nan 0 0 0 0 0</pose><link name='l'/></model></sdf>"]):
        refused(*words)
    refused("spawn", "/no/such/file.sdf", code=2, says="no such file")
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


# In a name space of its own with a /dev/shm and a disk of a few pages.
def no_room():
    small = f"{work.name}/small"
    os.mkdir(small)

    def alone(script):
        command = f"mount -t tmpfs -o size=64k tmpfs {small} && {script}"
        return subprocess.run(["unshare", "-m", "sh", "-c", command], capture_output=True, text=True, timeout=watchdog)

    if (probe := alone("true")).returncode != 0:
        print(f"skipped: needs a mount namespace: {probe.stderr.strip()}")
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
    ends(f"mount -t tmpfs tmpfs /dev/shm && {run} --duration 1 --record /no/such/folder/record", 2, ['"/no/such/folder/record"', "there is no folder"])
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
    await_("a line about it", lambda: "was truncated" in open(process.log.name).read())
    assert listener.wait(watchdog) == 1
    before = read("stats")["sim_time"]
    await_("running time", lambda: read("stats")["sim_time"] > before)
    near(read("echo", f"{robot}::position2d", "-n", "1")["odometry"], (0, 0, 0), 1e-3)
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
            assert done.returncode == 2 and "cannot be read" in done.stderr, done
            done = as_stranger(f"{bin_dir}/simctl", "-s", server_id, "screenshot", f"{work.name}/x.png")
            assert done.returncode == 1 and "Permission denied" in done.stderr, done
    stop(process)


run(faults, bad_requests, no_room, scribbled_over, killed, living_server_is_refused, ends, ends_while_it_loads, cut_short, shared)
