# Topics of robots before a peer by another maker of DDS: ros2_topics.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import json
import math
import struct
import xml.etree.ElementTree

from ros2_rig import *


# The clock, the frames, a scan and the odometry of each robot, with every field; a Twist moves the robot.
def thin_line():
    with Rig() as rig:
        rig.sim(two)
        rig.gateway(robots=2)
        peer = rig.peer()
        peer.subscribe("/clock", "rosgraph_msgs/Clock", "best_effort")
        peer.subscribe("/tf", "tf2_msgs/TFMessage")
        peer.subscribe("/tf_static", "tf2_msgs/TFMessage", durability="transient")
        peer.subscribe("/leader/scan", "sensor_msgs/LaserScan", "best_effort")
        peer.subscribe("/leader/odom", "nav_msgs/Odometry")
        assert wire.seconds(peer.message("/clock", "rosgraph_msgs/Clock")["clock"]) >= 0
        scan = peer.message("/leader/scan", "sensor_msgs/LaserScan")
        assert scan["header"]["frame_id"] == "leader/laser", scan["header"]
        count = round((scan["angle_max"] - scan["angle_min"]) / scan["angle_increment"]) + 1
        assert len(scan["ranges"]) == count and scan["range_max"] > scan["range_min"] > 0, scan
        assert any(math.isfinite(one) and one > scan["range_min"] for one in scan["ranges"])
        odometry = peer.message("/leader/odom", "nav_msgs/Odometry")
        assert (odometry["header"]["frame_id"], odometry["child_frame_id"]) == ("leader/odom", "leader/base_link")
        assert odometry["pose"]["covariance"][35] == 1e-3 and len(odometry["twist"]["covariance"]) == 36

        def has_fixed_frames():
            children = {one["child_frame_id"] for message in peer.messages("/tf_static", "tf2_msgs/TFMessage") for one in message["transforms"]}
            assert {"leader/laser", "follower/laser", "leader/sonar_0"} <= children, children
            return True

        await_("the fixed frames of both robots", has_fixed_frames, 0.1)
        frames = peer.message("/tf", "tf2_msgs/TFMessage", lambda m: m["transforms"][0]["child_frame_id"] == "follower/base_link")
        assert frames["transforms"][0]["header"]["frame_id"] == "follower/odom"
        peer.advertise("/leader/cmd_vel", "geometry_msgs/Twist")
        peer.await_matched("/leader/cmd_vel")

        def moves():
            peer.put("/leader/cmd_vel", "geometry_msgs/Twist", wire.twist(0.2, 0.1))
            return peer.messages("/leader/odom", "nav_msgs/Odometry")[-1]["twist"]["twist"]["linear"]["x"] > 0.1

        await_("the leader moves", moves, 0.1)
        # Without another command it stops.
        peer.message("/leader/odom", "nav_msgs/Odometry", lambda m: abs(m["twist"]["twist"]["linear"]["x"]) < 1e-3)


