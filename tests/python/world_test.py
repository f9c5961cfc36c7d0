# rtmsim.World: steps, models, sensors, drives, faults, images.
import math

import numpy
import pytest
import rtmsim
from conftest import course


def test_a_step_moves_time_on_by_its_length(course_world):
    assert course_world.time == 0
    assert course_world.step(100) == pytest.approx(0.1)
    assert course_world.time == pytest.approx(0.1)
    assert course_world.steps == 100
    assert course_world.step_size == 0.001
    assert course_world.advance(0.05) == pytest.approx(0.15)


def test_a_robot_follows_the_velocity_that_is_commanded(course_world):
    drive = course_world.drive("pioneer2dx")
    before = course_world.pose("pioneer2dx")
    drive.velocity(0.4)
    course_world.advance(1)
    after = course_world.pose("pioneer2dx")
    assert math.dist(before.position, after.position) > 0.2
    assert drive.odometry.shape == (3,)
    assert drive.odometry[0] > 0.2
    assert drive.measured_velocity[0] == pytest.approx(0.4, abs=0.05)
    assert course_world.velocity("pioneer2dx").vx > 0.1
    drive.stop()
    course_world.advance(1)
    assert drive.measured_velocity[0] == pytest.approx(0, abs=0.01)


def test_a_command_with_a_duration_ends_by_itself(course_world):
    drive = course_world.drive("pioneer2dx")
    drive.velocity(0.3, duration=0.5)
    course_world.advance(2)
    assert abs(drive.measured_velocity[0]) < 0.01


def test_a_scan_never_changes_under_its_reader(course_world):
    course_world.drive("pioneer2dx").velocity(0.4, va=0.5)
    first = course_world.scan("pioneer2dx::laser")
    copy = first.copy()
    seen = [first]
    for _ in range(20):
        course_world.step(100)
        seen.append(course_world.scan("pioneer2dx::laser"))
    assert first.dtype == numpy.float32 and first.ndim == 1
    assert numpy.array_equal(first, copy)
    assert not numpy.array_equal(seen[-1], first)
    kept = [scan.copy() for scan in seen]
    course_world.close()
    assert all(numpy.array_equal(a, b) for a, b in zip(seen, kept))


def test_a_sample_has_all_fields_of_its_iface(course_world):
    course_world.step(100)
    sample = course_world.read("pioneer2dx::laser")
    assert {"time", "sequence", "valid", "ranges", "intensities", "pose"} <= sample.keys()
    assert sample["valid"] is True
    assert sample["time"] <= course_world.time
    assert sample["pose"].shape == (7,)
    info = course_world.info("pioneer2dx::laser")
    assert info["beams"] == len(sample["ranges"])
    assert info["model"] == "pioneer2dx"


def test_every_type_of_iface_can_be_read(test_worlds):
    with rtmsim.World(test_worlds / "every_device.sdf") as world:
        for name, types in world.ifaces().items():
            for type in types.split(", "):
                if type == "simulation":
                    continue
                world.device(type, name)
        world.advance(1)
        for name, types in world.ifaces().items():
            for type in types.split(", "):
                if type == "simulation":
                    continue
                sample = world.read(name, type)
                assert sample["time"] >= 0, name
                assert world.info(name, type), name


def test_images_are_arrays_of_rows_from_the_top(test_worlds):
    with rtmsim.World(test_worlds / "every_device.sdf") as world:
        types = {}
        for name, kinds in world.ifaces().items():
            for kind in kinds.split(", "):
                types.setdefault(kind, name)
        camera = world.camera(types["camera"])
        info = world.info(types["camera"], "camera")
        assert camera.shape[:2] == (info["height"], info["width"])
        depth = world.depth(types["depth"])
        assert depth.dtype == numpy.float32 and depth.ndim == 2
        points = world.points(types["points"])
        assert points.ndim == 3 and points.shape[2] in (3, 4)
        kept = camera.copy()
        world.advance(1)
        for _ in range(6):
            world.camera(types["camera"])
        assert numpy.array_equal(camera, kept)


def test_a_screenshot_is_an_array(course_world):
    image = course_world.screenshot(320, 200, top=True)
    assert image.shape == (200, 320, 3) and image.dtype == numpy.uint8
    assert image.std() > 5
    assert course_world.screenshot(64, 48, follow="pioneer2dx").shape == (48, 64, 3)
    assert course_world.screenshot(64, 48, eye=(0, 0, 8, 0, 1.5, 0)).shape == (48, 64, 3)
    with pytest.raises(rtmsim.NotFound, match="no_such"):
        course_world.screenshot(follow="no_such")
    with pytest.raises(rtmsim.Error, match="one view"):
        course_world.screenshot(top=True, follow="pioneer2dx")
    with pytest.raises(rtmsim.Error, match="8192"):
        course_world.screenshot(9000, 10)


