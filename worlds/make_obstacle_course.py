#!/usr/bin/env python3
"""Writes obstacle_course.sdf: an arena of 12 x 12 m with boxes and cylinders scattered in it, and a Pioneer 2-DX with a Hokuyo at the start."""
import math
import random

import sdf_text

size, wall_height, wall = 12.0, 0.6, 0.15
colours = [(0.80, 0.25, 0.20), (0.20, 0.45, 0.75), (0.25, 0.60, 0.30), (0.85, 0.65, 0.15), (0.50, 0.35, 0.60)]
random.seed(7)


half = size / 2
lines = sdf_text.walls(half, wall, wall_height, sdf_text.paint("0.82 0.8 0.74"))

# Obstacles keep 1.4 m between their centres and 1.5 m from the start at (-4.5, -4.5), so that the robot fits through everywhere.
placed = [(-4.5, -4.5)]
count = 0
while count < 24:
    x, y = random.uniform(-half + 1.0, half - 1.0), random.uniform(-half + 1.0, half - 1.0)
    if any(math.hypot(x - a, y - b) < (1.9 if i == 0 else 1.5) for i, (a, b) in enumerate(placed)):
        continue
    placed.append((x, y))
    height = random.uniform(0.4, 0.9)
    rgb = sdf_text.numbers(colours[count % len(colours)])
    if count % 2 == 0:
        shape = sdf_text.box(round(random.uniform(0.25, 0.6), 2), round(random.uniform(0.25, 0.6), 2), round(height, 2))
        name = f"box_{count // 2}"
    else:
        shape = f"<geometry><cylinder><radius>{random.uniform(0.12, 0.3):.2f}</radius><length>{height:.2f}</length></cylinder></geometry>"
        name = f"cylinder_{count // 2}"
    lines.append(sdf_text.static(name, f"{x:.2f} {y:.2f} {round(height, 2) / 2:g} 0 0 {random.uniform(0, 3):.2f}", shape, sdf_text.paint(rgb)))
    count += 1

robot = """    <include>
      <uri>model://pioneer2dx_hokuyo</uri>
      <name>pioneer2dx</name>
      <pose>-4.5 -4.5 0 0 0 0.785</pose>
    </include>"""
(sdf_text.here / "obstacle_course.sdf").write_text(
    sdf_text.world("make_obstacle_course.py", "obstacle_course", [robot, *lines], look=sdf_text.scene("0.6 0.6 0.6", "0.7 0.78 0.88")))
