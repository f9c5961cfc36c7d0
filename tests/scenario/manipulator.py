# RTCManipulator against a living simulator of worlds/arm.sdf, called by clients of both texts of the JARA interface, one case per run: manipulator.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import json
import math
import re
import subprocess
import sys

from rig import Rig, await_

case, *folders = sys.argv[1:]
rig = Rig(*folders)
OK, NG, STATUS, VALUE, SERVO, FULL = 0, -1, -2, -3, -4, -5
servo, moving, alarm, full, paused = 1, 2, 4, 8, 16
start = (0, 0, 1.75, 0, 1.3916, 0)
down = (-1, 0, 0, 0.45, 0, 1, 0, 0.1, 0, 0, -1, 0.25)  # row by row: the hand points down


# The component in a process of its own, its client in another one, connected and active.
def up(*parameters, caller="ManipulatorCaller", module="JARA_ARM"):
    rig.server(world=f"{rig.source}/worlds/arm.sdf")
    rig.naming()
    rig.arm = rig.host(rig.device("RTCManipulator", "conf.default.force=15", f"conf.default.module={module}", *parameters))
    rig.client = rig.host(caller)
    rig.there("RTCManipulator0", f"{caller}0")
    rig.caller = f"{caller}0"
    connect(rig.caller)
    rig.rtse("act", "RTCManipulator0")


def connect(caller):
    rig.rtse("con", f"{caller}:common", "RTCManipulator0:common")
    rig.rtse("con", f"{caller}:middle", "RTCManipulator0:middle")


# The answers of the calls, each as (id, text).
def calls(*words, caller=None, process=None):
    caller, process = caller or rig.caller, process or rig.client
    before = len(rig.log(process))
    rig.rtse("conf", caller, "set", "calls", ";".join(words))
    rig.rtse("act", caller)
    assert rig.state(caller) == "Active", rig.log(process)[before:]
    rig.rtse("deact", caller)
    answers = [(int(id), text.strip()) for id, text in re.findall(r"answer \w+: (-?\d+)(.*)", rig.log(process)[before:])]
    assert len(answers) == len(words), (words, rig.log(process)[before:])
    return answers


def call(name, *values, **more):
    return calls(" ".join([name, *(str(value) for value in values)]), **more)[0]


def ok(name, *values, **more):
    answer, text = call(name, *values, **more)
    assert answer == OK, (name, values, answer, text)
    return [float(word) for word in text.split() if re.fullmatch(r"[-+.\deinf]+", word)]


def state(**more):
    return int(ok("getState", **more)[0])


def stands(**more):
    await_("an arm that stands", lambda: state(**more) & moving == 0)


def log():
    return rig.log(rig.arm)


def joints():
    return {joint["name"]: joint for joint in json.loads(rig.simctl("--json", "joints", "arm"))}


def near(values, goal, within=0.003):
    assert len(values) >= len(goal) and all(abs(a - b) < within for a, b in zip(values, goal)), (values, goal)