mast = f"""<sdf version="1.9"><world name="mast"><magnetic_field>2e-5 1e-6 -4e-5</magnetic_field><include><uri>{source}/worlds/models/ground_plane</uri></include>
<spherical_coordinates><latitude_deg>50</latitude_deg><longitude_deg>8</longitude_deg><elevation>100</elevation></spherical_coordinates>
<model name="mast"><pose>0 0 2 0 0 0</pose>
<link name="base"><inertial><mass>5</mass></inertial><collision name="c"><geometry><box><size>0.1 0.1 0.2</size></box></geometry></collision>
 <sensor name="pressure" type="air_pressure"><update_rate>20</update_rate></sensor>
 <sensor name="height" type="altimeter"><update_rate>20</update_rate></sensor>
 <sensor name="imu" type="imu"><update_rate>20</update_rate></sensor>
 <sensor name="field" type="magnetometer"><update_rate>20</update_rate></sensor>
 <sensor name="gps" type="navsat"><update_rate>20</update_rate></sensor>
 <sensor name="eye" type="camera"><pose>0.1 0 0 0 0.5236 0</pose><update_rate>10</update_rate><camera><horizontal_fov>1</horizontal_fov><image><width>32</width><height>24</height></image>
  <clip><near>0.1</near><far>50</far></clip></camera></sensor>
 <sensor name="deep" type="depth_camera"><pose>0.1 0 0 0 0.5236 0</pose><update_rate>10</update_rate><camera><horizontal_fov>1</horizontal_fov><image><width>32</width><height>24</height></image>
  <clip><near>0.1</near><far>50</far></clip></camera></sensor>
 <sensor name="rings" type="gpu_lidar"><pose>0 0 0.2 0 0 0</pose><update_rate>10</update_rate><lidar><scan><horizontal><samples>36</samples><min_angle>-1</min_angle><max_angle>1</max_angle></horizontal>
  <vertical><samples>4</samples><min_angle>-0.6</min_angle><max_angle>-0.3</max_angle></vertical></scan><range><min>0.1</min><max>30</max></range></lidar></sensor></link>
<link name="arm"><pose>0 0 0.5 0 0 0</pose><inertial><mass>2</mass></inertial></link>
<joint name="fix" type="fixed"><parent>world</parent><child>base</child></joint>
<joint name="wrist" type="fixed"><parent>base</parent><child>arm</child><sensor name="strain" type="force_torque"><update_rate>20</update_rate></sensor></joint></model></world></sdf>"""


# One message of each sensor, with every field, and what must be true of it.
def sensors():
    with Rig() as rig:
        rig.sim(mast)
        rig.gateway()
        peer = rig.peer()

        def first(topic, kind):
            peer.subscribe("/mast/" + topic, kind)
            message = peer.message("/mast/" + topic, kind)
            assert message["header"]["stamp"]["nanosec"] < 10**9
            return message

        pressure = first("air_pressure", "sensor_msgs/FluidPressure")
        assert 90000 < pressure["fluid_pressure"] < 102000 and pressure["header"]["frame_id"] == "mast/pressure", pressure
        assert abs(first("altimeter", "ros_gz_interfaces/Altimeter")["vertical_position"]) < 0.1
        imu = first("imu/data", "sensor_msgs/Imu")
        assert abs(imu["linear_acceleration"]["z"] - 9.8) < 0.1 and imu["orientation"]["w"] > 0.99, imu
        assert 3e-5 < math.hypot(*first("imu/mag", "sensor_msgs/MagneticField")["magnetic_field"].values()) < 6e-5
        fix = first("gps/fix", "sensor_msgs/NavSatFix")
        assert abs(fix["latitude"] - 50) < 1e-3 and abs(fix["altitude"] - 102) < 1 and fix["status"]["status"] == 0, fix
        image = first("eye/image_raw", "sensor_msgs/Image")
        assert (image["width"], image["height"], image["encoding"], image["step"], len(image["data"])) == (32, 24, "rgb8", 96, 96 * 24)
        assert image["header"]["frame_id"] == "mast/eye_optical_frame"
        jpeg = first("eye/image_raw/compressed", "sensor_msgs/CompressedImage")
        assert jpeg["format"] == "jpeg" and jpeg["data"][:2] == b"\xff\xd8"
        info = first("eye/camera_info", "sensor_msgs/CameraInfo")
        assert info["k"][2] == 16 and info["k"][0] == info["p"][0] > 0 and info["distortion_model"] == "plumb_bob" and info["r"][4] == 1, info
        depth = first("deep/depth/image_raw", "sensor_msgs/Image")
        assert (depth["encoding"], depth["step"]) == ("32FC1", 128) and first("deep/depth/camera_info", "sensor_msgs/CameraInfo")["width"] == 32
        cloud = first("points", "sensor_msgs/PointCloud2")
        assert [field["name"] for field in cloud["fields"]] == ["x", "y", "z", "intensity", "ring", "time"], cloud["fields"]
        assert (cloud["height"], cloud["width"], cloud["point_step"], len(cloud["data"])) == (4, 36, 24, 4 * 36 * 24)
        rings = {struct.unpack_from("<H", cloud["data"], i * 24 + 16)[0] for i in range(4 * 36)}
        assert rings == {0, 1, 2, 3}, rings
        assert abs(first("strain/wrench", "geometry_msgs/WrenchStamped")["wrench"]["force"]["z"]) > 10
        peer.subscribe("/mast/robot_description", "std_msgs/String", durability="transient")
        description = peer.message("/mast/robot_description", "std_msgs/String")["data"]
        assert 'robot name="mast"' in description and 'link name="base_link"' in description and "<box" in description, description
        # Nobody is subscribed any more: nothing is simulated.
        peer.end()
        rig.peers.remove(peer)
        await_("all sensors rest", lambda: all(one["subscribers"] == 0 for one in json.loads(rig.simctl("--json", "list")) if one["type"] != "simulation"), 0.1)


