# Runs that depend on nothing: delivery by the clock between components of one phase, hash logs, `rtse diff`, `--twice` and `--strict`; and that a
# planted race is found.
#
# usage: chance.py CASE BIN_DIR LIB_DIR SOURCE_DIR
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import chance_system
from system import System

case, bin_dir, lib_dir, source = sys.argv[1:]
watchdog = 200  # [s]; a bound on hanging, not on speed
rtse = f"{bin_dir}/rtse"
avoidance = f"{source}/worlds/systems/obstacle_avoidance.xml"
course = f"{source}/worlds/obstacle_course.sdf"
empty = f"{source}/worlds/empty.sdf"
folder = tempfile.TemporaryDirectory()
place = pathlib.Path(folder.name)
(place / "tmp").mkdir()
environment = {**{key: value for key, value in os.environ.items() if key != "CI"}, "TMPDIR": str(place / "tmp")}


def call(*words, **more):
    done = subprocess.run([rtse, *map(str, words)], text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=watchdog, cwd=place,
                          env={**environment, **more.get("env", {})})
    return done.returncode, done.stdout, done.stderr


def run(text, *options, world=empty, **more):
    (place / "system.xml").write_text(text)
    return call("run", "system.xml", "--world", world, "--module-path", lib_dir, *options, **more)


# Every subscription type and pull, all links of one phase: in one process and in four the same, and the same again.
def links_of_one_phase():
    for interface in ("corba_cdr", "shared_memory"):
        for processes in ([], ["--one-process-each"]):
            code, out, err = run(chance_system.ring(interface), "--duration", "2", "--hash-log", f"{interface}{len(processes)}.log", "--strict", *processes)
            assert code == 0, (interface, processes, out, err)
        code, out, err = call("diff", f"{interface}0.log", f"{interface}1.log")
        assert code == 0, (interface, out, err)
        assert out.startswith("the same in "), out
    code, out, err = run(chance_system.ring("direct"), "--duration", "2", "--hash-log", "direct0.log", "--strict")
    assert code == 0, (out, err)
    for interface in ("shared_memory", "direct"):
        code, out, err = call("diff", "corba_cdr0.log", f"{interface}0.log")
        assert code == 0, (interface, out, err)  # how data travels is no part of what it is


def twice():
    code, out, err = run(chance_system.ring(), "--duration", "2", "--twice", "--one-process-each", "--strict")
    assert code == 0 and "  run " in out, (out, err)


