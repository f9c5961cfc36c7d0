# Components of other processes and of another make (foreign_component.py) in lock step: foreign_members.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import json
import os
import re
import signal
import struct
import subprocess
import time

from foreign_rig import Mixed, Run, bin_dir, case, empty, lib_dir, profile, source


def join_and_leave():
    # A component that runs already joins, is called in our tick and phase, and runs in its own context again after it has left.
    with Mixed(bin_dir, lib_dir) as s:
        s.chain()
        s.rtse("act", "Alien")
        s.until("calls in its own context", lambda: ["on_execute", "0"] in s.calls("Alien"))
        said = s.rtse("join", "Alien", "--phase", "1", "--rate", "100", "--server-id", s.server_id)
        assert "participates in simulator" in said and "phase 1" in said and "once that runs" not in said, said
        assert {p["name"] for p in s.participants()} == {"From", "To", "Alien"}
        s.rtse("act", "From", "To")
        assert s.state("Alien") == "Active"
        before = len(s.calls("Alien"))
        s.simctl("step", "1000")
        calls = s.calls("Alien")[before:]
        assert [callback for callback, _ in calls] == ["on_execute"] * 101 and {handle for _, handle in calls} == {"1000"}, calls
        seen = s.values("To")
        assert [value for _, value in seen] == list(range(2, 103)), seen
        assert [at for at, _ in seen] == [round(n / 100, 9) for n in range(101)], seen
        s.rtse("leave", "Alien")
        assert s.state("Alien") == "Active"
        s.until("two participants", lambda: {p["name"] for p in s.participants()} == {"From", "To"})
        before = len(s.calls("Alien"))
        s.until("calls in its own context", lambda: s.calls("Alien")[before:].count(["on_execute", "0"]) > 2)
        refused = s.try_rtse("leave", "Alien")
        assert refused.returncode == 1 and "takes no part" in refused.stderr, refused
        s.until("the end of the host", lambda: "Alien_time" not in s.rtse("ls", "-R"))


def started():
    # A run starts the process, waits for its component, wires it, calls it in its phase, stamps what it sends, and takes everything down.
    with Run() as r:
        seen = []
        for fault in ("", "--fault 300@*", "--fault 1500@3"):
            code, err, read, calls = r.run(start=r.start(fault), duration="0.5")
            assert code == 0 and "stamped with simulated time" in err and "Alien.out to To.in" in err, (code, err)
            assert ("waiting up to" in err) == ("1500" in fault), err
            seen.append((read, calls))
        assert len(set(seen)) == 1, seen
        read, calls = seen[0]
        assert [line.split()[1] for line in read.splitlines()] == ["2", "3", "4", "5", "6", "7"], read
        assert [float(line.split()[0]) for line in read.splitlines()] == [0, 0.1, 0.2, 0.3, 0.4, 0.5], read
        assert calls.split("\n")[0] == "on_activated 1000 0" and calls.count("on_execute 1000") == 6, calls
        # At the end it is deactivated, as components of ours are.
        assert calls.splitlines()[-1].startswith("on_deactivated 1000"), calls


def same_state():
    # A real robot with one of its components as a program that knows nothing of simulated time: the same run as with all of them in our hosts.
    def state(*words):
        done = subprocess.run([f"{bin_dir}/rtse", "--json", "run", f"{source}/worlds/systems/obstacle_avoidance.xml", "--world", f"{source}/worlds/obstacle_course.sdf", "--duration", "20", *words],
                              text=True, capture_output=True, timeout=120, env={**os.environ, "PATH": f"{bin_dir}:{os.environ['PATH']}"})
        assert done.returncode == 0, done
        return json.loads(done.stdout)["state_hash"]

    # Also what goes through the ports, though the program stamps with the clock of the machine: nothing in it depends on chance.
    assert state() == state("--run-file", f"{source}/worlds/systems/obstacle_avoidance.run.yaml", "--twice", "--strict")


