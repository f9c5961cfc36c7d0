# Whole systems in real time, one case per run: systems.py CASE BIN_DIR LIB_DIR SOURCE_DIR. Processes are killed in the middle, hosted together and apart, saved and
# restored; the rest lives on, and the robot never drives without its commander.
import fcntl
import json
import os
import pty
import re
import select
import struct
import subprocess
import sys
import termios
import time

from rig import Rig, await_
from system import watchdog

case, *folders = sys.argv[1:]
rig = Rig(*folders)
avoidance = ("RTCLaser0", "LaserObstacleAvoid0", "RTCPosition2d0")
device = rig.device


def wire():
    rig.there(*avoidance)
    rig.rtse("con", "RTCLaser0:range", "LaserObstacleAvoid0:range", "-i", "scans")
    rig.rtse("con", "LaserObstacleAvoid0:velocity", "RTCPosition2d0:velocity", "-i", "commands")
    rig.rtse("act", *avoidance)
    rig.driving("a driving robot")
    rig.rtse("save", rig.path("system.xml"))
    rig.rtse("check", rig.path("system.xml"), "--state", "saved")


# Each component in a process of its own.
def apart():
    rig.server()
    names = rig.naming()
    hosts = {name: rig.host(device(name) if name.startswith("RTC") else name) for name in ("RTCLaser", "LaserObstacleAvoid", "RTCPosition2d")}
    wire()
    return names, hosts


# After the restart of what was killed: only what the dead one had is made again.
def recover(*components):
    await_("the components again", lambda: all(rig.state(component) == "Inactive" for component in components))
    rig.rtse("load", rig.path("system.xml"))
    rig.rtse("act", *components)
    rig.driving("a robot that drives again")
    rig.rtse("check", rig.path("system.xml"), "--state", "saved")


def kill_simulator():
    simulator = rig.server()
    rig.naming()
    rig.host(device("RTCLaser"), "LaserObstacleAvoid", device("RTCPosition2d"))
    wire()
    for _ in range(2):
        rig.kill(simulator)
        for component in avoidance:
            assert rig.state(component) == "Active", component
        simulator = rig.server()
        rig.driving("a robot that drives in the new world")
    assert [rig.state(component) for component in avoidance] == ["Active"] * 3


def kill_host():
    rig.server()
    rig.naming()
    host = rig.host(device("RTCLaser"), "LaserObstacleAvoid", device("RTCPosition2d"))
    wire()
    rig.kill(host)
    rig.standing("a robot without commander that stands")
    rig.host(device("RTCLaser"), "LaserObstacleAvoid", device("RTCPosition2d"))
    recover(*avoidance)


def kill_avoider():
    _, hosts = apart()
    rig.kill(hosts["LaserObstacleAvoid"])
    await_("a robot that gets no velocities any more and stands", lambda: abs(rig.speed()) < 0.01)
    assert rig.state("RTCLaser0") == "Active" and rig.state("RTCPosition2d0") == "Active"
    rig.host("LaserObstacleAvoid")
    recover("LaserObstacleAvoid0")


def kill_sensor():
    _, hosts = apart()
    rig.kill(hosts["RTCLaser"])
    await_("a robot that sees nothing any more and stands", lambda: abs(rig.speed()) < 0.01)
    assert rig.state("LaserObstacleAvoid0") == "Active" and rig.state("RTCPosition2d0") == "Active"
    rig.host(device("RTCLaser"))
    recover("RTCLaser0")


def kill_naming():
    names, _ = apart()
    rig.kill(names)
    rig.driving("a robot that drives without naming service")
    rig.naming()
    rig.there(*avoidance)
    rig.rtse("check", rig.path("system.xml"), "--state", "saved")
    rig.driving("a robot that still drives")


def one_process():
    rig.server()
    rig.naming()
    rig.host(device("RTCLaser"), "LaserObstacleAvoid", device("RTCPosition2d"), device("RTCSimulation"))
    wire()


def four_processes():
    rig.server()
    rig.naming()
    for component in (device("RTCLaser"), "LaserObstacleAvoid", device("RTCPosition2d"), device("RTCSimulation")):
        rig.host(component)
    wire()


def late_naming():
    rig.server()
    for component in (device("RTCLaser"), "LaserObstacleAvoid", device("RTCPosition2d")):
        rig.host(component)
    rig.naming()
    wire()


