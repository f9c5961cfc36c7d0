"""Textures (PNG) and meshes (OBJ, COLLADA with limbs) for make_farm_models.py."""
import math
import random
import struct
import zlib

newline = "\n"


# --- textures -----------------------------------------------------------------


def write_png(path, size, colour_of):
    """A square RGB image; colour_of(u, v) with u, v in [0, 1) gives r, g, b in [0, 1]."""
    rows = bytearray()
    for y in range(size):
        rows.append(0)
        for x in range(size):
            rows.extend(max(0, min(255, round(255 * c))) for c in colour_of(x / size, y / size))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", size, size, 8, 2, 0, 0, 0)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(bytes(rows), 9)) + chunk(b"IEND", b""))


def noise(seed, cells):
    """Smooth noise in [0, 1] over the unit square that fits to itself on all sides, from a lattice of cells x cells."""
    rng = random.Random(seed)
    lattice = [[rng.random() for _ in range(cells)] for _ in range(cells)]

    def at(u, v):
        x, y = u * cells, v * cells
        i, j = math.floor(x), math.floor(y)
        s, t = (f * f * (3 - 2 * f) for f in (x - i, y - j))
        a, b = lattice[j % cells], lattice[(j + 1) % cells]
        i, k = i % cells, (i + 1) % cells
        return (a[i] * (1 - s) + a[k] * s) * (1 - t) + (b[i] * (1 - s) + b[k] * s) * t

    return at


def layered(seed, cells, octaves=4):
    layers = [(noise(f"{seed}{n}", cells * 2**n), 0.5**n) for n in range(octaves)]
    total = sum(weight for _, weight in layers)
    return lambda u, v: sum(weight * layer(u, v) for layer, weight in layers) / total


def blend(a, b, t):
    t = max(0.0, min(1.0, t))
    return tuple(x + (y - x) * t for x, y in zip(a, b))


def ground_texture(seed, dark, light, cells=6):
    rough = layered(seed, cells, 5)
    return lambda u, v: blend(dark, light, 2.2 * rough(u, v) - 0.6)


def hide_texture():
    patches, hair = layered("hide", 4, 3), layered("hair", 24, 2)
    return lambda u, v: blend(blend((0.93, 0.91, 0.87), (0.84, 0.82, 0.78), hair(u, v)), (0.06, 0.05, 0.05), 40 * (patches(u, v) - 0.56))


def planks_texture(seed, base, gap, count):
    grain, tones = noise(seed, 64), random.Random(seed)
    shades = [0.85 + 0.3 * tones.random() for _ in range(count)]

    def at(u, v):
        across = u * count
        if across % 1 < 0.06:
            return gap
        streak = 0.88 + 0.24 * grain(u, v / 16)
        return tuple(c * streak * shades[int(across)] for c in base)

    return at


def roof_texture(u, v):
    row = v * 8
    across = (u * 12 + (0.5 if int(row) % 2 else 0)) % 1
    shade = 0.7 + 0.3 * (row % 1)
    return tuple(c * shade * (0.75 if across < 0.05 else 1) for c in (0.42, 0.30, 0.26))


# --- meshes -------------------------------------------------------------------


def add(a, b):
    return tuple(x + y for x, y in zip(a, b))


def sub(a, b):
    return tuple(x - y for x, y in zip(a, b))


def mul(a, s):
    return tuple(x * s for x in a)


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    length = math.sqrt(sum(x * x for x in a))
    return mul(a, 1 / length) if length > 1e-12 else (0.0, 0.0, 1.0)


