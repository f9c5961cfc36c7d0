# The components of arms and hands, and simctl joints, against a living simulator of worlds/arm.sdf, one case per run: arms.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import json
import subprocess
import sys

from rig import Rig, await_

case, *folders = sys.argv[1:]
rig = Rig(*folders)
device = rig.device
arm = "waist,shoulder,elbow,roll,pitch,twist"


def server():
    rig.server(world=f"{rig.source}/worlds/arm.sdf")


def up():
    server()
    rig.naming()
    rig.host(device("RTCActArray", f"conf.default.joints={arm}"), device("RTCGripper", "conf.default.force=15"), "ArmProbe")
    rig.there("RTCActArray0", "RTCGripper0", "ArmProbe0")
    rig.rtse("con", "ArmProbe0:act_array", "RTCActArray0:act_array")
    rig.rtse("con", "ArmProbe0:gripper", "RTCGripper0:gripper")
    rig.rtse("act", "RTCActArray0", "RTCGripper0")


def joints(model="arm"):
    return {joint["name"]: joint for joint in json.loads(rig.simctl("--json", "joints", model))}


def position(joint, model="arm"):
    return joints(model)[joint]["position"]


def sample(port):
    return json.loads(rig.rtse("--json", "print", port, "-n", "1", "-t", "60"))["value"]


def call(what):
    rig.rtse("conf", "ArmProbe0", "set", "call", what)
    rig.rtse("act", "ArmProbe0")
    assert rig.state("ArmProbe0") == "Active", rig.log(rig.running[-1])
    rig.rtse("deact", "ArmProbe0")


def command(port, **values):
    rig.rtse("inject", f"RTCActArray0:{port}", json.dumps({"tm": {"sec": 0, "nsec": 0}, **values}))


def log():
    return rig.log(rig.running[-1])


# Shows, moves, waits, refuses; what it commanded brakes when it ends.
def simctl():
    server()
    now = joints()
    assert list(now) == arm.split(",") + ["left_finger", "right_finger"], list(now)
    assert now["shoulder"]["mode"] == "none" and now["shoulder"]["upper"] == 1.9 and "derived" in now["shoulder"]["gains"]["from"], now["shoulder"]
    text = rig.simctl("joints", "arm", "waist=0.5", "elbow=1.5")
    assert "waist" in text and "position" in text, text
    assert abs(position("waist") - 0.5) < 0.002 and abs(position("elbow") - 1.5) < 0.002, text
    await_("brakes", lambda: joints()["waist"]["mode"] == "brake")
    assert joints()["shoulder"]["mode"] == "none"
    rig.simctl("joints", "arm", "waist=0.3", "--mode", "velocity", "--for", "1")
    assert abs(position("waist") - 0.8) < 0.1, position("waist")
    for words, line in ((["arm", "wrist=1"], 'model arm has no joint "wrist"; it has waist, shoulder'), (["arm", "waist"], 'joint "waist": expected JOINT=NUMBER with mode position'),
                        (["arm", "waist=fast"], 'joint "waist=fast": expected JOINT=NUMBER'), (["table"], "table::joints")):
        done = subprocess.run([f"{rig.bin_dir}/simctl", "-s", str(rig.server_id), "joints", *words], capture_output=True, text=True, timeout=60)
        assert done.returncode == (2 if "expected" in line else 1) and line in done.stderr and done.stderr.count("\n") == 1, (words, done.stderr)
    assert "waist" in rig.simctl("joints", "arm", "all", "--mode", "brake")
    assert all(joint["mode"] == "brake" for joint in joints().values())


