# Messages of ROS 2 as bytes, written and read by this test alone: plain CDR from the fields that ROS 2 documents.
import struct

FIELDS = {}
for line in """
builtin_interfaces/Time: i32 sec, u32 nanosec
builtin_interfaces/Duration: i32 sec, u32 nanosec
std_msgs/Header: builtin_interfaces/Time stamp, str frame_id
std_msgs/String: str data
std_msgs/UInt32: u32 data
std_msgs/Bool: bool data
std_msgs/Int8: i8 data
std_msgs/Int16: i16 data
std_msgs/Int32: i32 data
std_msgs/Int64: i64 data
std_msgs/UInt8: u8 data
std_msgs/UInt16: u16 data
std_msgs/UInt64: u64 data
std_msgs/Float32: f32 data
std_msgs/Float64: f64 data
std_msgs/MultiArrayDimension: str label, u32 size, u32 stride
std_msgs/MultiArrayLayout: std_msgs/MultiArrayDimension[] dim, u32 data_offset
std_msgs/Int8MultiArray: std_msgs/MultiArrayLayout layout, i8[] data
std_msgs/Int16MultiArray: std_msgs/MultiArrayLayout layout, i16[] data
std_msgs/Int32MultiArray: std_msgs/MultiArrayLayout layout, i32[] data
std_msgs/Int64MultiArray: std_msgs/MultiArrayLayout layout, i64[] data
std_msgs/UInt8MultiArray: std_msgs/MultiArrayLayout layout, u8[] data
std_msgs/UInt16MultiArray: std_msgs/MultiArrayLayout layout, u16[] data
std_msgs/UInt32MultiArray: std_msgs/MultiArrayLayout layout, u32[] data
std_msgs/UInt64MultiArray: std_msgs/MultiArrayLayout layout, u64[] data
std_msgs/Float32MultiArray: std_msgs/MultiArrayLayout layout, f32[] data
std_msgs/Float64MultiArray: std_msgs/MultiArrayLayout layout, f64[] data
geometry_msgs/PointStamped: std_msgs/Header header, geometry_msgs/Point point
geometry_msgs/Vector3Stamped: std_msgs/Header header, geometry_msgs/Vector3 vector
geometry_msgs/QuaternionStamped: std_msgs/Header header, geometry_msgs/Quaternion quaternion
shop_msgs/Label: std_msgs/Header header, str text
geometry_msgs/Vector3: f64 x, f64 y, f64 z
geometry_msgs/Point: f64 x, f64 y, f64 z
geometry_msgs/Quaternion: f64 x, f64 y, f64 z, f64 w
geometry_msgs/Pose: geometry_msgs/Point position, geometry_msgs/Quaternion orientation
geometry_msgs/PoseStamped: std_msgs/Header header, geometry_msgs/Pose pose
geometry_msgs/Twist: geometry_msgs/Vector3 linear, geometry_msgs/Vector3 angular
geometry_msgs/TwistStamped: std_msgs/Header header, geometry_msgs/Twist twist
geometry_msgs/Accel: geometry_msgs/Vector3 linear, geometry_msgs/Vector3 angular
geometry_msgs/PoseWithCovariance: geometry_msgs/Pose pose, f64[36] covariance
geometry_msgs/TwistWithCovariance: geometry_msgs/Twist twist, f64[36] covariance
geometry_msgs/Transform: geometry_msgs/Vector3 translation, geometry_msgs/Quaternion rotation
geometry_msgs/TransformStamped: std_msgs/Header header, str child_frame_id, geometry_msgs/Transform transform
geometry_msgs/Wrench: geometry_msgs/Vector3 force, geometry_msgs/Vector3 torque
geometry_msgs/WrenchStamped: std_msgs/Header header, geometry_msgs/Wrench wrench
geometry_msgs/TwistWithCovarianceStamped: std_msgs/Header header, geometry_msgs/TwistWithCovariance twist
geometry_msgs/PoseWithCovarianceStamped: std_msgs/Header header, geometry_msgs/PoseWithCovariance pose
sensor_msgs/BatteryState: std_msgs/Header header, f32 voltage, f32 temperature, f32 current, f32 charge, f32 capacity, f32 design_capacity, f32 percentage, u8 power_supply_status, u8 power_supply_health, u8 power_supply_technology, bool present, f32[] cell_voltage, f32[] cell_temperature, str location, str serial_number
std_msgs/ColorRGBA: f32 r, f32 g, f32 b, f32 a
visualization_msgs/UVCoordinate: f32 u, f32 v
visualization_msgs/MeshFile: str filename, u8[] data
visualization_msgs/Marker: std_msgs/Header header, str ns, i32 id, i32 type, i32 action, geometry_msgs/Pose pose, geometry_msgs/Vector3 scale, std_msgs/ColorRGBA color, builtin_interfaces/Duration lifetime, bool frame_locked, geometry_msgs/Point[] points, std_msgs/ColorRGBA[] colors, str texture_resource, sensor_msgs/CompressedImage texture, visualization_msgs/UVCoordinate[] uv_coordinates, str text, str mesh_resource, visualization_msgs/MeshFile mesh_file, bool mesh_use_embedded_materials
visualization_msgs/MarkerArray: visualization_msgs/Marker[] markers
vision_msgs/Point2D: f64 x, f64 y
vision_msgs/Pose2D: vision_msgs/Point2D position, f64 theta
vision_msgs/BoundingBox2D: vision_msgs/Pose2D center, f64 size_x, f64 size_y
vision_msgs/BoundingBox3D: geometry_msgs/Pose center, geometry_msgs/Vector3 size
vision_msgs/ObjectHypothesis: str class_id, f64 score
vision_msgs/ObjectHypothesisWithPose: vision_msgs/ObjectHypothesis hypothesis, geometry_msgs/PoseWithCovariance pose
vision_msgs/Detection2D: std_msgs/Header header, vision_msgs/ObjectHypothesisWithPose[] results, vision_msgs/BoundingBox2D bbox, str id
vision_msgs/Detection2DArray: std_msgs/Header header, vision_msgs/Detection2D[] detections
vision_msgs/Detection3D: std_msgs/Header header, vision_msgs/ObjectHypothesisWithPose[] results, vision_msgs/BoundingBox3D bbox, str id
vision_msgs/Detection3DArray: std_msgs/Header header, vision_msgs/Detection3D[] detections
tf2_msgs/TFMessage: geometry_msgs/TransformStamped[] transforms
rosgraph_msgs/Clock: builtin_interfaces/Time clock
nav_msgs/Odometry: std_msgs/Header header, str child_frame_id, geometry_msgs/PoseWithCovariance pose, geometry_msgs/TwistWithCovariance twist
sensor_msgs/LaserScan: std_msgs/Header header, f32 angle_min, f32 angle_max, f32 angle_increment, f32 time_increment, f32 scan_time, f32 range_min, f32 range_max, f32[] ranges, f32[] intensities
sensor_msgs/PointField: str name, u32 offset, u8 datatype, u32 count
sensor_msgs/PointCloud2: std_msgs/Header header, u32 height, u32 width, sensor_msgs/PointField[] fields, bool is_bigendian, u32 point_step, u32 row_step, u8[] data, bool is_dense
sensor_msgs/Image: std_msgs/Header header, u32 height, u32 width, str encoding, u8 is_bigendian, u32 step, u8[] data
sensor_msgs/CompressedImage: std_msgs/Header header, str format, u8[] data
sensor_msgs/RegionOfInterest: u32 x_offset, u32 y_offset, u32 height, u32 width, bool do_rectify
sensor_msgs/CameraInfo: std_msgs/Header header, u32 height, u32 width, str distortion_model, f64[] d, f64[9] k, f64[9] r, f64[12] p, u32 binning_x, u32 binning_y, sensor_msgs/RegionOfInterest roi
sensor_msgs/Imu: std_msgs/Header header, geometry_msgs/Quaternion orientation, f64[9] orientation_covariance, geometry_msgs/Vector3 angular_velocity, f64[9] angular_velocity_covariance, geometry_msgs/Vector3 linear_acceleration, f64[9] linear_acceleration_covariance
sensor_msgs/NavSatStatus: i8 status, u16 service
sensor_msgs/NavSatFix: std_msgs/Header header, sensor_msgs/NavSatStatus status, f64 latitude, f64 longitude, f64 altitude, f64[9] position_covariance, u8 position_covariance_type
sensor_msgs/MagneticField: std_msgs/Header header, geometry_msgs/Vector3 magnetic_field, f64[9] magnetic_field_covariance
sensor_msgs/FluidPressure: std_msgs/Header header, f64 fluid_pressure, f64 variance
sensor_msgs/Range: std_msgs/Header header, u8 radiation_type, f32 field_of_view, f32 min_range, f32 max_range, f32 range, f32 variance
sensor_msgs/JointState: std_msgs/Header header, str[] name, f64[] position, f64[] velocity, f64[] effort
trajectory_msgs/JointTrajectoryPoint: f64[] positions, f64[] velocities, f64[] accelerations, f64[] effort, builtin_interfaces/Duration time_from_start
trajectory_msgs/JointTrajectory: std_msgs/Header header, str[] joint_names, trajectory_msgs/JointTrajectoryPoint[] points
ros_gz_interfaces/Entity: u64 id, str name, u8 type
ros_gz_interfaces/JointWrench: std_msgs/Header header, std_msgs/String body_1_name, std_msgs/UInt32 body_1_id, std_msgs/String body_2_name, std_msgs/UInt32 body_2_id, geometry_msgs/Wrench body_1_wrench, geometry_msgs/Wrench body_2_wrench
ros_gz_interfaces/Contact: ros_gz_interfaces/Entity collision1, ros_gz_interfaces/Entity collision2, geometry_msgs/Vector3[] positions, geometry_msgs/Vector3[] normals, f64[] depths, ros_gz_interfaces/JointWrench[] wrenches
ros_gz_interfaces/Contacts: std_msgs/Header header, ros_gz_interfaces/Contact[] contacts
ros_gz_interfaces/Altimeter: std_msgs/Header header, f64 vertical_position, f64 vertical_velocity, f64 vertical_reference
rmw_dds_common/Gid: u8[16] data
rmw_dds_common/NodeEntitiesInfo: str node_namespace, str node_name, rmw_dds_common/Gid[] reader_gid_seq, rmw_dds_common/Gid[] writer_gid_seq
rmw_dds_common/ParticipantEntitiesInfo: rmw_dds_common/Gid gid, rmw_dds_common/NodeEntitiesInfo[] node_entities_info_seq
std_srvs/Empty: u8 structure_needs_at_least_one_member
rcl_interfaces/ParameterValue: u8 type, bool bool_value, i64 integer_value, f64 double_value, str string_value, u8[] byte_array_value, bool[] bool_array_value, i64[] integer_array_value, f64[] double_array_value, str[] string_array_value
rcl_interfaces/Parameter: str name, rcl_interfaces/ParameterValue value
rcl_interfaces/ListParametersRequest: str[] prefixes, u64 depth
rcl_interfaces/ListParametersResponse: str[] names, str[] prefixes
rcl_interfaces/GetParametersRequest: str[] names
rcl_interfaces/GetParametersResponse: rcl_interfaces/ParameterValue[] values
rcl_interfaces/SetParametersRequest: rcl_interfaces/Parameter[] parameters
rcl_interfaces/SetParametersResult: bool successful, str reason
rcl_interfaces/SetParametersResponse: rcl_interfaces/SetParametersResult[] results
simulation_interfaces/Result: u8 result, str error_message
simulation_interfaces/EntityState: std_msgs/Header header, geometry_msgs/Pose pose, geometry_msgs/Twist twist, geometry_msgs/Accel acceleration
simulation_interfaces/GetSimulatorFeaturesResponse: u16[] features, str[] spawn_formats, str custom_info
simulation_interfaces/GetSimulationStateResponse: u8 state, simulation_interfaces/Result result
simulation_interfaces/SetSimulationStateRequest: u8 state
simulation_interfaces/ResetSimulationRequest: u8 scope
simulation_interfaces/StepSimulationRequest: u64 steps
simulation_interfaces/ResultResponse: simulation_interfaces/Result result
simulation_interfaces/Bounds: u8 type, geometry_msgs/Vector3[] points
simulation_interfaces/GetEntitiesRequest: str filter, u8[] categories, str[] tags, u8 filter_mode, simulation_interfaces/Bounds bounds
simulation_interfaces/GetEntitiesResponse: simulation_interfaces/Result result, str[] entities
simulation_interfaces/EntityRequest: str entity
simulation_interfaces/GetEntityStateResponse: simulation_interfaces/Result result, simulation_interfaces/EntityState state
simulation_interfaces/SetEntityStateRequest: str entity, simulation_interfaces/EntityState state
simulation_interfaces/SetEntityStateRequest2: str entity, simulation_interfaces/EntityState state, bool set_pose, bool set_twist, bool set_acceleration
simulation_interfaces/GetEntitiesStatesResponse: simulation_interfaces/Result result, str[] entities, simulation_interfaces/EntityState[] states
simulation_interfaces/SpawnEntityRequest: str name, bool allow_renaming, str uri, str resource_string, str entity_namespace, geometry_msgs/PoseStamped initial_pose
simulation_interfaces/GetSpawnablesRequest: str[] sources
simulation_interfaces/Spawnable: str uri, str description, simulation_interfaces/Bounds spawn_bounds
simulation_interfaces/GetSpawnablesResponse: simulation_interfaces/Result result, simulation_interfaces/Spawnable[] spawnables
simulation_interfaces/Resource: str uri, str resource_string
simulation_interfaces/Spawnable2: simulation_interfaces/Resource entity_resource, str description, simulation_interfaces/Bounds spawn_bounds
simulation_interfaces/GetSpawnablesResponse2: simulation_interfaces/Result result, simulation_interfaces/Spawnable2[] spawnables
simulation_interfaces/GetEntityInfoResponse: simulation_interfaces/Result result, u8 category, str description, str[] tags
simulation_interfaces/GetEntityBoundsResponse: simulation_interfaces/Result result, simulation_interfaces/Bounds bounds
simulation_interfaces/SpawnEntity: str name, bool allow_renaming, simulation_interfaces/Resource entity_resource, str entity_namespace, geometry_msgs/PoseStamped initial_pose
simulation_interfaces/SpawnResult: simulation_interfaces/Result result, str entity_name
simulation_interfaces/SpawnEntitiesRequest: simulation_interfaces/SpawnEntity[] spawn_requests
simulation_interfaces/SpawnEntitiesResponse: simulation_interfaces/Result result, simulation_interfaces/SpawnResult[] results
action_msgs/GoalInfo: u8[16] goal_id, builtin_interfaces/Time stamp
action_msgs/GoalStatus: action_msgs/GoalInfo goal_info, i8 status
action_msgs/GoalStatusArray: action_msgs/GoalStatus[] status_list
action_msgs/CancelGoalRequest: action_msgs/GoalInfo goal_info
action_msgs/CancelGoalResponse: i8 return_code, action_msgs/GoalInfo[] goals_canceling
simulation_interfaces/SendGoalRequest: u8[16] goal_id, u64 steps
simulation_interfaces/SendGoalResponse: bool accepted, builtin_interfaces/Time stamp
simulation_interfaces/GetResultRequest: u8[16] goal_id
simulation_interfaces/GetResultResponse: i8 status, simulation_interfaces/Result result
simulation_interfaces/action/SimulateSteps_FeedbackMessage: u8[16] goal_id, u64 completed_steps, u64 remaining_steps
rcl_interfaces/Log: builtin_interfaces/Time stamp, u8 level, str name, str msg, str file, str function, u32 line
simulation_interfaces/SpawnEntityResponse: simulation_interfaces/Result result, str entity_name
""".strip().splitlines():
    name, fields = line.split(": ", 1)
    FIELDS[name] = [field.split() for field in fields.split(", ")]