def faulty():
    # What a component of others does wrong is told by its name, and the run fails.
    with Run() as r:
        for fault, why in (("fail@3", "Alien ended in the ERROR state"), ("throw@3", "Alien ended in the ERROR state"), ("die@3", "process of Alien"), ("hang@3", "Alien: did not finish its tick")):
            code, err, read, calls = r.run("--hang-timeout", "1", start=r.start("--fault", fault))
            assert code == 1 and why in err, (fault, code, err)
            if fault in ("fail@3", "throw@3"):
                # The others go on, and the component is told as by its own context.
                assert "on_aborting 1000" in calls and calls.count("on_error 1000") > 5, (fault, calls)
            if fault == "die@3":
                assert "killed by signal 9" in err, err
        code, err, read, calls = r.run(start=r.start("--fault raise@3"))
        assert code == 1 and re.search(r"Alien ended in the ERROR state \(onExecute at 0.2 s: .*UNKNOWN.*; ValueError: no scan\)", err), (code, err)
        # Who is stopped is named.
        for fault in ("--fault stop@3", "--stop-at 3"):
            code, err, read, calls = r.run("--hang-timeout", "2", start=r.start(fault))
            assert code == 1 and re.search(r"process of Alien \(pid \d+\) is stopped, by a signal or a debugger", err), (fault, code, err)
        # Who hangs while it takes a sample is named beside the one who waits for it.
        code, err, read, calls = r.run("--hang-timeout", "3", start=r.start("--late 100000@3"))
        assert code == 1 and "From: did not finish its tick at 0.2 s" in err and "From.out waits for Alien.in" in err, (code, err)
        # It is told at once, by its own name and the time, where the command lives on.
        for options in ("--fault die@3", "--fault die@3 --context triggered --active"):
            system = r.system()
            with open(f"{r.path}/run.yaml", "w") as out:
                how = "tick" if "triggered" in options else "member"
                out.write(f"processes:\n  - command: {r.command(options)}; sleep 1000\n    components:\n      - {{name: Alien, join: {how}}}\n")
            done = subprocess.run([f"{bin_dir}/rtse", "run", system, "--world", empty, "--module-path", lib_dir, "--duration", "1000000", "--run-file", f"{r.path}/run.yaml"],
                                  text=True, capture_output=True, timeout=120)
            assert done.returncode == 1 and re.search(r"component Alien: .* was lost( in onExecute)? at 0.2 s", done.stderr), done
        # Where the command itself ends: also then the time is that of the tick, however far the others have come.
        code, err, read, calls = r.run("--hang-timeout", "1", start=r.start("--fault die@3"), duration="1000000")
        assert code == 1 and re.search(r"process of Alien .* killed by signal 9.*, at 0.2 s", err), err
        # Of several commands it is the one that has ended whose components are named.
        components = {"From": ("Relay", {"source": 1}), "Alien": ("Foreign", {}), "Other": ("Foreign", {})}
        system = profile(f"{r.path}/system.xml", components, [("From.out", "Alien.in"), ("From.out", "Other.in")])
        starts = [word for name in ("Alien", "Other") for word in ("--start", r.command("--fault die@3" if name == "Other" else "", name=name))]
        done = subprocess.run([f"{bin_dir}/rtse", "run", system, "--world", empty, "--module-path", lib_dir, "--duration", "1000000", *starts],
                              text=True, capture_output=True, timeout=120)
        assert done.returncode == 1 and "process of Other (" in done.stderr and ", at 0.2 s" in done.stderr, done
        # Also of one command that has started both; and a command whose components all answer is named alone.
        both = f"{r.command(name='Alien')} & {r.command('--fault die@3', name='Other')}"
        for commands, why in (((both,), "process of Other ("), (("true", r.command(name="Alien"), r.command(name="Other")), "process (true) ended with exit code 0")):
            starts = [word for command in commands for word in ("--start", command)]
            done = subprocess.run([f"{bin_dir}/rtse", "run", system, "--world", empty, "--module-path", lib_dir, "--duration", "1000000", *starts],
                                  text=True, capture_output=True, timeout=120)
            assert done.returncode == 1 and why in done.stderr, done
        # Who dies before the first tick has died, whatever else does not work then.
        for die in ("attach", "activate"):
            code, err, read, calls = r.run(start=r.start(f"--die {die}"))
            assert code == 1 and re.search(r"process of Alien \(.*\) was killed by signal 9", err), (die, err)


def late_receiver():
    # Who takes a sample, or joins, only after longer than any usual time-out of a call is waited for, and gets the next ones.
    with Run() as r:
        seen = []
        for late in ("", "--late 11000@3", "--attach-late 11000"):
            code, err, read, calls = r.run(start=r.start(late), duration="0.5")
            assert code == 0, (code, err)
            seen.append((read, calls.replace("asked 0 0\n", "")))
        assert len(set(seen)) == 1 and seen[0][0].count("\n") == 6, seen