# Gains of a file that is named come before derived ones, and simctl says where they stand; a file of no joint of the world ends the start.
def gains():
    def file(name, text):
        with open(f"{rig.work}/{name}", "w") as out:
            out.write(text)
        return f"{rig.work}/{name}"

    named = file("named.yaml", "arm_controller:\n  type: effort_controllers/JointTrajectoryController\n  gains:\n    elbow: {p: 900, i: 10, d: 30}\n")
    rig.server("--gains", named, world=f"{rig.source}/worlds/arm.sdf")
    now = joints()
    assert (now["elbow"]["gains"]["p"], now["elbow"]["gains"]["d"]) == (900, 30) and now["elbow"]["gains"]["from"].endswith("named.yaml:4"), now["elbow"]
    assert "derived" in now["waist"]["gains"]["from"] and "named.yaml:4" in rig.simctl("joints", "arm")
    mixed = file("mixed.yaml", "gazebo_ros_control/pid_gains:\n  elbow: {p: 900}\n  nose: {p: 1}\n")
    done = subprocess.run([f"{rig.bin_dir}/sim-server", f"{rig.source}/worlds/arm.sdf", "--check", "-v", "0", "--gains", mixed], capture_output=True, text=True, timeout=60)
    assert done.stderr.count(f'{mixed}:3: gains of joint "nose": the world has no such joint that moves') == 1 and done.stderr.count("mixed.yaml") == 1, done.stderr
    for path, line in ((file("other.yaml", "gazebo_ros_control/pid_gains: {nose: {p: 1}}\n"), "they are of no joint of the world"),
                       (file("wrong.yaml", "pid_gains: {elbow: {p: fast}}\n"), "none of them can be used"), (file("bad.yaml", "a: [\n"), "is no YAML: line"),
                       (f"{rig.work}/none.yaml", "no such file")):
        done = subprocess.run([f"{rig.bin_dir}/sim-server", f"{rig.source}/worlds/arm.sdf", "--check", "-v", "0", "--gains", path], capture_output=True, text=True, timeout=60)
        assert done.returncode == 2 and line in done.stderr and done.stderr.count("sim-server: gains ") == 1, (path, done.stderr)


def act_array():
    up()
    call("geometry")
    state = sample("RTCActArray0:state")
    assert len(state["actuators"]) == 6, state
    # All commands of one moment count, each for its joint.
    for index, goal in enumerate((0.4, 0.2, 1.2, -0.3, 1.0, 0.7)):
        command("position", index=index, position=goal)
    await_("the positions", lambda: all(abs(a["position"] - goal) < 0.002 for a, goal in zip(sample("RTCActArray0:state")["actuators"], (0.4, 0.2, 1.2, -0.3, 1.0, 0.7))))
    command("position", index=0, position=99)
    command("position", index=9, position=0)
    await_("two lines", lambda: "joint waist: a position must be within -2.9 and 2.9, got 99" in log() and "there is no joint 9, only 0 to 5" in log())
    call("no_joint")
    call("too_fast")
    await_("two more", lambda: "there is no joint 77" in log() and "joint waist: a speed must be within 0 and 2, got 1000" in log())
    assert abs(position("waist") - 0.4) < 0.002
    call("brakes_on")
    await_("brakes", lambda: joints()["waist"]["mode"] == "brake")
    command("position", index=0, position=1)
    await_("a refusal", lambda: "the brakes are on; the command is ignored" in log())
    call("brakes_off")
    command("speed", index=0, speed=-0.5)
    await_("a turning waist", lambda: joints()["waist"]["velocity"] < -0.4)
    call("home")
    await_("the start", lambda: abs(position("elbow") - 1.75) < 0.002 and abs(position("waist")) < 0.002)


# A command of the component's process that ends leaves the arm to its brakes.
def dead_commander():
    up()
    command("position", index=0, position=2.5)
    await_("a moving waist", lambda: position("waist") > 0.2)
    rig.kill(rig.running[-1])
    await_("brakes", lambda: joints()["waist"]["mode"] == "brake" and abs(joints()["waist"]["velocity"]) < 1e-3)
    line = "the client that commanded"
    assert rig.log(rig.running[0]).count(line) <= 2, rig.log(rig.running[0])
    assert line in rig.log(rig.running[0])
    assert abs(position("elbow") - 1.75) < 0.05


