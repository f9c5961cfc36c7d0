#!/usr/bin/env python3
"""Writes pond.sdf from the numbers below: a pond 4 m deep with a boat on two thrusters, an underwater vehicle on six, three buoys and a jetty.

Both vehicles are ours: no maker's. The water lifts what is in it up to z = 0 (Buoyancy); Hydrodynamics slows it down.
"""
import math

from sdf_text import box, box_moments, cylinder, cylinder_moments, here, number, numbers, paint, part, sphere, static

depth, half = 4.0, 20.0
hull, hull_mass = (2.0, 1.0, 0.5), 300.0
frame, frame_mass = (0.6, 0.4, 0.3), 70.5  # displaces 72 kg: with its thrusters it is 0.6 kg lighter than its water, and comes up by itself
propeller_mass, water = 0.15, 1000
white, red, yellow, dark, wood, blue = (paint(colour) for colour in ("0.92 0.92 0.94", "0.8 0.15 0.12", "0.95 0.8 0.1", "0.15 0.15 0.17", "0.5 0.36 0.22", "0.2 0.4 0.6"))


def inertial(mass, moments, pose=""):
    xx, yy, zz = (number(moment) for moment in moments)
    place = f"<pose>{pose}</pose>" if pose else ""
    return f"<inertial>{place}<mass>{number(mass)}</mass><inertia><ixx>{xx}</ixx><iyy>{yy}</iyy><izz>{zz}</izz></inertia></inertial>"


def thruster(name, pose, parent, diameter, most):
    """A propeller that pushes along the x axis of its link."""
    disc = part("visual", "disc", cylinder(diameter / 2, 0.02), "0 0 0 0 1.5708 0", dark)
    moments = cylinder_moments(propeller_mass, diameter / 2, 0.02)
    return [f'      <link name="{name}"><pose>{pose}</pose>{inertial(propeller_mass, (moments[2], moments[0], moments[1]))}{disc}</link>',
            f'      <joint name="{name}_shaft" type="revolute"><parent>{parent}</parent><child>{name}</child><axis><xyz>1 0 0</xyz></axis></joint>',
            f'      <plugin filename="gz-sim-thruster-system" name="gz::sim::systems::Thruster"><joint_name>{name}_shaft</joint_name><thrust_coefficient>0.004</thrust_coefficient>'
            f"<propeller_diameter>{number(diameter)}</propeller_diameter><fluid_density>{water}</fluid_density><velocity_control>true</velocity_control>"
            f"<max_thrust_cmd>{most}</max_thrust_cmd><min_thrust_cmd>-{most}</min_thrust_cmd></plugin>"]


def hydrodynamics(link, terms):
    values = "".join(f"<{name}>{number(value)}</{name}>" for name, value in terms.items())
    return f'      <plugin filename="gz-sim-hydrodynamics-system" name="gz::sim::systems::Hydrodynamics"><link_name>{link}</link_name>{values}</plugin>'


def boat():
    lines = ['    <model name="boat"><pose>0 0 0.1 0 0 0</pose>',
             f'      <link name="hull">{inertial(hull_mass, box_moments(hull_mass, *hull), "0 0 -0.1 0 0 0")}',
             "        " + part("collision", "hull", box(*hull)) + part("visual", "hull", box(*hull), "", white),
             "        " + part("visual", "stripe", box(hull[0] + 0.01, hull[1] + 0.01, 0.08), "0 0 0.1 0 0 0", red),
             "        " + part("visual", "cabin", box(0.7, 0.6, 0.5), "-0.2 0 0.5 0 0 0", blue) + part("visual", "bow", box(0.3, 0.5, 0.1), "0.85 0 0.3 0 0 0", red),
             '        <sensor name="gps" type="navsat"><update_rate>10</update_rate></sensor>', "      </link>"]
    for name, y in (("left", 0.35), ("right", -0.35)):
        lines += thruster(name, f"-1.05 {y} -0.15 0 0 0", "hull", 0.2, 150)
    return [*lines, hydrodynamics("hull", {"xU": -40, "xUabsU": -60, "yV": -200, "yVabsV": -300, "zW": -800, "kP": -80, "mQ": -250, "nR": -120, "nRabsR": -150,
                                           "xDotU": -30, "yDotV": -150, "zDotW": -250, "kDotP": -10, "mDotQ": -60, "nDotR": -50}), "    </model>"]


