# Contexts of other processes in lock step: ticked from outside, by a clock, together, and when their host ends. foreign_contexts.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import os
import signal
import subprocess
import sys

from foreign_rig import Mixed, Run, bin_dir, case, empty, lib_dir, profile, relay, source

sys.path.append(f"{source}/tests/ports")
from giop import Ior, Orb, SystemException  # noqa: E402
from idl_client import Idl, Remote  # noqa: E402


def ticked_together():
    # Contexts of two processes that are ticked from outside are ticked at the same time: each waits in its callback for the other.
    with Run() as r:
        for how, options in (("tick", ""), ("clock", "--clock 0.1")):
            system = r.system(Alien=("Foreign", {}), Other=("Foreign", {}))
            meeting = f"{r.path}/{how}"
            os.mkdir(meeting)
            with open(f"{r.path}/run.yaml", "w") as out:
                out.write("processes:\n")
                for name in ("Alien", "Other"):
                    command = r.command(f"--context triggered --active --fault meet{meeting}@2", options, name=name)
                    out.write(f"  - command: {command}\n    components:\n      - {{name: {name}, join: {how}}}\n")
            done = subprocess.run([f"{bin_dir}/rtse", "run", system, "--world", empty, "--module-path", lib_dir, "--duration", "0.5", "--run-file", f"{r.path}/run.yaml"],
                                  text=True, capture_output=True, timeout=120)
            assert done.returncode == 0, (how, done)
            for name in ("Alien", "Other"):
                assert r.read(f"{name}-{r.count}.journal").count("on_execute 0") == 6, (how, r.read(f"{name}-{r.count}.journal"))


def ticked_afterwards():
    # A context that runs its component on a thread of its own after tick() cannot be waited for: a strict run says so.
    with Run() as r:
        system = r.system()
        with open(f"{r.path}/run.yaml", "w") as out:
            out.write(f"processes:\n  - command: {r.command('--context afterwards --active')}\n    components:\n      - {{name: Alien, join: tick}}\n")
        done = subprocess.run([f"{bin_dir}/rtse", "run", system, "--world", empty, "--module-path", lib_dir, "--duration", "0.5", "--strict", "--run-file", f"{r.path}/run.yaml"],
                              text=True, capture_output=True, timeout=120)
        assert done.returncode == 1 and "component Alien: its context, an ExtTrigExecutionContext, runs it on a thread of its own" in done.stderr, done


def ticked():
    # Contexts that are ticked from outside: by the proxy, with the time where they take one, and by OpenHRP's clock, to which they subscribe.
    with Run() as r:
        for how, options in (("tick", "--context triggered --active"), ("tick", "--context logical --active"), ("tick", "--context lazy --active"), ("clock", "--context triggered --active --clock 0.1")):
            system = r.system()
            with open(f"{r.path}/run.yaml", "w") as out:
                out.write(f"processes:\n  - command: {r.command(options)}\n    components:\n      - {{name: Alien, join: {how}}}\n")
            done = subprocess.run([f"{bin_dir}/rtse", "run", system, "--world", empty, "--module-path", lib_dir, "--duration", "0.5", "--property", "From:exec_cxt.sim_time.phase=0",
                                   "--property", "To:exec_cxt.sim_time.phase=2", "--run-file", f"{r.path}/run.yaml"], text=True, capture_output=True, timeout=120)
            assert done.returncode == 0, done
            values = [line.split()[1] for line in r.read(f"To-{r.count}.txt").splitlines()]
            assert values == ["2", "3", "4", "5", "6", "7"], (how, values)
            journal = [line.split() for line in r.read(f"Alien-{r.count}.journal").splitlines()]
            assert journal[-1 if "lazy" not in options else -2][0] == "on_deactivated", journal
            ticks = [float(line[1]) for line in journal if line[0] == "tick"][:6]
            assert ticks == ([0, 0.1, 0.2, 0.3, 0.4, 0.5] if "logical" in options else [-1] * 6), ticks
            assert [line[1] for line in journal if line[0] == "on_execute"] == ["0"] * 6, journal


def ticked_by_hand():
    # Without a run: `join --tick` ticks the context of a component that runs already, `leave` ends that, and the host with it.
    with Mixed(bin_dir, lib_dir) as s:
        s.chain("--context", "triggered", "--active")
        s.rtse("join", "Alien", "--tick", "--phase", "1", "--rate", "100", "--server-id", s.server_id)
        for words in (["--tick"], []):
            again = s.try_rtse("join", "Alien", *words, "--rate", "100", "--server-id", s.server_id)
            assert again.returncode == 1 and "its own context is ticked in simulated time already" in again.stderr, again
        assert {p["name"]: p["phase"] for p in s.participants()} == {"From": 0, "To": 2, "Alien": 1}
        s.rtse("act", "From", "To")
        s.simctl("step", "500")
        assert s.calls("Alien").count(["tick", "-1.000000"]) == s.calls("Alien").count(["on_execute", "0"]) == 51, s.calls("Alien")
        assert [value for _, value in s.values("To")] == list(range(2, 53)), s.values("To")
        s.rtse("leave", "Alien")
        s.until("the end of the host", lambda: not s.time_hosts() and len(s.participants()) == 2)
        s.simctl("step", "100")
        assert s.calls("Alien").count(["tick", "-1.000000"]) == 51, s.calls("Alien")


