# Each interface component against a living simulator, one case per run: components.py CASE BIN_DIR LIB_DIR SOURCE_DIR. What comes out of the ports is compared with
# what the simulator says of the same moment, or with what the world makes certain.
import json
import math
import struct
import sys

from component_rig import call, case, close, device, rig, sample, truth
from rig import await_

sensors = """
<sensor name='imu' type='imu'><pose>0.1 0 0 0 0 0</pose><update_rate>50</update_rate></sensor>
<sensor name='gps' type='navsat'><pose>0.2 0 0 0 0 0</pose><update_rate>20</update_rate></sensor>
<sensor name='altimeter' type='altimeter'><update_rate>20</update_rate></sensor>
<sensor name='air_pressure' type='air_pressure'><update_rate>20</update_rate></sensor>
<sensor name='laser' type='gpu_lidar'><pose>0 0 0.2 0 0 0</pose><update_rate>10</update_rate><lidar><scan><horizontal><samples>181</samples><min_angle>-1.5708</min_angle>
<max_angle>1.5708</max_angle></horizontal></scan><range><min>0.1</min><max>8</max></range></lidar></sensor>
<sensor name='lidar' type='gpu_lidar'><pose>0 0 0.85 0 0 0</pose><update_rate>10</update_rate><lidar><scan>
<horizontal><samples>36</samples><min_angle>-3.1415</min_angle><max_angle>3.1415</max_angle></horizontal>
<vertical><samples>16</samples><min_angle>-0.2617993878</min_angle><max_angle>0.2617993878</max_angle></vertical></scan><range><min>0.1</min><max>50</max></range></lidar></sensor>
<sensor name='magnetometer' type='magnetometer'><update_rate>20</update_rate></sensor>
<sensor name='bumper' type='contact'><update_rate>50</update_rate><contact><collision>c</collision></contact></sensor>
"""
world = f"""<sdf version='1.9'><world name='w'>
<spherical_coordinates><surface_model>EARTH_WGS84</surface_model><latitude_deg>36.06</latitude_deg><longitude_deg>140.13</longitude_deg><elevation>25</elevation></spherical_coordinates>
<model name='ground_plane'><static>true</static><link name='l'><collision name='c'><geometry><plane/></geometry></collision></link></model>
<model name='wall'><static>true</static><pose>1.5 0 1 0 0 0</pose><link name='l'><collision name='c'><geometry><box><size>0.2 4 2</size></box></geometry></collision></link></model>
<include><uri>model://pioneer2dx</uri><name>pioneer2dx</name></include>
<model name='robot'><pose>-4 3 2 0 0 0.7</pose><link name='l'><inertial><mass>3</mass><inertia><ixx>.03</ixx><iyy>.03</iyy><izz>.03</izz></inertia></inertial>
<collision name='c'><geometry><box><size>.3 .3 .3</size></box></geometry></collision>{sensors}</link></model>
<model name='scale'><link name='base'/><joint name='base' type='fixed'><parent>world</parent><child>base</child></joint>
<link name='load'><pose>0 8 1 0 0 0</pose><inertial><mass>2</mass></inertial></link>
<joint name='j' type='revolute'><parent>base</parent><child>load</child><axis><xyz>0 0 1</xyz></axis>
<sensor name='force_torque' type='force_torque'><update_rate>50</update_rate></sensor></joint></model>
</world></sdf>"""


def up(component, iface=None, *options, beside=("SimulationProbe",)):
    with open(rig.path("w.sdf"), "w") as file:
        file.write(world)
    rig.server(*options, world=rig.path("w.sdf"))
    rig.naming()
    rig.host(device(component, *([f"conf.default.device_id={iface}"] if iface else [])), *beside)
    rig.there(f"{component}0")
    rig.rtse("act", f"{component}0")


def sonar():
    up("RTCSonar")
    value = sample("RTCSonar0:range")
    assert len(value["ranges"]) == 16, value
    # The two that look ahead stand 0.166 m in front and see the wall at 1.4 m; those behind see nothing within 5 m.
    close([value["ranges"][3], value["ranges"][4]], [1.4 - 0.166] * 2, 0.1)
    assert min(value["ranges"][11:13]) > 2, value["ranges"]


