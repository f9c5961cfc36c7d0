# ros2-gateway before a peer by another maker of DDS: ros2_gateway.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import json
import math
import os
import random
import re
import signal
import socket
import struct
import subprocess
import tempfile
import threading
import time

from ros2_rig import *

two = f"{source}/worlds/leader_follower.sdf"


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
        children = {one["child_frame_id"] for message in peer.messages("/tf_static", "tf2_msgs/TFMessage") for one in message["transforms"]}
        assert {"leader/laser", "follower/laser", "leader/sonar_0"} <= children, children
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


# One node for all robots, and frames without prefix on a topic of each robot.
def shapes():
    with Rig() as rig:
        rig.sim(two)
        rig.gateway("--one-node", "--tf-per-robot", "--distro", "jazzy", robots=2)
        peer = rig.peer()
        peer.reader("info", "ros_discovery_info", wire.type_on_wire("rmw_dds_common/ParticipantEntitiesInfo"), durability="transient", user_data=jazzy_hash)
        listed = peer.endpoints(lambda all: any(one[1] == "rt/follower/scan" for one in all) and any(one[1] == "rt/leader/tf" for one in all))
        own = {one[3] for one in listed if one[1] != "ros_discovery_info"}

        def is_one_node(info):
            nodes = info["node_entities_info_seq"]
            named = {gid["data"].hex() for node in nodes for kind in ("reader_gid_seq", "writer_gid_seq") for gid in node[kind]}
            return [(node["node_namespace"], node["node_name"]) for node in nodes] == [("/", "ros2_gateway")] and own <= named

        peer.message("info", "rmw_dds_common/ParticipantEntitiesInfo", is_one_node)
        # Parameters of the one node alone.
        assert {one[1].split("/")[1] for one in listed if one[1].endswith("list_parametersRequest")} == {"ros2_gateway"}, listed
        assert not any(one[1] in ("rt/tf", "rt/leader/robot/list_parameters") for one in listed), listed
        for robot in ("leader", "follower"):
            peer.subscribe(f"/{robot}/tf", "tf2_msgs/TFMessage")
            peer.subscribe(f"/{robot}/tf_static", "tf2_msgs/TFMessage", durability="transient")
            (frame,) = peer.message(f"/{robot}/tf", "tf2_msgs/TFMessage")["transforms"]
            assert (frame["header"]["frame_id"], frame["child_frame_id"]) == ("odom", "base_link"), frame
            fixed = {one["child_frame_id"]: one["header"]["frame_id"] for one in peer.message(f"/{robot}/tf_static", "tf2_msgs/TFMessage")["transforms"]}
            assert fixed["laser"] == "base_link", fixed
        peer.subscribe("/leader/scan", "sensor_msgs/LaserScan")
        assert peer.message("/leader/scan", "sensor_msgs/LaserScan")["header"]["frame_id"] == "laser"


arm = f"{source}/worlds/arm.sdf"


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
        message["joint_names"] = ["nobody"]
        peer.put(path, "trajectory_msgs/JointTrajectory", message)
        await_("the refusal", lambda: 'the robot has no joint "nobody"' in rig.log(rig.process))
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