def one_phase():
    # Links of one phase: what is sent is read in the next tick by components of others, too, and whatever the link says of who sends.
    with Run() as r:
        for kind, names in (("flush", ("Alien", "Other")), ("new", ("Alien", "Other")), ("flush", ("Other", "Alien"))):
            first, second = names
            r.count += 1
            journal = f"{r.path}/To-{r.count}.txt"
            components = {"From": ("Relay", {"source": 1}), "To": ("Relay", {"journal": journal, "stamp": 0}), "Alien": ("Foreign", {}), "Other": ("Foreign", {})}
            system = profile(f"{r.path}/system.xml", components, [("From.out", f"{first}.in"), (f"{first}.out", f"{second}.in"), (f"{second}.out", "To.in")], kind)
            starts = [word for name in names for word in ("--start", r.command(name=name))]
            done = subprocess.run([f"{bin_dir}/rtse", "run", system, "--world", empty, "--module-path", lib_dir, "--duration", "0.7", "--strict", *starts],
                                  text=True, capture_output=True, timeout=120)
            assert done.returncode == 0, done
            assert ("sent within the tick" in done.stderr) == (kind == "new"), done.stderr
            # Three links, so three ticks: what is stamped 0.2 is read at 0.3.
            seen = [(round(float(at) * 10), int(value)) for at, value in (line.split() for line in r.read(f"To-{r.count}.txt").splitlines())]
            assert seen == [(n - 1, n) for n in range(3, 8)], (kind, names, seen)


def one_phase_in_a_circle():
    # Whoever is called first, it is the same one each time, and the run says so.
    with Run() as r:
        components = {"From": ("Relay", {"source": 1}), "Alien": ("Foreign", {}), "Other": ("Foreign", {})}
        system = profile(f"{r.path}/system.xml", components, [("From.out", "Alien.in"), ("Alien.out", "Other.in"), ("Other.out", "Alien.in")])
        starts = [word for name in ("Alien", "Other") for word in ("--start", r.command(name=name))]
        done = subprocess.run([f"{bin_dir}/rtse", "run", system, "--world", empty, "--module-path", lib_dir, "--duration", "1", "--strict", "--twice", *starts],
                              text=True, capture_output=True, timeout=120)
        assert done.returncode == 0 and "connected in a circle" in done.stderr, done


def recorded():
    # A component without a service for parameters, and without one for observers, can be recorded, too.
    with Run() as r:
        code, err, read, calls = r.run("--record", f"{r.path}/run.mcap", start=r.start())
        assert code == 0, err
        done = subprocess.run([f"{bin_dir}/rtse", "--json", "recording", "info", f"{r.path}/run.mcap"], text=True, capture_output=True, timeout=60)
        samples = {channel["topic"]: channel["samples"] for channel in json.loads(done.stdout)["channels"]}
        assert samples["/Alien/out"] == 11 and samples["/From/out"] == 11, samples
        # A second one is equal: stamps of a clock of the machine do not count.
        code, err, read, calls = r.run("--record", f"{r.path}/again.mcap", start=r.start())
        assert code == 0, err
        done = subprocess.run([f"{bin_dir}/rtse", "recording", "compare", f"{r.path}/run.mcap", f"{r.path}/again.mcap", "--channel", "/Alien/out"], text=True, capture_output=True, timeout=60)
        assert done.returncode == 0 and "equal" in done.stdout, done
        # Whoever is replayed reads what it has read: from one of others with the receiver's stamps, and one of others in its own process.
        for into, start in (("To", ()), ("Alien", ("--start", r.start()[0]))):
            done = subprocess.run([f"{bin_dir}/rtse", "replay", f"{r.path}/run.mcap", "--into", into, "--compare", "--module-path", lib_dir, *start],
                                  text=True, capture_output=True, timeout=60)
            assert done.returncode == 0 and f"/{into}/out: 11 samples, equal" in done.stdout, done
        done = subprocess.run([f"{bin_dir}/rtse", "replay", f"{r.path}/run.mcap", "--into", "Alien", "--compare"], text=True, capture_output=True, timeout=60)
        assert done.returncode == 1 and "start that with --start COMMAND" in done.stderr, done


def lost_link():
    # Whoever throws when a sample comes loses the connection, as with OpenRTM-aist. A run in which that happens is none that has passed.
    with Run() as r:
        code, err, read, calls = r.run(start=r.start("--throw-at 4"))
        assert code == 1 and "rtse: connection lost: From.out to Alien.in: the peer throws UNKNOWN" in err, (code, err)
        assert [line.split()[1] for line in read.splitlines()] == ["2", "3", "4", "5"], read  # it has taken the fourth, too


def interrupted():
    # Whoever hangs while it joins, or is activated, keeps nobody from ending the run.
    with Run() as r:
        for late, journal in (("--attach-late 100000", ""), ("--activate-late 100000", "on_activated")):
            system = r.system()
            running = subprocess.Popen([f"{bin_dir}/rtse", "run", system, "--world", empty, "--module-path", lib_dir, "--start-timeout", "100", "--start", r.command(late)],
                                       text=True, stderr=subprocess.PIPE, stdout=subprocess.PIPE)
            end = time.monotonic() + 60
            while "asked" not in r.read(f"Alien-{r.count}.journal"):
                assert time.monotonic() < end and running.poll() is None, running.communicate()
                time.sleep(0.02)
            running.send_signal(signal.SIGINT)
            out, err = running.communicate(timeout=20)
            assert running.returncode == 1 and "run: interrupted" in err, (late, err)


