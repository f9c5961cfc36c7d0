# `rtse run`: what it says of runs that go well, badly and not at all, in its exit code, on standard error and in JUnit; and that nothing of it stays.
#
# usage: runs.py CASE BIN_DIR LIB_DIR SOURCE_DIR
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree

case, bin_dir, lib_dir, source = sys.argv[1:]
watchdog = 120  # [s]; a bound on hanging, not on speed
rtse = f"{bin_dir}/rtse"
avoidance = f"{source}/worlds/systems/obstacle_avoidance.xml"
course = f"{source}/worlds/obstacle_course.sdf"
empty = f"{source}/worlds/empty.sdf"


class Place:
    def __enter__(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name)
        (self.path / "tmp").mkdir()
        self.environment = {**os.environ, "TMPDIR": str(self.path / "tmp")}
        return self

    def __exit__(self, kind, *_):
        left = list((self.path / "tmp").iterdir())
        self.folder.cleanup()
        assert kind or not left, f"left behind: {left}"

    def write(self, name, text):
        (self.path / name).write_text(text)
        return str(self.path / name)

    # A system of relays, name -> configuration.
    def relays(self, **relays):
        components = ""
        for name, values in relays.items():
            data = "".join(f'<rts:ConfigurationData rts:name="{key}" rts:data="{value}"/>' for key, value in values.items())
            components += (f'<rts:Components xsi:type="rtsExt:component_ext" rts:id="RTC:rtm-sim:test:Relay:1.0.0" rts:pathUri="localhost/{name}.rtc" rts:instanceName="{name}" '
                           f'rts:activeConfigurationSet="default" rts:compositeType="None" rts:isRequired="true"><rts:ConfigurationSets rts:id="default">{data}</rts:ConfigurationSets>'
                           f'<rts:ExecutionContexts xsi:type="rtsExt:execution_context_ext" rts:id="0" rts:kind="PERIODIC" rts:rate="10.0"/></rts:Components>')
        return self.write("system.xml", '<?xml version="1.0" encoding="UTF-8"?><rts:RtsProfile xmlns:rts="http://www.openrtp.org/namespaces/rts" '
                          'xmlns:rtsExt="http://www.openrtp.org/namespaces/rts_ext" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" '
                          f'rts:id="RTSystem:rtm-sim:Test:1" rts:version="0.2">{components}</rts:RtsProfile>')

    def start(self, system, world, *options):
        self.junit = self.path / "junit.xml"
        junit = [] if "--junit" in options else ["--junit", str(self.junit)]
        return subprocess.Popen([rtse, "run", system, "--world", world, "--module-path", lib_dir, *junit, *options], text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=self.environment, cwd=self.path)

    # Exit code, standard output, standard error.
    def run(self, *words):
        process = self.start(*words)
        out, err = process.communicate(timeout=watchdog)
        return process.returncode, out, err

    # name -> "" or what is wrong, of the only seed or of one of several.
    def verdicts(self, seed=None):
        suite = xml.etree.ElementTree.parse(self.junit).getroot()
        cases = suite.findall("testcase")
        wrong = [case for case in cases if case.find("failure") is not None or case.find("error") is not None]
        assert int(suite.get("tests")) == len(cases) and int(suite.get("failures")) + int(suite.get("errors")) == len(wrong)
        return {case.get("name"): next((problem.get("message") for problem in case if problem.tag in ("failure", "error")), "") for case in cases
                if seed is None or case.get("classname").endswith(f".seed_{seed}")}


def is_running(pid):
    try:
        return pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except FileNotFoundError:
        return False


def expectations(*lines):
    return "".join(f"- {line}\n" for line in lines)


def of(verdicts, beginning):
    found = [problem for name, problem in verdicts.items() if name.startswith(beginning)]
    assert len(found) == 1, (beginning, verdicts)
    return found[0]