# What a public client does: servoON, a joint move without any speed, polling.
def moves():
    up()
    assert state() == 0
    await_("brakes", lambda: joints()["waist"]["mode"] == "brake")
    goal = (0.4, 0.2, 1.5, -0.3, 1.2, 0.7)
    answers = calls("servoON", "movePTPJointAbs " + " ".join(map(str, goal)), "getState")
    assert [id for id, _ in answers] == [OK] * 3 and int(answers[2][1]) == servo | moving, answers
    stands()
    near(ok("getFeedbackPosJoint"), (*goal, 100), 0.5)
    near(ok("getFeedbackPosJoint"), goal)
    near(json.loads(rig.rtse("--json", "print", "RTCManipulator0:joints", "-n", "1", "-t", "60"))["value"]["pos"], goal)
    ok("movePTPCartesianAbs", *down)
    stands()
    near(ok("getFeedbackPosCartesian"), down)
    ok("moveLinearCartesianRel", 1, 0, 0, 0, 0, 1, 0, -0.1, 0, 0, 1, -0.05)
    stands()
    near(ok("getFeedbackPosCartesian"), (*down[:7], 0, *down[8:11], 0.2))
    ok("moveCircularCartesianRel", *(1, 0, 0, 0, 0, 1, 0, 0.05, 0, 0, 1, 0.05), *(1, 0, 0, 0, 0, 1, 0, 0.1, 0, 0, 1, 0))
    stands()
    near(ok("getFeedbackPosCartesian"), (*down[:11], 0.2))
    ok("movePTPJointRel", 0.1, 0, 0, 0, 0, 0)
    ok("goHome")
    stands()
    near(ok("getFeedbackPosJoint"), start)
    ok("closeGripper")
    stands()
    assert ok("getFeedbackPosJoint")[6] < 3
    ok("moveGripper", 50)
    stands()
    near(ok("getFeedbackPosJoint")[6:], [50], 2)
    assert call("getManipInfo") == (OK, "rtm-sim 6 1 1")
    # Calls are answered while simulated time stands.
    rig.simctl("pause")
    ok("movePTPJointAbs", *goal)
    assert state() == servo | moving and state() == servo | moving
    rig.simctl("run")
    stands()
    near(ok("getFeedbackPosJoint"), goal)
    # The arm takes its joint back from another client, which says so.
    done = subprocess.run([f"{rig.bin_dir}/simctl", "-s", str(rig.server_id), "joints", "arm", "waist=1.5"], capture_output=True, text=True, timeout=60)
    assert done.returncode == 1 and "joint waist: has mode position and target " in done.stderr and "another client commands it" in done.stderr, done.stderr
    ok("servoOFF")
    await_("brakes", lambda: joints()["waist"]["mode"] == "brake")
    assert state() == 0


# The text of 2012: other repository ids, degrees and millimetres; from the same process and from another one.
def without_module():
    rig.server(world=f"{rig.source}/worlds/arm.sdf")
    rig.naming()
    kind = "ManipulatorCallerWithoutModule"
    rig.arm = rig.host(rig.device("RTCManipulator", "conf.default.units=deg_mm", "conf.default.module=none"), f"{kind}?instance_name=Inside")
    rig.client = rig.host(kind)
    rig.caller = f"{kind}0"
    rig.there("RTCManipulator0", "Inside", rig.caller)
    connect("Inside")
    connect(rig.caller)
    rig.rtse("act", "RTCManipulator0")
    ok("servoON")
    ok("movePTPJointAbs", 30, 10, 90, -20, 60, 45)
    stands()
    near(ok("getFeedbackPosJoint"), (30, 10, 90, -20, 60, 45), 0.2)
    inside = {"caller": "Inside", "process": rig.arm}
    near(ok("getFeedbackPosJoint", **inside), (30, 10, 90, -20, 60, 45), 0.2)
    near([joints()["waist"]["position"]], [math.radians(30)])
    millimetres = [value * 1000 if k % 4 == 3 else value for k, value in enumerate(down)]
    ok("movePTPCartesianAbs", *millimetres, **inside)
    stands(**inside)
    near(ok("getFeedbackPosCartesian"), millimetres, 3)
    near(ok("getMaxSpeedJoint"), (math.degrees(2),), 0.01)
    near(ok("getSoftLimitJoint"), (math.degrees(-2.9), math.degrees(2.9)), 0.01)
    near(ok("getMaxSpeedCartesian"), (500, math.degrees(1.5)), 0.01)