# Messages of other encodings, damaged ones and a graph of 100,000 nodes: counted or limited, and the gateway goes on serving.
def damaged():
    with Rig() as rig:
        rig.sim(two)
        rig.gateway("--distro", "jazzy", robots=2)
        peer = rig.peer()
        peer.subscribe("/leader/odom", "nav_msgs/Odometry")
        peer.message("/leader/odom", "nav_msgs/Odometry")
        peer.advertise("/leader/cmd_vel", "geometry_msgs/Twist")
        peer.await_matched("/leader/cmd_vel", 2)
        body = wire.encode("geometry_msgs/Twist", wire.twist(0.2, 0.0))
        damaged = [bytes([0, kind, 0, 0]) + body[4:] for kind in (2, 3, 6, 7, 8, 9, 10, 11, 255)] + [body[:size] for size in (1, 4, 5, 12, len(body) - 8)]
        for data in damaged:
            peer.say(f"put /leader/cmd_vel {data.hex()}")
        await_("the count", lambda: re.search(r"node /leader/robot: \d+ messages or requests could not be read", rig.log(rig.process)))
        assert all(abs(one["twist"]["twist"]["linear"]["x"]) < 1e-3 for one in peer.messages("/leader/odom", "nav_msgs/Odometry"))
        # Big-endian numbers are those of other machines.
        zero = struct.pack(">d", 0)
        peer.say(f"put /leader/cmd_vel {(bytes(4) + struct.pack('>d', 0.2) + zero * 5).hex()}")
        peer.message("/leader/odom", "nav_msgs/Odometry", lambda m: m["twist"]["twist"]["linear"]["x"] > 0.1)
        peer.writer("graph", "ros_discovery_info", wire.type_on_wire("rmw_dds_common/ParticipantEntitiesInfo"), durability="transient", user_data=jazzy_hash)
        peer.await_matched("graph")
        gid = struct.pack("<QQ", 7, 7)
        node = struct.pack("<I4sI4sI16sI16s", 3, b"/n\0\0", 2, b"n\0\0\0", 1, gid, 1, gid)
        for count, nodes in ((100000, node * 100000), (2**32 - 1, node), (2**31 - 1, b"")):
            peer.say(f"put graph {(body[:4] + gid + struct.pack('<I', count) + nodes).hex()}")
        count = len(peer.samples["/leader/odom"])
        await_("odometry goes on", lambda: len(peer.samples["/leader/odom"]) > count + 20)
        assert "starting again" not in rig.log(rig.process), rig.log(rig.process)


# What peers see of the nodes: type hashes, and each endpoint in the list of its node.
def graph():
    with Rig() as rig:
        rig.sim(two)
        rig.gateway("--distro", "jazzy", robots=2)
        peer = rig.peer()
        peer.reader("info", "ros_discovery_info", wire.type_on_wire("rmw_dds_common/ParticipantEntitiesInfo"), durability="transient", user_data=jazzy_hash)
        listed = peer.endpoints(lambda all: any(one[1] == "rt/follower/scan" for one in all) and any("/leader/robot/set_parameters_atomically" in one[1] for one in all))
        assert all("typehash=RIHS01_" in one[4] for one in listed), [one for one in listed if "typehash" not in one[4]]
        assert all(one[2].endswith("_") and "::dds_::" in one[2] for one in listed), listed
        services = [one for one in listed if one[1].startswith(("rq/", "rr/"))]
        assert services and all(one[4].startswith("serviceid=") for one in services)

        def is_complete(info):
            named = {gid["data"].hex() for node in info["node_entities_info_seq"] for kind in ("reader_gid_seq", "writer_gid_seq") for gid in node[kind]}
            return {one[3] for one in listed if one[1] != "ros_discovery_info"} <= named

        info = peer.message("info", "rmw_dds_common/ParticipantEntitiesInfo", is_complete)
        nodes = {(node["node_namespace"], node["node_name"]) for node in info["node_entities_info_seq"]}
        assert nodes == {("/", "ros2_gateway"), ("/leader", "robot"), ("/follower", "robot")}, nodes
        assert info["gid"]["data"][12:] == b"\0\0\1\xc1", info["gid"]


# Nothing of the graph is sent before the family is known; to Humble, gids of 24 bytes; a second family is reported.
def families():
    kind = wire.type_on_wire("rmw_dds_common/ParticipantEntitiesInfo")
    for family, user_data, size in (("jazzy", jazzy_hash, 16), ("humble", "-", 24)):
        with Rig() as rig:
            rig.sim(two)
            rig.gateway(robots=2)
            peer = rig.peer()
            peer.reader("info", "ros_discovery_info", kind, durability="transient")
            peer.subscribe("/clock", "rosgraph_msgs/Clock")
            peer.message("/clock", "rosgraph_msgs/Clock")
            assert not peer.samples["info"]
            peer.writer("own", "ros_discovery_info", kind, durability="transient", user_data=user_data)
            await_("the graph", lambda: peer.samples["info"])
            data = peer.samples["info"][0][4:]
            assert data[size : size + 4] != b"\0\0\0\0" and data[12:16] == b"\0\0\1\xc1", data[:40].hex()
            assert data[16:24] == (b"\0" * 8 if size == 24 else data[16:24])
            count = struct.unpack_from("<I", data, size)[0]
            assert count == 3, (family, count)
            peer.writer("other", "ros_discovery_info", kind, durability="transient", user_data="-" if size == 16 else jazzy_hash)
            await_("the report", lambda: "Nodes of both cannot share a domain" in rig.log(rig.process))