# Each kind of expectation, met and unmet.
def kinds():
    with Place() as place:
        met = place.write("met.yaml", expectations(
            "path_length: {model: pioneer2dx, min: 0.5, max: 5}", "reach: {model: pioneer2dx, region: [-6, -6, 6, 6], within: 1}",
            "stay: {model: pioneer2dx, region: [-6, -6, 6, 6]}", "no_contact: {model: pioneer2dx}",
            "value: {port: 'LaserObstacleAvoid0:velocity', member: data.vx, min: -0.3, max: 0.3}", "value: {port: 'RTCLaser0:range', member: 'ranges[0]', min: 0}",
            "state: {component: RTCLaser0, is: Active}", "command: 'test -s \"$RTMSIM_RECORD\" && simctl_stats=$(\"" + bin_dir + "/simctl\" stats)'",
            f"command: '\"{bin_dir}/rtse\" ls RTCLaser0.rtc'"))
        code, out, err = place.run(avoidance, course, "--duration", "5", "--expect", met)
        assert code == 0 and err == "" and out.startswith("passed"), (code, out, err)
        verdicts = place.verdicts()
        assert len(verdicts) == 12 and not any(verdicts.values()), verdicts

        unmet = place.write("unmet.yaml", expectations(
            "path_length: {model: pioneer2dx, max: 0.1}", "reach: {model: pioneer2dx, region: [50, 50, 60, 60]}", "stay: {model: pioneer2dx, region: [50, 50, 60, 60]}",
            "no_contact: {model: pioneer2dx, except: []}", "value: {port: 'LaserObstacleAvoid0:velocity', member: data.vx, min: 5}",
            "state: {component: RTCLaser0, is: Inactive}", "command: 'echo first of all; echo that is why; exit 3'"))
        code, out, err = place.run(avoidance, course, "--duration", "5", "--expect", unmet)
        assert code == 1 and out.startswith("FAILED"), (code, out, err)
        verdicts = place.verdicts()
        for beginning, text in {"path_length: {model: pioneer2dx": "expected at most 0.1", "reach": "no nearer than", "stay": "it was at", "no_contact": "it touched ground_plane",
                                "value: {port: Laser": "expected at least 5", "state": "it is Active", "command": "exit code 3: that is why"}.items():
            assert text in of(verdicts, beginning), (beginning, verdicts)
        details = [failure.text for failure in xml.etree.ElementTree.parse(place.junit).getroot().iter("failure") if failure.text]
        assert details == ["first of all\nthat is why\n"], details
        assert "\nrtse: model pioneer2dx: its path was " in "\n" + err and "rtse: component RTCLaser0: it is Active (state: {" in err, err
        assert len(err.splitlines()) == 7 and verdicts["runs for 5 s"] == "" and verdicts["no component ends in an error"] == "", (err, verdicts)


# A joint that swings, and a box that falls onto two fingers.
def joints_and_grips():
    plate = "<collision name='c'><geometry><box><size>0.2 0.2 0.1</size></box></geometry></collision>"
    hand = ("<model name='hand'><pose>3 0 0 0 0 0</pose>" + "".join(f"<link name='{name}'><pose>{x} 0 0.5 0 0 0</pose>{plate}</link><joint name='{name}_foot' type='fixed'><parent>world</parent><child>{name}</child></joint>"
            for name, x in (("left", -0.15), ("right", 0.15), ("far", 5)))
            + "<gripper name='grip'><gripper_link>left</gripper_link><gripper_link>hand::right</gripper_link><palm_link>left</palm_link></gripper>"
            "<gripper name='other'><gripper_link>left</gripper_link><gripper_link>far</gripper_link></gripper></model>")
    box = "<model name='box'><pose>3 0 0.8 0 0 0</pose><link name='l'><collision name='c'><geometry><box><size>0.4 0.1 0.1</size></box></geometry></collision></link></model>"
    swing = ("<model name='swing'><link name='post'/><link name='rod'><pose>0 0 2 0 0 0</pose><inertial><pose>0 0 -0.5 0 0 0</pose><mass>1</mass></inertial></link>"
             "<joint name='foot' type='fixed'><parent>world</parent><child>post</child></joint>"
             "<joint name='hip' type='revolute'><parent>post</parent><child>rod</child><axis><xyz>0 1 0</xyz><initial_position>1</initial_position></axis></joint></model>")
    with Place() as place:
        world = place.write("world.sdf", pathlib.Path(empty).read_text().replace("</world>", hand + box + swing + "</world>"))
        system = place.relays(Relay0={"source": 1})
        met = place.write("met.yaml", expectations("joint: {model: swing, name: hip, min: -0.2, max: 0.2, within: 2}", "joint: {model: swing, name: hip, min: -1.1, max: 1.1}",
                                                   "holds: {gripper: hand::grip, model: box}", "holds: {gripper: grip, model: box}"))
        code, out, err = place.run(system, world, "--duration", "2", "--expect", met)
        assert code == 0 and out.startswith("passed"), (code, out, err)
        unmet = place.write("unmet.yaml", expectations("joint: {model: swing, name: hip, min: 2, within: 1}", "joint: {model: swing, name: hip, min: 0.5}", "holds: {gripper: other, model: box}",
                                                       "holds: {gripper: grip, model: swing}"))
        code, out, err = place.run(system, world, "--duration", "2", "--expect", unmet)
        verdicts = place.verdicts()
        assert code == 1 and len([line for line in err.splitlines() if line.startswith("rtse: ")]) == 4, (code, out, err)
        near = of(verdicts, "joint: {model: swing, name: hip, min: 2")
        assert "it came no nearer than " in near and " s, expected at least 2 within 1 s" in near, verdicts
        assert ", expected at least 0.5" in of(verdicts, "joint: {model: swing, name: hip, min: 0.5"), verdicts
        assert "only left touches box" in of(verdicts, "holds: {gripper: other"), verdicts
        assert "no link of it touches swing; it has left, right" in of(verdicts, "holds: {gripper: grip, model: swing"), verdicts
        for line, why in (("joint: {model: swing, name: hp, min: 0}", 'model "swing" has no joint "hp"; joints: hip'), ("joint: {model: swig, name: hip, min: 0}", 'no model "swig"; it has'),
                          ("holds: {gripper: hand, model: box}", 'gripper "hand" may be hand::grip or hand::other'), ("holds: {gripper: claw, model: box}", 'no gripper "claw"; grippers: hand::grip, hand::other'),
                          ("holds: {gripper: grip, model: bx}", 'no model "bx"; it has'), ("holds: {gripper: grip, model: hand}", "gripper hand::grip is of this model itself"),
                          ("joint: {model: swing, name: hip, min: .nan}", "finite")):
            code, out, err = place.run(system, world, "--duration", "1000000", "--expect", place.write("e.yaml", expectations(line)))
            assert code == 2 and out == "" and len(err.splitlines()) == 1 and why in err, (line, code, out, err)