def late_simulator():
    rig.naming()
    rig.host(device("RTCLaser"), "LaserObstacleAvoid", device("RTCPosition2d"))
    rig.there(*avoidance)
    refused = rig.try_rtse("act", "RTCLaser0")
    assert refused.returncode == 1 and "RTCLaser0" in refused.stderr, refused
    await_("the error state", lambda: rig.state("RTCLaser0") == "Error")
    rig.server()
    rig.rtse("reset", "RTCLaser0")
    wire()


def model(name, x, y):
    return f"<include><uri>model://pioneer2dx_hokuyo</uri><name>{name}</name><pose>{x} {y} 0 0 0 0</pose></include>"


def wall(name, x, y):
    box = "<geometry><box><size>0.2 2 2</size></box></geometry>"
    return f"<model name='{name}'><static>true</static><pose>{x} {y} 1 0 0 0</pose><link name='l'><collision name='c'>{box}</collision></link></model>"


def two_robots_world():
    ground = "<model name='ground_plane'><static>true</static><link name='l'><collision name='c'><geometry><plane/></geometry></collision></link></model>"
    parts = [ground, model("left", 0, 10), model("right", 0, -10), wall("near", 2.1, 10), wall("far", 4.1, -10)]
    with open(rig.path("two.sdf"), "w") as file:
        file.write(f"<sdf version='1.9'><world name='two'>{''.join(parts)}</world></sdf>")
    return rig.path("two.sdf")


