#!/usr/bin/env python3
"""Writes the models of the farm to models/: meshes (OBJ), textures (PNG) and SDFormat, all from the numbers below. Run it after changing one of them.

Lengths in m, masses in kg, angles in rad. x is forward, z up. Everything random comes from a fixed seed, so that a second run writes the same bytes.
"""
import math
import random

from farm_meshes import Joint, Mesh, ground_texture, hide_texture, planks_texture, roof_texture, write_collada, write_png
from sdf_text import box, box_moments, cylinder, here, part, sphere, write_model

models = here / "models"


# --- SDFormat -----------------------------------------------------------------


def mesh(name):
    model = name.split("/")[0]
    return f"<geometry><mesh><uri>model://{model}/meshes/{name.split('/')[1]}.obj</uri></mesh></geometry>"


def write(name, title, description, parts, static=True, inertial="", after=""):
    body = "\n".join(f"      {line}" for line in ([inertial] if inertial else []) + parts)
    state = "    <static>true</static>\n" if static else ""
    write_model("make_farm_models.py", name, title, description, f'  <model name="{name}">\n{state}    <link name="link">\n{body}\n    </link>\n{after}  </model>')


# --- the models ---------------------------------------------------------------


def cow_joints():
    """Walks a metre in a round of steps: hind left, fore left, hind right, fore right."""
    turn = lambda t: 2 * math.pi * t
    hips = Joint("hips", None, (-0.1, 0, 1.0), way=lambda t: (t, 0, 0.012 * math.sin(2 * turn(t))))
    joints = [hips, Joint("neck", hips, (0.70, 0, 1.15), lambda t: (0, 0.06 * math.sin(2 * turn(t)), 0)), Joint("tail_root", hips, (-0.95, 0, 1.29), lambda t: (0.25 * math.sin(turn(t)), 0, 0))]
    for name, x, knee, y, begin, bent in (("hind_left", -0.70, -0.75, 0.2, 0.0, 1), ("fore_left", 0.50, 0.50, 0.2, 0.25, 1), ("hind_right", -0.70, -0.75, -0.2, 0.5, 1), ("fore_right", 0.50, 0.50, -0.2, 0.75, 1)):
        # The foot goes back while it carries, and forward, lifted, while it does not.
        upper = Joint(name, hips, (x, y, 1.0), lambda t, b=begin: (0, 0.27 * math.sin(turn(t - b)), 0))
        lower = Joint(f"{name}_low", upper, (knee, y, 0.55), lambda t, b=begin, s=bent: (0, s * 0.7 * max(0.0, -math.cos(turn(t - b))) ** 1.5, 0))
        joints += [upper, lower]
    return joints


def cow_weights(limb, position):
    smooth = lambda value, none, all: max(0.0, min(1.0, (value - none) / (all - none)))
    x, _, z = position
    if limb == "trunk":
        neck = smooth(x, 0.60, 0.92)
        return [("hips", 1 - neck), ("neck", neck)]
    if limb in ("head", "tail"):
        return [({"head": "neck", "tail": "tail_root"}[limb], 1.0)]
    leg, low = smooth(z, 1.08, 0.92), smooth(z, 0.62, 0.48)
    return [("hips", 1 - leg), (limb, leg - low), (f"{limb}_low", low)]


