#!/usr/bin/env python3
"""Writes quadcopter.sdf from the numbers below: a quadcopter with four rotors, an IMU and a camera, on a pad, and two towers to fly around.

The quadcopter is ours: no maker's. Each rotor pushes with `thrust` times the square of its speed; at 544 rad/s the four carry it.
"""
import math

from sdf_text import box, box_moments, cylinder, cylinder_moments, here, number, numbers, paint, part, sphere, static, world

body, body_mass, arm = (0.22, 0.22, 0.08), 1.16, 0.25  # arm: from the middle to a rotor
rotor_radius, rotor_mass, thrust, moment, fastest = 0.13, 0.005, 1e-5, 0.016, 850
corners = [(1, -1, "ccw"), (-1, 1, "ccw"), (1, 1, "cw"), (-1, -1, "cw")]  # front right, back left, front left, back right
dark, orange, grey, red = paint("0.15 0.15 0.17"), paint("0.95 0.45 0.1"), paint("0.6 0.6 0.63"), paint("0.8 0.15 0.15")


def inertial(mass, moments):
    xx, yy, zz = (number(moment) for moment in moments)
    return f"<inertial><mass>{number(mass)}</mass><inertia><ixx>{xx}</ixx><iyy>{yy}</iyy><izz>{zz}</izz></inertia></inertial>"


def base():
    # Its arms and motors are far out: the moments are those of half of the mass in the body and half at the rotors.
    inner, out = box_moments(body_mass / 2, *body), body_mass / 2 * arm * arm
    lines = [f'      <link name="base">{inertial(body_mass, (inner[0] + out / 2, inner[1] + out / 2, inner[2] + out))}',
             "        " + part("collision", "body", box(*body)), "        " + part("visual", "body", box(*body), "", orange)]
    reach = arm / math.sqrt(2)
    for i, (x, y, _) in enumerate(corners):
        place, turn = numbers((x * reach / 2, y * reach / 2, 0)), number(math.atan2(y, x))
        lines.append("        " + part("visual", f"arm_{i}", box(arm, 0.03, 0.02), f"{place} 0 0 {turn}", dark))
        foot = f"{numbers((x * reach * 0.6, y * reach * 0.6, -0.07))} 0 0 0"
        lines.append("        " + part("collision", f"foot_{i}", sphere(0.02), foot) + part("visual", f"foot_{i}", sphere(0.02), foot, dark))
    camera = "<camera><horizontal_fov>1.2</horizontal_fov><image><width>320</width><height>240</height></image><clip><near>0.05</near><far>100</far></clip></camera>"
    lines.append('        <sensor name="imu" type="imu"><update_rate>200</update_rate></sensor>')
    lines.append(f'        <sensor name="camera" type="camera"><update_rate>20</update_rate><pose>0.12 0 0 0 0.5 0</pose>{camera}</sensor>')
    return [*lines, "      </link>"]


def rotors():
    lines, reach = [], arm / math.sqrt(2)
    for i, (x, y, turn) in enumerate(corners):
        disc = cylinder(rotor_radius, 0.005)
        lines.append(f'      <link name="rotor_{i}"><pose>{numbers((x * reach, y * reach, 0.04))} 0 0 0</pose>'
                     f"{inertial(rotor_mass, cylinder_moments(rotor_mass, rotor_radius, 0.005))}"
                     f'{part("visual", "blade", box(2 * rotor_radius, 0.02, 0.006), "", red if x > 0 else grey)}</link>')
        lines.append(f'      <joint name="motor_{i}" type="revolute"><parent>base</parent><child>rotor_{i}</child><axis><xyz>0 0 1</xyz></axis></joint>')
        lines.append('      <plugin filename="gz-sim-multicopter-motor-model-system" name="gz::sim::systems::MulticopterMotorModel">'
                     f"<robotNamespace>quadcopter</robotNamespace><jointName>motor_{i}</jointName><linkName>rotor_{i}</linkName><turningDirection>{turn}</turningDirection>"
                     f"<motorType>velocity</motorType><motorNumber>{i}</motorNumber><motorConstant>{thrust:g}</motorConstant><momentConstant>{moment}</momentConstant>"
                     f"<maxRotVelocity>{fastest}</maxRotVelocity><timeConstantUp>0.0125</timeConstantUp><timeConstantDown>0.025</timeConstantDown>"
                     "<rotorDragCoefficient>8e-05</rotorDragCoefficient><rollingMomentCoefficient>1e-06</rollingMomentCoefficient>"
                     "<rotorVelocitySlowdownSim>10</rotorVelocitySlowdownSim><commandSubTopic>motor_speed</commandSubTopic></plugin>")
    return lines


def control():
    names = "".join(f"<rotor><jointName>motor_{i}</jointName><forceConstant>{thrust:g}</forceConstant><momentConstant>{moment}</momentConstant>"
                    f"<direction>{1 if turn == 'ccw' else -1}</direction></rotor>" for i, (_, _, turn) in enumerate(corners))
    return ['      <plugin filename="gz-sim-multicopter-control-system" name="gz::sim::systems::MulticopterVelocityControl"><robotNamespace>quadcopter</robotNamespace>'
            "<commandSubTopic>cmd_vel</commandSubTopic><enableSubTopic>enable</enableSubTopic><comLinkName>base</comLinkName><velocityGain>2.4 2.4 2.4</velocityGain>"
            "<attitudeGain>1.2 1.2 0.07</attitudeGain><angularRateGain>0.24 0.24 0.09</angularRateGain><maximumLinearAcceleration>2 2 2</maximumLinearAcceleration>"
            f"<maximumLinearVelocity>4 4 2</maximumLinearVelocity><maximumAngularVelocity>2 2 1.5</maximumAngularVelocity><rotorConfiguration>{names}</rotorConfiguration></plugin>"]


if __name__ == "__main__":
    lines = [static("pad", "0 0 0.05 0 0 0", cylinder(0.6, 0.1), grey),
             static("tower_0", "6 0 2.5 0 0 0", cylinder(0.5, 5), paint("0.45 0.5 0.6")), static("tower_1", "6 8 2 0 0 0.4", box(1, 1, 4), paint("0.55 0.45 0.35")),
             '    <model name="quadcopter"><pose>0 0 0.19 0 0 0</pose>', *base(), *rotors(), *control(), "    </model>"]
    (here / "quadcopter.sdf").write_text(world("make_quadcopter.py", "quadcopter", lines, look="    <gravity>0 0 -9.81</gravity>\n"))