def gripper():
    up()
    await_("open fingers", lambda: sample("RTCGripper0:state")["status"] == "GRIPPER_STATE_OPEN")
    # Over the green box, down, and up again.
    for index, goal in enumerate((0, 0.8384, 1.73, 0, 0.5732, 0)):
        command("position", index=index, position=goal)
    await_("a hand at the box", lambda: all(joint["status"] == "idle" for joint in joints().values()))
    call("close")
    await_("closed fingers", lambda: sample("RTCGripper0:state")["status"] == "GRIPPER_STATE_CLOSED")
    assert 0.015 < position("left_finger") < 0.035, position("left_finger")
    command("position", index=1, position=0)
    await_("a box in the air", lambda: float(rig.simctl("pose", "green_box").split()[2]) > 0.85)
    call("open")
    await_("the box on its way down", lambda: float(rig.simctl("pose", "green_box").split()[2]) < 0.8)
    await_("open fingers", lambda: sample("RTCGripper0:state")["status"] == "GRIPPER_STATE_OPEN")


def ptz():
    server()
    rig.naming()
    rig.host(device("RTCPTZ"))
    rig.there("RTCPTZ0")
    rig.rtse("act", "RTCPTZ0")
    rig.rtse("inject", "RTCPTZ0:angles", json.dumps({"tm": {"sec": 0, "nsec": 0}, "pan": 0.6, "tilt": -0.3}))
    await_("the angles", lambda: abs(sample("RTCPTZ0:state")["angles"]["pan"] - 0.6) < 0.002 and abs(position("tilt", "eye") + 0.3) < 0.002)
    rig.rtse("inject", "RTCPTZ0:angles", json.dumps({"tm": {"sec": 0, "nsec": 0}, "pan": 0.2, "tilt": 9}))
    await_("a refusal", lambda: "joint tilt: a position must be within -0.8 and 1.2, got 9" in log())


# The tip goes to poses; brakes, power and what it cannot reach.
def limb():
    server()
    rig.naming()
    rig.host(device("RTCLimb", "conf.default.tool=0.09", "conf.default.speed=0.5"), "ArmProbe")
    rig.there("RTCLimb0", "ArmProbe0")
    rig.rtse("con", "ArmProbe0:limb", "RTCLimb0:limb")
    rig.rtse("act", "RTCLimb0")

    def pose(x, y, z):  # the hand points down
        rig.rtse("inject", "RTCLimb0:pose", json.dumps({"tm": {"sec": 0, "nsec": 0}, "data": {"position": {"x": x, "y": y, "z": z}, "orientation": {"r": 0, "p": 3.14159265, "y": 0}}}))

    def tip():
        return sample("RTCLimb0:state")

    def is_at(*goal):
        at = tip()["oapMatrix"]["position"]
        return all(abs(at[axis] - value) < 0.002 for axis, value in zip("xyz", goal))

    pose(0.45, 0.1, 0.2)
    await_("the tip at a pose", lambda: is_at(0.45, 0.1, 0.2))
    await_("rest", lambda: tip()["status"] == "LIMB_STATUS_IDLE")
    approach = tip()["oapMatrix"]["approach"]
    assert abs(approach["z"] + 1) < 1e-3, approach
    pose(3, 0, 0.2)
    await_("a pose out of reach", lambda: tip()["status"] == "LIMB_STATUS_OOR" and "the arm cannot reach the pose" in log())
    assert is_at(0.45, 0.1, 0.2)
    call("limb_speed")
    await_("a refusal", lambda: "SetSpeed: a speed must be above 0" in log())
    call("limb_brakes_on")
    await_("brakes", lambda: joints()["waist"]["mode"] == "brake" and tip()["status"] == "LIMB_STATUS_BRAKED")
    pose(0.45, 0, 0.3)
    await_("a refusal", lambda: "pose: the brakes are on; it is ignored" in log())
    call("limb_brakes_off")
    pose(0.45, -0.1, 0.3)
    await_("the tip at a pose", lambda: is_at(0.45, -0.1, 0.3))
    call("limb_power_off")
    await_("brakes", lambda: joints()["waist"]["mode"] == "brake")