class CycloneClient:
    count = 0

    def __init__(self, peer, service, request, response, more=""):
        CycloneClient.count += 1
        self.peer, self.service, self.number = peer, service, 0
        self.id = struct.pack("<Q", 77 + CycloneClient.count)
        mark = f"clientid=1.f.{CycloneClient.count:x};" + more
        self.replies = f"reply{CycloneClient.count}"
        self.requests = f"request{CycloneClient.count}"
        peer.reader(self.replies, f"rr{service}Reply", response, user_data=mark)
        peer.writer(self.requests, f"rq{service}Request", request, user_data=mark)
        peer.await_matched(self.requests)
        peer.await_matched(self.replies)

    def call(self, kind, value, reply_kind):
        return self.reply(self.start(kind, value), reply_kind)

    def start(self, kind, value):
        self.number += 1
        head = self.id + struct.pack("<q", self.number)
        body = wire.encode(kind, value)
        self.peer.say(f"put {self.requests} {(body[:4] + head + body[4:]).hex()}")
        return head

    def reply(self, head, reply_kind):
        def reply():
            for data in list(self.peer.samples[self.replies]):
                if data[4:20] == head:
                    return wire.decode(reply_kind, data[:4] + data[20:])

        return await_(f"the reply of {self.service}", reply)


SIMULATION = "simulation_interfaces"


def caller(peer, name):
    front = f"{SIMULATION}::srv::dds_::{name}"
    snake = "".join("_" + c.lower() if c.isupper() else c for c in name).lstrip("_")
    return CycloneClient(peer, "/" + snake, front + "_Request_", front + "_Response_")