def settings():
    up("conf.default.speed=80")
    near(ok("getMaxSpeedJoint"), (2, 2, 2.5, 3, 3, 4), 1e-9)
    ok("setMaxSpeedJoint", 1, 1, 1, 1, 1, 1)
    near(ok("getMaxSpeedJoint"), (1,) * 6, 1e-9)
    ok("setMaxSpeedCartesian", 0.3, 0.6)
    near(ok("getMaxSpeedCartesian"), (0.3, 0.6), 1e-9)
    ok("setMinAccelTimeJoint", 0.2)
    ok("setMinAccelTimeCartesian", 0.3)
    near(ok("getMinAccelTimeJoint"), [0.2], 1e-9)
    near(ok("getMinAccelTimeCartesian"), [0.3], 1e-9)
    assert call("setAccelTimeJoint", 0.1)[0] == VALUE and call("setAccelTimeCartesian", 0.2)[0] == VALUE
    ok("setAccelTimeJoint", 0.5)
    ok("setAccelTimeCartesian", 0.5)
    ok("setSpeedJoint", 70)
    ok("setSpeedCartesian", 70)
    limits = (-1, 1, -1.5, 1.5, -0.3, 2.6, -3, 3, -2, 2, -4, 4)
    ok("setSoftLimitJoint", *limits)
    near(ok("getSoftLimitJoint"), limits, 1e-9)
    ok("setSoftLimitCartesian", -1, 1, -0.5, 0.5, 0.05, 2)
    near(ok("getSoftLimitCartesian"), (-1, 1, -0.5, 0.5, 0.05, 2), 1e-9)
    ok("setBaseOffset", 1, 0, 0, 0.1, 0, 1, 0, 0.2, 0, 0, 1, 0.3)
    near(ok("getBaseOffset"), (1, 0, 0, 0.1, 0, 1, 0, 0.2, 0, 0, 1, 0.3), 1e-9)
    ok("setControlPointOffset", 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0.09)
    home = (0.2, 0, 1.5, 0, 1.3, 0)
    ok("setHome", *home)
    near(ok("getHome"), home, 1e-9)
    ok("servoON")
    assert call("movePTPJointAbs", 1.5, 0, 1.75, 0, 1.39, 0)[0] == VALUE
    ok("goHome")
    stands()
    near(ok("getFeedbackPosJoint"), home)


def bad_values():
    up()
    rotated = list(down)
    rotated[0] = 1e-300  # the rotation part of uninitialised memory
    assert call("movePTPJointAbs", 0, 0, 1, 0, 1, 0)[0] == SERVO
    assert call("closeGripper")[0] == SERVO
    ok("servoON")
    before = ok("getFeedbackPosJoint")
    for name, values, text in (("movePTPJointAbs", ("nan", 0, 1, 0, 1, 0), "joint 1: expected -2.9 to 2.9 [rad or m], got nan"), ("movePTPJointAbs", (1, 2, 3), "expected 6 joints, got 3"),
                               ("movePTPJointRel", (0, 0, 99, 0, 0, 0), "joint 3: expected"), ("movePTPCartesianAbs", rotated, "is not a rotation"),
                               ("moveLinearCartesianAbs", rotated, "is not a rotation"), ("movePTPCartesianAbs", (1, 0, 0, "inf", 0, 1, 0, 0, 0, 0, 1, 0), "x: expected"),
                               ("movePTPCartesianAbs", (1, 0, 0, 4, 0, 1, 0, 0, 0, 0, 1, 0.3), "cannot reach"), ("moveLinearCartesianRel", (1, 0, 0, 4, 0, 1, 0, 0, 0, 0, 1, 0), "cannot reach"),
                               ("setSpeedJoint", (101,), "within 0 and 100 %"), ("setSpeedCartesian", (4000000000,), "within 0 and 100 %"), ("moveGripper", (101,), "within 0 and 100 %"),
                               ("setAccelTimeJoint", ("nan",), "got nan"), ("setMaxSpeedJoint", (1,), "expected 6 values, got 1"), ("setMaxSpeedCartesian", ("nan", 1), "got nan"),
                               ("setSoftLimitJoint", (-9, 9) * 6, "joint 1: limits must ascend"), ("setHome", (9,) * 6, "joint 1"), ("setBaseOffset", (0,) * 12, "is not a rotation"),
                               ("setControlPointOffset", (1, 0, 0, "nan", 0, 1, 0, 0, 0, 0, 1, 0), "not finite"), ("setSoftLimitCartesian", (1, 0, 0, 1, 0, 1), "limits must ascend")):
        answer, comment = call(name, *values)
        assert answer == VALUE and text in comment, (name, values, answer, comment)
    assert state() == servo
    near(ok("getFeedbackPosJoint"), before)


