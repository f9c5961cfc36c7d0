#!/usr/bin/env python3
"""Writes obstacle_course.sdf: an arena of 12 x 12 m with boxes and cylinders scattered in it, and a Pioneer 2-DX with a Hokuyo at the start."""
import math
import pathlib
import random

size, wall_height, wall = 12.0, 0.6, 0.15
colours = [(0.80, 0.25, 0.20), (0.20, 0.45, 0.75), (0.25, 0.60, 0.30), (0.85, 0.65, 0.15), (0.50, 0.35, 0.60)]
random.seed(7)


def material(rgb):
    text = " ".join(f"{c:g}" for c in rgb)
    return f"<material><ambient>{text} 1</ambient><diffuse>{text} 1</diffuse></material>"


def model(name, pose, geometry, rgb):
    shape = f"<geometry>{geometry}</geometry>"
    return (f'    <model name="{name}"><static>true</static><pose>{pose}</pose><link name="link"><collision name="collision">{shape}</collision>'
            f'<visual name="visual">{shape}{material(rgb)}</visual></link></model>')


def box(x, y, z):
    return f"<box><size>{x:g} {y:g} {z:g}</size></box>"


lines = []
half = size / 2
for name, x, y, sx, sy in [("north", 0, half, size + wall, wall), ("south", 0, -half, size + wall, wall), ("east", half, 0, wall, size - wall),
                           ("west", -half, 0, wall, size - wall)]:
    lines.append(model(f"wall_{name}", f"{x:g} {y:g} {wall_height / 2:g} 0 0 0", box(sx, sy, wall_height), (0.82, 0.80, 0.74)))

# Obstacles keep 1.4 m between their centres and 1.5 m from the start at (-4.5, -4.5), so that the robot fits through everywhere.
placed = [(-4.5, -4.5)]
count = 0
while count < 24:
    x, y = random.uniform(-half + 1.0, half - 1.0), random.uniform(-half + 1.0, half - 1.0)
    if any(math.hypot(x - a, y - b) < (1.9 if i == 0 else 1.5) for i, (a, b) in enumerate(placed)):
        continue
    placed.append((x, y))
    height = random.uniform(0.4, 0.9)
    rgb = colours[count % len(colours)]
    if count % 2 == 0:
        geometry = box(round(random.uniform(0.25, 0.6), 2), round(random.uniform(0.25, 0.6), 2), round(height, 2))
        name = f"box_{count // 2}"
    else:
        geometry = f"<cylinder><radius>{random.uniform(0.12, 0.3):.2f}</radius><length>{height:.2f}</length></cylinder>"
        name = f"cylinder_{count // 2}"
    lines.append(model(name, f"{x:.2f} {y:.2f} {round(height, 2) / 2:g} 0 0 {random.uniform(0, 3):.2f}", geometry, rgb))
    count += 1

newline = "\n"
pathlib.Path(__file__).resolve().with_name("obstacle_course.sdf").write_text(f"""<?xml version="1.0"?>
<!-- Written by worlds/make_obstacle_course.py. -->
<sdf version="1.9">
  <world name="obstacle_course">
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
    <include>
      <uri>model://pioneer2dx_hokuyo</uri>
      <name>pioneer2dx</name>
      <pose>-4.5 -4.5 0 0 0 0.785</pose>
    </include>
{newline.join(lines)}
  </world>
</sdf>
""")
