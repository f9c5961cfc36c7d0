# Data ports on topics of ROS 2, before a peer by another maker of DDS and with an encoder of their own: each data type in both directions,
# QoS, connections in files, a module that is not there, a mapping of an author.
import copy
import math
import os
import struct
import sys
import threading

from ros2_rig import Rig, await_, case, lib_dir, source, wire

both = 2  # readers of a port that receives from all writers: one for those of best effort
STAMP = {"sec": 1234, "nanosec": 567000000}
TURN = {"x": 0.0, "y": 0.0, "z": math.sin(0.3), "w": math.cos(0.3)}  # about z by 0.6 rad


# A message with another value in each field, whose numbers all types can hold.
class Filled:
    def __init__(self):
        self.count = 0

    def value(self, kind):
        if kind.endswith("]"):
            element, size = kind[:-1].split("[")
            values = [self.value(element) for _ in range(int(size or 3))]
            return bytes(values) if element == "u8" else values
        if kind == "builtin_interfaces/Time":
            return dict(STAMP)
        if kind not in wire.NUMBERS and kind != "str":
            return {name: self.value(part) for part, name in wire.FIELDS[kind]}
        self.count += 1
        if kind == "str":
            return f"name{self.count}"
        if kind == "bool":
            return True
        return self.count + 0.25 if kind in ("f32", "f64") else self.count


def filled(kind, **changes):
    return {**Filled().value(kind), **changes}


def are_alike(a, b):
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(are_alike(a[key], b[key]) for key in a)
    if isinstance(a, list):
        return len(a) == len(b) and all(are_alike(x, y) for x, y in zip(a, b))
    if isinstance(a, float):
        return a == b or (math.isnan(a) and math.isnan(b)) or abs(a - b) <= 1e-6 * max(1, abs(a))
    return a == b


ZERO = {"x": 0.0, "y": 0.0, "z": 0.0}
NO_TWIST = {"linear": ZERO, "angular": ZERO}


def header(frame):
    return {"stamp": STAMP, "frame_id": frame}