def kept_hang_timeout():
    # A tick that takes longer than --hang-timeout fails the run, also when it ends in the end; who hangs is named a second after it began.
    with Run() as r:
        code, err, read, calls = r.run("--hang-timeout", "1", start=r.start("--fault 2500@3"))
        assert code == 1 and "Alien: did not finish its tick at 0.2 s after 1 s" in err, (code, err)
        code, err, read, calls = r.run(start=r.start("--fault 1800@3"))
        assert code == 0 and "Alien: did not finish its tick at 0.2 s for more than a second" in err, (code, err)


def between_others():
    # What components of others send each other is compared, too, without the stamps of their own clocks; a race there is found.
    with Run() as r:
        components = {"Alien": ("Foreign", {}), "Other": ("Foreign", {})}
        system = profile(f"{r.path}/system.xml", components, [("Alien.out", "Other.in")])

        def run(race, *words):
            starts = [word for name in ("Alien", "Other") for word in ("--start", r.command("--source" if name == "Alien" else "", race if name == "Alien" else "", name=name))]
            return subprocess.run([f"{bin_dir}/rtse", "run", system, "--world", empty, "--module-path", lib_dir, "--duration", "2", *words, *starts],
                                  text=True, capture_output=True, timeout=120)

        def is_found(race, *words):
            for _ in range(20):
                done = run(race, *words)
                if done.returncode == 1:
                    return done.stderr
                assert done.returncode == 0, done
            raise AssertionError(f"{race}: 20 runs, and nobody has noticed")

        log = f"{r.path}/run.hashlog"
        done = run("", "--twice", "--strict", "--hash-log", log)
        assert done.returncode == 0 and "stamps of their own clocks" in done.stderr, done
        octets = open(log, "rb").read()
        assert octets.count(b"Alien:out") == 1 and octets.count(struct.pack("<IIi", 0, 0, 7)) == 1, octets[-500:]
        err = is_found("--race clock", "--twice")
        assert re.search(r"first difference at 0 s .*port Alien:out \(out\): data is \d+ and \d+", err), err
        err = is_found("--race thread", "--strict")
        assert re.search(r"port Alien:out sent between two ticks at [\d.]+ s, in tick \d+", err), err


def wrong_start():
    with Run() as r:
        file = f"{r.path}/run.yaml"

        def refused(system, why, *words, code=2):
            done = subprocess.run([f"{bin_dir}/rtse", "run", system, "--world", empty, "--module-path", lib_dir, *words], text=True, capture_output=True, timeout=120)
            assert done.returncode == code and why in done.stderr, (words, done)
            return done.stderr

        for command, why in (("exit 3", "ended with exit code 3"), ("echo that is why >&2; sleep 100", "Alien: is not there after 0.5 s (echo that is why >&2; sleep 100): that is why")):
            with open(file, "w") as out:
                out.write(f"processes:\n  - {{command: '{command}', wait: 0.5, components: [Alien]}}\n")
            assert "process of Alien" in refused(r.system(), why, "--run-file", file, code=1) or "sleep" in command
        refused(r.system(Alien=("Relay", {})), "there is a module for each component", "--start", "sleep 100")
        refused(r.system(), 'folder "/nowhere" (--start-folder): there is no such folder', "--start", "sleep 100", "--start-folder", "/nowhere")
        refused(r.system(), "only its exec_cxt.sim_time.phase", "--start", "sleep 100", "--property", "Alien:conf.default.x=1")
        system = r.system()
        for text, why in (("processes: []", "needs a list"), ("process: 1", "has no key"), ("processes: [{command: x, components: [Nobody]}]", "no component Nobody"),
                          ("processes: [{command: x, components: [{name: Alien, phase: 99}]}]", "phase must be"), ("processes: [{command: x, components: [Alien, Alien]}]", "twice"),
                          ("processes: [{command: x, wait: nan, components: [Alien]}]", "wait must be"), ("processes: [{command: x, folder: nowhere, components: [Alien]}]", "no such folder"),
                          ("processes: [{command: x, command: y, components: [Alien]}]", 'key "command" appears twice'),
                          ("processes: [{command: x, components: [{name: Alien, join: up}]}]", "join must be"), ("][", "run.yaml:1")):
            with open(file, "w") as out:
                out.write(text)
            assert len(refused(system, why, "--run-file", file).splitlines()) == 1, text


globals()[case]()
