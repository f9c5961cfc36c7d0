# Wrong arguments of rtmsim: each method answers with rtmsim.Error in one line that shows the value, and the world goes on.
import math

import pytest
import rtmsim
from conftest import course

huge = 1 << 100
no_number = ["fast", None, [1], {}, b"1", object(), 1j]
no_finite = [*no_number, math.nan, math.inf, -math.inf, 10**400]
no_text = [None, 3, 1.5, b"pioneer2dx", ["pioneer2dx"], {}, "a\0b", "\udc80"]
no_three = [None, 3, "123", [1, 2], [1, 2, 3, 4], [1, 2, "3"], [1, 2, math.nan], [None] * 3, {}, object()]
no_whole = ["3", None, 1.5, math.nan, math.inf, [3], {}, huge, -1]
no_file = [None, 3, [], {}, "a\0b", "no_such_file"]


@pytest.fixture(scope="module")
def world():
    with rtmsim.World(course) as one:
        one.step()
        yield one


# Of each method with one argument wrong: the name in the message, and how it is called.
def calls(world):
    drive, laser = world.drive("pioneer2dx"), world.device("laser", "pioneer2dx::laser")
    robot = "pioneer2dx"

    yield "World.step", world.step, [*no_whole, 0]
    yield "World.advance", world.advance, [*no_finite]
    yield "World.reset", world.reset, [one for one in no_whole if one is not None]
    yield "World.run", world.run, [one for one in no_finite if one is not None]
    yield "World.timeout", lambda given: setattr(world, "timeout", given), [*no_number, math.nan, -1]
    for name in ("pose", "velocity", "scan", "sonar", "camera", "depth", "points", "read", "info", "drive", "joints", "delete"):
        yield f"World.{name}", getattr(world, name), no_text
    for name in ("tree", "contacts", "faults", "end_faults"):
        yield f"World.{name}", getattr(world, name), no_text
    yield "World.device type", lambda given: world.device(given, "pioneer2dx::laser"), [*no_text, "lidar"]
    yield "World.device name", lambda given: world.device("laser", given), no_text
    yield "World.read type", lambda given: world.read("pioneer2dx::laser", given), [one for one in no_text if one]
    yield "World.wait timeout", lambda given: world.wait("pioneer2dx::laser", timeout=given), [one for one in [*no_number, -1] if one is not None]
    yield "World.set_pose model", lambda given: world.set_pose(given, (0, 0, 0)), no_text
    yield "World.set_pose pose", lambda given: world.set_pose(robot, given), [None, 3, "123", [1, 2], [1] * 5, [1, 2, math.nan], {}, object()]
    yield "World.set_velocity", lambda given: world.set_velocity(robot, given), no_three
    yield "World.set_velocity angular", lambda given: world.set_velocity(robot, angular=given), no_three
    yield "World.push name", lambda given: world.push(given, (1, 0, 0)), no_text
    yield "World.push force", lambda given: world.push(robot, given), no_three
    yield "World.push torque", lambda given: world.push(robot, torque=given), no_three
    yield "World.push duration", lambda given: world.push(robot, duration=given), [*no_number, math.nan, -1]
    yield "World.push persistent", lambda given: world.push(robot, persistent=given), ["yes", [], object()]
    yield "World.push_joint joint", lambda given: world.push_joint(robot, given, 1), no_text
    yield "World.push_joint effort", lambda given: world.push_joint(robot, "left_wheel_joint", given), no_finite
    yield "World.spawn", world.spawn, no_file
    yield "World.spawn name", lambda given: world.spawn("model://pioneer2dx", given), no_text
    yield "World.spawn pose", lambda given: world.spawn("model://pioneer2dx", "x", given), [3, "123", [1, 2], [math.nan] * 3, {}]
    yield "World.fault iface", lambda given: world.fault(given, "off"), no_text
    yield "World.fault kind", lambda given: world.fault("pioneer2dx::laser", given), [*no_text, "odd"]
    yield "World.fault amount", lambda given: world.fault("pioneer2dx::laser", "bias", given), [one for one in no_finite if one is not None]
    yield "World.fault duration", lambda given: world.fault("pioneer2dx::laser", "off", duration=given), [*no_number, math.nan, -1]
    yield "World.write_tag reader", lambda given: world.write_tag(given, "tag", "data"), no_text
    yield "World.write_tag id", lambda given: world.write_tag("pioneer2dx::laser", given, "data"), no_text
    yield "World.write_tag data", lambda given: world.write_tag("pioneer2dx::laser", "tag", given), no_text
    yield "World.end_faults kind", lambda given: world.end_faults("", given), no_text
    yield "World.screenshot width", lambda given: world.screenshot(given, 10), [*no_whole, 0, 100000]
    yield "World.screenshot height", lambda given: world.screenshot(10, given), [*no_whole, 0, 100000]
    yield "World.screenshot follow", lambda given: world.screenshot(follow=given), [3, 1.5, b"x", ["x"]]
    yield "World.screenshot eye", lambda given: world.screenshot(8, 8, eye=given), [3, "123456", [1, 2], [math.nan] * 6, {}]
    yield "World.screenshot fov", lambda given: world.screenshot(8, 8, eye=(0, 0, 8, 0, 1.5, 0), fov=given), no_finite
    yield "World.screenshot span", lambda given: world.screenshot(8, 8, top=True, span=given), no_finite
    yield "World.screenshot centre", lambda given: world.screenshot(8, 8, top=True, centre=given), [None, 3, "12", [1], [1, math.nan]]
    yield "World.screenshot scans", lambda given: world.screenshot(8, 8, scans=given), ["yes", [], object()]
    yield "Drive.velocity", drive.velocity, no_finite
    yield "Drive.velocity va", lambda given: drive.velocity(0, va=given), no_finite
    yield "Drive.velocity duration", lambda given: drive.velocity(0, duration=given), [*no_number, math.nan, -1]
    yield "Drive.velocity3d", drive.velocity3d, no_three
    yield "Drive.set_odometry", lambda given: drive.set_odometry(given, 0, 0), no_finite
    yield "Drive.motors", drive.motors, ["off", [], object()]
    yield "Device.read", laser.read, [*no_number, math.nan, -1]
    yield "Device.value", laser.value, [*no_text, "rangs"]
    yield "Device.value timeout", lambda given: laser.value("ranges", given), [*no_number, math.nan, -1]
    yield "Device.array", laser.array, [*no_number, math.nan, -1]
    yield "Device.wait", laser.wait, no_whole
    yield "Device.command kind", lambda given: laser.command(given, [0, 0, 0]), no_whole
    yield "Device.command values", lambda given: laser.command(1, given), [None, 3, "123", [None], [math.nan], {"x": 1}]
    yield "Device.velocity", laser.velocity, no_finite
    yield "step_all", rtmsim.step_all, [None, 3, "worlds", [None], [world, 3]]
    yield "step_all count", lambda given: rtmsim.step_all([world], given), [*no_whole, 0]