def diagonal(*values):
    size = len(values)
    return [float(values[i // size]) if i % (size + 1) == 0 else 0.0 for i in range(size * size)]


WHEELS, UNKNOWN = diagonal(1e-5, 1e-5, 1e12, 1e12, 1e12, 1e-3), diagonal(*[1e12] * 6)


class Row:
    def __init__(self, port, kind, sent, wanted=None, named=False, more=(), source_kind=None):
        self.port, self.kind, self.sent = port, kind, sent
        self.wanted = copy.deepcopy(sent) if wanted is None else wanted
        self.in_kind = source_kind or kind
        # The default mapping has no marshaling_type.
        self.marshaling = ("-p", f"marshaling_type=ros2:{kind}") if named else ()
        self.in_marshaling = ("-p", f"marshaling_type=ros2:{self.in_kind}") if named or source_kind else ()
        self.more = more


def number_rows():
    for port, kind, value in (("State", "Int16", -3), ("Short", "Int16", -4), ("Long", "Int32", -50000), ("UShort", "UInt16", 60000),
                              ("ULong", "UInt32", 4000000000), ("Float", "Float32", 1.25), ("Double", "Float64", 1 / 3), ("Boolean", "Bool", True),
                              ("Octet", "UInt8", 200), ("Char", "Int8", 65), ("String", "String", "größer\n\"quoted\"")):
        yield Row(port, f"std_msgs/{kind}", {"data": value})
    for port, kind, value, wanted in (("Long", "Float64", 3.75, 3.0), ("Long", "Int64", 2**40, float(2**31 - 1)), ("Double", "UInt8", 200, 200),
                                      ("Float", "Int64", -(2**20), -(2**20)), ("State", "UInt64", 7, 7), ("ULong", "Int8", -1, 0),
                                      ("Short", "Float32", -1e9, -32768.0), ("UShort", "Int32", 70000, 65535), ("Double", "Float32", 0.5, 0.5)):
        yield Row(port, f"std_msgs/{kind}", {"data": value}, {"data": type(value)(wanted)}, named=True)
    plain = {"dim": [], "data_offset": 0}
    layout = {"dim": [{"label": "rows", "size": 3, "stride": 3}], "data_offset": 1}
    for port, kind, values in (("ShortSeq", "Int16", [-1, 2, -3]), ("LongSeq", "Int32", [-100000, 2, 3]), ("UShortSeq", "UInt16", [1, 60000, 3]),
                               ("ULongSeq", "UInt32", [1, 2, 4000000000]), ("FloatSeq", "Float32", [1.5, -2.5, 3.25]),
                               ("DoubleSeq", "Float64", [1 / 3, -2.0, 1e300]), ("OctetSeq", "UInt8", bytes([1, 2, 255])), ("CharSeq", "Int8", [-1, 2, 127])):
        yield Row(port, f"std_msgs/{kind}MultiArray", {"layout": layout, "data": values}, {"layout": plain, "data": values[1:]})
    yield Row("BooleanSeq", "std_msgs/UInt8MultiArray", {"layout": plain, "data": bytes([0, 1, 7])}, {"layout": plain, "data": bytes([0, 1, 1])})
    yield Row("LongSeq", "std_msgs/Int64MultiArray", {"layout": plain, "data": [2**40, -5]}, {"layout": plain, "data": [2**31 - 1, -5]}, named=True)
    yield Row("DoubleSeq", "std_msgs/Float32MultiArray", {"layout": plain, "data": [0.5, -1.5]}, named=True)
    yield Row("FloatSeq", "std_msgs/UInt8MultiArray", {"layout": plain, "data": bytes([5, 250])}, named=True)


def velocity_rows():
    twist = filled("geometry_msgs/Twist")
    flat = {"linear": {**twist["linear"], "z": 0.0}, "angular": {**ZERO, "z": twist["angular"]["z"]}}
    yield Row("Velocity2D", "geometry_msgs/Twist", twist, flat)
    yield Row("Velocity3D", "geometry_msgs/Twist", twist)
    for port, wanted in (("Velocity2D", flat), ("Velocity3D", twist)):
        yield Row(port, "geometry_msgs/TwistStamped", {"header": header("any"), "twist": twist}, {"header": header("base_link"), "twist": wanted}, named=True)


def pose_rows():
    place = filled("geometry_msgs/Point")
    flat = {"position": {**place, "z": 0.0}, "orientation": TURN}
    tilted = {"position": place, "orientation": {"x": 0.5, "y": 0.1, "z": -0.3, "w": math.sqrt(1 - 0.35)}}
    q = tilted["orientation"]
    yaw = math.atan2(2 * (q["w"] * q["z"] + q["x"] * q["y"]), 1 - 2 * (q["y"] ** 2 + q["z"] ** 2))
    turned = {"position": flat["position"], "orientation": {"x": 0.0, "y": 0.0, "z": math.sin(yaw / 2), "w": math.cos(yaw / 2)}}
    stamped = {"header": header("map"), "pose": tilted}
    yield Row("Pose3D", "geometry_msgs/PoseStamped", stamped, {**stamped, "header": header("odom")})
    yield Row("Pose2D", "geometry_msgs/PoseStamped", stamped, {"header": header("odom"), "pose": turned}, named=True)
    odometry = filled("nav_msgs/Odometry", header=header("map"))
    odometry["pose"]["pose"] = tilted
    twist = odometry["twist"]["twist"]
    flat_twist = {"linear": {**twist["linear"], "z": 0.0}, "angular": {**ZERO, "z": twist["angular"]["z"]}}

    def wanted(pose, motion, covariance, motion_covariance, frames=("odom", "base_link")):
        return {"header": header(frames[0]), "child_frame_id": frames[1], "pose": {"pose": pose, "covariance": covariance},
                "twist": {"twist": motion, "covariance": motion_covariance}}

    none = [0.0] * 36
    yield Row("Pose2D", "nav_msgs/Odometry", odometry, wanted(turned, NO_TWIST, WHEELS, UNKNOWN, ("a/odom", "a/base")),
              more=("-p", "ros2.frame_id=a/odom", "-p", "ros2.child_frame_id=a/base"))
    yield Row("Pose3D", "nav_msgs/Odometry", odometry, wanted(tilted, NO_TWIST, none, UNKNOWN), named=True)
    yield Row("PoseVel2D", "nav_msgs/Odometry", odometry, wanted(turned, flat_twist, WHEELS, WHEELS))
    yield Row("PoseVel3D", "nav_msgs/Odometry", odometry, wanted(tilted, twist, none, none))


def value_rows():
    point, base = filled("geometry_msgs/Point"), header("base_link")
    for port, part in (("Point3D", point), ("Point2D", {**point, "z": 0.0})):
        yield Row(port, "geometry_msgs/PointStamped", {"header": header("any"), "point": point}, {"header": base, "point": part})
    for port in ("Vector3D", "Vector2D", "AngularVelocity3D", "Acceleration3D"):
        part = {**point, "z": 0.0} if port == "Vector2D" else point
        yield Row(port, "geometry_msgs/Vector3Stamped", {"header": header("any"), "vector": point}, {"header": base, "vector": part})
    q = {"x": 0.5, "y": 0.1, "z": -0.3, "w": math.sqrt(1 - 0.35)}
    for port in ("Quaternion", "Orientation3D"):
        yield Row(port, "geometry_msgs/QuaternionStamped", {"header": header("any"), "quaternion": q}, {"header": base, "quaternion": q})
    imu = filled("sensor_msgs/Imu", header=header("any"), orientation=q)
    unmeasured = [-1.0] + [0.0] * 8
    nothing = {"header": base, "orientation": {**ZERO, "w": 1.0}, "orientation_covariance": unmeasured, "angular_velocity": ZERO,
               "angular_velocity_covariance": unmeasured, "linear_acceleration": ZERO, "linear_acceleration_covariance": unmeasured}
    for port, part in (("Orientation3D", "orientation"), ("AngularVelocity3D", "angular_velocity"), ("Acceleration3D", "linear_acceleration")):
        yield Row(port, "sensor_msgs/Imu", imu, {**nothing, part: imu[part], part + "_covariance": [0.0] * 9}, named=True)


def sensor_rows():
    scan = filled("sensor_msgs/LaserScan", header=header("any"), angle_min=-1.0, angle_max=1.0, angle_increment=0.5, scan_time=0.125, range_min=0.25,
                  range_max=8.0, ranges=[1.5, math.inf, -math.inf, math.nan, 4.0], intensities=[1.0] * 5)
    yield Row("RangeData", "sensor_msgs/LaserScan", scan,
              {**scan, "header": header("laser"), "time_increment": 0.0, "ranges": [1.5, math.inf, -math.inf, math.inf, 4.0], "intensities": []},
              more=("-p", "ros2.frame_id=laser"))
    packed = {"header": header("base_link"), "height": 2, "width": 3, "encoding": "rgb8", "is_bigendian": 0, "step": 9, "data": bytes(range(18))}
    rows = {**packed, "header": header("any"), "step": 12, "data": bytes(range(9)) + b"xyz" + bytes(range(9, 18)) + b"xyz"}
    yield Row("CameraImage", "sensor_msgs/Image", rows, packed)
    jpeg = {"header": header("any"), "format": "rgb8; jpeg compressed bgr8", "data": bytes([255, 216, 1, 2, 3])}
    yield Row("CameraImage", "sensor_msgs/CompressedImage", jpeg, {**jpeg, "header": header("base_link"), "format": "jpeg"}, named=True)

    def field(name, offset, datatype=7, count=1):
        return {"name": name, "offset": offset, "datatype": datatype, "count": count}

    # Doubles with the other byte order, and a colour between them.
    data = b"".join(struct.pack(">d", z) + struct.pack(">I", 0xFF8000) + struct.pack(">dd", x, y) + b"." * 4 for x, y, z in ((1.5, 2.5, 3.5), (-1.0, 0.0, 0.25)))
    cloud = {"header": header("any"), "height": 1, "width": 2, "fields": [field("z", 0, 8), field("rgb", 8), field("x", 12, 8), field("y", 20, 8)],
             "is_bigendian": True, "point_step": 32, "row_step": 64, "data": data, "is_dense": False}
    plain = b"".join(struct.pack("<fffI", x, y, z, 0xFF8000) for x, y, z in ((1.5, 2.5, 3.5), (-1.0, 0.0, 0.25)))
    yield Row("PointCloud", "sensor_msgs/PointCloud2", cloud,
              {"header": header("base_link"), "height": 1, "width": 2, "fields": [field("x", 0), field("y", 4), field("z", 8), field("rgb", 12)],
               "is_bigendian": False, "point_step": 16, "row_step": 32, "data": plain, "is_dense": True})
    any_cloud = {**cloud, "fields": cloud["fields"] + [field("ring", 28, 4, 2)], "is_dense": True}
    yield Row("Cloud", "sensor_msgs/PointCloud2", any_cloud, {**any_cloud, "header": header("base_link")})
    joints = filled("sensor_msgs/JointState", header=header(""), name=["elbow", "wrist", "hip"])
    named = ("-p", "ros2.joint_names=wrist,elbow")
    two = {"header": header(""), "name": ["wrist", "elbow"], **{key: [joints[key][1], joints[key][0]] for key in ("position", "velocity", "effort")}}
    yield Row("ActArrayState", "sensor_msgs/JointState", joints, two, more=named)
    yield Row("DoubleSeq", "sensor_msgs/JointState", joints, {**two, "velocity": [], "effort": []}, named=True, more=named)
    yield Row("JointPos", "sensor_msgs/JointState", joints,
              {**joints, "name": ["joint_0", "joint_1", "joint_2"], "velocity": [], "effort": []})
    fix = filled("sensor_msgs/NavSatFix", header=header("any"), status={"status": 2, "service": 1}, position_covariance=diagonal(4, 9, 16), position_covariance_type=2)
    yield Row("GPSData", "sensor_msgs/NavSatFix", fix, {**fix, "header": header("base_link"), "position_covariance": diagonal(4, 4, 16)})


class PortRig(Rig):
    def relay(self, *components, **more):
        self.naming()
        host = self.rtcd("-o", f"ros2.domain.id:{self.domain}", "-o", "ros2.network:loopback", "-o", "ros2.distro:jazzy", "-o", "ros2.node.name:relay",
                         "-o", "exec_cxt.periodic.rate:200", *(components or ("TopicRelay",)), **more)
        self.until("the component", lambda: self.rtse("act", "TopicRelay0") is not None)
        return host

    def connect(self, port, topic, *words, transport="ros2"):
        self.rtse("con", f"TopicRelay0:{port}", "-p", f"interface_type={transport}", "-p", f"{transport}.topic={topic}", *words)


# Every data type in both directions, with each field: a message arrives at the InPort, and the OutPort sends its value. The module is
# loaded by the first connection.
def types():
    rows = [row for rows in (number_rows, velocity_rows, pose_rows, value_rows, sensor_rows) for row in rows()]
    with PortRig() as rig:
        host = rig.relay()
        assert "ROS2Transport" not in open(f"/proc/{host.pid}/maps").read()
        peer = rig.peer()
        work = list(enumerate(rows))
        lock, failures = threading.Lock(), []

        def connect_some():
            while True:
                with lock:
                    if not work or failures:
                        return
                    i, row = work.pop()
                try:
                    rig.connect(f"{row.port}_in", f"/in_{i}", *row.in_marshaling, *row.more)
                    rig.connect(f"{row.port}_out", f"/out_{i}", *row.marshaling, *row.more)
                except Exception as error:  # of a thread: told by the main one
                    failures.append((row.port, row.kind, error))

        threads = [threading.Thread(target=connect_some) for _ in range(3)]
        for thread in threads:
            thread.start()
        for i, row in enumerate(rows):
            peer.subscribe(f"/out_{i}", row.kind)
            peer.advertise(f"/in_{i}", row.in_kind)
        for thread in threads:
            thread.join()
        assert not failures, (failures, rig.log(host))
        for i, row in enumerate(rows):
            peer.await_matched(f"/in_{i}", both)
            peer.await_matched(f"/out_{i}")
        # A port of several rows sends to all of their topics: a sample of the row before may still be on its way.
        for i, row in enumerate(rows):
            peer.put(f"/in_{i}", row.in_kind, row.sent)
            try:
                await_(f"{row.port} as {row.kind}", lambda: any(are_alike(row.wanted, got) for got in peer.messages(f"/out_{i}", row.kind)))
            except AssertionError as late:
                raise AssertionError(f"{late}: got {peer.messages(f'/out_{i}', row.kind)[-1:]}, wanted {row.wanted}\n{rig.log(host)}") from None
        # What no message holds is refused with a line; the port can name another encoding.
        refused = rig.try_rtse("con", "TopicRelay0:WString_out", "-p", "interface_type=ros2", "-p", "ros2.topic=/wide")
        assert refused.returncode != 0, refused
        assert "interface_type ros2 has no encoding of IDL:RTC/TimedWString:1.0" in rig.log(host), rig.log(host)
        assert "ros2-gateway" not in rig.log(host), rig.log(host)
        # Hashes are in the discovery data.
        listed = [one for one in peer.endpoints(lambda all: len(all) > 2 * len(rows)) if one[3].startswith("010f")]  # not of the peer itself
        assert len(listed) >= 2 * len(rows) and all("typehash=RIHS01_" in one[4] for one in listed), listed


# Values that are no message, and messages that are no value, have a line and end nothing.
def bad_values():
    with PortRig() as rig:
        host = rig.relay()
        peer = rig.peer()
        rig.connect("CameraImage_in", "/image")
        rig.connect("CameraImage_out", "/image_out")
        rig.connect("PointCloud_in", "/cloud")
        rig.connect("PointCloud_out", "/cloud_out")
        for topic, kind in (("/image", "sensor_msgs/Image"), ("/cloud", "sensor_msgs/PointCloud2")):
            peer.advertise(topic, kind)
            peer.subscribe(topic + "_out", kind)
            peer.await_matched(topic, both)
            peer.await_matched(topic + "_out")
        image = {"header": header("any"), "height": 2, "width": 2, "encoding": "mono8", "is_bigendian": 0, "step": 2, "data": b"1234"}
        for change in ({"encoding": "yuv422"}, {"step": 2**31, "height": 2**31}, {"data": b"123"}, {"width": 70000, "step": 70000}, {"is_bigendian": 1, "encoding": "mono16", "step": 4}):
            peer.put("/image", "sensor_msgs/Image", {**image, **change})
        peer.say("put /image 00010000ffffffff")
        peer.put("/image", "sensor_msgs/Image", image)
        got = peer.message("/image_out", "sensor_msgs/Image")
        assert got["data"] == b"1234" and len(peer.samples["/image_out"]) == 1, got
        assert 'encoding "yuv422" is not known' in rig.log(host), rig.log(host)
        cloud = {"header": header("any"), "height": 1, "width": 1, "fields": [{"name": name, "offset": 4 * i, "datatype": 7, "count": 1} for i, name in enumerate("xyz")],
                 "is_bigendian": False, "point_step": 12, "row_step": 12, "data": bytes(12), "is_dense": True}
        for change in ({"width": 2**32 - 1}, {"height": 2**32 - 1}, {"point_step": 0}, {"data": b""}, {"fields": cloud["fields"][:2]}, {"point_step": 11}):
            peer.put("/cloud", "sensor_msgs/PointCloud2", {**cloud, **change})
        peer.put("/cloud", "sensor_msgs/PointCloud2", cloud)
        assert peer.message("/cloud_out", "sensor_msgs/PointCloud2")["width"] == 1
        assert len(peer.samples["/cloud_out"]) == 1 and host.poll() is None


# Best effort and reliable, in the spellings of OpenRTM and in ours; what does not fit is named.
def qos():
    with PortRig() as rig:
        host = rig.relay()
        peer = rig.peer()
        best = "BEST_EFFORT_RELIABILITY_QOS"
        rig.connect("Long_in", "/sensor", "-p", f"ros2.reader_qos.reliability.kind={best}")
        rig.connect("Long_out", "/fast", "-p", f"fast-rtps.publisher.qos.reliability.kind={best}", "-p", "fast-rtps.publisher.topic.historyQos.depth=3",
                    "-p", "fast-rtps.publisher.qos.deadline.period.seconds=1", "-p", "marshaling_type=ros2:std_msgs/Int32", transport="fast-rtps")
        rig.connect("Long_out", "/plain", "-p", "ros2.reliability=best_effort")
        rig.connect("Long_out", "/kept", "-p", "ros2.durability=transient_local", "-p", "ros2.depth=1")
        rig.connect("Double_in", "/strict", "-p", "ros2.reliability=reliable")
        # Without a reliability a reader receives from all writers, each sample once.
        rig.connect("Short_in", "/any")
        rig.connect("Short_out", "/any_out")
        peer.subscribe("/any_out", "std_msgs/Int16")
        for name, reliability in (("sure", "reliable"), ("weak_one", "best_effort")):
            peer.writer(name, "rt/any", wire.type_on_wire("std_msgs/Int16"), reliability)
        peer.await_matched("sure", both)
        peer.await_matched("weak_one")
        peer.await_matched("/any_out")
        for i in range(20):
            peer.put("sure", "std_msgs/Int16", {"data": i})
        await_("the last reliable number", lambda: {"data": 19} in peer.messages("/any_out", "std_msgs/Int16"))

        def weak_one_passes():
            peer.put("weak_one", "std_msgs/Int16", {"data": -1})
            return {"data": -1} in peer.messages("/any_out", "std_msgs/Int16")

        await_("a number of the best effort writer", weak_one_passes, 0.1)
        numbers = [one["data"] for one in peer.messages("/any_out", "std_msgs/Int16") if one["data"] >= 0]
        assert len(numbers) == len(set(numbers)), numbers
        assert "fast-rtps.publisher.qos.deadline.period.seconds=1 without effect: reliability" in rig.log(host), rig.log(host)
        peer.advertise("/sensor", "std_msgs/Int32", "best_effort")
        for topic in ("/fast", "/plain"):
            peer.subscribe(topic, "std_msgs/Int32", "best_effort")
            peer.await_matched(topic)
        peer.await_matched("/sensor")

        def passes():
            peer.put("/sensor", "std_msgs/Int32", {"data": 5})
            return peer.samples["/fast"] and peer.samples["/plain"]

        await_("best effort both ways", passes, 0.1)
        # Late readers of a topic that is kept receive its last sample.
        peer.subscribe("/kept", "std_msgs/Int32", durability="transient")
        assert peer.message("/kept", "std_msgs/Int32") == {"data": 5}
        # Reliable is requested from best effort, in both directions.
        reader = peer.reader("wish", "rt/fast", wire.type_on_wire("std_msgs/Int32"))
        writer = peer.writer("weak", "rt/strict", wire.type_on_wire("std_msgs/Float64"), "best_effort")
        peer.writer("own", "ros_discovery_info", wire.type_on_wire("rmw_dds_common/ParticipantEntitiesInfo"), durability="transient",
                    user_data="typehash=RIHS01_91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e;")
        node = {"node_namespace": "/", "node_name": "stranger", "reader_gid_seq": [{"data": bytes.fromhex(reader)}], "writer_gid_seq": [{"data": bytes.fromhex(writer)}]}
        peer.put("own", "rmw_dds_common/ParticipantEntitiesInfo", {"gid": {"data": bytes.fromhex(reader)[:12] + b"\0\0\1\xc1"}, "node_entities_info_seq": [node]})
        await_("the writer's mismatch", lambda: "/fast is offered as best effort, but reliable is requested by a reader of /stranger" in rig.log(host))
        await_("the reader's mismatch", lambda: "/strict is requested as reliable, but best effort is offered by a writer of /stranger" in rig.log(host))
        assert "ros2-gateway" not in rig.log(host), rig.log(host)
        for words, line in ((("ros2.reliability=sure",), 'ros2.reliability must be best_effort or reliable, got "sure"'),
                            (("ros2.writer_qos.durability.kind=PERSISTENT_DURABILITY_QOS",), "ros2.writer_qos.durability.kind must be volatile or transient_local"),
                            (("ros2.depth=0",), 'ros2.depth must be from 1 to 10000, got "0"')):
            done = rig.try_rtse("con", "TopicRelay0:Short_out", "-p", "interface_type=ros2", "-p", "ros2.topic=/a", *(word for one in words for word in ("-p", one)))
            assert done.returncode != 0 and line in rig.log(host), (words, rig.log(host))


# A misspelled property is named with the one that was meant; -d makes no second connection of a port to its topic.
def keys():
    with PortRig() as rig:
        host = rig.relay()
        rig.connect("Long_out", "/keys", "-p", "ros2.relibility=best_effort", "-p", "ros2.writer_qos.history.dept=3", "-p", "ros2.shelf=7")
        for line in ("ros2.relibility=best_effort without effect; did you mean ros2.reliability?",
                     "ros2.writer_qos.history.dept=3 without effect; did you mean ros2.writer_qos.history.depth?",
                     "ros2.shelf=7 without effect, unless a mapping of your own reads it"):
            await_(line, lambda: line in rig.log(host))
        for wrong, line in ((("ros2.topc=/a",), "ros2.topc=/a without effect; did you mean ros2.topic?"), (("ros2.topic=/a//b",), 'got "/a//b"'),
                            (("ros2.topic=a-b",), 'ros2.topic may have letters, digits, _ and / only, got "a-b"')):
            words = [word for one in ("interface_type=ros2", *wrong) for word in ("-p", one)]
            for port in ("Long_out", "Long_in"):
                done = rig.try_rtse("con", f"TopicRelay0:{port}", *words)
                assert done.returncode != 0 and line in rig.log(host), (wrong, rig.log(host))
                assert f"connection refused: TopicRelay0.{port}: ros2.topic" in rig.log(host), rig.log(host)

        def connections():
            rig.rtse("save", f"{rig.work}/system.yaml")
            return open(f"{rig.work}/system.yaml").read().count("/once")

        words = ("-p", "interface_type=ros2", "-p")
        rig.rtse("con", "TopicRelay0:Double_out", *words, "ros2.topic=/once")
        one = connections()
        assert one > 0
        rig.rtse("con", "-d", "TopicRelay0:Double_out", *words, "ros2.topic=once")
        assert connections() == one
        rig.rtse("con", "-d", "TopicRelay0:Double_out", *words, "ros2.topic=/once_more")
        assert connections() == 2 * one


# A saved system has the connections of its ports with topics, as XML and as YAML.
def saved():
    with PortRig() as rig:
        rig.relay()
        peer = rig.peer()
        rig.connect("Double_in", "/in", "-p", "ros2.reliability=best_effort")
        rig.connect("Double_out", "/out", "-p", "marshaling_type=ros2:std_msgs/Float32")
        for file in ("system.xml", "system.yaml"):
            path = f"{rig.work}/{file}"
            rig.rtse("save", path)
            assert open(path).read().count("/in") >= 1
            checked = rig.try_rtse("check", path)
            assert checked.returncode == 0, checked.stdout + checked.stderr
            rig.rtse("dis", "TopicRelay0")
            checked = rig.try_rtse("check", path)
            assert checked.returncode != 0, checked.stdout
            loaded = rig.try_rtse("load", path)
            assert loaded.returncode == 0, loaded.stdout + loaded.stderr
            again = rig.try_rtse("load", path)
            assert again.returncode == 0, again.stdout + again.stderr
            if not peer.samples:
                peer.advertise("/in", "std_msgs/Float64")
                peer.subscribe("/out", "std_msgs/Float32")
            peer.await_matched("/in")
            peer.await_matched("/out")
            count = len(peer.samples["/out"])
            peer.put("/in", "std_msgs/Float64", {"data": 0.5})
            await_("a number through the restored connections", lambda: len(peer.samples["/out"]) > count)
            assert peer.messages("/out", "std_msgs/Float32")[-1] == {"data": 0.5}
        torn = rig.try_rtse("teardown", f"{rig.work}/system.xml")
        assert torn.returncode == 0, torn.stdout + torn.stderr
        assert rig.try_rtse("check", f"{rig.work}/system.xml").returncode != 0


# A process that has had topics ends as one without: while they are there, and after they have gone.
def ends():
    for goes_first in (False, True):
        with PortRig() as rig:
            host = rig.relay()
            rig.connect("Double_in", "/in")
            rig.connect("Double_out", "/out")
            if goes_first:
                rig.rtse("dis", "TopicRelay0")
            host.terminate()
            assert host.wait(30) == 0, (goes_first, rig.log(host))


# Without the module the refusal names it and its package.
def missing():
    with PortRig() as rig:
        folder = f"{rig.work}/modules"
        os.mkdir(folder)
        os.symlink(f"{lib_dir}/TopicRelay.so", f"{folder}/TopicRelay.so")
        rig.naming()
        host = rig.start(f"{sys.argv[2]}/rtcd", "-o", f"corba.nameservers:{rig.names}", "-o", f"manager.modules.load_path:{folder}", "-o", "manager.shutdown_auto:NO", "TopicRelay")
        rig.until("the component", lambda: rig.rtse("act", "TopicRelay0") is not None)
        done = rig.try_rtse("con", "TopicRelay0:Long_in", "-p", "interface_type=ros2", "-p", "ros2.topic=/a")
        assert done.returncode != 0 and "does not find the module ROS2Transport (package rtm-ros2)" in done.stderr, done.stderr
        assert host.poll() is None


# A mapping of an author's own message, as the page shows it: both directions, and used without a marshaling_type.
def own_mapping():
    code = open(f"{source}/tests/ros2/own_mapping.cpp").read()
    shown = "".join("    " + line if line.strip() else line for line in code.splitlines(True))
    assert shown.rstrip("\n") in open(f"{source}/docs/ros2.md").read(), "docs/ros2.md shows another example than tests/ros2/own_mapping.cpp"
    with PortRig() as rig:
        rig.relay("-o", "manager.modules.preload:OwnMapping.so", "TopicRelay")
        peer = rig.peer()
        rig.connect("String_in", "/label")
        rig.connect("String_out", "/label_out", "-p", "marshaling_type=ros2:shop_msgs/Label", "-p", "ros2.frame_id=shelf")
        rig.connect("String_out", "/text_out", "-p", "marshaling_type=ros2:std_msgs/String")
        peer.advertise("/label", "shop_msgs/Label")
        peer.subscribe("/label_out", "shop_msgs/Label")
        peer.subscribe("/text_out", "std_msgs/String")
        peer.await_matched("/label", both)
        for topic in ("/label_out", "/text_out"):
            peer.await_matched(topic)
        peer.put("/label", "shop_msgs/Label", {"header": header("any"), "text": "nails"})
        assert peer.message("/label_out", "shop_msgs/Label") == {"header": header("shelf"), "text": "nails"}
        assert peer.message("/text_out", "std_msgs/String") == {"data": "nails"}


globals()[case]()
