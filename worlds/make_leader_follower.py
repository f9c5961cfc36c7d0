#!/usr/bin/env python3
"""Writes leader_follower.sdf: an arena of 10 x 10 m with a few round obstacles, a leader, and a follower behind it."""
import pathlib

size, height, wall = 10.0, 0.6, 0.15
half = size / 2
obstacles = [(2.6, 2.4, 0.3), (-2.4, 2.6, 0.25), (-2.8, -2.2, 0.3), (2.2, -2.8, 0.25), (0.2, 0.3, 0.35)]


def static(name, x, y, geometry, rgb):
    shape = f"<geometry>{geometry}</geometry>"
    return (f'    <model name="{name}"><static>true</static><pose>{x:g} {y:g} {height / 2:g} 0 0 0</pose><link name="link"><collision name="collision">{shape}</collision>'
            f'<visual name="visual">{shape}<material><ambient>{rgb} 1</ambient><diffuse>{rgb} 1</diffuse></material></visual></link></model>')


lines = []
for name, x, y, sx, sy in [("north", 0, half, size + wall, wall), ("south", 0, -half, size + wall, wall), ("east", half, 0, wall, size - wall),
                           ("west", -half, 0, wall, size - wall)]:
    lines.append(static(f"wall_{name}", x, y, f"<box><size>{sx:g} {sy:g} {height:g}</size></box>", "0.82 0.8 0.74"))
for i, (x, y, radius) in enumerate(obstacles):
    lines.append(static(f"pillar_{i}", x, y, f"<cylinder><radius>{radius:g}</radius><length>{height:g}</length></cylinder>", "0.8 0.55 0.2"))

# A drum behind the robot's own scanner, which looks 120 degrees to either side, and as high as those of others, which would look over the robot.
drum = "<geometry><cylinder><radius>0.14</radius><length>0.26</length></cylinder></geometry>"


def robot(name, x, rgb):
    return f"""    <model name="{name}">
      <pose>{x:g} -3.9 0 0 0 0</pose>
      <include merge="true"><uri>model://pioneer2dx_hokuyo</uri></include>
      <link name="drum">
        <pose relative_to="chassis">-0.12 0 0.36 0 0 0</pose>
        <inertial><mass>0.5</mass><inertia><ixx>0.00527</ixx><iyy>0.00527</iyy><izz>0.0049</izz></inertia></inertial>
        <collision name="collision">{drum}</collision>
        <visual name="visual">{drum}<material><ambient>{rgb} 1</ambient><diffuse>{rgb} 1</diffuse></material></visual>
      </link>
      <joint name="drum_joint" type="fixed"><parent>chassis</parent><child>drum</child></joint>
    </model>"""


newline = "\n"
pathlib.Path(__file__).resolve().with_name("leader_follower.sdf").write_text(f"""<?xml version="1.0"?>
<!-- Written by worlds/make_leader_follower.py. -->
<sdf version="1.9">
  <world name="leader_follower">
    <physics name="default" type="ode">
      <max_step_size>0.001</max_step_size>
      <real_time_factor>1</real_time_factor>
    </physics>
    <scene>
      <ambient>0.6 0.6 0.6 1</ambient>
      <background>0.7 0.78 0.88 1</background>
      <shadows>true</shadows>
    </scene>
    <include><uri>model://sun</uri></include>
    <include><uri>model://ground_plane</uri></include>
{robot("leader", -3.2, "0.15 0.3 0.75")}
{robot("follower", -4.4, "0.15 0.6 0.25")}
{newline.join(lines)}
  </world>
</sdf>
""")