def vehicle():
    lines = ['    <model name="diver"><pose>0 -4 -1 0 0 0</pose>',
             f'      <link name="frame">{inertial(frame_mass, box_moments(frame_mass, *frame), "0 0 -0.03 0 0 0")}',
             "        " + part("collision", "frame", box(*frame)),
             "        " + part("visual", "float", box(frame[0], frame[1], 0.12), "0 0 0.09 0 0 0", yellow) + part("visual", "tube", box(0.5, 0.24, 0.16), "0 0 -0.06 0 0 0", dark),
             '        <sensor name="imu" type="imu"><update_rate>100</update_rate></sensor>',
             '        <sensor name="camera" type="camera"><update_rate>10</update_rate><pose>0.31 0 0 0 0 0</pose><camera><horizontal_fov>1.2</horizontal_fov><image><width>320</width>'
             "<height>240</height></image><clip><near>0.05</near><far>50</far></clip></camera></sensor>", "      </link>"]
    for name, x, y in (("front_left", 0.22, 0.15), ("front_right", 0.22, -0.15), ("back_left", -0.22, 0.15), ("back_right", -0.22, -0.15)):
        turn = math.copysign(math.pi / 4, -x * y)  # forward and inward in front, forward and outward behind
        lines += thruster(name, f"{numbers((x, y, 0))} 0 0 {number(turn)}", "frame", 0.1, 60)
    for name, y in (("up_left", 0.17), ("up_right", -0.17)):
        lines += thruster(name, f"0 {y} 0.02 0 -1.5708 0", "frame", 0.1, 60)
    return [*lines, hydrodynamics("frame", {"xU": -10, "xUabsU": -60, "yV": -15, "yVabsV": -90, "zW": -20, "zWabsW": -120, "kP": -3, "kPabsP": -4, "mQ": -4, "mQabsQ": -6,
                                            "nR": -3, "nRabsR": -5, "xDotU": -20, "yDotV": -40, "zDotW": -60, "kDotP": -0.6, "mDotQ": -1, "nDotR": -0.8}), "    </model>"]


def buoy(name, x, y):
    mass, radius = 15.0, 0.25  # of 65 kg of water: a quarter is below
    ball = 0.4 * mass * radius * radius
    return [f'    <model name="{name}"><pose>{numbers((x, y, 0.1))} 0 0 0</pose><link name="ball">{inertial(mass, (ball, ball, ball), "0 0 -0.1 0 0 0")}'
            f'{part("collision", "ball", sphere(radius))}{part("visual", "ball", sphere(radius), "", red)}{part("visual", "mast", cylinder(0.02, 0.6), "0 0 0.5 0 0 0", white)}</link>',
            hydrodynamics("ball", {"xU": -15, "yV": -15, "zW": -60, "kP": -2, "mQ": -2, "nR": -1}), "    </model>"]


if __name__ == "__main__":
    surface = f'    <model name="surface"><static>true</static><pose>0 0 0 0 0 0</pose><link name="link"><visual name="water"><transparency>0.45</transparency><cast_shadows>false</cast_shadows>{box(2 * half, 2 * half, 0.004)}{paint("0.15 0.4 0.55")}</visual></link></model>'
    lines = [surface, static("jetty", "0 10 -1.8 0 0 0", box(6, 1.5, 4.4), wood), *boat(), *vehicle()]
    for i, (x, y) in enumerate(((8, 0), (8, 5), (2, -8))):
        lines += buoy(f"buoy_{i}", x, y)
    content = "\n".join(lines)
    (here / "pond.sdf").write_text(f"""<?xml version="1.0"?>
<!-- Written by worlds/make_pond.py. -->
<sdf version="1.9">
  <world name="pond">
    <physics name="default" type="ode">
      <max_step_size>0.002</max_step_size>
      <real_time_factor>1</real_time_factor>
    </physics>
    <gravity>0 0 -9.81</gravity>
    <plugin filename="gz-sim-buoyancy-system" name="gz::sim::systems::Buoyancy"><graded_buoyancy><default_density>{water}</default_density><density_change><above_depth>0</above_depth><density>1.2</density></density_change></graded_buoyancy></plugin>
    <include><uri>model://sun</uri></include>
    <include><uri>model://ground_plane</uri><pose>0 0 {number(-depth)} 0 0 0</pose></include>
{content}
  </world>
</sdf>
""")