# A name that does not exist is found before the run: as a wrong command line, with what there is, and no result.
def unknown_names():
    with Place() as place:
        for line, why in (("path_length: {model: nobody, min: 1}", 'the world has no model "nobody"; it has'), ("no_contact: {model: pioneer2dx, except: [wal]}", 'no model "wal"; it has'),
                          ("value: {port: 'RTCLaser0:range', member: data.nosuch, min: 0}", "have no number data.nosuch; they have tm, ranges"),
                          ("value: {port: 'RTCLaser0:ranges', member: data, min: 0}", 'no port "ranges"; it has'), ("value: {port: 'Laser0:range', member: data, min: 0}", 'no component "Laser0"; it has'),
                          ("state: {component: RTCLaser, is: Active}", 'no component "RTCLaser"; it has RTCLaser0'), ("state: {component: RTCLaser0, is: Running}", "is must be")):
            file = place.write("e.yaml", expectations(line))
            for more in ([], ["--seeds", "1..3"]):
                code, out, err = place.run(avoidance, course, "--duration", "1000000", "--expect", file, *more)
                assert code == 2 and out == "" and len(err.splitlines()) == 1 and err.startswith("rtse: file ") and why in err, (line, code, out, err)
                assert any(why in problem for problem in place.verdicts().values()), place.verdicts()
        # What cannot be run as it is has no result either.
        code, out, err = place.run(avoidance, course, "--property", "Nobody:a=b")
        assert code == 2 and out == "" and "Nobody" in err, (code, out, err)


# What is not a number is within no bounds.
def not_a_number():
    with Place() as place:
        system = place.relays(Relay0={"source": 1, "nan_at": 10})
        bounds = place.write("e.yaml", expectations("value: {port: 'Relay0:number', member: data, min: 0, max: 100}"))
        code, out, err = place.run(system, empty, "--duration", "3", "--expect", bounds)
        assert code == 1 and "NaN" in of(place.verdicts(), "value"), (code, err)


# A run that cannot be judged is an error in the report, with the reason, and never an old or an empty report.
def crash():
    with Place() as place:
        place.write("junit.xml", "<testsuite tests='0'/>")
        code, out, err = place.run(place.relays(Relay0={"source": 1, "crash_at": 15}, Relay1={}), empty, "--duration", "10", "--one-process-each")
        assert code == 1 and "host of Relay0 was killed by signal 6" in err and "--keep" in err, (code, err)
        assert "killed by signal 6" in place.verdicts()["runs for 10 s"]
        code, out, err = place.run(place.relays(Relay0={"source": 1, "crash_at": 15}), empty, "--duration", "10", "--seeds", "1..3", "-j", "2")
        assert code == 1 and "0 of 3 seeds passed" in out and "seed 2: host of Relay0 was killed" in err, (code, out, err)
        for seed in (1, 2, 3):
            assert "killed by signal 6" in place.verdicts(seed)["runs for 10 s"]