NUMBERS = {"bool": "?", "i8": "b", "u8": "B", "i16": "h", "u16": "H", "i32": "i", "u32": "I", "i64": "q", "u64": "Q", "f32": "f", "f64": "d"}


def type_on_wire(name):
    package, rest = name.split("/", 1)
    middle, last = rest.split("/") if "/" in rest else ("msg", rest)
    return f"{package}::{middle}::dds_::{last}_"


class Reader:
    def __init__(self, data):
        assert data[:2] == b"\x00\x01", f"no little-endian CDR: {data[:4].hex()}"
        self.data, self.at = data[4:], 0

    def number(self, kind):
        code = NUMBERS[kind]
        size = struct.calcsize(code)
        self.at += -self.at % size
        (value,) = struct.unpack_from("<" + code, self.data, self.at)
        self.at += size
        return value

    def value(self, kind):
        if kind.endswith("]"):
            element, count = kind[:-1].split("[")
            count = int(count) if count else self.number("u32")
            if element == "u8":
                self.at += count
                return bytes(self.data[self.at - count : self.at])
            return [self.value(element) for _ in range(count)]
        if kind == "str":
            size = self.number("u32")
            text = self.data[self.at : self.at + size]
            assert text[-1:] == b"\0", text
            self.at += size
            return text[:-1].decode()
        if kind in NUMBERS:
            return self.number(kind)
        return {name: self.value(part) for part, name in FIELDS[kind]}