def cow():
    """2.4 x 0.8 x 1.5 m; the origin is on the ground below the middle."""
    m = Mesh()
    m.limb = "trunk"
    along = lambda *rings: [((x, 0, z), a, b) for x, z, a, b in rings]
    m.loft("hide", along((-0.97, 1.15, 0.08, 0.10), (-0.93, 1.11, 0.20, 0.22), (-0.80, 1.08, 0.30, 0.31), (-0.50, 1.04, 0.37, 0.36), (-0.10, 1.01, 0.40, 0.39),
                         (0.25, 1.03, 0.37, 0.38), (0.50, 1.07, 0.31, 0.35), (0.68, 1.13, 0.23, 0.29), (0.82, 1.22, 0.16, 0.22), (0.95, 1.32, 0.12, 0.16)), 20)
    m.limb = "head"
    m.loft("hide", along((0.90, 1.41, 0.07, 0.07), (0.95, 1.41, 0.13, 0.14), (1.06, 1.37, 0.14, 0.145), (1.20, 1.28, 0.11, 0.11), (1.30, 1.22, 0.095, 0.095)), 14, (0.3, 0.5))
    m.loft("skin", along((1.28, 1.23, 0.097, 0.097), (1.36, 1.18, 0.10, 0.09), (1.41, 1.15, 0.085, 0.075), (1.43, 1.14, 0.04, 0.04)), 14)
    m.loft("white", along((1.02, 1.505, 0.02, 0.01), (1.10, 1.48, 0.045, 0.02), (1.20, 1.38, 0.05, 0.02), (1.29, 1.30, 0.06, 0.02)), 8)  # the blaze
    for side in (-1, 1):
        m.limb = "head"
        m.loft("horn", [((0.97, 0.09 * side, 1.51), 0.035, 0.035), ((0.98, 0.18 * side, 1.55), 0.028, 0.028), ((1.02, 0.22 * side, 1.62), 0.008, 0.008)], 8)
        m.loft("black", [((0.96, 0.11 * side, 1.43), 0.02, 0.03), ((0.95, 0.20 * side, 1.42), 0.025, 0.06), ((0.94, 0.29 * side, 1.39), 0.008, 0.015)], 8)
        m.ellipsoid("black", (1.13, 0.12 * side, 1.39), (0.025, 0.02, 0.03), 6)
        m.ellipsoid("black", (1.405, 0.045 * side, 1.19), (0.02, 0.015, 0.012), 6)
        y, name = 0.20 * side, "left" if side > 0 else "right"
        m.limb = f"fore_{name}"
        m.loft("white", [((0.50, y, 1.00), 0.10, 0.16), ((0.50, y, 0.72), 0.075, 0.10), ((0.50, y, 0.45), 0.06, 0.065), ((0.50, y, 0.10), 0.055, 0.055)], 10)
        m.limb = f"hind_{name}"
        m.loft("white", [((-0.70, y, 1.05), 0.12, 0.22), ((-0.68, y, 0.75), 0.09, 0.14), ((-0.76, y, 0.48), 0.06, 0.07), ((-0.72, y, 0.10), 0.055, 0.055)], 10)
        for x in (0.50, -0.72):
            m.limb = f"fore_{name}" if x > 0 else f"hind_{name}"
            m.loft("black", [((x + 0.01, y, 0.11), 0.06, 0.06), ((x + 0.02, y, 0.0), 0.075, 0.08)], 10)
        m.limb = "trunk"
        for x in (-0.36, -0.50):
            m.loft("skin", [((x, 0.08 * side, 0.66), 0.022, 0.022), ((x, 0.08 * side, 0.56), 0.014, 0.014)], 6)
    m.ellipsoid("skin", (-0.43, 0, 0.70), (0.20, 0.17, 0.11), 10)
    m.limb = "tail"
    m.loft("hide", [((-0.94, 0, 1.30), 0.035, 0.035), ((-1.01, 0, 1.22), 0.03, 0.03), ((-1.04, 0, 0.80), 0.02, 0.02)], 8, (0.2, 0.2))
    m.ellipsoid("black", (-1.04, 0, 0.72), (0.04, 0.04, 0.14), 8)
    folder = models / "cow" / "meshes"
    materials = {"hide": ((1, 1, 1), "hide.png"), "skin": ((0.90, 0.62, 0.58), None), "horn": ((0.85, 0.78, 0.62), None), "white": ((0.88, 0.86, 0.82), None), "black": ((0.05, 0.045, 0.04), None)}
    m.write(folder, "cow", materials)
    write_collada(folder / "walking_cow.dae", m, materials, cow_joints(), cow_weights, 1.25, 20)
    write_png(folder / "hide.png", 256, hide_texture())
    mass, (x, y, z) = 600, (1.9, 0.7, 0.8)
    moments = box_moments(mass, x, y, z)
    inertial = "<inertial><pose>0 0 1 0 0 0</pose><mass>{}</mass><inertia><ixx>{:.4g}</ixx><iyy>{:.4g}</iyy><izz>{:.4g}</izz></inertia></inertial>".format(mass, *moments)
    legs = [part("collision", f"leg_{n}", cylinder(0.075, 0.7), f"{x} {y} 0.35 0 0 0") for n, (x, y) in enumerate(((0.5, 0.2), (0.5, -0.2), (-0.71, 0.2), (-0.71, -0.2)))]
    write("cow", "Cow", "2.4 x 0.8 x 1.5 m, 600 kg, own mesh. A trajectory plugin of the world makes it walk.",
                [part("visual", "cow", mesh("cow/cow")), part("collision", "body", box(1.7, 0.66, 0.66), "-0.13 0 1.04 0 0 0"), part("collision", "head", box(0.55, 0.26, 0.36), "1.15 0 1.32 0 0.5 0"), *legs],
                static=False, inertial=inertial)