# Of several components in a process the one whose callback ends it is named, with the tick, and simulated time stops there.
def sudden_ends():
    with Place() as place:
        for fault, end in (({"crash_at": 1}, "was killed by signal 6 (Aborted) in onExecute of Guilty at 0 s, in tick 1"),
                           ({"crash_at": 15}, "was killed by signal 6 (Aborted) in onExecute of Guilty at 1.4 s, in tick 15"),
                           ({"exit_at": 15}, "ended with exit code 3 in onExecute of Guilty at 1.4 s, in tick 15"),
                           ({"kill_at": 15}, "was killed by signal 9 (Killed) in the tick of Guilty at 1.4 s, in tick 15"),
                           ({"crash_active": 1}, "was killed by signal 6 (Aborted) in onActivated of Guilty")):
            system = place.relays(First={"source": 1}, Guilty=fault, Last={})
            phases = [word for name, phase in (("First", 0), ("Last", 2)) for word in ("--property", f"{name}:exec_cxt.sim_time.phase={phase}")]
            code, out, err = place.run(system, empty, "--duration", "1000", *phases)
            assert code == 1 and f"rtse: host of First, Guilty, Last {end}" in err and "path" not in out, (fault, code, out, err)
            if "tick 15" in end:
                assert "  1.4 s simulated" in out, (fault, out)


def hang():
    with Place() as place:
        code, out, err = place.run(place.relays(Relay0={"source": 1, "hang_at": 15}, Relay1={}), empty, "--duration", "10", "--hang-timeout", "2", "--one-process-each")
        assert code == 1 and "Relay0: did not finish its tick" in err and "Relay1" not in err, (code, err)
        assert "Relay0" in place.verdicts()["runs for 10 s"]


def missing_module():
    with Place() as place:
        system = place.write("system.xml", pathlib.Path(avoidance).read_text().replace("RTCLaser:1.0.0", "NoSuchThing:1.0.0"))
        code, out, err = place.run(system, course, "--duration", "1")
        assert code == 1 and "NoSuchThing" in err and "killed" not in err, (code, err)
        assert "NoSuchThing" in place.verdicts()["runs for 1 s"]


# A world that is not whole is said to be so, and a component in its error state fails the run.
def incomplete():
    with Place() as place:
        world = place.write("world.sdf", pathlib.Path(course).read_text().replace("</world>", "<include><uri>model://nosuchthing</uri></include></world>"))
        environment = {**place.environment, "RTMSIM_RESOURCE_PATH": f"{source}/worlds"}
        place.environment = environment
        code, out, err = place.run(avoidance, world, "--duration", "1")
        assert code == 0 and "nosuchthing" in err, (code, err)
        code, out, err = place.run(place.write("system.xml", pathlib.Path(avoidance).read_text().replace("pioneer2dx::laser", "pioneer2dx::none")), course, "--duration", "1")
        assert code == 1 and "pioneer2dx::none" in err, (code, err)


def interrupted():
    with Place() as place:
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            for delay in (0.05, 0.4, 1.5):
                process = place.start(avoidance, course, "--duration", "12345")
                time.sleep(delay)  # some moment of its life
                for _ in range(3):
                    process.send_signal(number)
                    time.sleep(0.03)
                out, err = process.communicate(timeout=watchdog)
                # Before it can catch anything it may just end.
                assert process.returncode == 1 and "interrupted" in err or process.returncode == -number and delay == 0.05, (number, delay, process.returncode, err)
        process = place.start(avoidance, course, "--duration", "12345", "--seeds", "1..20", "-j", "2")
        time.sleep(2)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=watchdog)
        assert process.returncode == 1 and "interrupted after 2 of 20 seeds" in err, (process.returncode, out, err)
        assert "interrupted" in place.verdicts(1)["runs for 12345 s"]


