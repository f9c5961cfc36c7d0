#!/usr/bin/env python3
"""Writes a walled arena with N Pioneers with Hokuyo lasers on a grid and a pillar between each four of them.

usage: make_arena.py N [FILE]     (the shipped hundred.sdf: make_arena.py 100 hundred.sdf)
"""
import math
import pathlib
import sys

import sdf_text

if len(sys.argv) not in (2, 3) or not sys.argv[1].isdigit() or int(sys.argv[1]) < 1:
    sys.exit(__doc__)
count = int(sys.argv[1])
spacing = 4.0
side = math.ceil(math.sqrt(count))
half = side * spacing / 2

grey = "<material><diffuse>{0} {0} {0} 1</diffuse></material>"

lines = sdf_text.walls(half, 0.2, 0.6, grey.format(0.8))
for row in range(side - 1):
    for column in range(side - 1):
        x, y = (column + 1) * spacing - half, (row + 1) * spacing - half
        lines.append(sdf_text.static(f"pillar_{row * (side - 1) + column}", f"{sdf_text.numbers((x, y, 0.4))} 0 0 0", sdf_text.cylinder(0.2, 0.8), grey.format(0.5)))
for i in range(count):
    x, y = (i % side + 0.5) * spacing - half, (i // side + 0.5) * spacing - half
    lines.append(sdf_text.include("pioneer2dx_hokuyo", f"pioneer_{i}", f"{sdf_text.numbers((x, y))} 0 0 0 {i * 2.399963 % (2 * math.pi):.4f}"))

text = sdf_text.world(f"make_arena.py {count}", "arena", lines, step=0.005)
if len(sys.argv) == 3:
    pathlib.Path(sys.argv[2]).write_text(text)
else:
    print(text, end="")