class Mesh:
    """Triangles by material. A vertex is a position, a normal and texture coordinates."""

    def __init__(self):
        self.vertices, self.faces = [], {}
        self.limb, self.limbs = None, []  # limb of the next vertices; limb of each vertex

    def vertex(self, position, normal, uv=(0, 0)):
        self.vertices.append((position, normal, uv))
        self.limbs.append(self.limb)
        return len(self.vertices)

    def triangle(self, material, *corners):
        self.faces.setdefault(material, []).append(corners)

    def grid(self, material, rows, uv_scale=(1, 1)):
        """A tube through closed rings of points; smooth. The rings run anti-clockwise seen from the tube's end."""
        count = len(rows[0])
        index = []
        for i, row in enumerate(rows):
            before, after = rows[max(i - 1, 0)], rows[min(i + 1, len(rows) - 1)]
            line = []
            for k in range(count + 1):
                p = k % count
                around = sub(row[(p + 1) % count], row[p - 1])
                normal = unit(cross(around, sub(after[p], before[p])))
                line.append(self.vertex(row[p], normal, (uv_scale[0] * i / (len(rows) - 1), uv_scale[1] * k / count)))
            index.append(line)
        for a, b in zip(index, index[1:]):
            for k in range(count):
                self.triangle(material, a[k], a[k + 1], b[k + 1])
                self.triangle(material, a[k], b[k + 1], b[k])

    def loft(self, material, rings, count=12, uv_scale=(1, 1)):
        """An elliptic tube; rings = [(centre, half width, half height)], closed at both ends."""
        rings = [(rings[0][0], 1e-4, 1e-4), *rings, (rings[-1][0], 1e-4, 1e-4)]
        rows = []
        for i, (centre, a, b) in enumerate(rings):
            tangent = unit(sub(rings[min(i + 1, len(rings) - 1)][0], rings[max(i - 1, 0)][0]))
            side = unit(cross((0, 0, 1) if abs(tangent[2]) < 0.9 else (1, 0, 0), tangent))
            up = cross(tangent, side)
            angles = (2 * math.pi * k / count for k in range(count))
            rows.append([add(centre, add(mul(side, a * math.cos(t)), mul(up, b * math.sin(t)))) for t in angles])
        self.grid(material, rows, uv_scale)

    def ellipsoid(self, material, centre, radii, count=10, lumps=0.0, seed=0):
        rng = random.Random(seed)
        rows = []
        for i in range(count // 2 + 1):
            polar = math.pi * (1 - i / (count // 2))
            ring = []
            for k in range(count):
                azimuth, r = 2 * math.pi * k / count, 1 + lumps * (rng.random() - 0.5)
                ring.append(add(centre, (radii[0] * r * math.sin(polar) * math.cos(azimuth), radii[1] * r * math.sin(polar) * math.sin(azimuth), radii[2] * math.cos(polar))))
            rows.append(ring)
        self.grid(material, rows, (2, 2))

    def quad(self, material, a, b, c, d, uv=(1, 1)):
        """A flat piece, anti-clockwise from its front; uv = how often the texture repeats along ab and bc."""
        normal = unit(cross(sub(b, a), sub(d, a)))
        corners = [self.vertex(p, normal, t) for p, t in zip((a, b, c, d), ((0, 0), (uv[0], 0), uv, (0, uv[1])))]
        self.triangle(material, *corners[:3])
        self.triangle(material, corners[0], *corners[2:])

    def box(self, material, centre, size, repeat=1.0):
        """uv repeats every `repeat` metres."""
        x, y, z = (s / 2 for s in size)
        sx, sy, sz = (s / repeat for s in size)
        at = lambda *p: add(centre, p)
        self.quad(material, at(x, -y, -z), at(x, y, -z), at(x, y, z), at(x, -y, z), (sy, sz))
        self.quad(material, at(-x, y, -z), at(-x, -y, -z), at(-x, -y, z), at(-x, y, z), (sy, sz))
        self.quad(material, at(x, y, -z), at(-x, y, -z), at(-x, y, z), at(x, y, z), (sx, sz))
        self.quad(material, at(-x, -y, -z), at(x, -y, -z), at(x, -y, z), at(-x, -y, z), (sx, sz))
        self.quad(material, at(-x, -y, z), at(x, -y, z), at(x, y, z), at(-x, y, z), (sx, sy))
        self.quad(material, at(-x, y, -z), at(x, y, -z), at(x, -y, -z), at(-x, -y, -z), (sx, sy))

    def write(self, folder, name, materials):
        """materials = {name: (colour, texture file or None)}"""
        folder.mkdir(parents=True, exist_ok=True)
        text = ["# Written by worlds/make_farm_models.py.", f"mtllib {name}.mtl"]
        text += ["v {:.4f} {:.4f} {:.4f}".format(*p) for p, _, _ in self.vertices]
        text += ["vt {:.3f} {:.3f}".format(*t) for _, _, t in self.vertices]
        text += ["vn {:.3f} {:.3f} {:.3f}".format(*n) for _, n, _ in self.vertices]
        for material, faces in self.faces.items():
            text.append(f"usemtl {material}")
            text += ["f " + " ".join(f"{i}/{i}/{i}" for i in face) for face in faces]
        (folder / f"{name}.obj").write_text("\n".join(text) + "\n")
        lines = ["# Written by worlds/make_farm_models.py."]
        for material in self.faces:
            (r, g, b), picture = materials[material]
            lines += [f"newmtl {material}", f"Ka {r} {g} {b}", f"Kd {r} {g} {b}", "Ks 0.05 0.05 0.05", "Ns 10"]
            if picture:
                lines.append(f"map_Kd {picture}")
        (folder / f"{name}.mtl").write_text("\n".join(lines) + "\n")


# --- meshes with limbs ----------------------------------------------------------


class Joint:
    """A joint of a skeleton at a position in the mesh. angles(t), t in [0, 1), is its roll, pitch and yaw during a round of steps, way(t) its offset from that position."""

    def __init__(self, name, parent, place, angles=lambda t: (0, 0, 0), way=lambda t: (0, 0, 0)):
        self.name, self.parent, self.place, self.angles, self.way = name, parent, place, angles, way

    def matrix(self, t=None):
        """The transform in its parent, row by row; without a time that at rest."""
        x, y, z = sub(self.place, self.parent.place if self.parent else (0, 0, 0))
        if t is None:
            return [1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z, 0, 0, 0, 1]
        r, p, w = self.angles(t)
        x, y, z = add((x, y, z), self.way(t))
        (cr, sr), (cp, sp), (cw, sw) = ((math.cos(a), math.sin(a)) for a in (r, p, w))
        return [cw * cp, cw * sp * sr - sw * cr, cw * sp * cr + sw * sr, x, sw * cp, sw * sp * sr + cw * cr, sw * sp * cr - cw * sr, y, -sp, cp * sr, cp * cr, z, 0, 0, 0, 1]


def write_collada(path, m, materials, joints, weights_of, length, frames):
    """The mesh with its skeleton and a round of steps, in seconds. weights_of(limb, position) gives (joint's name, share) pairs."""
    numbers = lambda values: " ".join(f"{v:.4f}".rstrip("0").rstrip(".") for v in values)

    def source(name, values, names, kind="float", array="float_array"):
        width = {"float4x4": 16}.get(kind, len(names))
        text = " ".join(values) if array == "Name_array" else numbers(values)
        params = "".join(f'<param name="{n}" type="{kind}"/>' for n in names)
        return (f'<source id="{name}"><{array} id="{name}-array" count="{len(values)}">{text}</{array}><technique_common>'
                f'<accessor source="#{name}-array" count="{len(values) // width}" stride="{width}">{params}</accessor></technique_common></source>')

    flat = lambda rows: [x for row in rows for x in row]
    index = {joint.name: i for i, joint in enumerate(joints)}
    shares, table, counts, pairs = [1.0], {1.0: 0}, [], []
    for limb, (position, _, _) in zip(m.limbs, m.vertices):
        weights = [(name, round(share, 3)) for name, share in weights_of(limb, position) if share > 0.0005]
        counts.append(len(weights))
        for name, share in weights:
            if share not in table:
                table[share] = len(shares)
                shares.append(share)
            pairs += [index[name], table[share]]
    effects, library, triangles, bindings = [], [], [], []
    for material, faces in m.faces.items():
        colour, picture = materials[material]
        image = (f'<newparam sid="{material}-surface"><surface type="2D"><init_from>{material}-image</init_from></surface></newparam>'
                 f'<newparam sid="{material}-sampler"><sampler2D><source>{material}-surface</source></sampler2D></newparam>') if picture else ""
        diffuse = f'<texture texture="{material}-sampler" texcoord="UV"/>' if picture else f"<color>{numbers((*colour, 1))}</color>"
        effects.append(f'<effect id="{material}-effect"><profile_COMMON>{image}<technique sid="common"><lambert><diffuse>{diffuse}</diffuse></lambert></technique></profile_COMMON></effect>')
        library.append(f'<material id="{material}" name="{material}"><instance_effect url="#{material}-effect"/></material>')
        corners = " ".join(str(i - 1) for face in faces for i in face)
        triangles.append(f'<triangles material="{material}" count="{len(faces)}"><input semantic="VERTEX" source="#vertices" offset="0"/><input semantic="NORMAL" source="#normals" offset="0"/>'
                         f'<input semantic="TEXCOORD" source="#uvs" offset="0" set="0"/><p>{corners}</p></triangles>')
        bindings.append(f'<instance_material symbol="{material}" target="#{material}"><bind_vertex_input semantic="UV" input_semantic="TEXCOORD" input_set="0"/></instance_material>')
    images = "".join(f'<image id="{name}-image"><init_from>{picture}</init_from></image>' for name, (_, picture) in materials.items() if picture)

    def node(joint):
        children = "".join(node(other) for other in joints if other.parent is joint)
        return f'<node id="{joint.name}" name="{joint.name}" sid="{joint.name}" type="JOINT"><matrix sid="transform">{numbers(joint.matrix())}</matrix>{children}</node>'

    times = [length * i / frames for i in range(frames + 1)]
    animations = "\n".join(
        f'<animation id="{joint.name}-steps">' + source(f"{joint.name}-times", times, ["TIME"]) +
        source(f"{joint.name}-poses", flat(joint.matrix(i / frames) for i in range(frames + 1)), ["TRANSFORM"], "float4x4") +
        source(f"{joint.name}-kinds", ["LINEAR"] * (frames + 1), ["INTERPOLATION"], "name", "Name_array") +
        f'<sampler id="{joint.name}-sampler"><input semantic="INPUT" source="#{joint.name}-times"/><input semantic="OUTPUT" source="#{joint.name}-poses"/>'
        f'<input semantic="INTERPOLATION" source="#{joint.name}-kinds"/></sampler><channel source="#{joint.name}-sampler" target="{joint.name}/transform"/></animation>' for joint in joints)
    inverse = [[1, 0, 0, -j.place[0], 0, 1, 0, -j.place[1], 0, 0, 1, -j.place[2], 0, 0, 0, 1] for j in joints]
    root = joints[0]
    path.write_text(f"""<?xml version="1.0" encoding="utf-8"?>
<!-- Written by worlds/make_farm_models.py. -->
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="meter" meter="1"/><up_axis>Z_UP</up_axis></asset>
<library_images>{images}</library_images>
<library_effects>{"".join(effects)}</library_effects>
<library_materials>{"".join(library)}</library_materials>
<library_geometries><geometry id="mesh" name="mesh"><mesh>
{source("positions", flat(p for p, _, _ in m.vertices), "XYZ")}
{source("normals", flat(n for _, n, _ in m.vertices), "XYZ")}
{source("uvs", flat(t for _, _, t in m.vertices), "ST")}
<vertices id="vertices"><input semantic="POSITION" source="#positions"/></vertices>
{newline.join(triangles)}
</mesh></geometry></library_geometries>
<library_controllers><controller id="skin"><skin source="#mesh"><bind_shape_matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</bind_shape_matrix>
{source("joints", [j.name for j in joints], ["JOINT"], "name", "Name_array")}
{source("inverse", flat(inverse), ["TRANSFORM"], "float4x4")}
{source("shares", shares, ["WEIGHT"])}
<joints><input semantic="JOINT" source="#joints"/><input semantic="INV_BIND_MATRIX" source="#inverse"/></joints>
<vertex_weights count="{len(counts)}"><input semantic="JOINT" source="#joints" offset="0"/><input semantic="WEIGHT" source="#shares" offset="1"/><vcount>{" ".join(map(str, counts))}</vcount>
<v>{" ".join(map(str, pairs))}</v></vertex_weights>
</skin></controller></library_controllers>
<library_animations>
{animations}
</library_animations>
<library_visual_scenes><visual_scene id="scene">{node(root)}
<node id="body" name="body"><instance_controller url="#skin"><skeleton>#{root.name}</skeleton><bind_material><technique_common>{"".join(bindings)}</technique_common></bind_material></instance_controller></node>
</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#scene"/></scene>
</COLLADA>
""")
