#!/usr/bin/env python3
"""Writes arm.sdf from the numbers below: an arm of six joints with a gripper of two fingers on a table, three boxes, and a camera on a pan and a tilt joint.

Lengths in m, masses in kg, angles in rad. The arm is ours: no maker's. At the start it stands with its hand over the table; a controller holds it there until
a client commands its joints.
"""
import pathlib


def number(value):
    text = f"{value:.6g}"
    return "0" if text == "-0" else text


def box_inertia(mass, size):
    x, y, z = size
    return mass / 12 * (y * y + z * z), mass / 12 * (x * x + z * z), mass / 12 * (x * x + y * y)


def cylinder_inertia(mass, radius, length):  # along z
    across = mass * (3 * radius * radius + length * length) / 12
    return across, across, mass * radius * radius / 2


def inertial(mass, moments, pose):
    xx, yy, zz = (number(m) for m in moments)
    return f"<inertial><pose>{pose}</pose><mass>{number(mass)}</mass><inertia><ixx>{xx}</ixx><iyy>{yy}</iyy><izz>{zz}</izz></inertia></inertial>"


def material(r, g, b, shine=0.1):
    return f"<material><ambient>{r} {g} {b} 1</ambient><diffuse>{r} {g} {b} 1</diffuse><specular>{shine} {shine} {shine} 1</specular></material>"


def box(size):
    return f"<geometry><box><size>{' '.join(number(s) for s in size)}</size></box></geometry>"


def cylinder(radius, length):
    return f"<geometry><cylinder><radius>{number(radius)}</radius><length>{number(length)}</length></cylinder></geometry>"


table, table_height = (1.2, 1.4, 0.7), 0.7
orange, grey, dark, wood = material(0.9, 0.45, 0.1, 0.3), material(0.75, 0.75, 0.78, 0.3), material(0.2, 0.2, 0.22), material(0.55, 0.4, 0.25)
# Joint, its link, place of the joint on the link before, axis, limits, speed, effort, position at the start; mass of the link, radius and length of its tube,
# which stands on the joint.
arm = [
    ("waist", "turret", 0.10, "0 0 1", -2.9, 2.9, 2.0, 200, 0.0, 4.0, 0.08, 0.15, grey),
    ("shoulder", "upper_arm", 0.15, "0 1 0", -1.9, 1.9, 2.0, 200, 0.0, 5.0, 0.055, 0.35, orange),
    ("elbow", "forearm", 0.35, "0 1 0", -0.3, 2.6, 2.5, 120, 1.75, 2.5, 0.045, 0.15, grey),
    ("roll", "wrist", 0.15, "0 0 1", -3.1, 3.1, 3.0, 50, 0.0, 1.2, 0.04, 0.2, orange),
    ("pitch", "hand", 0.20, "0 1 0", -2.1, 2.1, 3.0, 30, 1.3916, 0.8, 0.035, 0.08, grey),
    ("twist", "palm", 0.08, "0 0 1", -4.7, 4.7, 4.0, 20, 0.0, 0.4, 0.03, 0.03, dark),
]
finger, finger_mass, finger_way, finger_effort = (0.02, 0.012, 0.07), 0.08, 0.04, 40
cubes = [("red_box", -0.2, (0.85, 0.15, 0.12)), ("green_box", 0.0, (0.15, 0.65, 0.2)), ("blue_box", 0.2, (0.15, 0.3, 0.85))]
cube_size, cube_mass, cube_x = 0.05, 0.5, 0.45
grip = "<surface><friction><ode><mu>0.8</mu><mu2>0.8</mu2></ode></friction></surface>"


def link(name, pose, weight, shape, offset, colour, surface="", more=""):
    inertia = inertial(*weight, offset)
    return (f'    <link name="{name}"><pose>{pose}</pose>{inertia}\n'
            f'      <collision name="collision"><pose>{offset}</pose>{shape}{surface}</collision>\n'
            f'      <visual name="visual"><pose>{offset}</pose>{shape}{colour}</visual>{more}\n    </link>\n')


def joint(name, kind, parent, child, axis, low, high, speed, effort, start):
    return (f'    <joint name="{name}" type="{kind}"><parent>{parent}</parent><child>{child}</child><axis><xyz>{axis}</xyz>'
            f"<limit><lower>{number(low)}</lower><upper>{number(high)}</upper><velocity>{number(speed)}</velocity><effort>{number(effort)}</effort></limit>"
            f"<initial_position>{number(start)}</initial_position></axis></joint>\n")