def imu():
    up("RTCImu", "robot::imu")

    def at_rest():
        acceleration = sample("RTCImu0:acceleration")["data"]
        close([acceleration["ax"], acceleration["ay"], acceleration["az"]], [0, 0, 9.8], 0.1)
        return True

    await_("a box that lies on the floor and feels gravity", at_rest)
    turn = sample("RTCImu0:orientation")["data"]
    close([turn["r"], turn["p"]], [0, 0], 0.01)
    rate = sample("RTCImu0:angular_velocity")["data"]
    close(list(rate.values()), [0, 0, 0], 0.01)


def gps():
    up("RTCGps", "robot::gps")
    value = sample("RTCGps0:position")
    wanted = truth("robot::gps")
    close([value["latitude"], value["longitude"]], [wanted["latitude"], wanted["longitude"]], 1e-6)
    # The robot stands four metres west and three north of the origin and looks to 0.7 rad.
    close([value["latitude"], value["longitude"]], [36.06 + (3 + 0.2 * math.sin(0.7)) / 110950, 140.13 - (4 - 0.2 * math.cos(0.7)) / 90050], 1e-6)
    await_("the floor's height", lambda: abs(sample("RTCGps0:position")["altitude"] - 25.15) < 0.05)


def bumper():
    up("RTCBumper", "robot::bumper", beside=("DeviceProbe",))
    rig.rtse("con", "DeviceProbe0:bumper", "RTCBumper0:bumper")
    call("bumper")
    await_("a contact with the floor", lambda: sample("RTCBumper0:contact")["data"] == [True])

    def weight():
        force = sample("RTCBumper0:force")["data"]
        return len(force) >= 9 and abs(abs(sum(force[2::3])) - 3 * 9.8) < 1

    await_("the floor carrying the box", weight)
    call("pressed")
    rig.simctl("pause")
    rig.simctl("pose", "robot", "-4", "3", "50", "0")
    rig.simctl("run")
    assert await_("a box in the air", lambda: sample("RTCBumper0:contact")["data"] == [False])


def ranger():
    up("RTCLaser", "robot::laser", beside=("DeviceProbe",))
    rig.rtse("con", "DeviceProbe0:ranger", "RTCLaser0:ranger")
    whole = sample("RTCLaser0:range")
    call("laser")
    intensities = sample("RTCLaser0:intensities")
    assert len(intensities["intensities"]) == len(whole["ranges"]) and all(0 <= one <= 1 for one in intensities["intensities"])
    call("narrow")
    scan = await_("a part of the scan", lambda: (got := sample("RTCLaser0:range"))["config"]["angularRes"] > 1.5 * whole["config"]["angularRes"] and got)
    config, step = scan["config"], whole["config"]["angularRes"]
    assert -0.5 <= config["minAngle"] < -0.5 + step and 0.5 - 2 * step < config["maxAngle"] <= 0.5 and config["maxRange"] == 1, config
    assert len(scan["ranges"]) == round((config["maxAngle"] - config["minAngle"]) / config["angularRes"]) + 1 and max(scan["ranges"]) == 1, scan
    assert len(sample("RTCLaser0:intensities")["intensities"]) == len(scan["ranges"])
    call("nan")
    assert "SetConfig: expected finite numbers" in rig.log(rig.running[-1])
    assert sample("RTCLaser0:range")["config"] == config
    call("all")
    await_("all of the scan", lambda: sample("RTCLaser0:range")["config"] == whole["config"])
    call("power_off")
    used = lambda: next(one["subscribers"] for one in json.loads(rig.simctl("--json", "list")) if one["name"] == "robot::laser")
    await_("a sensor that rests", lambda: used() == 0)
    call("power_on")
    assert len(sample("RTCLaser0:range")["ranges"]) == len(whole["ranges"])
    call("intensities_off")
    assert rig.try_rtse("print", "RTCLaser0:intensities", "-n", "1", "-t", "1").returncode != 0
    call("intensities_on")
    assert sample("RTCLaser0:intensities")


