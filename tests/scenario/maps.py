# Occupancy maps of worlds: simctl map. One case per run: maps.py CASE BIN_DIR SOURCE_DIR.
import json
import math

import pixels
from server_rig import *

ground = "<include><uri>model://ground_plane</uri></include>"


def model(name, pose, shape, is_static=True):
    return f"<model name='{name}'><static>{str(is_static).lower()}</static><pose>{pose}</pose><link name='l'><collision name='c'><geometry>{shape}</geometry></collision></link></model>"


def box(name, pose, size, **more):
    return model(name, pose, f"<box><size>{size}</size></box>", **more)


def simulated(*content):
    path = f"{work.name}/{len(running)}.sdf"
    with open(path, "w") as file:
        file.write(f"<sdf version='1.9'><world name='w'>{''.join(content)}</world></sdf>")
    return started("--paused", world=path)


def mapped(*options, name="map"):
    """What simctl reports, and the cells from the bottom row up."""
    said = read("map", f"{work.name}/{name}.png", *options)
    width, height, octets = pixels.png(f"{work.name}/{name}.png", channels=1)
    assert (width, height) == (said["width"], said["height"]), said
    rows = [octets[y * width : (y + 1) * width] for y in range(height)][::-1]
    return said, rows


def occupied(rows):
    return {(x, y) for y, row in enumerate(rows) for x, value in enumerate(row) if value == 0}


# The worked number: 1 x 1 m at (2, 3) are 400 cells of 5 cm. Movable models, and what is above the heights or below them, do not count.
def box_is_400_cells():
    simulated(ground, box("crate", "2 3 0.5 0 0 0", "1 1 1"), box("shelf", "2.5 2.5 2 0 0 0", "9 9 0.1"), box("mat", "2 3 0.01 0 0 0", "3 3 0.02"),
              box("cart", "1.2 2.2 0.2 0 0 0", "0.3 0.3 0.3", is_static=False))
    said, rows = mapped("--area", "1", "2", "3", "4")
    assert (said["width"], said["height"], said["occupied"], said["free"], said["unknown"]) == (40, 40, 400, 1200, 0), said
    assert occupied(rows) == {(x, y) for x in range(10, 30) for y in range(10, 30)}
    said, rows = mapped("--area", "1", "2", "3", "4", "--all")
    assert said["occupied"] == 400 + 36, said
    said, _ = mapped("--area", "1", "2", "3", "4", "--heights", "1.8", "2.2")
    assert said["occupied"] == 1600, said
    # Without an area: what stands, and half a metre around.
    said, _ = mapped("--resolution", "0.1")
    assert (said["width"], said["height"], said["occupied"]) == (20, 20, 100) and close(said["origin"], (1, 2, 0)), said


def close(got, wanted):
    return len(got) == len(wanted) and all(abs(a - b) < 1e-9 for a, b in zip(got, wanted))


# As map_server reads them: 0 occupied, 254 free, 205 unknown where nothing is below; the origin is the corner of the lower left cell.
def map_server_reads_it():
    simulated(box("floor", "0 0 -0.05 0 0 0", "2 2 0.1"), box("wall", "0.5 0 0.5 0 0 0", "0.2 2 1"), model("pillar", "-0.5 0.5 0.5 0 0 0", "<cylinder><radius>0.3</radius><length>1</length></cylinder>"))
    said, rows = mapped("--area", "-2", "-2", "2", "2")
    values = {value: sum(row.count(value) for row in rows) for value in (0, 205, 254)}
    assert values[205] == 80 * 80 - 40 * 40 and sum(values.values()) == 80 * 80, values
    wall = {(x, y) for x in range(48, 52) for y in range(20, 60)}
    assert wall <= occupied(rows)
    pillar = occupied(rows) - wall
    area = math.pi * 0.3**2 / 0.05**2
    assert area * 0.97 < len(pillar) < area * 1.4 and all(y > 40 and x < 40 for x, y in pillar), len(pillar)
    with open(f"{work.name}/map.yaml") as file:
        lines = dict(line.strip().split(": ", 1) for line in file)
    assert lines == {"image": '"map.png"', "mode": "trinary", "resolution": "0.05", "origin": "[-2, -2, 0]", "negate": "0", "occupied_thresh": "0.65", "free_thresh": "0.196"}, lines
    assert json.loads(lines["image"]) == "map.png"


# A wall without thickness, a turned one, and the inside of a mesh.
def thin_and_turned():
    simulated(ground, box("thin", "0 0 0.5 0 0 0", "0.000001 1 1"), box("turned", "2 0 0.5 0 0 0.7853981633974483", "1 0.2 1"))
    said, rows = mapped("--area", "-1", "-1", "1", "1")
    cells = occupied(rows)
    assert {y for _, y in cells} == set(range(10, 30)) and {x for x, _ in cells} <= {19, 20} and len(cells) <= 40, cells
    said, rows = mapped("--area", "1", "-1", "3", "1")
    assert 80 <= said["occupied"] <= 80 + 2 * 1.2 / 0.05 * 1.5, said


# The map of a world is a floor plan: the world that includes it has the same map.
def map_is_a_floor_plan():
    first = started(world=course)
    said, rows = mapped("--area", "-5", "-5", "5", "5", name="course")
    assert said["occupied"] > 100, said
    first.terminate()
    first.wait()
    simulated(ground, f"<include><uri>{work.name}/course.png</uri><name>walls</name><resolution>0.05</resolution></include>")
    assert occupied(mapped("--area", "-5", "-5", "5", "5")[1]) == occupied(rows)


def bad_input():
    simulated(ground)
    refused("map", f"{work.name}/map.png", says="no static model is between 0.05 and 0.5 m")
    refused("map", f"{work.name}/map.png", "--area", "0", "0", "100", "100", "--resolution", "0.001", says="at most 8192 a side")
    refused("map", f"{work.name}/no/map.png", "--area", "0", "0", "1", "1", says="no/map.png")
    for words in (["map.pgm"], ["map.png", "--heights", "1", "0.5"], ["map.png", "--area", "1", "1", "0", "0"], ["map.png", "--area", "1", "1"], ["map.png", "--resolution", "0"]):
        refused("map", *words, code=2)
    said, _ = mapped("--area", "0", "0", "1", "1")
    assert (said["occupied"], said["free"]) == (0, 400), said


run(box_is_400_cells, map_server_reads_it, thin_and_turned, map_is_a_floor_plan, bad_input)