# A simulator that has the id already is left alone.
def foreign_simulator():
    with Place() as place:
        script = f'id=$((5000 + $$ * 7 % 5000)); "{bin_dir}/sim-server" -s $id --paused "{empty}" & echo $id $!; for i in $(seq 100); do "{bin_dir}/simctl" -s $id stats >/dev/null 2>&1 && break; ' \
                 f'sleep 0.1; done; exec "{rtse}" run "{avoidance}" --world "{course}" --duration 2'
        process = subprocess.Popen(["bash", "-c", script], text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=place.environment)
        server_id, pid = process.stdout.readline().split()
        try:
            # Its output stays open in the simulator.
            assert process.wait(watchdog) == 0, process.stderr.read()
            stats = json.loads(subprocess.run([f"{bin_dir}/simctl", "-s", server_id, "--json", "stats"], capture_output=True, text=True, check=True).stdout)
            assert stats["steps"] == 0 and stats["pid"] == int(pid), stats
        finally:
            os.kill(int(pid), signal.SIGTERM)
        process.communicate(timeout=watchdog)


# Commands that do not end, what they leave behind, names with blanks, and phases by property.
def odds_and_ends():
    with Place() as place:
        world = place.write("world.sdf", pathlib.Path(empty).read_text().replace(
            "</world>", "<model name='my \"big\" box'><pose>3 3 1 0 0 0</pose><link name='l'><collision name='c'><geometry><box><size>1 1 1</size></box></geometry></collision></link></model></world>"))
        journal = place.path / "journal"
        system = place.relays(Relay0={"source": 1}, Relay1={"journal": journal})
        e = place.write("e.yaml", expectations("path_length: {model: 'my \"big\" box', max: 2}", "no_contact: {model: 'my \"big\" box'}", f"command: 'sleep 1000 & echo $! > {place.path}/pid'"))
        code, out, err = place.run(system, world, "--duration", "2", "--expect", e, "--property", "Relay1:exec_cxt.sim_time.phase=5", "--keep", str(place.path / "kept"))
        assert code == 0, (code, out, err)
        pid = int((place.path / "pid").read_text())
        assert not is_running(pid), "the command's child is still there"
        kept = {path.name for path in (place.path / "kept").iterdir()}
        assert {"record.txt", "rtcd-0.log", "sim-server.log", "system.xml"} <= kept, kept
        assert "phase 5" in (place.path / "kept/rtcd-0.log").read_text()
        for words in (["--property", "Nobody:a=b"], ["--property", "x"], ["--property", "Relay1:exec_cxt.sim_time.phase=99"]):
            code, out, err = place.run(system, world, "--duration", "1", *words)
            assert code == 2 and "property" in err, (code, err)
        for words in (["--duration", "nan"], ["--seeds", ""], ["--seeds", "3..1"], ["--seed", "-5"], ["--seeds", "1..2", "--seed", "3"], ["--hang-timeout", "0"]):
            code, out, err = place.run(system, world, *words)
            assert code == 2 and len(err.splitlines()) == 1, (words, code, err)
        os.mkfifo(place.path / "pipe")
        missing = f"{place.path}/missing"
        mistakes = {("--module-path", missing): f"module path \"{missing}\"", ("--resource-path", missing): "resource path", ("--junit", system): "something else too",
                    ("--picture", str(place.path / "pipe")): "no ordinary file", ("--picture", f"{place.path}/same", "--junit", f"{place.path}/same"): "something else too"}
        for words, why in mistakes.items():
            code, out, err = place.run(system, world, *words)
            assert code == 2 and why in err and "--keep" not in err, (words, code, err)
        e = place.write("e.yaml", expectations("value: {port: 'Relay1:in', member: data, min: 0}"))
        code, out, err = place.run(system, world, "--duration", "1", "--expect", e)
        assert code == 2 and "Relay1:in: is not an OutPort" in err, err
        # What a command says need not be text, and the signals are as they are for a program started by a shell.
        e = place.write("e.yaml", expectations("command: 'head -c 300 /dev/urandom; exit 3'", "command: 'yes | head -n 1; grep -q \"^SigIgn:.*0000000000000000$\" /proc/self/status'"))
        code, out, err = place.run(system, world, "--duration", "1", "--expect", e)
        verdicts = place.verdicts()
        assert of(verdicts, "command: head").startswith("it ended with exit code 3") and of(verdicts, "command: yes | head") == "", verdicts
        # What a component warns of is said, though its log is not kept.
        code, out, err = place.run(system, world, "--duration", "1", "--property", "Relay1:exec_cxt.sim_time.server_id=none")
        assert code == 0 and "exec_cxt.sim_time.server_id" in err and "none" in err, (code, err)
        bad = place.write("bad.xml", pathlib.Path(system).read_text().replace('rts:rate="10.0"', 'rts:rate="nan"'))
        code, out, err = place.run(bad, world)
        assert code == 2 and "rate" in err and "nan" in err, err
        with open("/dev/full", "w") as full:
            done = subprocess.run([rtse, "run", system, "--world", world, "--duration", "1", "--module-path", lib_dir], text=True, stdout=full, stderr=subprocess.PIPE, env=place.environment)
        assert done.returncode == 1 and done.stderr.count("standard output: cannot be written") == 1, done
        code, out, err = place.run(system, world, "--picture", f"{missing}/p.png")
        assert code == 2 and missing in err, err