# Devices of every other kind: each has a topic, with every field of its message. No kind is left without one.
def devices():
    with Rig() as rig:
        rig.sim(f"{source}/tests/worlds/every_device.sdf")
        rig.gateway(robots=4)
        peer = rig.peer()

        def first(topic, kind, good=lambda message: True):
            peer.subscribe(topic, kind)
            return peer.message(topic, kind, good)

        battery = first("/rover/battery_state", "sensor_msgs/BatteryState")
        info = json.loads(rig.simctl("--json", "echo", "rover::battery", "-n", "1"))
        assert abs(battery["voltage"] - info["voltage"]) < 0.1 and 0 <= battery["percentage"] <= 1 and battery["present"], (battery, info)
        assert math.isnan(battery["temperature"]) and battery["power_supply_status"] in (1, 2, 3, 4) and battery["location"], battery
        wheels = first("/rover/encoders/wheel_states", "sensor_msgs/JointState")
        assert len(wheels["name"]) == len(wheels["position"]) == len(wheels["velocity"]) > 0 and not wheels["effort"], wheels
        pose = first("/rig/estimate/pose", "geometry_msgs/PoseWithCovarianceStamped")
        assert pose["header"]["frame_id"] == "world" and len(pose["pose"]["covariance"]) == 36, pose
        assert first("/rig/air_speed", "sensor_msgs/FluidPressure")["header"]["frame_id"] == "rig/pitot"
        fix = first("/rig/navigation/fix", "sensor_msgs/NavSatFix")
        assert fix["header"]["frame_id"] == "rig/navigation" and abs(fix["latitude"]) <= 90
        turn = first("/rig/navigation/orientation", "sensor_msgs/Imu")
        assert turn["angular_velocity_covariance"][0] == turn["linear_acceleration_covariance"][0] == -1, turn
        assert first("/rig/navigation/velocity", "geometry_msgs/TwistStamped")["header"]["stamp"]["nanosec"] < 10**9
        for topic, kind in (("reader/tags", "std_msgs/String"), ("receiver/transmitters", "std_msgs/String"), ("models/models", "visualization_msgs/MarkerArray"),
                            ("marks/markers", "visualization_msgs/MarkerArray"), ("boxes/detections", "vision_msgs/Detection2DArray")):
            first(f"/rig/{topic}", kind)
        peer.subscribe("/rig/log/velocity", "geometry_msgs/TwistWithCovarianceStamped")
        peer.await_matched("/rig/log/velocity")
        table = rig.call(f"{bin_dir}/ros2-gateway", "--interfaces")
        kinds = {one["type"] for one in json.loads(rig.simctl("--json", "list"))} - {"simulation", "truth"}
        assert all(f"| `{kind}` |" in table for kind in kinds), kinds