def test_every_wrong_argument_is_one_line(world):
    wrong = []
    before = world.hash()
    count = 0
    for name, call, values in calls(world):
        for value in values:
            count += 1
            try:
                call(value)
                wrong.append(f"{name}({value!r}) is accepted")
            except rtmsim.Error as problem:
                if "\n" in str(problem) or not 10 < len(str(problem)) < 400:
                    wrong.append(f"{name}({value!r}): {problem}")
            except Exception as problem:
                wrong.append(f"{name}({value!r}) raises {type(problem).__name__}: {problem}")
    assert not wrong, "\n".join(wrong)
    assert count > 400
    assert world.hash() == before, "what is refused changes nothing"
    assert world.step() > 0


@pytest.mark.parametrize("arguments", [
    (3,), (None,), ([],), (course, "seed", -1), (course, "seed", "one"), (course, "seed", 1.5), (course, "seed", 1 << 64), (course, "timeout", "x"),
    (course, "timeout", math.nan), (course, "resource_path", 3), (course, "resource_path", [3]), (course, "options", 3),
    (course, "options", "--threads"), (course, "options", ["--no-such-option"]), (course, "server_id", 1), (None, "server_id", "x"),
    (None, "server_id", -1), (None, "server_id", 1 << 40), (None, "server_id", 4999), ("no_such.sdf",), ("<sdf",), ("a\0b",), ("/",)], ids=repr)
def test_a_world_that_cannot_be_made_is_one_line(arguments):
    world, *named = arguments
    with pytest.raises(rtmsim.Error) as caught:
        rtmsim.World(world, **dict([named] if named else []))
    assert "\n" not in str(caught.value) and len(str(caught.value)) < 400


@pytest.mark.parametrize("named", [
    {"system": 3}, {"world": None}, {"system": "no_such.xml"}, {"world": "no_such.sdf"}, {"duration": "long"}, {"duration": math.nan}, {"duration": -1},
    {"seed": "x"}, {"seed": -1}, {"seeds": 3}, {"seeds": ["x"]}, {"seeds": "12"}, {"seeds": [1], "jobs": 0}, {"jobs": "two", "seeds": [1]},
    {"record": 3}, {"options": "--twice"}, {"options": 3}, {"options": ["--no-such-option"]}, {"timeout": "x"}, {"expect": 3}, {"expect": [object()]},
    {"expect": [{"no_such": {}}]}, {"expect": "no_such.yaml"}], ids=repr)
def test_a_run_with_a_wrong_argument_is_one_line(named, worlds):
    arguments = {"system": worlds / "systems" / "obstacle_avoidance.xml", "world": course, "duration": 1, **named}
    with pytest.raises(rtmsim.Error) as caught:
        rtmsim.run(**arguments)
    assert "\n" not in str(caught.value) and len(str(caught.value)) < 400


@pytest.mark.parametrize("file", [3, None, [], "no_such.mcap", "/", "a\0b", course], ids=repr)
def test_a_recording_that_cannot_be_read_is_one_line(file):
    with pytest.raises(rtmsim.Error) as caught:
        rtmsim.Recording(file)
    assert "\n" not in str(caught.value)


def test_an_environment_with_wrong_arguments_is_one_line(world):
    for named in ({"physics_steps": 0}, {"physics_steps": "x"}, {"physics_steps": 1.5}, {"time_limit": "x"}, {"time_limit": -1}, {"render_mode": 3}):
        with pytest.raises(rtmsim.Error):
            rtmsim.Env(world, **named)
    for make, count in ((lambda: None, 1), (lambda: rtmsim.Env(world), 0), (lambda: rtmsim.Env(world), "x")):
        with pytest.raises(rtmsim.Error):
            rtmsim.BatchEnv(make, count)
    env = rtmsim.Env(world)
    for seed in (-1, "x", 1.5, 1 << 64):
        with pytest.raises(rtmsim.Error):
            env.reset(seed=seed)
