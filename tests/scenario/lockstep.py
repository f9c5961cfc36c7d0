# Many processes in lock step with one simulator, and what happens to the rest when one of them fails: lockstep.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import json
import re
import signal
import subprocess
import sys
import time

from system import System, is_stopped

sys.path.append(f"{sys.argv[4]}/tests/ports")
from giop import Ior, Orb

case, bin_dir, lib_dir, source = sys.argv[1:]
empty = f"{source}/worlds/empty.sdf"
rtcd_line = re.compile(r"\[(\d+\.\d+)\] INFO: (\w+): relay activated")


def relay(name, **options):
    words = {"exec_cxt.periodic.rate": 100, "instance_name": name, **options}
    return "Relay?" + "&".join(f"{key}={value}" for key, value in words.items())


def join(s, count, *, server_id=None):
    s.until(f"{count} participants", lambda: len(s.participants(server_id)) == count)


def goes_on(s, server_id=None):
    before = s.seconds(server_id)
    s.until("time that passes", lambda: s.seconds(server_id) > before + 0.5)


def stands_still(s):
    before = s.seconds()
    s.until("a hanging participant that is late", lambda: any(p["late"] for p in s.participants()))
    assert s.seconds() - before < 0.5, "time did not wait"
    at = s.seconds()
    assert s.seconds() == at and s.seconds() == at, "time passes without the participant"
    s.simctl("pause")  # what changes nothing in the world is answered all the same
    s.simctl("run")
    assert s.simctl("tree")


# The reference of a component's first context, asked of the naming service and of the component in GIOP.
def own_context(orb, s, component):
    host, port = s.names.split(":")
    folders = re.findall(r"^/[^/]+/(\S+):\n((?:\S+\n)+)", s.rtse("ls", "-R"), re.MULTILINE)
    folder = next(folder for folder, names in folders if f"{component}.rtc" in names.split())
    names = [part.rsplit(".", 1) for part in folder.split("/")] + [(component, "rtc")]
    root = Ior.make("IDL:omg.org/CosNaming/NamingContext:1.0", host, int(port), b"NameService", 2)

    def write_name(out):
        def one(pair):
            out.string(pair[0])
            out.string(pair[1])

        out.sequence(names, one)

    reference = orb.invoke(root, "resolve", write_name).ior()
    contexts = orb.invoke(reference, "get_owned_contexts")
    return contexts.sequence(contexts.ior)[0]


def journal(path):
    return [(float(time_text), int(value)) for time_text, value in (line.split() for line in open(path))]


