# What the scenarios of Player clients share: the worlds, the rig of a simulator and a gateway, commands of drives.
import json
import math
import re
import struct
import subprocess
import sys

from player_peer import *
from system import System, await_

case, bin_dir, lib_dir, source = sys.argv[1:]

world = f"""<sdf version="1.9"><world name="two">
  <physics name="default" type="ode"><max_step_size>0.002</max_step_size></physics>
  <include><uri>{source}/worlds/models/ground_plane</uri></include>
  <include><uri>{source}/worlds/models/pioneer2dx_sick</uri><name>first</name><pose>0 0 0 0 0 0</pose></include>
  <include><uri>{source}/worlds/models/pioneer2dx_sick</uri><name>second</name><pose>0 4 0 0 0 0</pose></include>
  <model name="wall"><static>true</static><pose>3 0 0.3 0 0 0</pose><link name="link"><collision name="c"><geometry><box><size>0.2 12 0.6</size></box></geometry></collision></link></model>
</world></sdf>"""


class Rig(System):
    def __init__(self):
        super().__init__(bin_dir, lib_dir)
        self.world = f"{self.work}/two.sdf"
        with open(self.world, "w") as file:
            file.write(world)

    def sim(self, *options, world=None):
        self.simulator = self.server(world or self.world, *options)
        return self.simulator

    # With any free ports; ports[i] is that of the i-th robot.
    def gateway(self, *options, robots=2):
        self.process = self.start(f"{bin_dir}/player-gateway", *(options or ("--port", "0")))
        self.ports = await_("the gateway", lambda: self.shown(robots))
        return self.ports

    def lines(self):
        return re.findall(r"^port (\d+): (.*?):((?: \w+:\d+=\S+)*)$", self.log(self.process), re.M)

    def shown(self, robots):
        assert self.process.poll() is None, self.log(self.process)
        ports = {}
        for port, _, _ in self.lines():
            ports[int(port)] = None
        assert len(ports) >= robots
        return list(ports)

    def is_alive(self):
        assert self.process.poll() is None, self.log(self.process)

    def truth(self, model="first"):
        return [float(word) for word in self.simctl("pose", model).split()[:3]]

    def is_subscribed(self, iface):
        return any(one["name"] == iface and one["subscribers"] > 0 for one in json.loads(self.simctl("--json", "list")))

    def json_echo(self, iface):
        return json.loads(self.simctl("--json", "echo", iface, "-n", "1"))

    def driven(self, model="first"):
        return self.json_echo(f"{model}::position2d")["velocity"][0]

    def try_gateway(self, *words):
        return subprocess.run([f"{bin_dir}/player-gateway", "-s", self.server_id, *words], capture_output=True, text=True, timeout=60)


def started(*options, robots=2):
    rig = Rig()
    rig.sim(*options)
    rig.gateway(robots=robots)
    return rig


def pose_command(x, y, a, speed=0.0, turn=0.0, state=1):
    return struct.pack(">6dI", x, y, a, speed, 0, turn, state)


def reached(client, x, y, a):
    def is_there(payload):
        state = Position(payload)
        near = math.hypot(state.pose[0] - x, state.pose[1] - y) < 0.02 and abs(math.remainder(state.pose[2] - a, 2 * math.pi)) < 0.02
        return near and max(map(abs, state.velocity)) < 0.005

    return Position(client.read_until(POSITION2D, good=is_there))


def stands(client):
    client.read_until(POSITION2D, good=lambda p: max(map(abs, Position(p).velocity)) < 0.005)


def moves(client, at_least=0.1):
    return Position(client.read_until(POSITION2D, good=lambda p: Position(p).velocity[0] > at_least))


flying = f"""<sdf version="1.9"><world name="sensors">
  <spherical_coordinates><surface_model>EARTH_WGS84</surface_model><latitude_deg>36.06</latitude_deg><longitude_deg>140.13</longitude_deg><elevation>25</elevation></spherical_coordinates>
  <include><uri>{source}/worlds/models/sun</uri></include>
  <include><uri>{source}/worlds/models/ground_plane</uri></include>
  <model name="flyer"><pose>0 0 2 0 0 0.5</pose><link name="l"><inertial><mass>3</mass><inertia><ixx>.03</ixx><iyy>.03</iyy><izz>.03</izz></inertia></inertial><gravity>false</gravity>
    <sensor name="eye" type="camera"><update_rate>10</update_rate><camera><image><width>64</width><height>48</height></image></camera></sensor>
    <sensor name="grey" type="camera"><update_rate>10</update_rate><camera><image><width>64</width><height>48</height><format>L8</format></image></camera></sensor></link>
    <plugin name="gz::sim::systems::VelocityControl" filename="gz-sim-velocity-control-system"/></model>
  <model name="faller"><pose>0 3 1 0 0 0.7</pose><link name="l"><inertial><mass>3</mass><inertia><ixx>.03</ixx><iyy>.03</iyy><izz>.03</izz></inertia></inertial>
    <collision name="c"><pose>.05 0 0 0 0 0</pose><geometry><box><size>.4 .3 .3</size></box></geometry></collision>
    <sensor name="imu" type="imu"><update_rate>50</update_rate></sensor>
    <sensor name="gps" type="navsat"><update_rate>20</update_rate></sensor>
    <sensor name="bumper" type="contact"><update_rate>50</update_rate><contact><collision>c</collision></contact></sensor></link></model>
</world></sdf>"""


def run(*cases):
    {function.__name__: function for function in cases}[case]()