def faulty_ticked():
    # As members, so those whose own context is ticked: who is slow makes no difference, who throws is ticked all the same, who hangs is named.
    with Run() as r:
        def run(fault, *options):
            r.count += 1
            system = profile(f"{r.path}/system.xml", {"From": ("Relay", {"source": 1}), "To": ("Relay", {"journal": f"{r.path}/To-{r.count}.txt", "stamp": 0}), "Alien": ("Foreign", {})},
                             [("From.out", "Alien.in"), ("Alien.out", "To.in")])
            with open(f"{r.path}/run.yaml", "w") as out:
                command = r.command("--context triggered --active", f"--fault {fault}" if fault else "")
                out.write(f"processes:\n  - command: {command}\n    components:\n      - {{name: Alien, join: tick}}\n")
            done = subprocess.run([f"{bin_dir}/rtse", "run", system, "--world", empty, "--module-path", lib_dir, "--duration", "0.5", "--property", "From:exec_cxt.sim_time.phase=0",
                                   "--property", "To:exec_cxt.sim_time.phase=2", "--run-file", f"{r.path}/run.yaml", *options], text=True, capture_output=True, timeout=120)
            return done.returncode, done.stderr, r.read(f"To-{r.count}.txt"), r.read(f"Alien-{r.count}.journal")

        seen = []
        for fault in ("", "300@*", "1500@3"):
            code, err, read, calls = run(fault)
            assert code == 0 and ("waiting up to" in err) == ("1500" in fault), (fault, code, err)
            seen.append((read, calls))
        assert len(set(seen)) == 1 and seen[0][1].count("on_execute 0") == 6, seen
        code, err, read, calls = run("throw@3")
        assert code == 0 and "throws" in err and calls.count("tick ") == 6 and calls.count("on_execute 0") == 5, (code, err, calls)
        code, err, read, calls = run("hang@3", "--hang-timeout", "1")
        assert code == 1 and "Alien: did not finish its tick" in err, (code, err)


def together():
    # Members of one phase in two processes are called at the same time: each waits in its callback for the other.
    with Run() as r:
        system = r.system(Alien=("Foreign", {}), Other=("Foreign", {}))
        starts = [word for name in ("Alien", "Other") for word in ("--start", r.command(f"--fault meet{r.path}@2", name=name))]
        done = subprocess.run([f"{bin_dir}/rtse", "run", system, "--world", empty, "--module-path", lib_dir, "--duration", "0.5", *starts], text=True, capture_output=True, timeout=120)
        assert done.returncode == 0, done
        for name in ("Alien", "Other"):
            assert r.read(f"{name}-{r.count}.journal").count("on_execute 1000") == 6


# What a name server holds, by an ORB of its own.
def resolver(s):
    idl = Idl(f"{source}/idl", "ClockGenerator.idl", f"{source}/tests/ports/naming.idl")
    orb = Orb(2, "<")
    host, port = s.names.split(":")
    root = Remote(idl, orb, Ior.make("IDL:omg.org/CosNaming/NamingContext:1.0", host, int(port), b"NameService", 2), "CosNaming::NamingContext")
    return lambda *path, interface="RTC::RTObject": root.resolve([idl.struct("CosNaming::NameComponent", id=name, kind=kind) for name, kind in path]).narrow(interface)