# Services in the forms of both kinds of client, alone and side by side.
def services():
    with Rig() as rig:
        rig.sim(two, "--paused")
        rig.gateway("--distro", "jazzy", robots=2)
        peer = rig.peer()
        names = CycloneClient(peer, "/leader/robot/list_parameters", "rcl_interfaces::srv::dds_::ListParameters_Request_", "rcl_interfaces::srv::dds_::ListParameters_Response_")
        listed = names.call("rcl_interfaces/ListParametersRequest", {"prefixes": [], "depth": 0}, "rcl_interfaces/ListParametersResponse")
        assert listed["names"] == ["use_sim_time"], listed

        def fast(service, front, kind, value, reply_kind):
            words = rig.call(f"{bin_dir}/ros2_fast_client", rig.domain, service, front + "_Request_", front + "_Response_", wire.encode(kind, value).hex())
            return wire.decode(reply_kind, bytes.fromhex(words.strip()))

        front = "rcl_interfaces::srv::dds_::"
        assert fast("/leader/robot/list_parameters", front + "ListParameters", "rcl_interfaces/ListParametersRequest", {"prefixes": [], "depth": 0},
                    "rcl_interfaces/ListParametersResponse")["names"] == ["use_sim_time"]
        values = fast("/ros2_gateway/get_parameters", front + "GetParameters", "rcl_interfaces/GetParametersRequest", {"names": ["use_sim_time", "other"]},
                      "rcl_interfaces/GetParametersResponse")["values"]
        assert [(one["type"], one["bool_value"]) for one in values] == [(1, True), (0, False)], values
        # The reply for the client of Fast DDS did not come to that of Cyclone.
        assert len(peer.samples[names.replies]) == 1

        state = caller(peer, "GetSimulationState")
        empty = {"structure_needs_at_least_one_member": 0}

        def current():
            reply = state.call("std_srvs/Empty", empty, "simulation_interfaces/GetSimulationStateResponse")
            assert reply["result"]["result"] == 1
            return reply["state"]

        assert current() == 0
        step = caller(peer, "StepSimulation")

        def ask(client, kind, value):
            return client.call(f"simulation_interfaces/{kind}", value, "simulation_interfaces/ResultResponse")["result"]

        assert ask(step, "StepSimulationRequest", {"steps": 100})["result"] == 1
        assert rig.stats()["steps"] == 100 and current() == 2
        change = caller(peer, "SetSimulationState")
        assert ask(change, "SetSimulationStateRequest", {"state": 1})["result"] == 1 and current() == 1
        assert ask(change, "SetSimulationStateRequest", {"state": 1})["result"] == 101
        assert ask(change, "SetSimulationStateRequest", {"state": 3})["result"] == 0
        refused = ask(step, "StepSimulationRequest", {"steps": 1})
        assert refused["result"] == 4 and "pause it first" in refused["error_message"], refused
        assert ask(change, "SetSimulationStateRequest", {"state": 0})["result"] == 1 and current() == 0
        assert ask(change, "SetSimulationStateRequest", {"state": 2})["result"] == 103 and current() == 0
        # What takes long does not keep others waiting, and can be ended.
        long = step.start("simulation_interfaces/StepSimulationRequest", {"steps": 10**9})
        await_("the steps", lambda: rig.stats()["steps"] > 0)
        assert ask(change, "SetSimulationStateRequest", {"state": 2})["result"] == 1 and current() == 2
        step.reply(long, "simulation_interfaces/ResultResponse")
        entities = caller(peer, "GetEntities")
        unfiltered = {"categories": b"", "tags": [], "filter_mode": 0, "bounds": {"type": 0, "points": []}}
        # Patterns that would take all memory, or for ever.
        for hostile in ("a{1,255}{1,255}{1,255}", "(a{1000}){1000}", "(a*)*\\1", "x" * 201, "["):
            refused = entities.call("simulation_interfaces/GetEntitiesRequest", {"filter": hostile, **unfiltered}, "simulation_interfaces/GetEntitiesResponse")["result"]
            assert refused["result"] == 4 and hostile[:20] in refused["error_message"], refused
        found = entities.call("simulation_interfaces/GetEntitiesRequest", {"filter": "^(lead|foll)", **unfiltered}, "simulation_interfaces/GetEntitiesResponse")
        assert sorted(found["entities"]) == ["follower", "leader"], found
        pose = caller(peer, "GetEntityState")
        where = pose.call("simulation_interfaces/EntityRequest", {"entity": "leader"}, "simulation_interfaces/GetEntityStateResponse")
        assert where["result"]["result"] == 1 and abs(where["state"]["pose"]["position"]["x"] + 3.2) < 1e-3, where
        assert pose.call("simulation_interfaces/EntityRequest", {"entity": "nobody"}, "simulation_interfaces/GetEntityStateResponse")["result"]["result"] == 2
        spawn = caller(peer, "SpawnEntity")
        sdf = '<sdf version="1.9"><model name="box"><link name="l"><inertial><mass>1</mass></inertial><collision name="c"><geometry><box><size>1 1 1</size></box></geometry></collision></link></model></sdf>'
        place = {"header": where["state"]["header"], "pose": {"position": {"x": 2.0, "y": 2.0, "z": 0.5}, "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}}}
        place["header"]["frame_id"] = ""
        request = {"name": "crate", "allow_renaming": False, "uri": "", "resource_string": sdf, "entity_namespace": "", "initial_pose": place}

        def spawned(**more):
            reply = spawn.call("simulation_interfaces/SpawnEntityRequest", {**request, **more}, "simulation_interfaces/SpawnEntityResponse")
            return reply["result"]["result"], reply["entity_name"]

        assert spawned() == (1, "crate")
        assert spawned() == (101, "") and spawned(allow_renaming=True) == (1, "crate_1")
        assert spawned(name="x", resource_string="<sdf")[0] == 106 and spawned(name="x", resource_string="")[0] == 104
        assert spawned(name="x", entity_namespace="/a")[0] == 105
        # Names that the model would not have; huge texts come back shortened.
        for name in ("", "a::b", "world", "a\nb", "n" * 100000):
            assert spawned(name=name) == (102, ""), name
        assert spawned(name="", allow_renaming=True)[0] == 1
        assert spawned(name="x", resource_string="<mujoco/>")[0] == 103 and spawned(name="x", resource_string="nonsense")[0] == 106
        urdf = '<?xml version="1.0"?><robot name="r"><link name="base"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>'
        assert spawned(name="of_urdf", resource_string=urdf) == (1, "of_urdf")
        for x in (math.nan, math.inf, 1e300):
            far = {**place, "pose": {**place["pose"], "position": {"x": x, "y": 0.0, "z": 0.0}}}
            assert spawned(name="x", initial_pose=far)[0] == 109, x
        lost = pose.call("simulation_interfaces/EntityRequest", {"entity": "n" * 100000}, "simulation_interfaces/GetEntityStateResponse")["result"]
        assert lost["result"] == 2 and len(lost["error_message"]) < 600, len(lost["error_message"])
        spawnables = caller(peer, "GetSpawnables")
        listed = spawnables.call("simulation_interfaces/GetSpawnablesRequest", {"sources": []}, "simulation_interfaces/GetSpawnablesResponse")
        assert listed["result"]["result"] == 1 and listed["spawnables"], listed
        # A client of 2.x has the same request and another reply: told apart by the hash of the reply.
        front = "simulation_interfaces::srv::dds_::GetSpawnables_"
        newer = CycloneClient(peer, "/get_spawnables", front + "Request_", front + "Response_", "typehash=RIHS01_cb61fd741c429d6bc689514b7bfc65bb1518126961317acc6e414a841dc43daa;")
        again = newer.call("simulation_interfaces/GetSpawnablesRequest", {"sources": []}, "simulation_interfaces/GetSpawnablesResponse2")
        assert [one["entity_resource"]["uri"] for one in again["spawnables"]] == [one["uri"] for one in listed["spawnables"]], again
        other = spawnables.call("simulation_interfaces/GetSpawnablesRequest", {"sources": ["https://"]}, "simulation_interfaces/GetSpawnablesResponse")
        assert other["result"]["result"] == 0, other
        assert spawned(name="from_path", resource_string="", uri=listed["spawnables"][0]["uri"])[0] in (1, 106)
        delete = caller(peer, "DeleteEntity")
        assert ask(delete, "EntityRequest", {"entity": "crate"})["result"] == 1
        assert ask(delete, "EntityRequest", {"entity": "crate"})["result"] == 2


# While the simulation is paused the clock goes on coming, and each step is seen at once.
def paused():
    with Rig() as rig:
        rig.sim(two, "--paused")
        rig.gateway(robots=2)
        peer = rig.peer()
        peer.subscribe("/clock", "rosgraph_msgs/Clock", "best_effort")
        assert wire.seconds(peer.message("/clock", "rosgraph_msgs/Clock")["clock"]) == 0
        await_("the clock again", lambda: len(peer.samples["/clock"]) > 2)
        step = rig.stats()["step"] if "step" in rig.stats() else 0.001
        rig.simctl("step", "1")
        peer.message("/clock", "rosgraph_msgs/Clock", lambda m: 0 < wire.seconds(m["clock"]) <= step * 1.001)
        rig.simctl("reset")
        await_("the clock of the reset", lambda: wire.seconds(peer.messages("/clock", "rosgraph_msgs/Clock")[-1]["clock"]) == 0)


# A gateway that is killed stops the robots that it drove, and nothing else; another one takes its place.
def gateway_ends():
    with Rig() as rig:
        rig.sim(two)
        rig.gateway("--command-timeout", "0", robots=2)
        peer = rig.peer()
        peer.subscribe("/leader/odom", "nav_msgs/Odometry")
        peer.advertise("/leader/cmd_vel", "geometry_msgs/Twist")
        peer.await_matched("/leader/cmd_vel")
        peer.put("/leader/cmd_vel", "geometry_msgs/Twist", wire.twist(0.2, 0.0))
        peer.message("/leader/odom", "nav_msgs/Odometry", lambda m: m["twist"]["twist"]["linear"]["x"] > 0.1)
        rig.kill(rig.process)
        before = rig.seconds()
        await_("the robot stops", lambda: abs(json.loads(rig.simctl("--json", "echo", "leader::position2d", "-n", "1"))["velocity"][0]) < 1e-3)
        assert rig.seconds() > before
        count = len(peer.samples["/leader/odom"])
        rig.gateway(robots=2)
        await_("odometry again", lambda: len(peer.samples["/leader/odom"]) > count + 5)
        # And a simulator that restarts.
        rig.kill(rig.simulator)
        await_("the loss", lambda: "has ended; waiting for it" in rig.log(rig.process))
        rig.sim(two)
        peer.await_matched("/leader/odom")
        count = len(peer.samples["/leader/odom"])
        await_("odometry of the next simulator", lambda: len(peer.samples["/leader/odom"]) > count + 5)


# The library that reads packets may crash: the gateway starts again by itself, and the simulation goes on.
def crash():
    with Rig() as rig:
        rig.sim(two)
        rig.gateway(robots=2)
        peer = rig.peer()
        peer.subscribe("/leader/odom", "nav_msgs/Odometry")
        peer.message("/leader/odom", "nav_msgs/Odometry")
        with open(f"/proc/{rig.process.pid}/task/{rig.process.pid}/children") as file:
            (child,) = (int(word) for word in file.read().split())
        os.kill(child, signal.SIGSEGV)
        await_("the report", lambda: "ended by signal 11" in rig.log(rig.process))
        count = len(peer.samples["/leader/odom"])
        await_("odometry again", lambda: len(peer.samples["/leader/odom"]) > count + 5)
        assert rig.simulator.poll() is None


# Damaged packets of RTPS: the gateway goes on serving, or starts again; the simulation does not notice.
def packets():
    with Rig() as rig:
        rig.sim(two)
        base = 7400 + 250 * int(rig.domain)
        # Participants look for others at the ports of all indices: what they send to one that nobody has is the seed.
        ear = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        ear.bind(("127.0.0.1", base + 10 + 2 * 25))
        ear.settimeout(60)
        rig.gateway(robots=2)
        peer = rig.peer()
        peer.subscribe("/leader/odom", "nav_msgs/Odometry")
        peer.message("/leader/odom", "nav_msgs/Odometry")
        seeds = [ear.recv(65536) for _ in range(6)]
        assert all(seed[:4] == b"RTPS" for seed in seeds)
        seed = os.getpid()
        print("seed", seed)
        chance = random.Random(seed)
        steps = rig.stats()["steps"]
        out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        for i in range(20000):
            data = bytearray(chance.choice(seeds))
            for _ in range(chance.randint(1, 6)):
                if len(data) < 4:
                    break
                way = chance.randrange(4)
                at = chance.randrange(20 if chance.random() < 0.3 else 4, len(data)) if len(data) > 24 else 0
                if way == 0:
                    data[at] = chance.randrange(256)
                elif way == 1:
                    data[at:] = b""
                elif way == 2:
                    data[at:at] = data[at : at + chance.randrange(64)]
                else:
                    data[at : at + 2] = chance.choice((b"\0\0", b"\xff\xff", b"\xff\x7f", b"\1\0"))
            for port in (base + 10, base + 11, base + 12, base + 13):
                out.sendto(bytes(data), ("127.0.0.1", port))
            if i % 200 == 0:
                time.sleep(0.01)  # the queue of a socket is short
        # Whether it has crashed or not, it serves: also a participant that comes now.
        late = rig.peer()
        late.subscribe("/leader/odom", "nav_msgs/Odometry")
        late.message("/leader/odom", "nav_msgs/Odometry")
        count = len(late.samples["/leader/odom"])
        await_("odometry goes on", lambda: len(late.samples["/leader/odom"]) > count + 10)
        assert rig.process.poll() is None and rig.simulator.poll() is None and rig.stats()["steps"] > steps
        print("started again", rig.log(rig.process).count("starting again"), "times")


# A suspended subscriber delays nothing; what it misses is counted, and its node named.
def slow_subscriber():
    with Rig() as rig:
        rig.sim(two)
        rig.gateway(robots=2)
        slow, quick = rig.peer(), rig.peer()
        for peer in (slow, quick):
            peer.subscribe("/clock", "rosgraph_msgs/Clock")
            peer.message("/clock", "rosgraph_msgs/Clock")
        reader = bytes.fromhex(slow.guids["/clock"])
        slow.writer("own", "ros_discovery_info", wire.type_on_wire("rmw_dds_common/ParticipantEntitiesInfo"), durability="transient", user_data=jazzy_hash)
        node = {"node_namespace": "/", "node_name": "sleeper", "reader_gid_seq": [{"data": reader}], "writer_gid_seq": []}
        slow.put("own", "rmw_dds_common/ParticipantEntitiesInfo", {"gid": {"data": reader[:12] + b"\0\0\1\xc1"}, "node_entities_info_seq": [node]})
        slow.reader("late", "rt/leader/scan", wire.type_on_wire("sensor_msgs/LaserScan"), durability="transient")
        slow.await_matched("own")
        await_("the doubt", lambda: "/leader/scan is offered as volatile, but transient local is requested by a reader" in rig.log(rig.process))
        os.kill(slow.process.pid, signal.SIGSTOP)
        try:
            count = len(quick.samples["/clock"])
            await_("clocks for the other one", lambda: len(quick.samples["/clock"]) > count + 300)
            await_("the count", lambda: "samples were not confirmed in time by every reader" in rig.log(rig.process))
            await_("its name", lambda: "/sleeper" in rig.log(rig.process))
        finally:
            os.kill(slow.process.pid, signal.SIGCONT)


# A follower that answers each scan, in lock step: two runs end alike.
def lockstep():
    hashes = []
    for _ in range(2):
        with Rig() as rig:
            rig.sim(two, "--lockstep", "--paused", "--rtf", "0")
            rig.gateway("--lockstep", "--clock-rate", "50", "--wait-for", "/follower/cmd_vel=10Hz", "--wait-timeout", "50", robots=2)
            peer = rig.peer()
            peer.subscribe("/follower/scan", "sensor_msgs/LaserScan")
            peer.advertise("/follower/cmd_vel", "geometry_msgs/TwistStamped")
            peer.await_matched("/follower/cmd_vel")
            peer.await_matched("/follower/scan")
            await_("the gateway joins", lambda: any(one["name"] == "ros2-gateway" for one in rig.participants()))
            stop = threading.Event()

            def follow():
                seen = 0
                while not stop.is_set():
                    scans = peer.samples["/follower/scan"]
                    if len(scans) == seen:
                        time.sleep(0.001)
                        continue
                    scan = wire.decode("sensor_msgs/LaserScan", scans[seen])
                    seen += 1
                    if wire.seconds(scan["header"]["stamp"]) == 0:
                        continue
                    near = min(one for one in scan["ranges"] if one > 0)
                    turn = 0.3 if near < 1 else -0.1
                    peer.put("/follower/cmd_vel", "geometry_msgs/TwistStamped", {"header": scan["header"], "twist": wire.twist(0.2, turn)})

            thread = threading.Thread(target=follow)
            thread.start()
            try:
                steps = round(2 / rig.stats()["step"]) if "step" in rig.stats() else 2000
                rig.simctl("step", str(steps))
            finally:
                stop.set()
                thread.join()
            stats = rig.stats()
            hashes.append((stats["steps"], stats["state_hash"] if "state_hash" in stats else stats["hash"], rig.simctl("pose", "follower")))
            assert rig.process.poll() is None, rig.log(rig.process)
    assert hashes[0] == hashes[1], hashes
    # Without an answer the gateway ends, and says what it waited for.
    with Rig() as rig:
        rig.sim(two, "--lockstep", "--paused")
        rig.gateway("--lockstep", "--wait-for", "cmd_vel=10Hz", "--wait-timeout", "1", robots=2)
        await_("the gateway joins", lambda: any(one["name"] == "ros2-gateway" for one in rig.participants()))
        rig.simctl("run")
        await_("the end", lambda: rig.process.poll() == 1)
        assert "no command on /follower/cmd_vel, /leader/cmd_vel for the tick at t = 0.1 s" in rig.log(rig.process), rig.log(rig.process)


# The leader by RT components, the follower by a program that speaks only DDS: it keeps its distance, and two runs end alike.
def demo():
    states = []
    for _ in range(2):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([f"{bin_dir}/rtse-demo", "ros2", "--duration", "15", "--output", folder], capture_output=True, text=True, timeout=250)
            assert done.returncode == 0, done.stdout + done.stderr
            with open(f"{folder}/demo-ros2.png", "rb") as file:
                assert file.read(4)[1:] == b"PNG"
            near, far = (float(word) for word in re.search(r"between leader and follower: (\S+) to (\S+) m", done.stdout).groups())
            assert 0.4 < near < far < 3, done.stdout
            assert "follow: leader at" in done.stdout, done.stdout
            states.append(re.search(r"state (\w+)", done.stdout).group(1))
    assert states[0] == states[1], states


# A component alone: its InPort reads a topic and its OutPort writes one, each wired to ROS 2 by one port. Bad values get a line.
def ports():
    with Rig() as rig:
        rig.naming()
        host = rig.rtcd("-o", "manager.modules.preload:ROS2Transport.so", "-o", f"ros2.domain.id:{rig.domain}", "-o", "ros2.network:loopback",
                        "-o", "ros2.distro:jazzy", "-o", "ros2.node.name:filter", "Filter", "Relay")
        rig.until("the component", lambda: rig.rtse("act", "Filter0") is not None)
        twist = ("-p", "interface_type=ros2", "-p", "marshaling_type=ros2:geometry_msgs/Twist")
        rig.rtse("con", "Filter0:in", *twist, "-p", "ros2.topic=/raw")
        rig.rtse("con", "Filter0:out", "-p", "interface_type=fast-rtps", "-p", "marshaling_type=ros2:geometry_msgs/TwistStamped",
                 "-p", "fast-rtps.topic=smooth")
        peer = rig.peer()
        peer.subscribe("/smooth", "geometry_msgs/TwistStamped")
        peer.advertise("/raw", "geometry_msgs/Twist")
        peer.await_matched("/raw", 2)
        peer.await_matched("/smooth")

        def passes():
            peer.put("/raw", "geometry_msgs/Twist", wire.twist(0.25, -0.5))
            return peer.messages("/smooth", "geometry_msgs/TwistStamped")

        rig.until("a twist through the component", passes, 0.1)
        moved = peer.message("/smooth", "geometry_msgs/TwistStamped", lambda m: m["twist"]["linear"]["x"] != 0)
        assert moved["twist"]["linear"]["x"] > 0 > moved["twist"]["angular"]["z"], moved
        numbers = ("-p", "interface_type=ros2", "-p", "marshaling_type=ros2:std_msgs/Int32")
        rig.rtse("act", "Relay0")
        rig.rtse("con", "Relay0:in", *numbers, "-p", "ros2.topic=/number")
        rig.rtse("con", "Relay0:out", *numbers, "-p", "ros2.topic=/relayed")
        peer.subscribe("/relayed", "std_msgs/Int32")
        peer.advertise("/number", "std_msgs/Int32")
        peer.await_matched("/number", 2)
        peer.await_matched("/relayed")
        peer.put("/number", "std_msgs/Int32", {"data": -7})
        peer.message("/relayed", "std_msgs/Int32", lambda m: m["data"] == -7)
        rig.rtse("con", "Relay0:number", "-p", "interface_type=ros2", "-p", "marshaling_type=ros2:std_msgs/Float64", "-p", "ros2.topic=/one")
        peer.subscribe("/one", "std_msgs/Float64")
        assert peer.message("/one", "std_msgs/Float64") == {"data": 1.0}
        for wrong, words in ((("-p", "ros2.topic=/a//b"), "ros2.topic"), ((), "ros2.topic is missing"),
                             (("-p", "ros2.topic=/a", "-p", "ros2.writer_qos.history.depth=0"), "history.depth must be")):
            assert rig.try_rtse("con", "Filter0:out", *twist, *wrong).returncode != 0, wrong
            assert words in rig.log(host), rig.log(host)
        alone = rig.try_rtse("con", "Filter0:out")
        assert alone.returncode != 0 and "expected a second port" in alone.stderr, alone.stderr
        rig.rtse("dis", "Filter0:in")
        assert host.poll() is None and "unknown key" not in rig.log(host), rig.log(host)


globals()[case]()
