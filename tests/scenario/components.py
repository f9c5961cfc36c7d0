# Each interface component against a living simulator, one case per run: components.py CASE BIN_DIR LIB_DIR SOURCE_DIR. What comes out of the ports is compared with
# what the simulator says of the same moment, or with what the world makes certain.
import json
import math
import sys

from rig import Rig, await_

case, *folders = sys.argv[1:]
rig = Rig(*folders)
device = rig.device

sensors = """
<sensor name='imu' type='imu'><update_rate>50</update_rate></sensor>
<sensor name='gps' type='navsat'><update_rate>20</update_rate></sensor>
<sensor name='bumper' type='contact'><update_rate>50</update_rate><contact><collision>c</collision></contact></sensor>
"""
world = f"""<sdf version='1.9'><world name='w'>
<spherical_coordinates><surface_model>EARTH_WGS84</surface_model><latitude_deg>36.06</latitude_deg><longitude_deg>140.13</longitude_deg><elevation>25</elevation></spherical_coordinates>
<model name='ground_plane'><static>true</static><link name='l'><collision name='c'><geometry><plane/></geometry></collision></link></model>
<model name='wall'><static>true</static><pose>1.5 0 1 0 0 0</pose><link name='l'><collision name='c'><geometry><box><size>0.2 4 2</size></box></geometry></collision></link></model>
<include><uri>model://pioneer2dx</uri><name>pioneer2dx</name></include>
<model name='robot'><pose>-4 3 2 0 0 0.7</pose><link name='l'><inertial><mass>3</mass><inertia><ixx>.03</ixx><iyy>.03</iyy><izz>.03</izz></inertia></inertial>
<collision name='c'><geometry><box><size>.3 .3 .3</size></box></geometry></collision>{sensors}</link></model>
</world></sdf>"""


def up(component, iface=None, *options):
    with open(rig.path("w.sdf"), "w") as file:
        file.write(world)
    rig.server(*options, world=rig.path("w.sdf"))
    rig.naming()
    rig.host(device(component, *([f"conf.default.device_id={iface}"] if iface else [])), "SimulationProbe")
    rig.there(f"{component}0")
    rig.rtse("act", f"{component}0")


def sample(port):
    return json.loads(rig.rtse("--json", "print", port, "-n", "1", "-t", "60"))["value"]


def truth(iface):
    return json.loads(rig.simctl("--json", "echo", iface, "-n", "1"))


def close(got, wanted, tolerance):
    assert len(got) == len(wanted) and all(abs(a - b) <= tolerance for a, b in zip(got, wanted)), f"expected {wanted}, got {got}"


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
    # Four metres west and three north of the origin.
    close([value["latitude"], value["longitude"]], [36.06 + 3 / 110950, 140.13 - 4 / 90050], 1e-6)
    await_("the floor's height", lambda: abs(sample("RTCGps0:position")["altitude"] - 25.15) < 0.05)


def bumper():
    up("RTCBumper", "robot::bumper")
    await_("a contact with the floor", lambda: sample("RTCBumper0:contact")["data"] == [True])

    def weight():
        force = sample("RTCBumper0:force")["data"]
        return len(force) >= 9 and abs(abs(sum(force[2::3])) - 3 * 9.8) < 1

    await_("the floor carrying the box", weight)
    rig.simctl("pause")
    rig.simctl("pose", "robot", "-4", "3", "50", "0")
    rig.simctl("run")
    assert await_("a box in the air", lambda: sample("RTCBumper0:contact")["data"] == [False])


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
    log = open(rig.running[-1].log).read()
    assert "pioneer2dx::sonat" in log and "pioneer2dx::sonar" in log, log
    rig.rtse("conf", "RTCSonar0", "set", "server_id", "-1")
    rig.rtse("reset", "RTCSonar0")
    assert rig.try_rtse("act", "RTCSonar0").returncode == 1
    await_("the error state", lambda: rig.state("RTCSonar0") == "Error")
    rig.rtse("conf", "RTCSonar0", "set", "server_id", str(rig.server_id))
    rig.rtse("conf", "RTCSonar0", "set", "device_id", "pioneer2dx::sonar")
    rig.rtse("reset", "RTCSonar0")
    rig.rtse("act", "RTCSonar0")
    assert math.isfinite(sample("RTCSonar0:range")["ranges"][3])


cases = {f.__name__: f for f in (sonar, imu, gps, bumper, simulation, motors, wrong_device)}
try:
    cases[case]()
except BaseException:
    rig.logs()
    raise
finally:
    rig.close()
print("ok")