def test_a_reset_with_a_seed_is_the_start_of_a_simulator_with_that_seed(course_world):
    def run(world):
        world.drive("pioneer2dx").velocity(0.3, va=0.2)
        scans = []
        for _ in range(5):
            world.step(100)
            scans.append(world.scan("pioneer2dx::laser"))
        return numpy.stack(scans), world.hash()

    course_world.scan("pioneer2dx::laser")
    first = run(course_world)
    course_world.reset(7)
    assert course_world.seed == 7 and course_world.time == 0
    seventh = run(course_world)
    course_world.reset()
    assert course_world.seed == 7
    again = run(course_world)
    course_world.reset(1)
    back = run(course_world)
    with rtmsim.World(course, seed=7) as other:
        other.scan("pioneer2dx::laser")
        fresh = run(other)
    assert numpy.array_equal(seventh[0], fresh[0]) and seventh[1] == fresh[1]
    assert numpy.array_equal(seventh[0], again[0]) and seventh[1] == again[1]
    assert numpy.array_equal(first[0], back[0]) and first[1] == back[1]
    assert first[1] != seventh[1]


def test_sensors_show_what_a_reset_or_a_move_has_changed_and_the_run_goes_on_as_without(course_world):
    def run(looks):
        course_world.reset(3)
        drive = course_world.drive("pioneer2dx")
        first = course_world.scan("pioneer2dx::laser") if looks else None
        drive.velocity(0.4)
        course_world.step(1000)
        course_world.set_pose("pioneer2dx", (-2, -4.5, 0))
        if looks:
            there = course_world.read("pioneer2dx::laser")
            assert there["pose"][:2] == pytest.approx([-2, -4.5], abs=0.3)
            assert there["time"] == pytest.approx(1)
        course_world.step(1000)
        return first, course_world.hash()

    course_world.scan("pioneer2dx::laser")
    first = run(True)
    again = run(True)
    assert numpy.array_equal(first[0], again[0])
    assert course_world.drive("pioneer2dx").odometry[0] > 0.5
    course_world.reset()
    assert course_world.drive("pioneer2dx").odometry.tolist() == [0, 0, 0]
    assert run(False)[1] == first[1] == again[1]


def test_models_are_moved_spawned_and_deleted(course_world):
    assert "pioneer2dx" in course_world.models()
    course_world.set_pose("pioneer2dx", (1, -1.5, math.pi / 2))
    pose = course_world.pose("pioneer2dx")
    assert (pose.x, pose.y) == pytest.approx((1, -1.5))
    assert pose.yaw == pytest.approx(math.pi / 2)
    box = ('<sdf version="1.9"><model name="crate"><link name="link"><collision name="c"><geometry><box><size>.2 .2 .2</size></box>'
           '</geometry></collision></link></model></sdf>')
    assert course_world.spawn(box, "crate7", (2, 2, 0.5, 0)) == "crate7"
    assert course_world.poses()["crate7"].z == pytest.approx(0.5)
    course_world.set_velocity("crate7", (0.5, 0, 0))
    assert course_world.velocity("crate7").vx == pytest.approx(0.5)
    course_world.advance(1)
    assert course_world.pose("crate7").z == pytest.approx(0.1, abs=0.02)
    assert course_world.contacts("crate7")
    x = course_world.pose("crate7").x
    course_world.push("crate7", (200, 0, 0), duration=0.2)
    course_world.advance(0.5)
    assert course_world.pose("crate7").x > x
    x = course_world.pose("crate7").x
    course_world.push("crate7", (-20, 0, 0), persistent=True)
    course_world.advance(0.5)
    assert course_world.pose("crate7").x < x - 0.1
    course_world.push("crate7", persistent=True)
    with pytest.raises(rtmsim.NotFound, match="no joint crate7::hinge"):
        course_world.push_joint("crate7", "hinge", 1)
    course_world.delete("crate7")
    assert "crate7" not in course_world.models()
    with pytest.raises(rtmsim.NotFound, match="crate7"):
        course_world.pose("crate7")


def test_a_sensor_of_a_model_that_was_deleted_and_came_back_is_read_again(course_world):
    course_world.step(100)
    course_world.scan("pioneer2dx::laser")
    laser = course_world.device("laser", "pioneer2dx::laser")
    course_world.delete("pioneer2dx")
    with pytest.raises(rtmsim.NotFound):
        course_world.scan("pioneer2dx::laser")
    course_world.reset()
    assert course_world.scan("pioneer2dx::laser").size > 0
    assert laser.array(5.0).size > 0