def helicopter():
    """1.6 m from nose to tail, rotor of 1.8 m; the origin is in the cabin. Camera under the nose, looking straight down with its upper edge forward."""
    m = Mesh()
    rings = [((0.62, -0.06), 0.05, 0.05), ((0.56, -0.05), 0.14, 0.13), ((0.40, -0.02), 0.22, 0.20), ((0.15, 0), 0.26, 0.25), ((-0.15, 0.03), 0.23, 0.24), ((-0.35, 0.07), 0.14, 0.16),
             ((-0.50, 0.10), 0.065, 0.075), ((-0.80, 0.12), 0.045, 0.05), ((-0.98, 0.13), 0.03, 0.035)]
    m.loft("paint", [((x, 0, z), a, b) for (x, z), a, b in rings], 20)
    m.ellipsoid("glass", (0.30, 0, 0.06), (0.285, 0.215, 0.19), 18)
    m.loft("white", [((-0.86, 0, 0.12), 0.012, 0.09), ((-0.97, 0, 0.28), 0.012, 0.07), ((-1.03, 0, 0.40), 0.010, 0.05)], 10)
    m.box("white", (-0.82, 0, 0.12), (0.12, 0.42, 0.015))
    m.loft("metal", [((-0.02, 0, 0.22), 0.10, 0.10), ((-0.02, 0, 0.32), 0.05, 0.05), ((-0.02, 0, 0.42), 0.025, 0.025)], 10)
    for angle in (0.5, 0.5 + math.pi / 2):
        c, s = math.cos(angle), math.sin(angle)
        a, b = (-s * 0.035, c * 0.035), (c * 0.9, s * 0.9)
        for z, order in ((0.425, 1), (0.417, -1)):
            corners = [(-0.02 - b[0] - a[0], -b[1] - a[1], z), (-0.02 + b[0] - a[0], b[1] - a[1], z), (-0.02 + b[0] + a[0], b[1] + a[1], z), (-0.02 - b[0] + a[0], -b[1] + a[1], z)]
            m.quad("metal", *corners[::order])
    for side in (-1, 1):
        y = 0.24 * side
        m.loft("metal", [((-0.40, y, -0.44), 0.018, 0.018), ((0.42, y, -0.44), 0.018, 0.018), ((0.52, y, -0.40), 0.015, 0.015)], 8)
        for x in (-0.20, 0.25):
            m.loft("metal", [((x, 0.12 * side, -0.18), 0.014, 0.014), ((x, y, -0.44), 0.014, 0.014)], 6)
    m.ellipsoid("metal", (0.42, 0, -0.24), (0.06, 0.06, 0.06), 10)
    folder = models / "helicopter" / "meshes"
    m.write(folder, "helicopter", {"paint": ((0.78, 0.10, 0.08), None), "glass": ((0.10, 0.16, 0.22), None), "white": ((0.92, 0.92, 0.90), None), "metal": ((0.25, 0.26, 0.28), None)})
    disc = "<material><ambient>0.3 0.3 0.3 1</ambient><diffuse>0.3 0.3 0.3 1</diffuse></material><transparency>0.8</transparency><cast_shadows>false</cast_shadows>"
    camera = ('<sensor name="camera" type="camera">\n        <pose>0.42 0 -0.31 0 1.5708 0</pose>\n        <update_rate>30</update_rate>\n        <camera><horizontal_fov>1.0472</horizontal_fov>'
              "<image><width>320</width><height>240</height><format>R8G8B8</format></image><clip><near>0.05</near><far>200</far></clip></camera>\n      </sensor>")
    flight = ('    <!-- Flies by velocity commands (vx, vy, vz, yaw rate) of its iface <name>::position3d and holds its height without one. -->\n'
              '    <plugin name="gz::sim::systems::VelocityControl" filename="gz-sim-velocity-control-system">\n      <max_speed>5</max_speed>\n      <max_acceleration>2</max_acceleration>\n'
              "      <max_yaw_rate>1.5</max_yaw_rate>\n      <max_yaw_acceleration>2</max_yaw_acceleration>\n    </plugin>\n")
    write("helicopter", "Helicopter", "1.6 m, rotor of 1.8 m, flies by velocity commands; camera of 320 x 240, 60 degrees, 30 Hz looking down.",
                ["<gravity>false</gravity>", part("visual", "body", mesh("helicopter/helicopter")), part("visual", "rotor", cylinder(0.9, 0.004), "-0.02 0 0.43 0 0 0", disc),
                 part("visual", "tail_rotor", cylinder(0.15, 0.004), "-1 0.03 0.28 1.5708 0 0", disc), part("collision", "cabin", box(1.05, 0.5, 0.5), "0.1 0 0 0 0 0"),
                 part("collision", "tail", box(0.65, 0.1, 0.1), "-0.7 0 0.12 0 0 0"), part("collision", "skids", box(0.9, 0.52, 0.04), "0.05 0 -0.44 0 0 0"), camera],
                static=False, inertial="<inertial><mass>20</mass><inertia><ixx>1.2</ixx><iyy>3.2</iyy><izz>3.2</izz></inertia></inertial>", after=flight)