def ahead(laser):
    scan = json.loads(rig.rtse("--json", "print", f"{laser}:range", "-n", "1", "-t", "30"))["value"]
    ranges = scan["ranges"]
    return ranges[len(ranges) // 2]


def two_robots():
    rig.server(world=two_robots_world())
    rig.naming()
    # The second of a kind gets the first robot: it is the configuration that counts and not the order.
    robots = {"RTCLaser0": "right::laser", "RTCLaser1": "left::laser", "RTCPosition2d0": "right::position2d", "RTCPosition2d1": "left::position2d"}
    rig.host(*(device(name[:-1], f"conf.default.device_id={iface}") for name, iface in robots.items()))
    rig.there(*robots)
    for name, iface in robots.items():
        assert f"device_id = {iface}" in rig.rtse("cat", name), name
    rig.rtse("act", *robots)
    assert 1 < ahead("RTCLaser1") < 2.5 < ahead("RTCLaser0") < 4.5, (ahead("RTCLaser1"), ahead("RTCLaser0"))

    def spin(component, rate):
        rig.rtse("inject", f"{component}:velocity", json.dumps({"tm": {"sec": 0, "nsec": 0}, "data": {"vx": 0, "vy": 0, "va": rate}}))

    def turns(robot):
        return rig.robot(f"{robot}::position2d")["velocity"][2]

    def spun(component, robot, other, rate):
        def ready():
            spin(component, rate)
            assert abs(turns(other)) < 0.01, f"{other} moves though {robot} is driven"
            return abs(turns(robot) - rate) < 0.1

        await_(f"{robot} turning", ready)
        spin(component, 0)
        await_(f"{robot} standing", lambda: abs(turns(robot)) < 0.01)

    spun("RTCPosition2d0", "right", "left", 0.5)
    spun("RTCPosition2d1", "left", "right", -0.5)

    # Both ids change while the components run: the robots change places, and a second simulation is shown.
    rig.rtse("conf", "RTCPosition2d0", "set", "device_id", "left::position2d")
    rig.rtse("conf", "RTCPosition2d1", "set", "device_id", "right::position2d")
    spun("RTCPosition2d0", "left", "right", 0.5)
    other = str(int(rig.server_id) + 1)  # first ids are even
    rig.server(server_id=other)
    rig.rtse("conf", "RTCLaser1", "set", "server_id", other)
    await_("the error of a device that the other world has not", lambda: rig.state("RTCLaser1") == "Error")
    log = "".join(rig.log(process) for process in rig.running)
    assert "pioneer2dx::laser" in log, "no line names what there is instead of left::laser"
    rig.rtse("conf", "RTCLaser1", "set", "device_id", "pioneer2dx::laser")
    rig.rtse("reset", "RTCLaser1")
    rig.rtse("act", "RTCLaser1")
    assert ahead("RTCLaser1") > 0
    assert [rig.state(name) for name in ("RTCLaser0", "RTCPosition2d0", "RTCPosition2d1")] == ["Active"] * 3


def saved(file):
    text = re.sub(r'.*"IOR".*\n', '', open(rig.path(file)).read())
    return re.sub(r'(creationDate|updateDate)="[^"]*"', r'\1=""', text)


def demo_host():
    return rig.host("SourceAll", "SinkAll", "ConfigDemo", "EchoProvider", "EchoConsumer")


demo = ("SourceAll0", "SinkAll0", "ConfigDemo0", "EchoProvider0", "EchoConsumer0")


def connect_demo():
    rig.there(*demo)
    profile = json.loads(rig.rtse("--json", "cat", "SourceAll0"))
    sinks = {port["data_type"]: port["name"] for port in json.loads(rig.rtse("--json", "cat", "SinkAll0"))["ports"]}
    kinds = ("flush", "new", "periodic")
    pairs = [(port["name"], sinks[port["data_type"]]) for port in profile["ports"] if port["data_type"] in sinks]
    assert len(pairs) >= 6, pairs
    for number, (source, sink) in enumerate(pairs):
        options = ["-p", f"subscription_type={kinds[number % 3]}", "-p", "push_rate=25", "-p", f"push_policy={('all', 'skip', 'new')[number % 3]}", "-p", "skip_count=2"]
        rig.rtse("con", f"SourceAll0:{source}", f"SinkAll0:{sink}", "-i", f"connection {number}", "-n", f"{source} to {sink} <&\">", *options)
    rig.rtse("inject", "SinkAll0:long_seq", "[1,2]", "[]", "{\"data\": [3]}")  # arrays and several values reach the port whole
    services = {name: [p["name"] for p in json.loads(rig.rtse("--json", "cat", name))["ports"] if p["type"] == "CorbaPort"] for name in ("EchoConsumer0", "EchoProvider0")}
    rig.rtse("con", f"EchoConsumer0:{services['EchoConsumer0'][0]}", f"EchoProvider0:{services['EchoProvider0'][0]}", "-i", "echo")


def change_configuration():
    sets = json.loads(rig.rtse("--json", "cat", "ConfigDemo0"))["configuration"]
    names = [name for name in sets if not name.startswith("_")]
    rig.rtse("conf", "ConfigDemo0", "-s", names[-1], "set", "mode", "[a,b]", "--force")
    assert rig.rtse("conf", "ConfigDemo0", "-s", names[-1], "get", "mode").strip() == "[a,b]"
    text = next(key for key in sets[names[0]] if "weights" in key)
    rig.rtse("conf", "ConfigDemo0", "-s", names[0], "set", text, "7, 8.25,-1e-3")
    rig.rtse("conf", "ConfigDemo0", "use", names[-1])
    return names, text


def differences(wanted):
    rig.rtse("save", rig.path("again.xml"))
    now = saved("again.xml")
    assert now == wanted, "\n".join(sorted(set(wanted.splitlines()) ^ set(now.splitlines())))


def save_and_load():
    rig.naming()
    host = demo_host()
    connect_demo()
    names, text = change_configuration()
    active = ("SourceAll0", "ConfigDemo0", "EchoProvider0")
    rig.rtse("act", *active)
    for ending in ("xml", "yaml"):
        rig.rtse("save", rig.path(f"system.{ending}"))
    wanted = saved("system.xml")

    def states():
        return {name: rig.state(name) for name in demo}

    wanted_states = states()
    for ending in ("xml", "yaml"):
        rig.rtse("teardown", rig.path("system.xml"))
        assert '"id"' not in json.dumps([p["connectors"] for p in json.loads(rig.rtse("--json", "cat", "SourceAll0"))["ports"]])
        rig.rtse("deact", *active)
        rig.rtse("act", "SinkAll0")
        rig.rtse("conf", "ConfigDemo0", "-s", names[0], "set", text, "0")
        rig.rtse("conf", "ConfigDemo0", "use", names[0])
        wrong = rig.try_rtse("check", rig.path("system.xml"), "--state", "saved")
        assert wrong.returncode == 1 and "connection 0" in wrong.stderr and "ConfigDemo0" in wrong.stderr and "SinkAll0" in wrong.stderr, wrong.stderr
        rig.rtse("load", "--states", "--force", rig.path(f"system.{ending}"))
        assert states() == wanted_states, (states(), wanted_states)
        rig.rtse("check", rig.path("system.xml"), "--state", "saved")
        differences(wanted)
        rig.rtse("load", "--states", "--force", rig.path(f"system.{ending}"))  # what stands already stays
        differences(wanted)
    # The same after all processes were restarted.
    for process in (host, rig.running[0]):
        rig.kill(process)
    rig.naming()
    demo_host()
    rig.there(*demo)
    rig.rtse("load", "--states", "--force", rig.path("system.xml"))
    assert states() == wanted_states, (states(), wanted_states)
    differences(wanted)


# What `rtse watch` has written to a terminal after some refreshes.
def watched(seconds):
    screen, terminal = pty.openpty()
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 60, 160, 0, 0))
    process = subprocess.Popen([f"{rig.bin_dir}/rtse", "--ns", rig.names, "watch"], stdin=terminal, stdout=terminal, env={**os.environ, "TERM": "xterm"})
    os.close(terminal)
    written, end, quits = b"", time.monotonic() + seconds, False
    while True:
        if not quits and time.monotonic() > end:
            os.write(screen, b"q")
            quits = True
        if select.select([screen], [], [], 0.1)[0]:
            try:
                written += os.read(screen, 65536)
            except OSError:  # nobody has the terminal open any more
                break
        assert time.monotonic() < end + watchdog, "watch does not end"
    assert process.wait(watchdog) == 0
    return re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", " ", written.decode(errors="replace"))