def test_faults_are_injected_listed_and_ended(course_world):
    course_world.fault("pioneer2dx::laser", "bias", 0.5)
    assert [fault["kind"] for fault in course_world.faults()] == ["bias"]
    assert course_world.end_faults() == 1
    with pytest.raises(rtmsim.Error, match="odd"):
        course_world.fault("pioneer2dx::laser", "odd")
    with pytest.raises(rtmsim.NotFound, match="pioneer2dx::lasr"):
        course_world.fault("pioneer2dx::lasr", "off")


def test_a_reader_writes_a_tag_in_its_reach(worlds):
    with rtmsim.World(worlds / "devices.sdf") as world:
        def tags():
            world.step(100)
            found = world.read("rover::rfid")["tags"]
            return list(zip(found["id"], found["data"]))

        assert tags() == [("E200-0017", "shelf 3")]
        world.write_tag("rover::rfid", "E200-0017", "shelf 42")
        assert tags() == [("E200-0017", "shelf 42")]
        with pytest.raises(rtmsim.Error, match="has no tag \"E200-9\" in reach; it has E200-0017"):
            world.write_tag("rover::rfid", "E200-9", "x")
        with pytest.raises(rtmsim.NotFound, match="rover::rfd"):
            world.write_tag("rover::rfd", "E200-0017", "x")
        world.reset()
        assert tags() == [("E200-0017", "shelf 3")]


def test_joints_follow_commands_by_name_and_by_number(worlds):
    with rtmsim.World(worlds / "arm.sdf") as world:
        names = [name for name, type in world.ifaces().items() if type == "joints"]
        joints = world.joints(names[0])
        assert joints.position.shape == (len(joints.names),)
        goal = float(numpy.clip(0.3, joints.lower[0], joints.upper[0]))
        joints.command(position={joints.names[0]: goal})
        world.advance(5)
        assert joints.position[0] == pytest.approx(goal, abs=0.02)
        joints.command(position=joints.position)
        with pytest.raises(rtmsim.Error, match="one per joint"):
            joints.command(velocity=[1.0] * 99)
        with pytest.raises(rtmsim.NotFound, match="no joint 'elbo'"):
            joints.command(effort={"elbo": 1.0})
        with pytest.raises(rtmsim.Error, match="expected one of"):
            joints.command()


def test_wrong_names_are_answered_with_one_line_that_says_what_there_is(course_world):
    for call, words in (
        (lambda: course_world.pose("pioner2dx"), "did you mean"),
        (lambda: course_world.scan("pioneer2dx::lasr"), "lasr"),
        (lambda: course_world.read("pioneer2dx::lasr"), "did you mean"),
        (lambda: course_world.drive("box_0"), "pioneer2dx"),
        (lambda: course_world.device("lidar", "x"), "expected one of"),
        (lambda: course_world.device("laser", "pioneer2dx::laser").value("rangs", 1.0), "it has"),
    ):
        with pytest.raises(rtmsim.NotFound) as caught:
            call()
        assert words in str(caught.value)
        assert "\n" not in str(caught.value)
    with pytest.raises(rtmsim.Error, match="at least 1, got 0"):
        course_world.step(0)
    with pytest.raises(rtmsim.Error, match="seed"):
        course_world.reset(-1)
    with pytest.raises(rtmsim.Error, match="pose: expected 3 numbers"):
        course_world.set_pose("pioneer2dx", (1, 2))
    with pytest.raises(rtmsim.Error, match="finite"):
        course_world.set_pose("pioneer2dx", (math.nan, 2, 0))


def test_the_kinds_of_errors_are_the_same_when_recordings_are_loaded(course_world):
    with pytest.raises(rtmsim.Error, match="no_such.mcap"):
        rtmsim.Recording("no_such.mcap")
    with pytest.raises(rtmsim.NotFound):
        course_world.pose("no_such")


def test_worlds_can_be_text_and_step_at_the_same_time():
    text = ('<sdf version="1.9"><world name="w"><model name="ball"><pose>0 0 10 0 0 0</pose><link name="l"><collision name="c"><geometry>'
            '<sphere><radius>.1</radius></sphere></geometry></collision></link></model></world></sdf>')
    with rtmsim.World(text) as one, rtmsim.World(text) as two:
        assert one.server_id != two.server_id
        times = rtmsim.step_all([one, two], 100)
        assert times == [one.time, two.time] == pytest.approx([0.1, 0.1])
        assert one.pose("ball") == two.pose("ball")
        assert one.pose("ball").z < 10


def test_a_closed_world_says_so(course_world):
    course_world.close()
    course_world.close()
    with pytest.raises(rtmsim.Error, match="closed"):
        course_world.pose("pioneer2dx")
    with pytest.raises(rtmsim.Error, match="closed"):
        course_world.step()