def barn():
    """8 x 6 m, walls of 3 m, ridge at 5 m along x; the doors are in the wall towards +x."""
    m = Mesh()
    x, y, wall, ridge, eaves = 4, 3, 3, 5, 0.4
    for s in (-1, 1):
        m.quad("planks", (x * s, -y * s, 0), (x * s, y * s, 0), (x * s, y * s, wall), (x * s, -y * s, wall), (3, 1))
        m.quad("planks", (x * s, y * s, 0), (-x * s, y * s, 0), (-x * s, y * s, wall), (x * s, y * s, wall), (4, 1))
        corners = [m.vertex(p, (s, 0, 0), t) for p, t in (((x * s, -y * s, wall), (0, 0)), ((x * s, y * s, wall), (3, 0)), ((x * s, 0, ridge), (1.5, 1)))]
        m.triangle("planks", *corners)
        drop = eaves * (ridge - wall) / y
        m.quad("roof", (-(x + eaves) * s, -(y + eaves) * s, wall - drop), ((x + eaves) * s, -(y + eaves) * s, wall - drop), ((x + eaves) * s, 0, ridge), (-(x + eaves) * s, 0, ridge), (4, 2))
        m.quad("trim", ((x + eaves) * s, -(y + eaves) * s, wall - drop - 0.01), (-(x + eaves) * s, -(y + eaves) * s, wall - drop - 0.01), (-(x + eaves) * s, 0, ridge - 0.01), ((x + eaves) * s, 0, ridge - 0.01))
    for centre, size in (((x + 0.03, 0, 2.45), (0.06, 2.7, 0.14)), ((x + 0.03, -1.28, 1.2), (0.06, 0.14, 2.4)), ((x + 0.03, 1.28, 1.2), (0.06, 0.14, 2.4)), ((x + 0.03, 0, 1.2), (0.06, 0.14, 2.4)),
                         ((x + 0.03, 0, 3.7), (0.06, 0.9, 0.9))):
        m.box("trim", centre, size)
    folder = models / "barn" / "meshes"
    m.write(folder, "barn", {"planks": ((1, 1, 1), "planks.png"), "roof": ((1, 1, 1), "roof.png"), "trim": ((0.92, 0.90, 0.85), None)})
    write_png(folder / "planks.png", 128, planks_texture("barn", (0.58, 0.12, 0.09), (0.22, 0.04, 0.03), 8))
    write_png(folder / "roof.png", 128, roof_texture)
    write("barn", "Barn", "8 x 6 x 5 m with doors to the east.", [part("visual", "barn", mesh("barn/barn")), part("collision", "walls", box(8, 6, 3), "0 0 1.5 0 0 0"), part("collision", "roof", mesh("barn/barn"))])


def fence():
    """4 m along x, 1.2 m high."""
    m = Mesh()
    for n in range(3):
        m.box("wood", (-2 + 2 * n, 0, 0.6), (0.12, 0.12, 1.2), 0.6)
    for z in (0.35, 0.7, 1.05):
        m.box("wood", (0, 0.07, z), (4, 0.03, 0.12), 0.6)
    folder = models / "fence" / "meshes"
    m.write(folder, "fence", {"wood": ((1, 1, 1), "wood.png")})
    write_png(folder / "wood.png", 64, planks_texture("fence", (0.55, 0.42, 0.28), (0.30, 0.22, 0.14), 3))
    write("fence", "Fence", "Three rails, 4 m long, 1.2 m high.", [part("visual", "fence", mesh("fence/fence")), part("collision", "fence", box(4.1, 0.16, 1.2), "0 0.02 0.6 0 0 0")])