def queue():
    up()
    there, back = "movePTPJointAbs 0.05 0 1.75 0 1.3916 0", "movePTPJointAbs 0 0 1.75 0 1.3916 0"
    rig.simctl("pause")
    answers = calls("servoON", *([there, back] * 8), there, "getState")
    assert [id for id, _ in answers] == [OK] * 17 + [FULL, OK] and int(answers[-1][1]) == servo | moving | full, answers
    rig.simctl("run")
    stands()
    near(ok("getFeedbackPosJoint"), start)
    assert [id for id, _ in calls("movePTPJointAbs 2 0 1.75 0 1.3916 0", "pause")] == [OK, OK]
    assert state() & paused
    await_("an arm at rest", lambda: abs(joints()["waist"]["velocity"]) < 1e-3)
    assert joints()["waist"]["position"] < 1.9
    ok("resume")
    stands()
    near(ok("getFeedbackPosJoint"), (2,))
    assert [id for id, _ in calls("setSpeedJoint 5", "movePTPJointAbs 0 0 1.75 0 1.3916 0")] == [OK, OK]
    await_("a moving waist", lambda: joints()["waist"]["position"] < 1.95)
    ok("stop")
    stands()
    assert 0.05 < joints()["waist"]["position"] < 1.95, joints()["waist"]


# The hand is pressed on the table: the arm stops with an alarm, and can be moved away.
def alarms():
    up()
    ok("servoON")
    ok("movePTPCartesianAbs", *down)
    ok("moveLinearCartesianRel", 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, -0.3)
    await_("an alarm", lambda: state() & ~moving == servo | alarm)
    answer, text = call("getActiveAlarm")
    # The hand that no longer presses may spring back faster than a joint may move.
    assert answer == OK and re.fullmatch(r"2 joint \d is at its highest effort and does not move( 3 joint \d moves at .*)?", text), text
    assert log().count("alarm 2: joint") == 1, log()
    assert call("movePTPJointAbs", *start)[0] == STATUS and call("setSoftLimitJoint", *(0, 1) * 6)[0] == STATUS and call("openGripper")[0] == STATUS
    ok("clearAlarms")
    assert call("getActiveAlarm") == (OK, "")
    ok("moveLinearCartesianRel", 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0.2)
    ok("movePTPJointAbs", *start)
    stands()
    near(ok("getFeedbackPosJoint"), start, 0.01)
    assert state() == servo


# Alarms of what is measured: a joint that is faster than its motor, beyond a soft limit, or the hand beyond the Cartesian ones. Each stops
# the arm, and is raised once.
def passed_limits():
    up()

    def expect(code, text, amount):
        ok("servoON")
        ok("movePTPJointAbs", *start)
        stands()
        rig.simctl("fault", "arm::joints::waist", "bias", str(amount))
        await_("an alarm", lambda: state() & ~moving == servo | alarm)  # the place that it holds is not where it is measured
        answer, active = call("getActiveAlarm")
        assert answer == OK and re.fullmatch(f"{code} {text}", active), active
        assert call("movePTPJointAbs", *start)[0] == STATUS
        ok("servoOFF")  # or the end of the fault is the next alarm
        rig.simctl("fault", "arm::joints::waist", "--end")
        ok("clearAlarms")
        assert call("getActiveAlarm") == (OK, "") and log().count(f"alarm {code}: ") == 1, log()

    expect(3, r"joint 1 moves at [\d.]+ \[rad/s or m/s\], its highest speed is 2", 0.5)
    ok("setSoftLimitJoint", -0.01, 0.01, -1.9, 1.9, -0.3, 2.6, -3, 3, -2, 2, -4, 4)
    expect(4, r"joint 1 is at 0.0[\d]+, beyond its soft limits -0.01 and 0.01", 0.06)
    ok("setSoftLimitJoint", -2.9, 2.9, -1.9, 1.9, -0.3, 2.6, -3, 3, -2, 2, -4, 4)
    ok("setSoftLimitCartesian", -1, 1, -0.001, 0.001, 0, 2)
    expect(5, r"the control point is at \([-\d.]+, 0.0[\d]+, [\d.]+\), beyond the Cartesian soft limits", 0.1)