# What cameras recognise, with numbers: boxes in the image and in the world, models and marks.
def seen():
    with Rig() as rig:
        rig.sim(f"{source}/worlds/devices.sdf")
        rig.gateway(robots=7)
        peer = rig.peer()
        flat, solid, models, marks = "/mast/boxes/detections", "/mast/oriented_boxes/detections", "/mast/models/models", "/mast/marks/markers"
        peer.subscribe(flat, "vision_msgs/Detection2DArray")
        peer.subscribe(solid, "vision_msgs/Detection3DArray")
        peer.subscribe(models, "visualization_msgs/MarkerArray")
        peer.subscribe(marks, "visualization_msgs/MarkerArray")
        found = {one["id"]: one for one in peer.message(flat, "vision_msgs/Detection2DArray", lambda m: m["detections"])["detections"]}
        ball = found["ball"]
        focal = 320 / math.tan(0.6)  # the ball of 0.2 m is at (2.6, -0.6, 0.2), the camera 0.9 m high
        center = ball["bbox"]["center"]["position"]
        assert ball["results"][0]["hypothesis"] == {"class_id": "2", "score": 1.0} and ball["header"]["frame_id"] == "mast/boxes_optical_frame", ball
        assert abs(center["x"] - (320 + focal * 0.6 / 2.6)) < 3 and abs(center["y"] - (240 + focal * 0.7 / 2.6)) < 3, ball
        crate = next(one for one in peer.message(solid, "vision_msgs/Detection3DArray", lambda m: m["detections"])["detections"] if one["id"] == "crate_near")
        assert all(abs(size - 0.6) < 1e-3 for size in crate["bbox"]["size"].values()) and crate["header"]["frame_id"] == "mast/oriented_boxes", crate
        texts = [one["text"] for one in peer.message(models, "visualization_msgs/MarkerArray", lambda m: len(m["markers"]) > 1)["markers"]]
        assert texts[0] == "" and {"crate_near", "ball"} <= set(texts), texts
        array = peer.message(marks, "visualization_msgs/MarkerArray", lambda m: len(m["markers"]) > 1)["markers"]
        assert array[0]["action"] == 3 and array[1]["ns"] == "mast::marks" and array[1]["type"] == 1 and array[1]["scale"]["y"] > 0, array[1]


arm = f"{source}/worlds/arm.sdf"


def product(a, b):
    w, x, y, z = a
    v, i, j, k = b
    return (w * v - x * i - y * j - z * k, w * i + x * v + y * k - z * j, w * j - x * k + y * v + z * i, w * k + x * j - y * i + z * v)


# Poses are (position, quaternion w x y z).
def moved(pose, by):
    (p, q), (point, turn) = pose, by
    _, *far = product(product(q, (0.0, *point)), (q[0], -q[1], -q[2], -q[3]))
    return tuple(a + b for a, b in zip(p, far)), product(q, turn)


def listed(numbers):
    return tuple(numbers[:3]), tuple(numbers[3:])


# rviz2 draws the shapes of the description in the frames of links: there the simulator has them, too.
def assert_described(rig, peer, model):
    peer.subscribe(f"/{model}/robot_description", "std_msgs/String", durability="transient")
    robot = xml.etree.ElementTree.fromstring(peer.message(f"/{model}/robot_description", "std_msgs/String")["data"])
    frames = {}
    for topic in ("/tf", "/tf_static"):
        for message in peer.messages(topic, "tf2_msgs/TFMessage"):
            frames.update({one["child_frame_id"]: one for one in message["transforms"]})

    def place(frame):
        if frame == "world":
            return (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)
        move, turn = (frames[frame]["transform"][part] for part in ("translation", "rotation"))
        return moved(place(frames[frame]["header"]["frame_id"]), ((move["x"], move["y"], move["z"]), (turn["w"], turn["x"], turn["y"], turn["z"])))

    drawn = {}
    for link in robot.findall("link"):
        for origin in link.findall("visual/origin"):
            at = tuple(float(word) for word in origin.get("xyz").split())
            drawn.setdefault(link.get("name"), []).append(moved(place(f"{model}/{link.get('name')}"), (at, (1.0, 0.0, 0.0, 0.0)))[0])
    assert len(drawn) > 2, drawn
    tree = next(one for one in json.loads(rig.simctl("--json", "tree"))["models"] if one["name"] == model)
    for link in tree["links"]:
        for shape in link["collisions"]:
            center = moved(listed(link["pose"]), listed(shape["pose"]))[0]
            near = [point for points in drawn.values() for point in points if math.dist(point, center) < 0.01]
            assert near or shape["shape"] not in ("box", "sphere", "cylinder"), (link["name"], center, drawn)