def tree():
    """5 m high, crown of 3.4 m."""
    m = Mesh()
    m.loft("bark", [((0, 0, -0.1), 0.26, 0.26), ((0.02, 0.02, 0.5), 0.18, 0.18), ((0, 0.05, 1.6), 0.15, 0.15), ((0.05, 0, 2.6), 0.10, 0.10)], 9, (4, 2))
    for n, (centre, radius) in enumerate((((0, 0, 3.3), 1.35), ((0.8, 0.3, 2.9), 0.95), ((-0.7, 0.5, 3.0), 1.0), ((0.1, -0.85, 2.9), 0.95), ((0.1, 0.1, 4.1), 0.95))):
        m.ellipsoid("leaves", centre, (radius, radius, 0.85 * radius), 12, 0.22, n)
    folder = models / "tree" / "meshes"
    m.write(folder, "tree", {"bark": ((0.36, 0.26, 0.18), None), "leaves": ((1, 1, 1), "leaves.png")})
    write_png(folder / "leaves.png", 128, ground_texture("leaves", (0.05, 0.17, 0.04), (0.26, 0.46, 0.12), 12))
    write("tree", "Tree", "A broad-leaved tree, 5 m high.", [part("visual", "tree", mesh("tree/tree")), part("collision", "trunk", cylinder(0.18, 2.4), "0 0 1.2 0 0 0"), part("collision", "crown", sphere(1.5), "0 0 3.3 0 0 0")])


def crop_row():
    """8 m along x with a plant every 0.4 m; leaves that nothing collides with."""
    m, rng = Mesh(), random.Random("crops")
    m.loft("soil", [((-4.1, 0, -0.06), 0.28, 0.14), ((4.1, 0, -0.06), 0.28, 0.14)], 8, (10, 1))
    for n in range(21):
        x, y, turn = -4 + 0.4 * n + rng.uniform(-0.05, 0.05), rng.uniform(-0.04, 0.04), rng.uniform(0, math.pi)
        for leaf in range(5):
            angle, reach, height = turn + 2 * math.pi * leaf / 5, rng.uniform(0.22, 0.30), rng.uniform(0.25, 0.42)
            c, s = math.cos(angle), math.sin(angle)
            root, tip = (x, y, 0.04), (x + reach * c, y + reach * s, height * 0.8)
            left, right = ((x + 0.5 * reach * c - 0.07 * k * s, y + 0.5 * reach * s + 0.07 * k * c, height) for k in (1, -1))
            for corners in ((root, right, tip, left), (left, tip, right, root)):
                m.quad("leaf", *corners)
    folder = models / "crop_row" / "meshes"
    m.write(folder, "crop_row", {"soil": ((0.26, 0.17, 0.10), None), "leaf": ((0.25, 0.52, 0.12), None)})
    write("crop_row", "Crop row", "A row of plants, 8 m long.", [part("visual", "row", mesh("crop_row/crop_row"))])


def field():
    """400 x 400 m of grass with a ploughed piece of 10 x 14 m at (10, 0)."""
    m = Mesh()
    m.quad("grass", (-200, -200, 0), (200, -200, 0), (200, 200, 0), (-200, 200, 0), (100, 100))
    m.quad("soil", (5, -7, 0.01), (15, -7, 0.01), (15, 7, 0.01), (5, 7, 0.01), (4, 6))
    folder = models / "field" / "meshes"
    m.write(folder, "field", {"grass": ((1, 1, 1), "grass.png"), "soil": ((1, 1, 1), "soil.png")})
    write_png(folder / "grass.png", 256, ground_texture("grass", (0.13, 0.27, 0.06), (0.36, 0.50, 0.16)))
    write_png(folder / "soil.png", 128, ground_texture("soil", (0.22, 0.14, 0.08), (0.42, 0.29, 0.18), 8))
    write("field", "Field", "Grass, 400 x 400 m, with a ploughed piece.", [part("visual", "field", mesh("field/field")), part("collision", "ground", "<geometry><plane><normal>0 0 1</normal><size>400 400</size></plane></geometry>")])


if __name__ == "__main__":
    for make in (cow, helicopter, barn, fence, tree, crop_row, field):
        make()
