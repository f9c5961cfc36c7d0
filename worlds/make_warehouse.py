#!/usr/bin/env python3
"""Writes warehouse.sdf, a hall with 50 robots that stand before boxes, a lane and a door for each, and what systems/warehouse.xml has to
reach in it: systems/warehouse.expect.yaml."""
import sdf_text
from sdf_text import box, number, part, static

lanes, pitch = 25, 0.9           # on each side
start, door, way = 3.2, 12, 7.5  # [m] of robots and doors from the middle; distance of the parameters of Porter
size = (0.3, 0.4, 0.2)           # of a box

grey, wood, steel = sdf_text.paint("0.75 0.76 0.78"), sdf_text.paint("0.66 0.47 0.28"), sdf_text.paint("0.25 0.35 0.5")
yellow = sdf_text.paint("0.9 0.75 0.15")


# A blade before the robot with an arm on each side, between which the box stays.
def fork():
    parts = [(box(0.02, 0.48, 0.1), "0.2 0 0.09 0 0 0"), (box(0.3, 0.02, 0.06), "0.35 0.235 0.09 0 0 0"), (box(0.3, 0.02, 0.06), "0.35 -0.235 0.09 0 0 0")]
    shapes = "".join(part("collision", f"collision_{i}", shape, pose, "<surface><friction><ode><mu>0.2</mu><mu2>0.2</mu2></ode></friction></surface>")
                     + part("visual", f"visual_{i}", shape, pose, yellow) for i, (shape, pose) in enumerate(parts))
    return (f'<link name="fork"><pose relative_to="chassis">0 0 0 0 0 0</pose><inertial><pose>0.28 0 0.09 0 0 0</pose><mass>0.4</mass>'
            f"<inertia><ixx>0.008</ixx><iyy>0.004</iyy><izz>0.012</izz></inertia></inertial>{shapes}</link>"
            f'<joint name="fork_joint" type="fixed"><parent>chassis</parent><child>fork</child></joint>')


def porter(i, x, y, yaw):
    return (f'    <model name="porter_{i}"><pose>{sdf_text.numbers((x, y))} 0 0 0 {number(yaw)}</pose>'
            f"<include merge=\"true\"><uri>model://pioneer2dx_sick</uri></include>{fork()}</model>")


def load(i, x, y):
    mass = 2
    moments = sdf_text.box_moments(mass, *size)
    inertia = f"<inertia><ixx>{number(moments[0])}</ixx><iyy>{number(moments[1])}</iyy><izz>{number(moments[2])}</izz></inertia>"
    surface = "<surface><friction><ode><mu>0.4</mu><mu2>0.4</mu2></ode></friction></surface>"
    return (f'    <model name="box_{i}"><pose>{sdf_text.numbers((x, y, size[2] / 2))} 0 0 0</pose><link name="link"><inertial><mass>{mass}</mass>{inertia}</inertial>'
            f'{part("collision", "collision", box(*size), "", surface)}{part("visual", "visual", box(*size), "", wood)}</link></model>')


lines, expectations = [], []
half = lanes * pitch / 2
for side, way_out in (("east", 1), ("west", -1)):
    for lane in range(lanes):
        i = lane + (lanes if way_out < 0 else 0)
        y = round(lane * pitch - half + pitch / 2, 3)
        lines += [porter(i, way_out * start, y, 0 if way_out > 0 else 3.141593), load(i, way_out * (start + 0.4), y)]
        near, far = sorted((way_out * (start + way), way_out * (start + way + 1)))
        expectations += [f"- no_contact: {{model: porter_{i}, except: [ground_plane, box_{i}]}}",
                         f"- reach: {{model: box_{i}, region: [{number(near)}, {number(y - pitch / 2)}, {number(far)}, {number(y + pitch / 2)}], within: 50}}"]
    for post in range(lanes + 1):
        y = post * pitch - half
        lines.append(static(f"post_{side}_{post}", f"{sdf_text.numbers((way_out * door, y, 0.5))} 0 0 0", box(0.08, 0.08, 1), grey))
    lines.append(static(f"lintel_{side}", f"{sdf_text.numbers((way_out * door, 0, 1.15))} 0 0 0", box(0.12, 2 * half + 0.12, 0.3), yellow))
for i in range(6):
    lines.append(static(f"rack_{i}", f"{sdf_text.numbers((0, (i - 2.5) * 3.6, 0.6))} 0 0 0", box(2.4, 2.4, 1.2), steel))

(sdf_text.here / "warehouse.sdf").write_text(
    sdf_text.world("make_warehouse.py", "warehouse", lines, step=0.005, look=sdf_text.scene("0.6 0.6 0.6", "0.7 0.78 0.88")))
(sdf_text.here / "systems/warehouse.expect.yaml").write_text("# Written by worlds/make_warehouse.py.\n" + "\n".join(expectations) + "\n")