class Writer:
    def __init__(self):
        self.data = b""

    def number(self, kind, value):
        code = NUMBERS[kind]
        self.data += b"\0" * (-len(self.data) % struct.calcsize(code)) + struct.pack("<" + code, value)

    def value(self, kind, value):
        if kind.endswith("]"):
            element, count = kind[:-1].split("[")
            if not count:
                self.number("u32", len(value))
            for one in value:
                self.value(element, one)
        elif kind == "str":
            self.number("u32", len(value.encode()) + 1)
            self.data += value.encode() + b"\0"
        elif kind in NUMBERS:
            self.number(kind, value)
        else:
            for part, name in FIELDS[kind]:
                self.value(part, value[name])


# Every field, and nothing after the last one but padding.
def decode(kind, data):
    reader = Reader(data)
    value = reader.value(kind)
    assert 0 <= len(reader.data) - reader.at < 4, f"{kind}: {len(reader.data) - reader.at} bytes after the last field"
    return value


def encode(kind, value):
    writer = Writer()
    writer.value(kind, value)
    return b"\x00\x01\x00\x00" + writer.data


def seconds(time):
    return time["sec"] + time["nanosec"] / 1e9


def twist(x, turn):
    zero = {"x": 0.0, "y": 0.0, "z": 0.0}
    return {"linear": {**zero, "x": x}, "angular": {**zero, "z": turn}}