# A path of joints, arrays for all of them, and one joint; the states and frames of links.
def joints():
    with Rig() as rig:
        rig.sim(arm)
        rig.gateway(robots=len(rig.models_with("joints")))
        model = rig.models_with("joints")[0]
        peer = rig.peer()
        states = f"/{model}/joint_states"
        peer.subscribe(states, "sensor_msgs/JointState", "best_effort")
        peer.subscribe("/tf", "tf2_msgs/TFMessage")
        state = peer.message(states, "sensor_msgs/JointState")
        names = state["name"]
        assert len(state["position"]) == len(state["velocity"]) == len(state["effort"]) == len(names) > 1, state
        frames = peer.message("/tf", "tf2_msgs/TFMessage", lambda m: len(m["transforms"]) == len(names))
        assert all(one["child_frame_id"].startswith(f"{model}/") for one in frames["transforms"])
        peer.subscribe("/tf_static", "tf2_msgs/TFMessage", durability="transient")
        fixed = {one["child_frame_id"]: one for one in peer.message("/tf_static", "tf2_msgs/TFMessage")["transforms"]}
        # The frame of a sensor is on the link that carries it.
        camera = fixed["eye/camera"]
        assert camera["header"]["frame_id"] == "eye/head" and abs(camera["transform"]["rotation"]["w"]) > 0.999, camera
        assert fixed["eye/base_link"]["header"]["frame_id"] == "world"
        assert_described(rig, peer, model)
        start, wanted = state["position"][0], state["position"][0] + 0.3
        path = f"/{model}/joint_trajectory"
        peer.advertise(path, "trajectory_msgs/JointTrajectory")
        peer.await_matched(path)
        zero = {"sec": 0, "nanosec": 0}

        def point(position, sec):
            return {"positions": [position], "velocities": [], "accelerations": [], "effort": [], "time_from_start": {"sec": sec, "nanosec": 0}}

        message = {"header": {"stamp": zero, "frame_id": ""}, "joint_names": [names[0]], "points": [point((start + wanted) / 2, 1), point(wanted, 2)]}
        peer.put(path, "trajectory_msgs/JointTrajectory", message)
        peer.message(states, "sensor_msgs/JointState", lambda m: abs(m["position"][0] - wanted) < 0.02)

        # Goals are checked before anything moves; a line has what was sent.
        def refused(why, names, points):
            peer.put(path, "trajectory_msgs/JointTrajectory", {**message, "joint_names": names, "points": points})
            await_("the refusal", lambda: f"{path}: {why}" in rig.log(rig.process))

        refused('the robot has no joint "nobody"', ["nobody"], message["points"])
        refused(f"joint {names[0]}: a position must be within -2.9 and 2.9, got 100; it is ignored", names[:1], [point(100.0, 1)])
        refused(f'joint_names has "{names[0]}" twice', names[:1] * 2, [{**point(0.0, 1), "positions": [0.0, 0.0]}])
        refused("joint_names is empty", [], [{**point(0.0, 1), "positions": []}])
        refused("each point needs as many finite positions", names[:2], [point(0.0, 1)])
        # A joint at its stop, to which it was pushed.
        finger = names.index("left_finger")
        peer.put(path, "trajectory_msgs/JointTrajectory", {**message, "joint_names": ["left_finger"], "points": [point(0.02, 1)]})
        peer.message(states, "sensor_msgs/JointState", lambda m: abs(m["position"][finger] - 0.02) < 0.002)
        assert abs(peer.messages(states, "sensor_msgs/JointState")[-1]["position"][0] - wanted) < 0.02
        # Of several values all count, or none.
        every = f"/{model}/position_controller/commands"
        peer.advertise(every, "std_msgs/Float64MultiArray")
        peer.await_matched(every)
        peer.put(every, "std_msgs/Float64MultiArray", {"layout": {"dim": [], "data_offset": 0}, "data": [0.0] * (len(names) - 1) + [100.0]})
        await_("the refusal", lambda: f"{every}: joint {names[-1]}: a position must be within" in rig.log(rig.process))
        peer.put(path, "trajectory_msgs/JointTrajectory", {**message, "joint_names": ["left_finger"], "points": [point(0.03, 1)]})
        peer.message(states, "sensor_msgs/JointState", lambda m: abs(m["position"][finger] - 0.03) < 0.002)
        assert abs(peer.messages(states, "sensor_msgs/JointState")[-1]["position"][0] - wanted) < 0.02
        one = f"/{model}/{names[0]}/position_command"
        peer.advertise(one, "std_msgs/Float64")
        peer.await_matched(one)
        peer.put(one, "std_msgs/Float64", {"data": start})
        peer.message(states, "sensor_msgs/JointState", lambda m: abs(m["position"][0] - start) < 0.02)
        rates = f"/{model}/velocity_controller/commands"
        peer.advertise(rates, "std_msgs/Float64MultiArray")
        peer.await_matched(rates)
        peer.put(rates, "std_msgs/Float64MultiArray", {"layout": {"dim": [], "data_offset": 0}, "data": [0.1] + [0.0] * (len(names) - 1)})
        peer.message(states, "sensor_msgs/JointState", lambda m: abs(m["velocity"][0] - 0.1) < 0.02)