# Components that wait in onExecute, for the simulator or for data, are not late.
def waiting_is_no_fault():
    rig.server()
    rig.naming()
    rig.rtcd("-o", "naming.update.interval:1", device("RTCLaser"), "LaserObstacleAvoid", device("RTCPosition2d"), cwd=rig.work)
    wire()

    def statistics(component):
        context = json.loads(rig.rtse("--json", "cat", component))["contexts"][0]
        return {key.split(".")[1]: float(value) for key, value in context["properties"].items() if key.startswith("statistics.")}

    for name in avoidance:
        await_(f"cycles of {name}", lambda: statistics(name)["cycles"] > 100)
        found = statistics(name)
        assert found["mean_execution_time"] < found["mean_waiting_time"] and found["mean_waiting_time"] > 0.001, (name, found)
        # Only on a busy machine, and only of cycles in which nothing had to be waited for.
        assert found["missed_cycles"] * 2 < found["cycles"], (name, found)
    screen = watched(3)
    assert "waits for data" in screen and "LaserObstacleAvoid0" in screen, screen
    assert "longer than its period" not in screen and "missed" not in screen, screen


# RTMSIM_SERVER_ID says to components which simulator is meant, as to all tools.
def server_of_the_environment():
    rig.server()
    rig.naming()
    rig.host("RTCLaser", "RTCPosition2d?conf.default.server_id=4999", "RTCSimulation")
    rig.there("RTCLaser0", "RTCPosition2d0", "RTCSimulation0")
    servers = {name: rig.rtse("conf", name, "get", "server_id").strip() for name in ("RTCLaser0", "RTCPosition2d0", "RTCSimulation0")}
    assert servers == {"RTCLaser0": rig.server_id, "RTCPosition2d0": "4999", "RTCSimulation0": rig.server_id}, servers
    rig.rtse("act", "RTCLaser0", "RTCSimulation0")


# A profile as rtcryo writes it, with what editors know of parameters in sets of their own: types, widgets and constraints are no values.
def hidden_sets():
    rig.server()
    rig.naming()
    rig.host("RTCLaser", "LaserObstacleAvoid", "RTCPosition2d")
    rig.there(*avoidance)
    values = {name: json.loads(rig.rtse("--json", "cat", name))["configuration"] for name in avoidance}
    for ending in ("xml", "yaml"):
        profile = f"{rig.source}/tests/golden/rtsprofile_hidden_sets.{ending}"
        rig.rtse("load", profile)
        assert rig.rtse("conf", "RTCPosition2d0", "get", "command_timeout").strip() == "0.7"
        for name in avoidance:
            now = json.loads(rig.rtse("--json", "cat", name))["configuration"]
            assert {key: now[key] for key in now if key.startswith("_")} == {key: values[name][key] for key in values[name] if key.startswith("_")}
        rig.rtse("check", profile, "--state", "inactive")
        rig.rtse("conf", "RTCPosition2d0", "set", "command_timeout", "0.6")
        wrong = rig.try_rtse("check", profile, "--state", "inactive")
        assert wrong.returncode == 1 and wrong.stderr.count("\n") == 1 and "command_timeout" in wrong.stderr, wrong.stderr
        rig.rtse("load", profile, "--force")
        rig.rtse("check", profile, "--state", "inactive")
        rig.rtse("teardown", profile)
        ran = rig.try_rtse("run", profile, "--world", f"{rig.source}/worlds/obstacle_course.sdf", "--duration", "1", "--module-path", rig.lib_dir)
        assert ran.returncode == 0 and not ran.stderr, ran


cases = {f.__name__: f for f in (kill_simulator, kill_host, kill_avoider, kill_sensor, kill_naming, one_process, four_processes, late_naming, late_simulator,
                                 two_robots, save_and_load, waiting_is_no_fault, server_of_the_environment, hidden_sets)}
with rig:
    cases[case]()
print("ok")
