#!/usr/bin/env python3
"""Writes models/tag36h11_N: boards with AprilTags of the family 36h11, which cameras see and detectors of marks (sensor type fiducial) know.

The size of a tag is the edge of its black square; the board is a white module wider on each side. The mark looks along the model's x axis.
"""
import struct
import zlib

import sdf_text

size = 0.2  # [m]
pixels = 24  # of a module: what is between them is filtered
tags = {  # rows of 8 modules from the top, # is black
    0: "######## #..#.#.# ##...#.# ##..#### #.#.#### ##.#..## ####.### ########",
    1: "######## #..#..## ##.#...# #....### ##..#### #.#..#.# ###.##.# ########",
    2: "######## #..#...# ##.##.## #.###### ###.##.# ####.### ###...## ########",
    3: "######## #...##.# ####...# #.##...# #.#.##.# #..##.## ##..#### ########",
}


def png(rows):
    """White with black modules, one module of white around."""
    side = (len(rows) + 2) * pixels
    white = b"\xff" * side
    lines = [white] * pixels
    for row in rows:
        line = b"\xff" * pixels + b"".join((b"\x00" if module == "#" else b"\xff") * pixels for module in row) + b"\xff" * pixels
        lines += [line] * pixels
    lines += [white] * pixels
    data = zlib.compress(b"".join(b"\0" + line for line in lines), 9)

    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", side, side, 8, 0, 0, 0, 0)) + chunk(b"IDAT", data) + chunk(b"IEND", b"")


board = size * 10 / 8
for number, text in tags.items():
    name = f"tag36h11_{number}"
    shape = sdf_text.box(0.01, board, board)
    look = f"<material><diffuse>1 1 1 1</diffuse><specular>0 0 0 1</specular><pbr><metal><albedo_map>model://{name}/tag.png</albedo_map><roughness>1</roughness><metalness>0</metalness></metal></pbr></material>"
    sdf_text.write_model("make_tags.py", name, f"AprilTag 36h11 {number}", f"Board with the AprilTag {number} of the family 36h11: {size:g} m from edge to edge of its black square, seen from +x.",
                         f"""  <model name="{name}">
    <static>true</static>
    <link name="board">
      {sdf_text.part("collision", "collision", shape, "-0.005 0 0 0 0 0")}
      {sdf_text.part("visual", "tag", shape, "-0.005 0 0 0 0 0", look)}
    </link>
    <plugin filename="rtmsim-fiducial" name="rtmsim::Fiducial"><id>{number}</id><size>{size:g}</size></plugin>
  </model>""")
    (sdf_text.here / "models" / name / "tag.png").write_bytes(png(text.split()))