# The ports and the service of hrpsys.
def robot_hardware():
    server()
    rig.naming()
    rig.host(device("RTCRobotHardware", f"conf.default.joints={arm}"), "ArmProbe")
    rig.there("RTCRobotHardware0", "ArmProbe0")
    rig.rtse("con", "ArmProbe0:hardware", "RTCRobotHardware0:RobotHardwareService")
    rig.rtse("act", "RTCRobotHardware0")

    def reference(port, *values):
        rig.rtse("inject", f"RTCRobotHardware0:{port}", json.dumps({"tm": {"sec": 0, "nsec": 0}, "data": values}))

    goal = (0.3, 0.2, 1.4, 0.1, 1.2, -0.4)
    reference("qRef", *goal)
    await_("the positions", lambda: all(abs(a - b) < 0.002 for a, b in zip(sample("RTCRobotHardware0:q")["data"], goal)))
    assert len(sample("RTCRobotHardware0:tau")["data"]) == 6
    reference("qRef", 1, 2)
    await_("a line", lambda: f"qRef has 2 values; expected 6: {arm.replace(',', ', ')}; it is ignored" in log())
    call("too_much_gain")
    await_("a line", lambda: "joint shoulder: a gain in percent must be within 0 and 200, got 1000" in log())
    call("half_gain")
    call("torque_mode")
    reference("tauRef", 0, 0, 0, 0, 0, 0.02)
    await_("a pushed twist", lambda: joints()["twist"]["mode"] == "effort" and joints()["shoulder"]["mode"] == "position")
    # A controller that asks for more than the motor has gets what it has, and one line.
    for effort in (500, 501, 502):
        reference("tauRef", 0, 0, 0, 0, 0, effort)
    await_("a motor at its limit", lambda: abs(joints()["twist"]["effort"]) > 15)
    assert log().count("tauRef of joint twist must be within -20 and 20, got 500; the nearest limit counts") == 1 and log().count("tauRef of joint twist") <= 3, log()
    call("free_mode")
    await_("a free twist", lambda: joints()["twist"]["mode"] == "free")
    call("position_mode")
    reference("qRef", *goal)
    await_("the positions", lambda: all(abs(a - b) < 0.002 for a, b in zip(sample("RTCRobotHardware0:q")["data"], goal)))
    call("servo_off")
    await_("brakes", lambda: joints()["waist"]["mode"] == "brake")
    call("servo_on")
    await_("the servo", lambda: joints()["waist"]["mode"] == "position")
    call("error_limit")
    reference("qRef", 2.5, *goal[1:])
    await_("a servo that switched off", lambda: "joint waist: servo error" in log() and joints()["waist"]["mode"] == "brake")


# Sensors of the robot on ports of the names that controllers know.
def robot_sensors():
    with open(f"{rig.source}/worlds/arm.sdf") as file:
        world = file.read().replace('<link name="palm">', '<link name="palm"><sensor name="gyro" type="imu"><update_rate>100</update_rate></sensor>', 1)
        world = world.replace('<joint name="twist" type="revolute">', '<joint name="twist" type="revolute"><sensor name="wrist" type="force_torque"><update_rate>100</update_rate></sensor>', 1)
    with open(f"{rig.work}/arm.sdf", "w") as file:
        file.write(world)
    rig.server(world=f"{rig.work}/arm.sdf")
    rig.naming()
    rig.host(device("RTCRobotHardware", f"conf.default.joints={arm}", "conf.default.sensors=gyrometer=rate:arm::gyro,gsensor=accel:arm::gyro,rhsensor=force:arm::wrist,odd=smell:arm::gyro"))
    rig.there("RTCRobotHardware0")
    assert 'sensors: expected NAME=KIND:IFACE with kind rate, accel or force, got "odd=smell:arm::gyro"; it is ignored' in log(), log()
    rig.rtse("act", "RTCRobotHardware0")
    await_("gravity", lambda: abs(sum(sample("RTCRobotHardware0:gsensor")["data"][axis] ** 2 for axis in ("ax", "ay", "az")) ** 0.5 - 9.81) < 0.3)
    assert set(sample("RTCRobotHardware0:gyrometer")["data"]) == {"avx", "avy", "avz"}
    force = sample("RTCRobotHardware0:rhsensor")["data"]
    assert len(force) == 6 and 3 < sum(value ** 2 for value in force[:3]) ** 0.5 < 8, force  # palm and fingers weigh 0.5 kg