def places():
    up("RTCImu", "robot::imu", beside=(device("RTCGps", "conf.default.device_id=robot::gps"), device("RTCSonar"), "DeviceProbe"))
    rig.rtse("act", "RTCGps0", "RTCSonar0")
    for port, provider in (("imu", "RTCImu0"), ("gps", "RTCGps0"), ("ranger", "RTCSonar0")):
        rig.rtse("con", f"DeviceProbe0:{port}", f"{provider}:{port}")
    call("place")
    call("sonar")


# Of a lidar 1 m above flat ground: the lowest ring, 15 degrees down, sees it at 3.864 m, those that look up see nothing.
def point_cloud():
    up("RTCPointCloud", "robot::lidar")

    def lowest_ring():
        points = [one["point"] for one in sample("RTCPointCloud0:points")["points"][:30]]
        return all(abs(math.dist((0, 0, 0), (p["x"], p["y"], p["z"])) - 3.864) < 0.05 and abs(p["z"] + 1) < 0.02 for p in points)

    await_("a robot that lies on the ground", lowest_ring)
    cloud = sample("RTCPointCloud0:cloud")
    assert (cloud["height"], cloud["type"], cloud["point_step"], cloud["is_dense"]) == (1, "xyz", 12, True), cloud
    assert len(cloud["data"]) == 12 * cloud["width"] and 0 < cloud["width"] < 16 * 36 and [one["name"] for one in cloud["fields"]] == ["x", "y", "z"]
    rig.rtse("conf", "RTCPointCloud0", "set", "organised", "1")
    rig.rtse("conf", "RTCPointCloud0", "set", "fields", "all")
    whole = await_("one row per layer", lambda: (got := sample("RTCPointCloud0:cloud"))["point_step"] == 24 and got)
    assert (whole["height"], whole["width"], whole["row_step"], whole["is_dense"]) == (16, 36, 864, False), whole
    x, y, z, intensity, ring, time = struct.unpack_from("<ffffHxxf", bytes(whole["data"]), 24 * 36 * 15)
    assert math.isnan(x) and ring == 15 and intensity == 0 and time == 0
    assert [(one["name"], one["offset"]) for one in whole["fields"]] == [("x", 0), ("y", 4), ("z", 8), ("intensity", 12), ("ring", 16), ("time", 20)]


def odometry():
    up("RTCPosition2d", beside=("DeviceProbe",))
    rig.rtse("con", "DeviceProbe0:drive", "RTCPosition2d0:drive")
    call("size")
    call("odometry")

    def is_set():
        pose = sample("RTCPosition2d0:odometry")["data"]
        return abs(pose["position"]["x"] - 7) + abs(pose["position"]["y"] + 3) + abs(pose["heading"] - 1) < 0.01

    await_("odometry that was set", is_set)
    call("odometry_nan")
    await_("a line", lambda: "finite" in rig.log(rig.running[-1]) or "NaN" in rig.log(rig.running[-1]))
    assert is_set()


def inject(port, data):
    rig.rtse("inject", f"RTCPosition2d0:{port}", json.dumps({"data": data}))