def low_level():
    up("conf.default.cycle=10")

    def command(*values):
        rig.rtse("inject", "RTCManipulator0:command", json.dumps({"tm": {"sec": 0, "nsec": 0}, "pos": values}))

    command(*start)
    await_("a refusal", lambda: "command: the servo is off; servoON switches it on; it is ignored" in log())
    ok("servoON")
    assert call("getManipInfo") == (OK, "rtm-sim 6 10 1")
    command(0.3, *start[1:])
    await_("the position", lambda: abs(joints()["waist"]["position"] - 0.3) < 0.002 and all(one["status"] == "idle" for one in joints().values()))
    command(1, 2)
    await_("a refusal", lambda: "command: expected 6 joints, got 2; it is ignored" in log())
    near(ok("getFeedbackPosJoint"), (0.3, *start[1:]))
    assert state() == servo


# Accepted motions are finished, then the arm holds its place.
def dead_client():
    up()
    assert [id for id, _ in calls("servoON", "movePTPJointAbs 1.5 0 1.75 0 1.3916 0", "movePTPJointAbs 1 0 1.75 0 1.3916 0")] == [OK] * 3
    rig.kill(rig.client)
    await_("the end of the queue", lambda: abs(joints()["waist"]["position"] - 1) < 0.003 and joints()["waist"]["status"] == "idle")
    assert joints()["waist"]["mode"] == "position"
    rig.rtse("deact", "RTCManipulator0")
    await_("brakes", lambda: joints()["waist"]["mode"] == "brake")


# A reset of the world switches the servo off.
def reset():
    up()
    assert [id for id, _ in calls("servoON", "movePTPJointAbs 2 0 1.75 0 1.3916 0")] == [OK] * 2
    await_("a moving waist", lambda: joints()["waist"]["position"] > 0.2)
    rig.simctl("reset")
    await_("brakes", lambda: joints()["waist"]["mode"] == "brake" and state() == 0)
    near(ok("getFeedbackPosJoint"), start, 0.02)
    ok("servoON")
    ok("movePTPJointAbs", 0.3, *start[1:])
    stands()
    near(ok("getFeedbackPosJoint"), (0.3, *start[1:]))


# The signal of an emergency stop leaves the arm to its brakes; nothing switches it on before the signal has ended.
def emergency():
    up()
    goal = (0.8, 0.2, 1.5, -0.3, 1.2, 0.7)
    ok("servoON")
    ok("movePTPJointAbs", *goal)
    await_("a moving arm", lambda: ok("getFeedbackPosJoint")[0] > 0.05)

    def signal(is_on):
        rig.rtse("inject", "RTCManipulator0:emergency", json.dumps({"tm": {"sec": 0, "nsec": 0}, "data": is_on}))

    signal(True)
    await_("an alarm", lambda: state() == alarm)
    await_("brakes", lambda: joints()["waist"]["mode"] == "brake" and abs(joints()["waist"]["velocity"]) < 1e-3)
    assert "alarm 1: emergency stop" in log(), log()
    for name in ("servoON", "clearAlarms"):
        answer, text = call(name)
        assert answer == STATUS and "the signal of the emergency stop is on" in text, (name, answer, text)
    assert call("movePTPJointAbs", *goal)[0] == SERVO
    signal(False)
    await_("the end of the signal", lambda: call("clearAlarms")[0] == OK)
    ok("servoON")
    ok("movePTPJointAbs", *goal)
    stands()
    near(ok("getFeedbackPosJoint"), goal)


cases = {f.__name__: f for f in (moves, without_module, settings, bad_values, queue, alarms, passed_limits, emergency, low_level, dead_client, reset)}
with rig:
    cases[case]()
print("ok")