# The log of a run with other noise differs, and the line names where, when, and the member with both values.
def first_difference():
    for seed in (1, 2):
        code, out, err = call("run", avoidance, "--world", course, "--duration", "5", "--seed", seed, "--hash-log", f"{seed}.log")
        assert code == 0, (out, err)
    code, out, err = call("diff", "1.log", "1.log")
    assert code == 0, (out, err)
    code, out, err = call("diff", "1.log", "2.log")
    assert code == 1 and "first difference at 0" in err, (code, out, err)
    code, out, _ = call("--json", "diff", "1.log", "2.log")
    found = json.loads(out)
    assert code == 1 and found["same"] is False and found["first"]["where"] and found["also"], out
    (place / "no.log").write_text("no log")
    code, out, err = call("diff", "1.log", "no.log")
    assert code == 2 and 'file "no.log": is no hash log' in err, err
    cut = (place / "1.log").read_bytes()
    (place / "cut.log").write_bytes(cut[: len(cut) * 2 // 3])
    code, out, err = call("diff", "1.log", "cut.log")
    assert code == 1 and ("first difference at" in err or "not come to the end" in err), err


# A change from outside is told while time passes, once, and not while it stands still: that is where the script of a run makes its changes, and
# where whoever looks on says good-bye.
def changed_from_outside():
    told = "nondeterministic: component Relay0 had its parameters changed by another process (set_configuration_set_values)"
    with System(bin_dir, lib_dir) as s:
        s.naming()
        s.server(empty, "--lockstep", "--paused", "--rtf", "0")
        host = s.host("Relay?instance_name=Relay0&conf.default.source=1")
        s.rtse("wait", "Relay0", "--state", "any", "--timeout", "60")
        s.rtse("act", "Relay0")
        s.until("a participant", lambda: s.participants())
        s.simctl("step", "10")
        s.rtse("conf", "Relay0", "set", "stamp", "0")
        s.rtse("deact", "Relay0")
        s.rtse("act", "Relay0")
        s.simctl("step", "10")
        assert "nondeterministic" not in s.log(host), s.log(host)
        stepping = s.start(f"{bin_dir}/simctl", "-s", s.server_id, "step", "1000000000")
        s.until("time that passes", lambda: s.seconds() > 0.03)
        for value in ("1", "0"):
            s.rtse("conf", "Relay0", "set", "stamp", value)
        s.until("what is told", lambda: told in s.log(host))
        assert s.log(host).count(told) == 1, s.log(host)
        s.rtse("con", "Relay0:out", "Relay0:in")
        s.rtse("deact", "Relay0")
        for told in ("port Relay0:out had a connection made or ended by another process (connect)", "component Relay0 had its state or a context changed by another process (deactivate_component)"):
            s.until(told, lambda: f"nondeterministic: {told}" in s.log(host))
        s.kill(stepping)


# Somebody whom no tick calls pushes between two ticks: in which tick that is read, nobody decides.
def sample_between_ticks():
    with System(bin_dir, lib_dir) as s:
        s.naming()
        s.server(empty, "--lockstep", "--paused", "--rtf", "1")
        host = s.host("Relay?instance_name=Relay0&exec_cxt.periodic.rate=1")
        s.start(sys.executable, "-B", f"{source}/tests/scenario/foreign_component.py", "Alien", "--names", s.names, "--source", "--active")
        s.rtse("wait", "Relay0", "Alien", "--state", "any", "--timeout", "60")
        s.rtse("con", "Alien:out", "Relay0:in", "-p", "dataport.subscription_type=flush")
        s.rtse("act", "Relay0")
        s.until("a participant", lambda: s.participants())
        stepping = s.start(f"{bin_dir}/simctl", "-s", s.server_id, "step", "1000000000", "--paced")
        told = "nondeterministic: port Relay0:in got a sample between two ticks at "
        s.until("what is told", lambda: told in s.log(host))
        s.kill(stepping)


# Who is called by a component of its own phase is named, in a strict run as a failure; with different phases there is nothing to say.
def service_of_one_phase():
    provider, consumer = "RTC:rtm-sim:example:EchoProvider:1.0.0", "RTC:rtm-sim:example:EchoConsumer:1.0.0"
    text = chance_system.system(chance_system.component("P", 10, provider), chance_system.component("C", 10, consumer),
                                chance_system.service("P.Echo", "C.Echo", provider, consumer))
    named = "a service between P.Echo and C.Echo, both of phase 1"
    code, out, err = run(text, "--duration", "0.5", "--strict")
    assert code == 1 and named in err, (code, out, err)
    code, out, err = run(text, "--duration", "0.5", env={"CI": "true"})
    assert code == 0 and named in err, (code, out, err)
    code, out, err = run(text, "--duration", "0.5", "--strict", "--property", "C:exec_cxt.sim_time.phase=2")
    assert code == 0, (code, out, err)


# Two components that call a third, in processes of their own and in one: who comes first, nobody decides.
def callers_of_one_phase():
    provider, consumer = "RTC:rtm-sim:example:EchoProvider:1.0.0", "RTC:rtm-sim:example:EchoConsumer:1.0.0"
    text = chance_system.system(chance_system.component("P", 10, provider), chance_system.component("C", 10, consumer), chance_system.component("D", 10, consumer),
                                chance_system.service("P.Echo", "C.Echo", provider, consumer), chance_system.service("D.Echo", "P.Echo", consumer, provider))
    named = "calls from C.Echo and D.Echo, both of phase 2, to P.Echo: give them different phases"
    options = ["--duration", "0.5", "--property", "C:exec_cxt.sim_time.phase=2", "--property"]
    for processes in ([], ["--one-process-each"]):
        code, out, err = run(text, *processes, *options, "D:exec_cxt.sim_time.phase=2", "--strict")
        assert code == 1 and named in err, (code, out, err)
    code, out, err = run(text, *options, "D:exec_cxt.sim_time.phase=2", env={"CI": "true"})
    assert code == 0 and named in err, (code, out, err)
    for processes in ([], ["--one-process-each"]):
        code, out, err = run(text, *processes, *options, "D:exec_cxt.sim_time.phase=3", "--strict")
        assert code == 0, (processes, code, out, err)
    # One client of two is no such thing: it calls one after the other.
    text = chance_system.system(chance_system.component("P", 10, provider), chance_system.component("Q", 10, provider), chance_system.component("C", 10, consumer),
                                chance_system.service("P.Echo", "C.Echo", provider, consumer), chance_system.service("Q.Echo", "C.Echo", provider, consumer))
    code, out, err = run(text, "--duration", "0.5", "--strict", "--property", "C:exec_cxt.sim_time.phase=2")
    assert code == 0, (code, out, err)


# The same run on other processors, as far as one can be made to look like others: the C library without AVX2 and AVX-512, the ray tracer with fewer
# instructions (up to AVX they give the same),
# the renderer with narrower vectors and more threads. Each pose, each scan, a picture a second.
def same_on_every_processor():
    laser, camera, drive = (f"RTC:rtm-sim:simulation:{name}:1.0.0" for name in ("RTCLaser", "RTCCamera", "RTCPosition2d"))
    avoid = "RTC:rtm-sim:navigation:LaserObstacleAvoid:1.0.0"
    text = chance_system.system(
        chance_system.component("RTCLaser0", 10, laser, device_id="pioneer2dx::laser"), chance_system.component("Avoid0", 10, avoid),
        chance_system.component("RTCPosition2d0", 10, drive, device_id="pioneer2dx::position2d"),
        chance_system.component("RTCCamera0", 1, camera, device_id="helicopter::camera"), chance_system.component("A", 1),
        chance_system.link("RTCLaser0.range", "Avoid0.range", "IDL:RTC/RangeData:1.0", source_id=laser, target_id=avoid),
        chance_system.link("Avoid0.velocity", "RTCPosition2d0.velocity", "IDL:RTC/TimedVelocity2D:1.0", source_id=avoid, target_id=drive),
        chance_system.link("RTCCamera0.image", "A.picture", "IDL:RTC/CameraImage:1.0", source_id=camera))
    world = place / "world.sdf"
    world.write_text(pathlib.Path(course).read_text().replace("</world>", "<include><uri>model://helicopter</uri><pose>0 0 3 0 0 0</pose></include></world>"))
    machines = {"this": {}, "libm": {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-AVX512F,-AVX512VL,-AVX512BW"}, "embree": {"RTMSIM_RAYS_ISA": "sse2"},
                "llvmpipe": {"LP_NATIVE_VECTOR_WIDTH": "128", "LP_NUM_THREADS": "8"}}
    for name, settings in machines.items():
        code, out, err = run(text, "--duration", "3", "--seed", "5", "--hash-log", f"{name}.log", "--resource-path", f"{source}/worlds", world=world,
                             env={"RTMSIM_RAYS_ISA": "avx", **settings})
        assert code == 0, (name, out, err)
        code, out, err = call("diff", "this.log", f"{name}.log")
        assert code == 0, (name, out, err)


def is_found(race, *options):
    for _ in range(20):
        code, out, err = run(chance_system.ring(A=race), "--duration", "1", *options)
        if code == 1:
            return err
        assert code == 0, (code, out, err)
    raise AssertionError(f"{race}: 20 runs, and nobody has noticed")


def race_of_a_thread():
    err = is_found("thread", "--strict")
    told = re.search(r"A:loose was written by a thread that no tick runs at (\d+\.?\d{0,3}) s, in tick (\d+)", err)
    assert told and int(told[2]) == round(float(told[1]) * 1000) // 10, err
    code, out, err = run(chance_system.ring(A="thread"), "--duration", "1", env={"CI": "true"})
    assert code == 0 and "A:loose" in err, (code, out, err)  # a warning
    code, out, err = run(chance_system.ring(A="thread"), "--duration", "1")
    assert code == 0 and "A:loose" not in err, (code, out, err)


def race_of_the_clock():
    err = is_found("clock", "--twice")
    assert "first difference at 0" in err and "(out): data is " in err, err


def race_of_an_address():
    err = is_found("address", "--twice")
    assert "port A:out (out)" in err, err


globals()[case]()
folder.cleanup()