def goals():
    up("RTCPosition2d", beside=("DeviceProbe",))
    at = lambda: (odometry := rig.robot()["odometry"])[:2] + [math.remainder(odometry[2], 2 * math.pi)]
    rig.rtse("con", "DeviceProbe0:drive", "RTCPosition2d0:drive")
    is_at = lambda *goal: all(abs(got - wanted) < 0.03 for got, wanted in zip(at(), goal))
    call("path_done")
    call("path")
    await_("a robot at the end of its path", lambda: is_at(0.3, 0.3, 1.5))
    await_("a robot that stands there", lambda: max(map(abs, rig.robot()["velocity"])) < 0.002)
    call("path_done")
    call("path_on_hold")
    call("path_nan")
    call("path_huge")
    rig.rtse("inject", "RTCPosition2d0:path", json.dumps({"waypoints": [{"target": {"position": {"x": 0.3, "y": 0.1}, "heading": 0}}]}))
    assert is_at(0.3, 0.3, 1.5)  # still on hold
    goal = [-0.8, 0.5, 2.0]
    inject("pose_control", {"position": {"x": goal[0], "y": goal[1]}, "heading": goal[2]})
    await_("a robot at its goal", lambda: all(abs(got - wanted) < 0.03 for got, wanted in zip(at(), goal)))
    await_("a robot that stands there", lambda: abs(rig.robot()["velocity"][2]) < 0.01)
    turned = lambda angle: abs(math.remainder(at()[2] - angle, 2 * math.pi)) < 0.05
    await_("a robot that looks back", lambda: inject("heading_control", {"speed": 0.1, "heading": -2.5}) or turned(-2.5))
    await_("a robot that stands when nobody commands", lambda: abs(rig.robot()["velocity"][0]) < 0.01)
    assert "no velocity for 1 s" in rig.log(rig.running[-1])
    inject("pose_control", {"position": {"x": 3, "y": 3}, "heading": 0})
    await_("a robot on its way", lambda: abs(rig.robot()["velocity"][2]) > 0.1)
    inject("velocity", {"vx": 0, "vy": 0, "va": 0})  # ends it
    await_("a robot that stands", lambda: abs(rig.robot()["velocity"][2]) < 0.01)
    inject("carlike_control", {"speed": 1, "steeringAngle": 0.3})
    await_("a line that it is no car", lambda: "the drive is not steered" in rig.log(rig.running[-1]))
    inject("pose_control", {"position": {"x": -3, "y": -3}, "heading": 0})
    await_("a robot on its way", lambda: abs(rig.robot()["velocity"][2]) > 0.1)
    call("odometry")  # the goal is no longer where it was
    await_("a robot that stands where its odometry says", lambda: abs(at()[0] - 7) < 0.3 and max(map(abs, rig.robot()["velocity"])) < 0.01)


# Each against what the simulator says of the same device.
def meters():
    meters = {"RTCForceTorque": "scale::force_torque", "RTCAltimeter": "robot::altimeter", "RTCAirPressure": "robot::air_pressure",
              "RTCMagnetometer": "robot::magnetometer", "RTCTruth": "robot"}
    first, *others = meters
    up(first, meters[first], beside=[device(one, f"conf.default.device_id={meters[one]}") for one in others])
    rig.there(*(f"{one}0" for one in others))
    rig.rtse("act", *(f"{one}0" for one in others))

    def rests():
        force = sample("RTCForceTorque0:force")["data"]
        assert len(force) == 6
        return abs(abs(force[2]) - 2 * 9.8) < 0.1 and abs(sample("RTCTruth0:velocity")["data"]["vz"]) < 1e-3

    await_("a load that hangs, and a box that lies", rests)
    wanted = truth("scale::force_torque")
    close(sample("RTCForceTorque0:force")["data"], wanted["force"] + wanted["torque"], 0.1)
    wanted = truth("robot::altimeter")
    close([sample("RTCAltimeter0:height")["data"], sample("RTCAltimeter0:climb")["data"]], [wanted["height"], wanted["climb"]], 0.01)
    assert wanted["height"] < -1, wanted
    close([sample("RTCAirPressure0:pressure")["data"]], [truth("robot::air_pressure")["pressure"]], 1)
    field = sample("RTCMagnetometer0:field")["data"]
    close([field["x"], field["y"], field["z"]], truth("robot::magnetometer")["field"], 1e-7)
    pose = sample("RTCTruth0:pose")["data"]
    close([pose["position"]["x"], pose["position"]["y"], pose["position"]["z"], pose["orientation"]["y"]], [-4, 3, 0.15, 0.7], 0.02)


