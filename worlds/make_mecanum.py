#!/usr/bin/env python3
"""Writes mecanum.sdf: a store with shelves, pallets and a conveyor, and a base on four mecanum wheels that goes round in it without turning.

The wheels touch the floor as gz-sim has it: plain cylinders that grip along the axes of their rollers alone, in the frame of the chassis.
"""
import math

import sdf_text

wheel_base, separation, radius, width = 0.5, 0.4, 0.1, 0.06
size, clearance, mass = (0.62, 0.32, 0.12), 0.05, 16
wheel_mass = 0.6
orange, dark, grey, wood, blue = (sdf_text.paint(c) for c in ("0.95 0.5 0.1", "0.15 0.15 0.17", "0.72 0.72 0.75", "0.6 0.45 0.28", "0.2 0.35 0.7"))


def inertial(mass, moments):
    xx, yy, zz = moments
    return f"<inertial><mass>{mass:g}</mass><inertia><ixx>{xx:.6g}</ixx><iyy>{yy:.6g}</iyy><izz>{zz:.6g}</izz></inertia></inertial>"


def rollers(side):
    """Where the front left wheel touches the floor its roller points to the front right: there it grips, and across it rolls."""
    text = ""
    for i in range(9):
        angle = i * 2 * math.pi / 9
        x, y = (radius - 0.012) * math.cos(angle), (radius - 0.012) * math.sin(angle)
        # Along the axle z, leaning by 45 degrees in the plane that touches the rim there.
        text += sdf_text.part("visual", f"roller_{i}", sdf_text.cylinder(0.012, width * 1.3), f"{x:.4f} {y:.4f} 0 {-side * math.pi / 4:.4f} 0 {angle:.4f}", grey)
    return text


def wheel(name, x, y, direction, side):
    grip = f'<surface><friction><ode><mu>1</mu><mu2>0</mu2><fdir1 gz:expressed_in="chassis">{direction}</fdir1></ode></friction></surface>'
    return (f'      <link name="{name}_wheel"><pose>{x:g} {y:g} {radius:g} {-math.pi / 2:.7f} 0 0</pose>{inertial(wheel_mass, sdf_text.cylinder_moments(wheel_mass, radius, width))}'
            f'{sdf_text.part("collision", "collision", sdf_text.cylinder(radius, width), "", grip)}{sdf_text.part("visual", "hub", sdf_text.cylinder(radius - 0.02, width * 0.9), "", dark)}{rollers(side)}</link>\n'
            f'      <joint name="{name}_joint" type="revolute"><parent>chassis</parent><child>{name}_wheel</child><axis><xyz>0 0 1</xyz></axis></joint>\n')


def base():
    length, breadth, height = size
    text = (f'    <model name="mecanum">\n      <link name="chassis"><pose>0 0 {clearance + height / 2:g} 0 0 0</pose>{inertial(mass, sdf_text.box_moments(mass, *size))}'
            f'{sdf_text.part("collision", "collision", sdf_text.box(*size))}{sdf_text.part("visual", "body", sdf_text.box(*size), "", orange)}'
            f'{sdf_text.part("visual", "deck", sdf_text.box(length * 0.9, breadth * 1.5, 0.02), f"0 0 {height / 2 + 0.03:g} 0 0 0", dark)}'
            f'{sdf_text.part("visual", "nose", sdf_text.box(0.04, breadth, 0.03), f"{length / 2:g} 0 0.02 0 0 0", blue)}'
            '<sensor name="laser" type="gpu_lidar"><pose>0.28 0 0.12 0 0 0</pose><update_rate>10</update_rate><lidar><scan><horizontal><samples>181</samples>'
            '<min_angle>-1.5708</min_angle><max_angle>1.5708</max_angle></horizontal></scan><range><min>0.05</min><max>8</max></range></lidar></sensor></link>\n')
    for name, side_x, side_y, direction in (("front_left", 1, 1, "1 -1 0"), ("front_right", 1, -1, "1 1 0"), ("back_left", -1, 1, "1 1 0"), ("back_right", -1, -1, "1 -1 0")):
        text += wheel(name, side_x * wheel_base / 2, side_y * separation / 2, direction, side_x * side_y)
    joints = "".join(f"<{name}_joint>{name}_joint</{name}_joint>" for name in ("front_left", "front_right", "back_left", "back_right"))
    return text + (f'      <plugin filename="gz-sim-mecanum-drive-system" name="gz::sim::systems::MecanumDrive">{joints}<wheelbase>{wheel_base:g}</wheelbase>'
                   f"<wheel_separation>{separation:g}</wheel_separation><wheel_radius>{radius:g}</wheel_radius><max_linear_velocity>0.6</max_linear_velocity>"
                   "<max_linear_acceleration>0.8</max_linear_acceleration></plugin>\n    </model>")


def shelf(name, x, y):
    boards = "".join(sdf_text.part(kind, f"board_{i}", sdf_text.box(1.6, 0.4, 0.04), f"0 0 {z:g} 0 0 0", wood if kind == "visual" else "")
                     for i, z in enumerate((0.1, 0.55, 1.0)) for kind in ("collision", "visual"))
    posts = "".join(sdf_text.part(kind, f"post_{i}", sdf_text.box(0.05, 0.4, 1.1), f"{side * 0.8:g} 0 0.55 0 0 0", grey if kind == "visual" else "")
                    for i, side in enumerate((-1, 1)) for kind in ("collision", "visual"))
    return f'    <model name="{name}"><static>true</static><pose>{x:g} {y:g} 0 0 0 0</pose><link name="link">{boards}{posts}</link></model>'


def conveyor():
    belt = sdf_text.box(2.4, 0.4, 0.3)
    return (f'    <model name="conveyor"><static>true</static><pose>1 2.75 0.15 0 0 0</pose><link name="belt">{sdf_text.part("collision", "collision", belt)}{sdf_text.part("visual", "visual", belt, "", dark)}</link>'
            '<plugin filename="gz-sim-track-controller-system" name="gz::sim::systems::TrackController"><link>belt</link><max_velocity>0.5</max_velocity></plugin></model>')


def parcel(name, x, y, z, colour):
    edge, weight = 0.2, 1
    return (f'    <model name="{name}"><pose>{x:g} {y:g} {z:g} 0 0 0</pose><link name="link">{inertial(weight, sdf_text.box_moments(weight, edge, edge, edge))}'
            f'{sdf_text.part("collision", "collision", sdf_text.box(edge, edge, edge))}{sdf_text.part("visual", "visual", sdf_text.box(edge, edge, edge), "", colour)}</link></model>')


lines = [base(), shelf("shelf_0", 1, 0.62), shelf("shelf_1", 1, -0.62), shelf("shelf_2", 1, 2.1), conveyor(),
         parcel("parcel_0", 0.2, 2.75, 0.4, blue), parcel("parcel_1", 0.8, 2.75, 0.4, orange)]
(sdf_text.here / "mecanum.sdf").write_text(
    sdf_text.world("make_mecanum.py", "store", lines, look=sdf_text.scene("0.6 0.6 0.6", "0.78 0.82 0.88")))
