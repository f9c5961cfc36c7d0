#!/usr/bin/env python3
"""Writes leader_follower.sdf: an arena of 10 x 10 m with a few round obstacles, a leader, and a follower behind it."""
import sdf_text

size, height, wall = 10.0, 0.6, 0.15
half = size / 2
obstacles = [(2.6, 2.4, 0.3), (-2.4, 2.6, 0.25), (-2.8, -2.2, 0.3), (2.2, -2.8, 0.25), (0.2, 0.3, 0.35)]


lines = sdf_text.walls(half, wall, height, sdf_text.paint("0.82 0.8 0.74"))
lines += [sdf_text.static(f"pillar_{i}", f"{sdf_text.numbers((x, y, height / 2))} 0 0 0", sdf_text.cylinder(radius, height), sdf_text.paint("0.8 0.55 0.2"))
          for i, (x, y, radius) in enumerate(obstacles)]

# A drum behind the robot's own scanner, which looks 120 degrees to either side, and as high as those of others, which would look over the robot.
drum = sdf_text.cylinder(0.14, 0.26)


def robot(name, x, rgb):
    return f"""    <model name="{name}">
      <pose>{x:g} -3.9 0 0 0 0</pose>
      <include merge="true"><uri>model://pioneer2dx_hokuyo</uri></include>
      <link name="drum">
        <pose relative_to="chassis">-0.12 0 0.36 0 0 0</pose>
        <inertial><mass>0.5</mass><inertia><ixx>0.00527</ixx><iyy>0.00527</iyy><izz>0.0049</izz></inertia></inertial>
        {sdf_text.part("collision", "collision", drum)}
        {sdf_text.part("visual", "visual", drum, "", sdf_text.paint(rgb))}
      </link>
      <joint name="drum_joint" type="fixed"><parent>chassis</parent><child>drum</child></joint>
    </model>"""


(sdf_text.here / "leader_follower.sdf").write_text(
    sdf_text.world("make_leader_follower.py", "leader_follower", [robot("leader", -3.2, "0.15 0.3 0.75"), robot("follower", -4.4, "0.15 0.6 0.25"), *lines],
                   look=sdf_text.scene("0.6 0.6 0.6", "0.7 0.78 0.88")))