# Five relays, each a process of its own, phases as given: value v, made in tick v, is seen by relay k as many ticks later as phases went back on the way.
def chain(s, phases, rate, ticks):
    s.naming()
    s.server(empty, "--lockstep", "--paused", "--rtf", "0", "--wait-for", "5")
    names = [f"Relay{k}" for k in range(5)]
    hosts = []
    for k, name in enumerate(names):
        hosts.append(s.host(relay(name, **{"exec_cxt.sim_time.phase": phases[k], "exec_cxt.periodic.rate": rate, "conf.default.source": int(k == 0),
                                           "conf.default.journal": f"{s.work}/{name}.txt"})))
    s.rtse("wait", *(f"{name}" for name in names), "--state", "any", "--timeout", "60")
    for a, b in zip(names, names[1:]):
        s.rtse("con", f"{a}:out", f"{b}:in", "-p", "dataport.subscription_type=flush")
    s.rtse("act", *names)
    join(s, 5)
    s.simctl("step", str(int(ticks / rate * 1000) + 1))
    seen = [journal(f"{s.work}/{name}.txt") for name in names]
    first = seen[0][0][0]
    period = [round(-(-(1000 * n) // rate)) / 1000 for n in range(ticks + 2)]  # the first step at or after each due time
    start = period.index(first)
    delay = 0
    for k in range(5):
        if k > 0 and phases[k] <= phases[k - 1]:
            delay += 1
        assert len(seen[k]) >= ticks - delay - 1, f"{names[k]}: {len(seen[k])} values in {ticks} ticks"
        for n, (at, value) in enumerate(seen[k]):
            assert value == n + 1, f"{names[k]}: value {value} where {n + 1} was expected"
            assert at == period[start + n + delay], f"{names[k]}: value {value} at {at}, expected at {period[start + n + delay]} (delay {delay} ticks)"
    for name, host in zip(names, hosts):
        said = rtcd_line.search(s.log(host))
        assert said and said[2] == name, f"no log line with simulated time: {s.log(host)}"


with System(bin_dir, lib_dir) as s:
    if case == "chain_forward":
        chain(s, (0, 1, 2, 3, 4), rate=100, ticks=300)
    elif case == "chain_backward":
        chain(s, (4, 3, 2, 1, 0), rate=100, ticks=300)
    elif case == "chain_mixed_at_a_rate_that_is_no_multiple_of_the_step":
        chain(s, (0, 2, 1, 3, 2), rate=30, ticks=300)

    elif case == "time_stamps":
        # Every policy stamps with simulated time, also where a thread of the receiver's or sender's process does it that no context runs.
        s.naming()
        s.server(empty, "--lockstep", "--paused", "--rtf", "0", "--wait-for", "2")
        s.host(relay("From", **{"exec_cxt.sim_time.phase": 0, "conf.default.source": 1, "conf.default.stamp": 0}))
        s.host(relay("To", **{"conf.default.stamp": 0, "conf.default.journal": f"{s.work}/to.txt"}))
        s.rtse("wait", "From", "To", "--state", "any", "--timeout", "60")
        join(s, 2)
        for flow in ("push", "pull"):
            for policy in ("on_write", "on_send", "on_received", "on_read"):
                open(f"{s.work}/to.txt", "w").close()
                s.rtse("con", "From:out", "To:in", "-p", f"dataport.dataflow_type={flow}", "-p", "dataport.subscription_type=flush", "-p", f"timestamp_policy={policy}")
                s.rtse("act", "From", "To")
                start = s.seconds()
                s.simctl("step", "100")
                seen = journal(f"{s.work}/to.txt")
                stamps = [at for at, _ in seen]
                due = [round(stamps[0] + 0.01 * n, 9) for n in range(max(10, len(stamps)))]
                assert stamps == due and start <= due[0] <= start + 0.02, f"{flow}, {policy}: from {start} on stamped {stamps}"
                s.rtse("deact", "From", "To")
                s.rtse("dis", "From:out")

    elif case == "killed":
        s.naming()
        s.server(empty, "--lockstep", "--rtf", "0")
        s.host(relay("Stays"))
        for n in range(10):
            victim = s.host(relay(f"Victim{n}"))
            join(s, 2)
            goes_on(s)
            time.sleep(0.003 * n)  # another point of a tick each time
            victim.send_signal(signal.SIGKILL)
            victim.wait()
            join(s, 1)
            goes_on(s)

    elif case == "stopped":
        s.naming()
        server = s.server(empty, "--lockstep", "--rtf", "0")
        s.host(relay("Stays"))
        victim = s.host(relay("Victim"))
        join(s, 2)
        for n in (1, 2):
            victim.send_signal(signal.SIGSTOP)
            s.until("a stopped process", lambda: is_stopped(victim))
            stands_still(s)
            s.until("a line that names it", lambda: len(re.findall(r"warn.*Victim", s.log(server))) == n)
            victim.send_signal(signal.SIGCONT)
            goes_on(s)
        join(s, 2)

    elif case == "dropped":
        s.naming()
        server = s.server(empty, "--lockstep", "--rtf", "0", "--participant-timeout", "1.5")
        s.host(relay("Stays"))
        victim = s.host(relay("Victim"))
        join(s, 2)
        victim.send_signal(signal.SIGSTOP)
        s.until("a stopped process", lambda: is_stopped(victim))
        join(s, 1)
        goes_on(s)
        victim.send_signal(signal.SIGCONT)
        join(s, 2)  # it participates again
        goes_on(s)

    elif case == "hanging_component":
        s.naming()
        server = s.server(empty, "--lockstep", "--rtf", "0", "--participant-timeout", "1.5")
        s.host(relay("Stays"))
        s.host(relay("Hangs", **{"conf.default.hang_at": 20}))
        s.rtse("wait", "Stays", "Hangs", "--state", "any", "--timeout", "60")
        join(s, 2)
        s.rtse("act", "Hangs")
        join(s, 1)
        goes_on(s)
        assert re.search(r"warn.*Hangs", s.log(server)), s.log(server)

    # One thread ticks both. The context of the one that hangs is to leave its group: it names the callback that it waits for, and the other one stays.
    elif case == "hangs_on_a_shared_thread":
        s.naming()
        s.server(empty, "--lockstep", "--rtf", "0")
        host = s.host("-o", "exec_cxt.sim_time.own_thread:NO", relay("Stays"), relay("Hangs", **{"conf.default.hang_at": 20}))
        s.rtse("wait", "Stays", "Hangs", "--state", "any", "--timeout", "60")
        join(s, 2)
        context = own_context(Orb(), s, "Hangs")
        s.rtse("act", "Hangs")
        stands_still(s)
        Orb().invoke(context, "set_rate", lambda out: out.number("d", 50.0))
        s.until("a line with the callback", lambda: "Hangs in onExecute, and does not return: its context participates in lock step again when it returns" in s.log(host))
        assert len(s.participants()) == 2, s.participants()

    elif case == "server_restarted":
        s.naming()
        hosts = [s.host(relay("One", **{"conf.default.source": 1, "conf.default.journal": f"{s.work}/one.txt"})), s.host(relay("Two"))]
        for host in hosts:
            s.until("a line that it waits", lambda: "waiting for the simulator" in s.log(host))
        for kind in (signal.SIGKILL, signal.SIGTERM, signal.SIGKILL):
            server = s.server(empty, "--lockstep", "--rtf", "0", "--wait-for", "2")
            s.rtse("wait", "One", "Two", "--state", "any", "--timeout", "60")
            s.rtse("act", "One", "Two")
            join(s, 2)
            goes_on(s)
            server.send_signal(kind)
            server.wait()
        s.server(empty, "--lockstep", "--rtf", "0")
        join(s, 2)
        goes_on(s)
        s.rtse("wait", "One", "Two", "--state", "Active", "--timeout", "60")
        for host in hosts:
            # Before the first simulator one line that it waits, then one for each that has gone.
            said = s.log(host).count("waiting for the simulator"), s.log(host).count("the simulator has exited; waiting for it")
            assert said == (1, 3), f"lines: {said}"

    elif case == "two_servers":
        other = str(int(s.server_id) + 1)
        s.naming()
        first = s.server(empty, "--lockstep", "--rtf", "0")
        s.server(empty, "--lockstep", "--rtf", "0", server_id=other)
        s.host(relay("One"), relay("Other", **{"exec_cxt.sim_time.server_id": other}))
        s.host(relay("Third"), RTMSIM_SERVER_ID=other)
        join(s, 1)
        join(s, 2, server_id=other)
        goes_on(s)
        goes_on(s, other)
        first.send_signal(signal.SIGKILL)
        first.wait()
        goes_on(s, other)
        s.server(empty, "--lockstep", "--rtf", "0")
        join(s, 1)
        goes_on(s)
        goes_on(s, other)

    elif case == "registers_1000_times":
        # A context joins at each start and leaves at each stop; time passes for the others all along, and nothing is left of any registration.
        s.naming()
        server = s.server(empty, "--lockstep", "--rtf", "0")
        s.host(relay("Stays"))
        host = s.host(relay("Comes"))
        s.rtse("wait", "Stays", "Comes", "--state", "any", "--timeout", "60")
        join(s, 2)
        orb = Orb()
        context = own_context(orb, s, "Comes")
        order = lambda operation: orb.invoke(context, operation).ulong()
        resident = lambda: int(re.search(r"VmRSS:\s*(\d+)", open(f"/proc/{server.pid}/status").read())[1])
        joined = lambda: len(re.findall(r"participant Comes .* joined", s.log(server)))
        at = s.seconds()
        for n in range(1, 1000):
            assert order("stop") == 0 and order("start") == 0, f"registration {n}"
            s.until(f"registration {n}", lambda: joined() > n, pause=0.001)
            if n == 100:
                early = resident()
        assert resident() < early + 1024, f"the simulator has grown from {early} to {resident()} KiB"
        join(s, 2)
        assert s.seconds() > at
        goes_on(s)
        said = s.log(host).count("Comes: ticking at 100 Hz")
        assert said <= 1, f"said {said} times that it has joined"
        host.terminate()
        host.wait()
        join(s, 1)
        goes_on(s)

    elif case == "reset":
        system = f"{source}/worlds/systems/obstacle_avoidance.xml"
        s.naming()
        s.server(f"{source}/worlds/obstacle_course.sdf", "--lockstep", "--paused", "--rtf", "0")
        for name in ("RTCLaser", "LaserObstacleAvoid", "RTCPosition2d"):
            s.host(f"{name}?exec_cxt.periodic.rate=10")
        names = ("RTCLaser0", "LaserObstacleAvoid0", "RTCPosition2d0")
        s.rtse("wait", *names, "--state", "any", "--timeout", "60")
        s.rtse("load", system)
        for name in ("RTCLaser0", "RTCPosition2d0"):
            s.rtse("conf", name, "set", "server_id", s.server_id)
        s.rtse("act", *names)
        join(s, 3)
        slow = '{"data": {"vx": 0.05, "vy": 0, "va": 0}}'
        hashes = []
        # What somebody else sends to the drive is one more command, not one by which all that follow are late, and no run hears of the one before.
        for sent in ("nothing", "in the run", "before the reset", "after it", "nothing"):
            s.simctl("step", "10000")
            if sent == "in the run":
                s.rtse("inject", "RTCPosition2d0:velocity", slow, slow, slow)
            s.simctl("step", "10000")
            hashes.append(s.stats()["hash"])
            if sent == "before the reset":
                s.rtse("inject", "RTCPosition2d0:velocity", slow)
            s.simctl("reset")
            assert s.seconds() == 0
            if sent == "after it":
                s.rtse("inject", "RTCPosition2d0:velocity", slow)
        assert len(set(hashes)) == 1, f"the runs differ: {hashes}"

    elif case == "waiting_samples":
        # A reset throws away what waits in an InPort; what comes after it waits for the first tick.
        s.naming()
        s.server(empty, "--lockstep", "--paused", "--rtf", "0")
        s.host(relay("Reads", **{"conf.default.journal": f"{s.work}/journal.txt"}), relay("Writes"))
        s.rtse("wait", "Reads", "Writes", "--state", "any", "--timeout", "60")
        s.rtse("con", "Writes:out", "Reads:in", "-p", "dataflow_type=pull")
        s.rtse("act", "Reads", "Writes")
        join(s, 2)

        def inject(*values):
            s.rtse("inject", "Reads:in", *(f'{{"data": {value}}}' for value in values))

        inject(1, 2, 3)
        s.rtse("inject", "Writes:in", '{"data": 4}')
        s.simctl("step", "1")
        inject(5)
        s.simctl("reset")
        inject(6, 7)
        s.simctl("step", "1000")
        read = [value for _, value in journal(f"{s.work}/journal.txt")]
        assert read == [1, 6, 7], read

    elif case == "active_over_restarts":
        # Components that stay active find each new simulator in its first tick: every run of it is the same, and the robot drives.
        system, course = f"{source}/worlds/systems/obstacle_avoidance.xml", f"{source}/worlds/obstacle_course.sdf"
        s.naming()
        first = s.server(course, "--lockstep", "--paused")
        for name in ("RTCLaser", "LaserObstacleAvoid", "RTCPosition2d"):
            s.host(f"{name}?exec_cxt.periodic.rate=10")
        names = ("RTCLaser0", "LaserObstacleAvoid0", "RTCPosition2d0")
        s.rtse("wait", *names, "--state", "any", "--timeout", "60")
        s.rtse("load", system)
        for name in ("RTCLaser0", "RTCPosition2d0"):
            s.rtse("conf", name, "set", "server_id", s.server_id)
        s.rtse("act", *names)
        join(s, 3)
        first.send_signal(signal.SIGKILL)
        first.wait()
        hashes = []
        for n in range(5):
            record = f"{s.work}/record-{n}.txt"
            out = s.call(f"{bin_dir}/sim-server", course, "-s", s.server_id, "--lockstep", "--rtf", "0", "--wait-for", "3", "--duration", "20", "--hash", "--record", record)
            hashes.append(re.search(r"\b([0-9a-f]{16})\b", out)[1])
            poses = [line.split() for line in open(record) if line.split()[1:2] == ["pioneer2dx"]]
            way = sum(abs(float(a[2]) - float(b[2])) + abs(float(a[3]) - float(b[3])) for a, b in zip(poses, poses[1:]))
            assert way > 1, f"run {n}: the robot has moved by {way} m"
        assert len(set(hashes)) == 1, f"the runs differ: {hashes}"

    elif case == "steps_end":
        # Steps end with the client that wants them, and when somebody pauses or resets.
        s.server(empty, "--paused")
        for kind in (signal.SIGINT, signal.SIGKILL):
            stepper = s.start(f"{bin_dir}/simctl", "-s", s.server_id, "step", "1000000000")
            goes_on(s)
            stepper.send_signal(kind)
            stepper.wait()
            s.until("the end of the steps", lambda: s.stats()["paused"])
            before = s.stats()["steps"]
            s.simctl("step", "3")
            assert s.stats()["steps"] == before + 3
        for command, why in (("pause", "has paused"), ("reset", "has reset")):
            stepper = s.start(f"{bin_dir}/simctl", "-s", s.server_id, "step", "1000000000")
            goes_on(s)
            s.simctl(command)
            assert stepper.wait(60) == 1 and why in s.log(stepper), s.log(stepper)
            before = s.stats()["steps"]
            s.simctl("step", "3")
            assert s.stats()["steps"] == before + 3 and s.stats()["paused"]

    elif case == "pushes_in_a_tick":
        # A component can push in its tick and wait for the answer: the wrench begins with the next step, in one order whoever asked first.
        s.naming()
        box = ("<sdf version='1.9'><model name='box'><pose>0 0 50 0 0 0</pose><link name='l'><gravity>false</gravity><inertial><mass>2</mass></inertial></link>"
               "</model></sdf>")
        found = []
        for forces in ("0.1", "0.2", "0.3"), ("0.3", "0.2", "0.1"):
            server = s.server(empty, "--lockstep", "--rtf", "0", "--paused", "--wait-for", "1")
            s.simctl("spawn", box)
            host = s.host(relay("Hangs"))
            join(s, 1)
            s.simctl("step", "100")
            host.send_signal(signal.SIGSTOP)
            s.until("a stopped process", lambda: is_stopped(host))
            stepper = s.start(f"{bin_dir}/simctl", "-s", s.server_id, "step", "100")
            s.until("a tick that waits", lambda: any(p["late"] for p in s.participants()))
            for force in forces:
                s.simctl("wrench", "box", force, "0", "0")
            host.send_signal(signal.SIGCONT)
            assert stepper.wait(60) == 0, s.log(stepper)
            found.append(json.loads(s.simctl("--json", "velocity", "box"))["linear"][0])
            for process in (host, server):
                process.send_signal(signal.SIGTERM)
                process.wait(60)
        assert found[0] == found[1] and abs(found[0] - 0.6 / 2 * 0.001) < 1e-9, found

    elif case == "refused_in_a_hang":
        # What needs the world to stand between two steps is refused with the name of who hangs, and does not happen later.
        s.naming()
        s.server(empty, "--lockstep", "--rtf", "0", "--wait-for", "1")
        host = s.host(relay("Hangs"))
        s.rtse("wait", "Hangs", "--state", "any", "--timeout", "60")
        join(s, 1)
        goes_on(s)
        host.send_signal(signal.SIGSTOP)
        s.until("a stopped process", lambda: is_stopped(host))
        stands_still(s)
        for words in (("reset",), ("step", "3")):
            done = subprocess.run([f"{bin_dir}/simctl", "-s", s.server_id, *words], capture_output=True, text=True, timeout=60)
            assert done.returncode == 1 and "Hangs" in done.stderr, (words, done.stderr)
        at = s.seconds()
        host.send_signal(signal.SIGCONT)
        goes_on(s)
        assert s.seconds() > at > 0.5 and not s.stats()["paused"], "the reset or the steps were done all the same"

    elif case == "observer":
        # The simulator goes on while somebody only looks, and does not write over what is looked at.
        s.server(f"{source}/worlds/obstacle_course.sdf", "--lockstep", "--rtf", "0", "--paused")
        name = re.search(r"laser +(\S+)", s.simctl("list"))[1]
        rate = 10  # [Hz] of that laser
        helper = subprocess.Popen([f"{bin_dir}/shm_helper", "observe", s.server_id, name, str(1000 // rate), "60"], stdout=subprocess.PIPE, text=True)
        join(s, 1)
        s.simctl("run")
        out, _ = helper.communicate(timeout=120)
        assert helper.returncode == 0, out
        ticks = [tuple(map(int, line.split())) for line in out.splitlines()]
        assert len(ticks) == 60, out
        wrong = [tick for tick in ticks if tick[1] != tick[0]]
        assert not wrong, f"samples of another time than the tick's: {wrong}"
        assert any(clock > now for now, _, clock in ticks), "the simulator has waited for the observer"
        # One that is stopped while it looks holds up no answer to what leaves the world alone.
        s.simctl("rtf", "1")
        helper = subprocess.Popen([f"{bin_dir}/shm_helper", "observe", s.server_id, name, str(1000 // rate), "100000"], stdout=subprocess.DEVNULL)
        for _ in range(10):
            s.until("an observer that ticks", lambda: sum(p["ticks"] for p in s.participants()) > 2)
            helper.send_signal(signal.SIGSTOP)
            for _ in range(10):
                s.simctl("stats")
            helper.send_signal(signal.SIGCONT)
        helper.kill()
        helper.wait()

    elif case == "loaded":
        # The same run on a machine that has better things to do.
        system, course = f"{source}/worlds/systems/obstacle_avoidance.xml", f"{source}/worlds/obstacle_course.sdf"

        def state(*more):
            run = s.call(f"{bin_dir}/rtse", "--json", "run", system, "--world", course, "--duration", "60", "--seed", "3", *more)
            return re.search(r'"state_hash": *"(\w+)"', run)[1]

        quiet = {state(), state("--one-process-each")}
        for _ in range(4):
            s.start(sys.executable, "-c", "while True: pass")
        busy = {state(), state("--one-process-each"), state("--one-process-each")}
        assert len(quiet | busy) == 1, f"{quiet} on a quiet machine, {busy} on a loaded one"
    else:
        sys.exit(f"lockstep.py: no case {case}")