def made_arm():
    text = '  <model name="arm"><pose>0 0 %s 0 0 0</pose>\n' % number(table_height)
    text += link("base", "0 0 0.05 0 0 0", (4, cylinder_inertia(4, 0.1, 0.1)), cylinder(0.1, 0.1), "0 0 0 0 0 0", dark)
    text += '    <joint name="foot" type="fixed"><parent>world</parent><child>base</child></joint>\n'
    height, before, names = 0.0, "base", []
    for name, child, place, axis, low, high, speed, effort, start, mass, radius, length, colour in arm:
        height += place
        weight = (mass, cylinder_inertia(mass, radius, length))
        text += link(child, f"0 0 {number(height)} 0 0 0", weight, cylinder(radius, length), f"0 0 {number(length / 2)} 0 0 0", colour)
        text += joint(name, "revolute", before, child, axis, low, high, speed, effort, start)
        before = child
        names.append(name)
    height += arm[-1][11]
    for side, sign in (("left", 1), ("right", -1)):
        y = sign * finger[1] / 2
        weight = (finger_mass, box_inertia(finger_mass, finger))
        text += link(f"{side}_pad", f"0 {number(y)} {number(height)} 0 0 0", weight, box(finger), f"0 0 {number(finger[2] / 2)} 0 0 0", orange, grip)
        text += joint(f"{side}_finger", "prismatic", before, f"{side}_pad", f"0 {sign} 0", 0, finger_way, 0.2, finger_effort, finger_way)
        names.append(f"{side}_finger")
    joints = "".join(f"<joint_name>{name}</joint_name>" for name in names)
    plugin = 'filename="gz-sim-joint-trajectory-controller-system" name="gz::sim::systems::JointTrajectoryController"'
    gripper = f"<palm_link>{before}</palm_link><gripper_link>left_pad</gripper_link><gripper_link>right_pad</gripper_link>"
    return text + f'    <gripper name="gripper">{gripper}</gripper>\n' + f"    <plugin {plugin}>{joints}</plugin>\n  </model>\n"


def made_cube(name, y, colour):
    weight = (cube_mass, box_inertia(cube_mass, (cube_size,) * 3))
    place = f"{number(cube_x)} {number(y)} {number(table_height + cube_size / 2)} 0 0 0"
    return f'  <model name="{name}"><pose>{place}</pose>\n' + link("link", "0 0 0 0 0 0", weight, box((cube_size,) * 3), "0 0 0 0 0 0", material(*colour), grip) + "  </model>\n"


def made_eye():
    """A camera that looks at the table, on a pan and a tilt joint."""
    camera = ('<sensor name="camera" type="camera"><update_rate>20</update_rate><pose>0.05 0 0 0 0 0</pose><camera><horizontal_fov>1.0</horizontal_fov>'
              "<image><width>320</width><height>240</height></image><clip><near>0.05</near><far>20</far></clip></camera></sensor>")
    text = '  <model name="eye"><pose>1.5 0 0 0 0 3.14159</pose>\n'
    text += link("post", "0 0 0.65 0 0 0", (5, cylinder_inertia(5, 0.04, 1.3)), cylinder(0.04, 1.3), "0 0 0 0 0 0", dark)
    text += '    <joint name="foot" type="fixed"><parent>world</parent><child>post</child></joint>\n'
    text += link("yoke", "0 0 1.33 0 0 0", (0.5, box_inertia(0.5, (0.06, 0.1, 0.06))), box((0.06, 0.1, 0.06)), "0 0 0 0 0 0", grey)
    text += joint("pan", "revolute", "post", "yoke", "0 0 1", -1.5, 1.5, 2, 5, 0)
    text += link("head", "0 0 1.4 0 0 0", (0.3, box_inertia(0.3, (0.1, 0.06, 0.06))), box((0.1, 0.06, 0.06)), "0 0 0 0 0 0", orange, more=camera)
    text += joint("tilt", "revolute", "yoke", "head", "0 1 0", -0.8, 1.2, 2, 5, 0.5)
    plugin = 'filename="gz-sim-joint-trajectory-controller-system" name="gz::sim::systems::JointTrajectoryController"'
    return text + f"    <plugin {plugin}><joint_name>pan</joint_name><joint_name>tilt</joint_name></plugin>\n  </model>\n"


def made_table():
    shape, place = box(table), f"0.35 0 {number(table_height - table[2] / 2)} 0 0 0"
    return f'  <model name="table"><static>true</static><pose>{place}</pose><link name="link"><collision name="collision">{shape}{grip}</collision><visual name="visual">{shape}{wood}</visual></link></model>\n'


def world():
    parts = [made_table(), made_arm(), *(made_cube(*cube) for cube in cubes), made_eye()]
    return ('<?xml version="1.0"?>\n<!-- Written by make_arm.py. -->\n<sdf version="1.9">\n<world name="arm">\n'
            '  <physics type="ode"><max_step_size>0.001</max_step_size></physics>\n  <gravity>0 0 -9.81</gravity>\n'
            "  <include><uri>model://ground_plane</uri></include>\n  <include><uri>model://sun</uri></include>\n" + "".join(parts) + "</world>\n</sdf>\n")


if __name__ == "__main__":
    (pathlib.Path(__file__).resolve().parent / "arm.sdf").write_text(world())