# Ports with the names, and a scan with the parameters, that components of other makers have.
def names():
    rig.server()
    rig.naming()
    rig.host(device("RTCLaser", "instance_name=Hokuyo0", "conf.default.port_names=range:ranges,ranger:svc,nonsense", "conf.default.start_angle=-0.5",
                    "conf.default.end_angle=0.5", "conf.default.cluster_count=2", "conf.default.enable_intensity=0"),
             device("RTCPosition2d", "conf.default.port_names=velocity:vel_control, actual_velocity:current_vel"))
    for component in ("Hokuyo0", "RTCPosition2d0"):
        rig.there(component)
        rig.rtse("act", component)
    scan = sample("Hokuyo0:ranges")
    assert -0.51 < scan["config"]["minAngle"] < -0.45 and 0.45 < scan["config"]["maxAngle"] < 0.51, scan["config"]
    assert len(scan["ranges"]) == round((scan["config"]["maxAngle"] - scan["config"]["minAngle"]) / scan["config"]["angularRes"]) + 1
    ports = {port["name"].split(".")[-1] for port in json.loads(rig.rtse("--json", "cat", "Hokuyo0"))["ports"]}
    assert ports == {"ranges", "intensities", "svc"}, ports
    assert 'port_names: expected OWN:OTHER, got "nonsense"' in rig.log(rig.running[-1])

    def drives():
        rig.rtse("inject", "RTCPosition2d0:vel_control", json.dumps({"tm": {"sec": 0, "nsec": 0}, "data": {"vx": 0.2, "vy": 0, "va": 0}}))
        return sample("RTCPosition2d0:current_vel")["data"]["vx"] > 0.05

    await_("a robot that drives", drives)


# Each sensor of the world that does not look, against what its iface says of the same moment.
def others():
    rig.server(world=f"{sys.argv[4]}/worlds/devices.sdf")
    rig.naming()
    devices = {"RTCPower": "rover::battery", "RTCDvl": "diver::dvl", "RTCAirSpeed": "glider::air_speed", "RTCIns": "rover::ins", "RTCRfid": "rover::rfid",
               "RTCWireless": "rover::wireless", "RTCWheels": "rover::wheels", "RTCLocalization": "rover::localization"}
    rig.host(*(device(component, f"conf.default.device_id={iface}") for component, iface in devices.items()), "DeviceProbe")
    for component in devices:
        rig.there(f"{component}0")
        rig.rtse("act", f"{component}0")
    battery = truth("rover::battery")
    close([sample(f"RTCPower0:{port}")["data"] for port in ("voltage", "current", "level")], [battery[key] for key in ("voltage", "current", "level")], 1e-6)
    assert sample("RTCPower0:state")["data"] == 0
    rig.rtse("inject", "RTCPower0:charger", json.dumps({"tm": {"sec": 0, "nsec": 0}, "data": True}))
    await_("a battery that is charged", lambda: sample("RTCPower0:state")["data"] == 2 and sample("RTCPower0:current")["data"] < -0.5)
    rig.rtse("deact", "RTCPower0")
    await_("a charger that is disconnected", lambda: truth("rover::battery")["state"] == 0)
    velocity = sample("RTCDvl0:velocity")["data"]
    close([velocity["vx"], velocity["vy"], velocity["vz"]], [0.3, 0, 0], 0.05)
    ranges = sample("RTCDvl0:ranges")["data"]
    assert len(ranges) == 4 and min(ranges) > 3.8 / math.cos(math.radians(29)) - 0.1 and abs(sample("RTCDvl0:range")["data"] - min(ranges)) < 0.1, ranges
    close([sample("RTCAirSpeed0:pressure")["data"], sample("RTCAirSpeed0:temperature")["data"]], [truth("glider::air_speed")["pressure"], 288.15 - 0.0065 * 35], 1)
    position = sample("RTCIns0:position")
    metre = 1 / (111320 * math.cos(math.radians(36.06)))  # to the east [deg]
    close([position["latitude"], position["longitude"]], [36.06, 140.13 - 4 * metre], 2e-5)
    assert abs(position["altitude"] - 25.3) < 0.1 and abs(position["orientation"]["y"]) < 0.1, position
    assert sample("RTCRfid0:tags")["data"] == ["E200-0017"]
    rig.rtse("con", "DeviceProbe0:rfid", "RTCRfid0:rfid")
    call("tag")
    call("write_tag")
    await_("a tag that is written", lambda: truth("rover::rfid")["tags"][0]["data"] == "shelf 42")
    sample("RTCRfid0:tags")  # the component has read them, too
    call("tag_written")
    assert sample("RTCWireless0:essids")["data"] == ["lab"] and -60 < sample("RTCWireless0:levels")["data"][0] < -30
    assert sample("RTCWheels0:ticks")["data"] == [0, 0] or len(sample("RTCWheels0:angles")["data"]) == 2
    best = sample("RTCLocalization0:pose")["data"]
    close([best["position"]["x"], best["position"]["y"], best["heading"]], [-4, 0, 0], 0.6)
    hypotheses = sample("RTCLocalization0:hypotheses")["hypotheses"]
    assert len(hypotheses) == 3 and abs(sum(one["weight"] for one in hypotheses) - 1) < 1e-9, hypotheses