def clock():
    # OpenHRP's clock: a tick at the first step at or after each multiple of the period; who subscribes again has the new period, who has died holds nobody up.
    with Mixed(bin_dir, lib_dir) as s:
        s.naming()
        s.server(empty, "--lockstep", "--paused", "--rtf", "0")
        s.host("ClockGenerator?conf.default.server_id=" + s.server_id)
        process = s.foreign("Alien", "--context", "triggered")
        resolve = resolver(s)
        clock = s.until("the clock", lambda: "ClockGenerator" in s.rtse("ls", "-R") and resolve(("ClockGenerator", ""), interface="OpenHRP::ClockGenerator"))
        context = resolve(("Alien", "rtc")).get_owned_contexts()[0]
        ticks = lambda: s.calls("Alien").count(["tick", "-1.000000"])
        for period in (0, -1, float("nan"), 1e9):
            try:
                clock.subscribe(context.ior, period)
                raise AssertionError(f"a period of {period} s is taken")
            except SystemException as problem:
                assert "BAD_PARAM" in str(problem), problem
        clock.subscribe(context.ior, 5.0)
        clock.subscribe(context.ior, 0.0015)
        s.until("the second subscription", lambda: len(s.participants()) == 1 and "Alien_clock2" in s.rtse("ls", "-R") and "Alien_clock1" not in s.rtse("ls", "-R"))
        s.simctl("step", "30")
        assert ticks() == 21, ticks()
        clock.unsubscribe(context.ior)
        s.until("nobody", lambda: not s.participants())
        s.simctl("step", "30")
        assert ticks() == 21, ticks()
        clock.subscribe(context.ior, 0.001)
        s.until("a participant", lambda: s.participants())
        s.kill(process)
        s.simctl("step", "30")
        assert s.state("Alien_clock3") == "Error" and "was lost" in "".join(s.log(one) for one in s.running), s.state("Alien_clock3")


def one_context():
    # By the calls of the standard alone: two components of two processes become members of one context, are called at the same time, and leave.
    with Mixed(bin_dir, lib_dir) as s:
        s.naming()
        s.server(empty, "--lockstep", "--paused", "--rtf", "0")
        s.host(relay("Host"))
        for name in ("Alien", "Other"):
            s.foreign(name, "--fault", f"meet{s.work}@2")
        s.rtse("wait", "Host", "Alien", "Other", "--state", "any", "--timeout", "60")
        resolve = resolver(s)
        context = resolve((os.uname().nodename, "host_cxt"), ("Host", "rtc")).get_owned_contexts()[0]
        members = [resolve((name, "rtc")) for name in ("Alien", "Other")]
        assert [context.add_component(member.ior) for member in members] == ["RTC_OK"] * 2
        assert context.add_component(members[0].ior) == "PRECONDITION_NOT_MET"
        assert [context.activate_component(member.ior) for member in members] == ["RTC_OK"] * 2
        s.until("a participant", lambda: len(s.participants()) == 1)
        s.simctl("step", "500")
        assert s.calls("Alien") == s.calls("Other") and s.calls("Alien").count(["on_execute", "1000"]) == 51, (s.calls("Alien"), s.calls("Other"))
        assert [context.deactivate_component(member.ior) for member in members] == ["RTC_OK"] * 2
        assert [context.remove_component(member.ior) for member in members] == ["RTC_OK"] * 2
        assert s.calls("Alien")[-1] == ["on_deactivated", "1000"], s.calls("Alien")


def host_dies():
    # Who has lost the host of its context is told so, and leaves all the same.
    with Mixed(bin_dir, lib_dir) as s:
        s.chain()
        s.rtse("join", "Alien", "--rate", "100", "--server-id", s.server_id)
        again = s.try_rtse("join", "Alien", "--rate", "100", "--server-id", s.server_id)
        assert again.returncode == 1 and "already" in again.stderr, again
        pid = next(p["pid"] for p in s.participants() if p["name"] == "Alien")
        os.kill(pid, signal.SIGKILL)
        s.until("its end", lambda: len(s.participants()) == 2)
        s.simctl("step", "10")
        s.rtse("leave", "Alien")
        assert s.try_rtse("leave", "Alien").returncode == 1
        s.rtse("join", "Alien", "--rate", "100", "--server-id", s.server_id)
        assert len(s.participants()) == 3
        s.rtse("leave", "Alien")


def forgotten():
    # Nobody says `leave`: the host of a context ends all the same when those whom it serves have gone, also after everybody else. The others stay.
    with Mixed(bin_dir, lib_dir) as s:
        names = s.naming()
        server = s.server(empty, "--lockstep", "--paused", "--rtf", "0")
        aliens = {"Ticked": s.foreign("Ticked", "--context", "triggered"), "Other": s.foreign("Other"), "Alien": s.foreign("Alien")}
        s.rtse("wait", *aliens, "--state", "any", "--timeout", "60")
        for name in aliens:
            s.rtse("join", name, *(["--tick"] if name == "Ticked" else []), "--rate", "100", "--server-id", s.server_id)
        assert len(s.time_hosts()) == 3, s.time_hosts()
        s.kill(aliens["Alien"])
        s.until("the end of its host", lambda: len(s.time_hosts()) < 3)
        s.simctl("step", "100")
        assert len(s.time_hosts()) == 2 and {p["name"] for p in s.participants()} == {"Ticked", "Other"}, s.participants()
        assert s.calls("Ticked").count(["tick", "-1.000000"]) == 11, s.calls("Ticked")
        server.terminate()
        server.wait(60)
        for process in (names, aliens["Ticked"], aliens["Other"]):
            s.kill(process)
        s.until("the end of the hosts", lambda: not s.time_hosts())


globals()[case]()
