#!/usr/bin/env python3
"""Writes farm.sdf: a pasture with a cow that walks her round, a calf on the way beside it, a field with crop rows, a barn, trees, and a helicopter above with a camera that looks down."""
import math

import sdf_text

cow_speed, helicopter_height, share = 0.8, 7, 0.6
centre = (-1, 0)
cow_way = [(-4.5, -2.5), (2, -3), (3, 1), (0.5, 3.2), (-4.5, 2.5)]
corner = 1.5


def include(model, name, x, y, z=0.0, yaw=0.0, more=""):
    return sdf_text.include(model, name, f"{x:g} {y:g} {z:g} 0 0 {yaw:.4g}", more)


def way(points, speed, radius):
    text = "".join(f"<waypoint>{' '.join(f'{c:g}' for c in point)}</waypoint>" for point in points)
    return (f'\n      <plugin name="gz::sim::systems::TrajectoryFollower" filename="gz-sim-trajectory-follower-system"><loop>true</loop><speed>{speed:g}</speed>'
            f"<corner_radius>{radius:g}</corner_radius><waypoints>{text}</waypoints></plugin>\n    ")


# The helicopter flies the same round, smaller and slower by the same share, so it is always near the cow, who walks about in its picture.
flight = [(centre[0] + (x - centre[0]) * share, centre[1] + (y - centre[1]) * share, helicopter_height) for x, y in cow_way]
heading = math.atan2(cow_way[1][1] - cow_way[0][1], cow_way[1][0] - cow_way[0][0])

lines = [include("cow", "cow", *cow_way[0], yaw=heading, more=way(cow_way, cow_speed, corner)),
         include("helicopter", "helicopter", *flight[0], yaw=heading, more=way(flight, cow_speed * share, corner * share)),
         include("barn", "barn", -12, 10, yaw=-0.5)]
panels = [(x, y, 0) for y in (-6, 6) for x in (-6, -2, 2)] + [(x, y, math.pi / 2) for x in (-8, 4) for y in (-4, 0, 4)]
panels.remove((2, 6, 0))  # the gate
lines += [include("fence", f"fence_{n}", x, y, 0, yaw) for n, (x, y, yaw) in enumerate(panels)]
lines += [include("crop_row", f"crop_row_{n}", 10, -5.4 + 1.2 * n) for n in range(10)]
trees = [(-14, -3, 0.3), (-12, -8, 1.9), (-4, 11, 0.9), (1, 12.5, 2.6), (7, 11, 1.2), (15, 10, 0.4), (-2, -11, 2.1), (8, -11, 0)]
lines += [include("tree", f"tree_{n}", x, y, 0, yaw) for n, (x, y, yaw) in enumerate(trees)]

# A calf walks up and down before the fence: an actor, whose legs move by the animation of its skin.
calf_speed, calf_scale, west, east, near, far = 0.6, 0.55, -7, 5, -9.1, -7.7
turn = (far - near) / 2
corner_step = 0.6  # places close to the bends keep the curve through them round
line = [(west, far, 0), (west + corner_step, far, 0)] + [(x, far, 0) for x in range(west + 2, east, 2)] + [(east - corner_step, far, 0)]
bend = lambda x, start, way: [(x + turn * math.cos(start + way * k * math.pi / 4), (near + far) / 2 + turn * math.sin(start + way * k * math.pi / 4), start + way * k * math.pi / 4 + way * math.pi / 2) for k in range(5)]
back = [(x, near, -math.pi) for x in (east - corner_step, *range(east - 2, west, -2), west + corner_step)]
round_trip = line + bend(east, math.pi / 2, -1) + back + bend(west, -math.pi / 2, -1)
time, stops = 0.0, []
for n, (x, y, yaw) in enumerate(round_trip):
    if n:
        time += math.dist(round_trip[n - 1][:2], (x, y)) / calf_speed
    stops.append(f"          <waypoint><time>{time:.2f}</time><pose>{x:.3f} {y:.3f} 0 0 0 {yaw:.4f}</pose></waypoint>")
cow_mesh = "model://cow/meshes/walking_cow.dae"
lines.append(f"""    <actor name="calf">
      <pose>{west} {far} 0 0 0 0</pose>
      <skin><filename>{cow_mesh}</filename><scale>{calf_scale}</scale></skin>
      <animation name="walking"><filename>{cow_mesh}</filename><scale>{calf_scale}</scale><interpolate_x>true</interpolate_x></animation>
      <script>
        <trajectory id="0" type="walking">
""" + "\n".join(stops) + """
        </trajectory>
      </script>
    </actor>""")

(sdf_text.here / "farm.sdf").write_text(
    sdf_text.world("make_farm.py", "farm", lines, look=sdf_text.scene("0.55 0.55 0.58", "0.62 0.78 0.94", "      <sky/>\n"), ground="field"))