# Grippers attach when they are asked to; a spawned arm has gains and a start of its own; the bad ones are one line.
def attach():
    def refused(line, *words, code=1):
        done = subprocess.run([f"{rig.bin_dir}/simctl", "-s", str(rig.server_id), *words], capture_output=True, text=True, timeout=60)
        assert done.returncode == code and line in done.stderr and done.stderr.count("\n") == 1, (words, done.stderr)

    server()
    shown = lambda: json.loads(rig.simctl("--json", "attach"))
    assert shown() == [{"name": "arm::gripper", "on": False, "holds": ""}], shown()
    rig.simctl("attach", "arm::gripper")
    # Over the green box, down, and closed around it.
    rig.simctl("joints", "arm", "shoulder=0.8384", "elbow=1.73", "pitch=0.5732")
    rig.simctl("joints", "arm", "left_finger=-0.05", "right_finger=-0.05", "--mode", "velocity", "--for", "2")
    await_("a box", lambda: shown()[0]["holds"].startswith("green_box::"))
    assert "arm::gripper" in rig.simctl("attach") and "green_box" in rig.simctl("attach")
    rig.simctl("joints", "arm", "shoulder=0")
    assert float(rig.simctl("pose", "green_box").split()[2]) > 0.85
    rig.simctl("detach", "arm::gripper")
    assert shown() == [{"name": "arm::gripper", "on": False, "holds": ""}], shown()
    refused("simctl: attach: no iface, gripper or detachable joint arm::griper", "attach", "arm::griper")
    refused("simctl: detach: no iface nobody", "detach", "nobody")

    with open(f"{rig.work}/gains.yaml", "w") as out:
        out.write("pid_gains:\n  elbow: {p: 700, d: 20}\n")
    model = "<sdf version='1.9'><model name='two'><pose>3 0 0 0 0 0</pose><link name='base'/><link name='rod'><pose>0 0 1 0 0 0</pose></link>" \
            "<joint name='held' type='fixed'><parent>world</parent><child>base</child></joint><joint name='elbow' type='revolute'><parent>base</parent><child>rod</child>" \
            "<axis><xyz>0 0 1</xyz><limit><lower>-1</lower><upper>1</upper><effort>10</effort></limit></axis></joint></model></sdf>"
    rig.simctl("spawn", model, "--joint", "elbow=0.5", "--gains", f"{rig.work}/gains.yaml")
    elbow = joints("two")["elbow"]
    assert abs(elbow["position"] - 0.5) < 1e-6 and elbow["rest"] == 0.5 and (elbow["gains"]["p"], elbow["gains"]["from"]) == (700, "--gains:2"), elbow
    refused('has no joint "nose" that moves; it has elbow', "spawn", model, "--name", "more", "--joint", "nose=1")
    refused("joint elbow: a position must be within -1 and 1, got 2", "spawn", model, "--name", "more", "--joint", "elbow=2")
    refused("no such file", "spawn", model, "--name", "more", "--gains", f"{rig.work}/none.yaml", code=2)
    with open(f"{rig.work}/gains.yaml", "w") as out:
        out.write("pid_gains:\n  nose: {p: 700, d: 20}\n")
    refused("gains: they are of no joint of model more", "spawn", model, "--name", "more", "--gains", f"{rig.work}/gains.yaml")


cases = {f.__name__: f for f in (simctl, gains, act_array, dead_commander, gripper, limb, ptz, robot_hardware, robot_sensors, attach)}
with rig:
    cases[case]()
print("ok")