def simulation():
    up("RTCSimulation", None, "--paused")
    now = lambda: json.loads(rig.simctl("--json", "stats"))["sim_time"]
    await_("time that passes because the component is active", lambda: now() > 0.05)
    stamp = sample("RTCSimulation0:time")
    assert abs(stamp["tm"]["sec"] + stamp["tm"]["nsec"] * 1e-9 - stamp["data"]) < 1e-6 and abs(stamp["data"] - now()) < 10, stamp
    rig.rtse("con", "SimulationProbe0:simulation", "RTCSimulation0:simulation")
    rig.rtse("deact", "RTCSimulation0")
    stands = now()
    assert now() == stands, "time passes though the component is not active"
    rig.rtse("act", "RTCSimulation0")  # a service answers while its component is active
    rig.rtse("act", "SimulationProbe0")
    assert rig.state("SimulationProbe0") == "Active"


# Motors that were switched off stay off in a simulator that was started anew.
def motors():
    up("RTCPosition2d")

    def turn():
        rig.rtse("inject", "RTCPosition2d0:velocity", json.dumps({"tm": {"sec": 0, "nsec": 0}, "data": {"vx": 0, "vy": 0, "va": 0.5}}))
        return rig.robot()["velocity"][2] > 0.3

    def is_off():
        return not rig.robot()["motors_enabled"]

    await_("a turning robot", turn)
    rig.rtse("conf", "RTCPosition2d0", "set", "motors_enabled", "0")
    await_("motors that are off", is_off)
    rig.kill(rig.running[0])
    rig.server(world=rig.path("w.sdf"))
    await_("motors that are off in the new world", is_off)
    assert not turn(), "the robot turns without motors"
    rig.rtse("conf", "RTCPosition2d0", "set", "motors_enabled", "1")
    await_("a robot that turns again", turn)


def wrong_device():
    up("RTCSonar")
    rig.rtse("conf", "RTCSonar0", "set", "device_id", "pioneer2dx::sonat")
    await_("the error state", lambda: rig.state("RTCSonar0") == "Error")
    log = rig.log(rig.running[-1])
    assert "pioneer2dx::sonat" in log and "pioneer2dx::sonar" in log, log
    rig.rtse("conf", "RTCSonar0", "set", "server_id", "-1", "--force")
    rig.rtse("reset", "RTCSonar0")
    assert rig.try_rtse("act", "RTCSonar0").returncode == 1
    await_("the error state", lambda: rig.state("RTCSonar0") == "Error")
    rig.rtse("conf", "RTCSonar0", "set", "server_id", rig.server_id)
    rig.rtse("conf", "RTCSonar0", "set", "device_id", "pioneer2dx::sonar")
    rig.rtse("reset", "RTCSonar0")
    rig.rtse("act", "RTCSonar0")
    assert math.isfinite(sample("RTCSonar0:range")["ranges"][3])


rig.run_case(case, globals())
