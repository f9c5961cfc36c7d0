# Rows of data types of ports: what arrives in a message and what is sent again.
import copy
import math
import struct

import wire

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