# TwistStamped of stamp 0 drives as Twist does, from writers of best effort too; what is not finite is refused.
def stamped():
    with Rig() as rig:
        rig.sim(two)
        rig.gateway("--root", "leader", robots=2)
        peer = rig.peer()
        peer.subscribe("/odom", "nav_msgs/Odometry")
        peer.writer("stamped", "rt/cmd_vel", wire.type_on_wire("geometry_msgs/TwistStamped"))
        peer.await_matched("stamped")
        message = {"header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""}, "twist": wire.twist(0.2, 0.0)}

        def moves():
            peer.put("stamped", "geometry_msgs/TwistStamped", message)
            return peer.message("/odom", "nav_msgs/Odometry")["twist"]["twist"]["linear"]["x"] > 0.1

        await_("the leader moves", moves, 0.1)
        assert peer.message("/odom", "nav_msgs/Odometry")["header"]["frame_id"] == "odom"
        peer.writer("weak", "rt/cmd_vel", wire.type_on_wire("geometry_msgs/Twist"), "best_effort")
        peer.await_matched("weak")

        def goes_back():
            peer.put("weak", "geometry_msgs/Twist", wire.twist(-0.2, 0.0))
            return peer.messages("/odom", "nav_msgs/Odometry")[-1]["twist"]["twist"]["linear"]["x"] < -0.1

        await_("the leader goes back", goes_back, 0.1)
        assert "is requested as" not in rig.log(rig.process), rig.log(rig.process)
        message["twist"] = wire.twist(math.nan, 0.0)
        peer.put("stamped", "geometry_msgs/TwistStamped", message)
        await_("the refusal", lambda: "warning: ros2-gateway: /cmd_vel:" in rig.log(rig.process).replace("warn:", "warning:"))


globals()[case]()
