#!/usr/bin/env python3
"""Writes a walled arena with N Pioneers with Hokuyo lasers on a grid and a pillar between each four of them.

usage: make_arena.py N [FILE]     (the shipped hundred.sdf: make_arena.py 100 hundred.sdf)
"""
import math
import pathlib
import sys

if len(sys.argv) not in (2, 3) or not sys.argv[1].isdigit() or int(sys.argv[1]) < 1:
    sys.exit(__doc__)
count = int(sys.argv[1])
spacing = 4.0
side = math.ceil(math.sqrt(count))
half = side * spacing / 2


def static(name, x, y, z, geometry, grey):
    shape = f"<geometry>{geometry}</geometry>"
    return (f'    <model name="{name}"><static>true</static><pose>{x:g} {y:g} {z:g} 0 0 0</pose><link name="link"><collision name="collision">{shape}</collision>'
            f'<visual name="visual">{shape}<material><diffuse>{grey} {grey} {grey} 1</diffuse></material></visual></link></model>')


lines = []
for name, x, y, sx, sy in [("north", 0, half, 2 * half + 0.2, 0.2), ("south", 0, -half, 2 * half + 0.2, 0.2), ("east", half, 0, 0.2, 2 * half - 0.2),
                           ("west", -half, 0, 0.2, 2 * half - 0.2)]:
    lines.append(static(f"wall_{name}", x, y, 0.3, f"<box><size>{sx:g} {sy:g} 0.6</size></box>", 0.8))
for row in range(side - 1):
    for column in range(side - 1):
        x, y = (column + 1) * spacing - half, (row + 1) * spacing - half
        lines.append(static(f"pillar_{row * (side - 1) + column}", x, y, 0.4, "<cylinder><radius>0.2</radius><length>0.8</length></cylinder>", 0.5))
for i in range(count):
    x, y = (i % side + 0.5) * spacing - half, (i // side + 0.5) * spacing - half
    lines.append(f"    <include><uri>model://pioneer2dx_hokuyo</uri><name>pioneer_{i}</name><pose>{x:g} {y:g} 0 0 0 {i * 2.399963 % (2 * math.pi):.4f}</pose></include>")

newline = "\n"
text = f"""<?xml version="1.0"?>
<!-- Written by worlds/make_arena.py {count}. -->
<sdf version="1.9">
  <world name="arena">
    <physics name="default" type="ode">
      <max_step_size>0.005</max_step_size>
      <real_time_factor>1</real_time_factor>
    </physics>
    <include><uri>model://sun</uri></include>
    <include><uri>model://ground_plane</uri></include>
{newline.join(lines)}
  </world>
</sdf>
"""
if len(sys.argv) == 3:
    pathlib.Path(sys.argv[2]).write_text(text)
else:
    print(text, end="")