def child_of(process, program):
    """The pid of the child that runs that program, once there is one."""
    while process.poll() is None:
        for pid in pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split():
            try:
                if pathlib.Path(f"/proc/{pid}/comm").read_text().strip() == program:
                    return int(pid)
            except FileNotFoundError:
                continue
        time.sleep(0.01)
    raise AssertionError(f"no {program}: {process.communicate()}")


def has_moved(process):
    try:
        words = pathlib.Path(f"/proc/{child_of(process, 'sim-server')}/cmdline").read_text().split("\0")
    except FileNotFoundError:
        return False
    if "--server-id" not in words:
        return False  # it is just beginning to be that program
    done = subprocess.run([f"{bin_dir}/simctl", "-s", words[words.index("--server-id") + 1], "--json", "stats"], capture_output=True, text=True, timeout=watchdog)
    return done.returncode == 0 and json.loads(done.stdout)["sim_time"] > 0


# A naming service that hangs is named, whenever it does, and nothing else is blamed.
# On a terminal the line of progress is written, and no program but those of the run is started for it.
def progress():
    with Place() as place:
        calls = place.path / "simctl.calls"
        for name, text in (("rtse", None), ("simctl", f'#!/bin/sh\necho "$@" >> {calls}\nexec {bin_dir}/simctl "$@"\n')):
            shutil.copy(rtse, place.path / name) if text is None else place.write(name, text)
            (place.path / name).chmod(0o755)
        system = place.relays(First={"source": 1})
        environment = {**place.environment, "PATH": f"{bin_dir}:{os.environ['PATH']}", "LD_LIBRARY_PATH": lib_dir}
        ours, theirs = os.openpty()
        process = subprocess.Popen([place.path / "rtse", "run", system, "--world", empty, "--module-path", lib_dir, "--duration", "5", "--realtime"],
                                   stdout=subprocess.DEVNULL, stderr=theirs, env=environment, cwd=place.path)
        os.close(theirs)
        seen = b""
        try:
            while piece := os.read(ours, 4096):
                seen += piece
        except OSError:
            pass  # nobody has the other end any more
        os.close(ours)
        assert process.wait(timeout=watchdog) == 0, seen
        assert b" of 5.0 s" in seen, seen
        assert not calls.exists(), calls.read_text()


def hung_naming():
    with Place() as place:
        for moment in ("start", "drive"):
            process = place.start(avoidance, course, "--duration", "10", "--realtime", "--start-timeout", "60" if moment == "drive" else "3")
            names = child_of(process, "omniNames")
            while moment == "drive" and not has_moved(process):
                time.sleep(0.01)
            os.kill(names, signal.SIGSTOP)
            out, err = process.communicate(timeout=watchdog)
            assert process.returncode == 1 and "\nrtse: name server" in f"\n{err}" and "gone" not in err, (moment, out, err)
            assert not is_running(names), "it is still there"
        # Also while nothing needs it.
        process = place.start(avoidance, course, "--duration", "12345", "--realtime", "--hang-timeout", "2")
        names = child_of(process, "omniNames")
        while not has_moved(process):
            time.sleep(0.01)
        os.kill(names, signal.SIGSTOP)
        out, err = process.communicate(timeout=watchdog)
        assert process.returncode == 1 and "\nrtse: name server" in f"\n{err}" and "stopped" in err, (out, err)


# How long a start may take can be said, and a long one is told.
def slow_start():
    with Place() as place:
        never = place.write("omniNames", "#!/bin/sh\nexec sleep 1000\n")
        os.chmod(never, 0o755)
        place.environment["PATH"] = f"{place.path}:{place.environment['PATH']}"
        code, out, err = place.run(avoidance, course, "--start-timeout", "6")
        assert code == 1 and "name server: not ready after" in err and "s; waiting up to 6 s (--start-timeout)" in err, err
        assert "not ready after 6 s (--start-timeout)" in err, err
        code, out, err = place.run(avoidance, course, "--start-timeout", "0")
        assert code == 2 and "--start-timeout" in err, err


globals()[case]()
