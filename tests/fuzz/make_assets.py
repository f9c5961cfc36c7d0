# Writes the small files that asset_fuzz begins with, one of each kind: make_assets.py FOLDER
import base64
import json
import pathlib
import struct
import sys
import zlib

folder = pathlib.Path(sys.argv[1])
folder.mkdir(exist_ok=True)
corners = [(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
faces = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]


def png(width, height, depth, color, row):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = b"".join(b"\0" + row(y) for y in range(height))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, color, 0, 0, 0)) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def write(name, content):
    (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())


colors = png(8, 8, 8, 6, lambda y: bytes((32 * x, 32 * y, 128, 255 - 8 * x) [c] for x in range(8) for c in range(4)))
write("colors.png", colors)
write("deep.png", png(9, 9, 16, 0, lambda y: b"".join(struct.pack(">H", 700 * x * y) for x in range(9))))
# Elevations: 9 x 9 floating-point numbers in one strip, with a mark for those without a value.
tags = [(256, 3, 1, 9), (257, 3, 1, 9), (258, 3, 1, 32), (259, 3, 1, 1), (262, 3, 1, 1), (273, 4, 1, 300), (277, 3, 1, 1), (278, 3, 1, 9), (279, 4, 1, 324), (339, 3, 1, 3)]
entries = b"".join(struct.pack("<HHII", *tag) for tag in tags) + struct.pack("<HHI4s", 42113, 2, 3, b"-1\0")
write("elevations.tif", (struct.pack("<4sIH", b"II*\0", 8, len(tags) + 1) + entries + bytes(4)).ljust(300, b"\0")
      + b"".join(struct.pack("<f", 100 + x * y if x != y else -1) for y in range(9) for x in range(9)))
write("packed.dds", struct.pack("<4s7I44x", b"DDS ", 124, 0x1007, 8, 8, 8, 0, 0) + struct.pack("<8I", 32, 4, 0x31545844, 0, 0, 0, 0, 0)
      + struct.pack("<5I", 0x1000, 0, 0, 0, 0) + bytes(range(32)))
# 16 x 16 pixels as libjpeg-turbo writes them: sequential with halved colours, and in scans that refine each other.
write("colors.jpg", base64.b64decode(
    "/9j/4AAQSkZJRgABAQAAAQABAAD/2wBDAAYEBQYFBAYGBQYHBwYIChAKCgkJChQODwwQFxQYGBcUFhYaHSUfGhsjHBYWICwgIyYnKSopGR8tMC0oMCUoKSj/2wBDAQcHBwoIChMKChMoGhYaKCgoKC"
    "goKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCj/wAARCAAQABADASIAAhEBAxEB/8QAHwAAAQUBAQEBAQEAAAAAAAAAAAECAwQFBgcICQoL/8QAtRAAAgEDAwIEAwUF"
    "BAQAAAF9AQIDAAQRBRIhMUEGE1FhByJxFDKBkaEII0KxwRVS0fAkM2JyggkKFhcYGRolJicoKSo0NTY3ODk6Q0RFRkdISUpTVFVWV1hZWmNkZWZnaGlqc3R1dnd4eXqDhIWGh4iJipKTlJWWl5iZmq"
    "KjpKWmp6ipqrKztLW2t7i5usLDxMXGx8jJytLT1NXW19jZ2uHi4+Tl5ufo6erx8vP09fb3+Pn6/8QAHwEAAwEBAQEBAQEBAQAAAAAAAAECAwQFBgcICQoL/8QAtREAAgECBAQDBAcFBAQAAQJ3AAEC"
    "AxEEBSExBhJBUQdhcRMiMoEIFEKRobHBCSMzUvAVYnLRChYkNOEl8RcYGRomJygpKjU2Nzg5OkNERUZHSElKU1RVVldYWVpjZGVmZ2hpanN0dXZ3eHl6goOEhYaHiImKkpOUlZaXmJmaoqOkpaanqK"
    "mqsrO0tba3uLm6wsPExcbHyMnK0tPU1dbX2Nna4uPk5ebn6Onq8vP09fb3+Pn6/9oADAMBAAIRAxEAPwDyrSfDvT5P0rs9J8OdPk/Sux0nw70+T9K7PSfDvT5P0rXHZ3vqLhXiP4dT/9k="))
write("progressive.jpg", base64.b64decode(
    "/9j/4AAQSkZJRgABAQAAAQABAAD/2wBDAAYEBQYFBAYGBQYHBwYIChAKCgkJChQODwwQFxQYGBcUFhYaHSUfGhsjHBYWICwgIyYnKSopGR8tMC0oMCUoKSj/2wBDAQcHBwoIChMKChMoGhYaKCgoKC"
    "goKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCj/wgARCAAQABADASIAAhEBAxEB/8QAFQABAQAAAAAAAAAAAAAAAAAABQb/xAAVAQEBAAAAAAAAAAAAAAAAAAABAv/a"
    "AAwDAQACEAMQAAABlGmGqP/EABYQAAMAAAAAAAAAAAAAAAAAAAADBP/aAAgBAQABBQJU4qcVOKnP/8QAFhEBAQEAAAAAAAAAAAAAAAAABQAx/9oACAEDAQE/ASkcv//EABYRAAMAAAAAAAAAAAAAAA"
    "AAAAADBP/aAAgBAgEBPwF9p//EABQQAQAAAAAAAAAAAAAAAAAAACD/2gAIAQEABj8CH//EABUQAQEAAAAAAAAAAAAAAAAAAABh/9oACAEBAAE/IZpppv/aAAwDAQACAAMAAAAQr//EABURAQEAAAAA"
    "AAAAAAAAAAAAAABR/9oACAEDAQE/EKn/xAAWEQADAAAAAAAAAAAAAAAAAAAAITH/2gAIAQIBAT8Qqz//xAAWEAADAAAAAAAAAAAAAAAAAAAAMcH/2gAIAQEAAT8QRImREiJP/9k="))
write("cube.obj", "mtllib cube.mtl\n" + "".join(f"v {x} {y} {z}\n" for x, y, z in corners) + "vt 0 0\nvt 1 0\nvt 1 1\nusemtl m\n"
      + "".join("f " + " ".join(f"{i + 1}/{k + 1}" for k, i in enumerate(f)) + "\n" for f in faces))
write("cube.mtl", "newmtl m\nKd 1 0.5 0\nmap_Kd colors.png\n")
write("text.stl", "solid s\n" + "".join("facet normal 0 0 1\nouter loop\n" + "".join("vertex {} {} {}\n".format(*corners[i]) for i in f) + "endloop\nendfacet\n" for f in faces)
      + "endsolid s\n")
write("binary.stl", b"\0" * 80 + struct.pack("<I", len(faces)) + b"".join(struct.pack("<12fH", 0, 0, 1, *(c for i in f for c in corners[i]), 0) for f in faces))
head = f"element vertex 8\nproperty float x\nproperty float y\nproperty float z\nelement face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
write("text.ply", "ply\nformat ascii 1.0\n" + head + "".join("{} {} {}\n".format(*c) for c in corners) + "".join("3 {} {} {}\n".format(*f) for f in faces))
write("binary.ply", ("ply\nformat binary_little_endian 1.0\n" + head).encode() + b"".join(struct.pack("<3f", *c) for c in corners)
      + b"".join(struct.pack("<B3i", 3, *f) for f in faces))
buffer = b"".join(struct.pack("<3f", *c) for c in corners) + b"".join(struct.pack("<3H", *f) for f in faces)
picture_at = len(buffer)


def gltf(buffers, images):
    views = [{"buffer": 0, "byteOffset": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}]
    if "bufferView" in images[0]:
        views.append({"buffer": 0, "byteOffset": picture_at, "byteLength": len(colors)})
    return json.dumps({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "name": "cube", "scale": [1, 2, 1]}],
                       "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
                       "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}], "textures": [{"source": 0}], "images": images,
                       "accessors": [{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", "min": [-0.5] * 3, "max": [0.5] * 3},
                                     {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}],
                       "bufferViews": views, "buffers": buffers})


write("cube.gltf", gltf([{"byteLength": len(buffer), "uri": "data:application/octet-stream;base64," + base64.b64encode(buffer).decode()}], [{"uri": "colors.png"}]))
inside = buffer + colors + b"\0" * (-(len(buffer) + len(colors)) % 4)
words = gltf([{"byteLength": len(inside)}], [{"bufferView": 2, "mimeType": "image/png"}]).encode()
words += b" " * (-len(words) % 4)
write("cube.glb", struct.pack("<4sII", b"glTF", 2, 28 + len(words) + len(inside)) + struct.pack("<I4s", len(words), b"JSON") + words + struct.pack("<I4s", len(inside), b"BIN\0") + inside)
# Bodies that touch this at its far end have no exact solution: ODE would end the process.
write("spike.bvh", "HIERARCHY\nROOT hip\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\nJOINT leg\n{\nOFFSET 0 -1 0\n"
      "CHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site\n{\nOFFSET 0 -1 65536\n}\n}\n}\nMOTION\nFrames: 1\nFrame Time: 0.1\n0 0 0 0 0 0 0 0 0\n")
write("walk.bvh", "HIERARCHY\nROOT hip\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\nJOINT leg\n{\nOFFSET 0 -1 0\n"
      "CHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site\n{\nOFFSET 0 -1 0\n}\n}\n}\nMOTION\nFrames: 3\nFrame Time: 0.1\n" + "".join(f"{i} 0 0 0 {i} 0 0 {2 * i} 0\n" for i in range(3)))
write("cube.fbx", "; FBX 7.4.0 project file\nFBXHeaderExtension:  {\n\tFBXHeaderVersion: 1003\n\tFBXVersion: 7400\n}\nObjects:  {\n\tGeometry: 1, \"Geometry::\", \"Mesh\" {\n"
      "\t\tVertices: *24 {\n\t\t\ta: " + ",".join(str(c) for corner in corners for c in corner) + "\n\t\t}\n\t\tPolygonVertexIndex: *36 {\n\t\t\ta: "
      + ",".join(f"{a},{b},{-c - 1}" for a, b, c in faces) + "\n\t\t}\n\t\tGeometryVersion: 124\n\t}\n\tModel: 2, \"Model::cube\", \"Mesh\" {\n\t\tVersion: 232\n\t}\n}\n"
      "Connections:  {\n\tC: \"OO\",2,0\n\tC: \"OO\",1,2\n}\n")
write("limb.dae", """<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><unit meter="1" name="m"/><up_axis>Z_UP</up_axis></asset>
<library_images><image id="i"><init_from>colors.png</init_from></image></library_images>
<library_effects><effect id="e"><profile_COMMON><newparam sid="s"><surface type="2D"><init_from>i</init_from></surface></newparam><newparam sid="t"><sampler2D><source>s</source></sampler2D></newparam>
<technique sid="x"><phong><diffuse><texture texture="t" texcoord="u"/></diffuse></phong></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="pa" count="12">0 0 0 1 0 0 0 1 0 0 0 1</float_array><technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles material="m" count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 3 2 0 1 3 1 2 3</p></triangles></mesh></geometry></library_geometries>
<library_controllers><controller id="c"><skin source="#g"><bind_shape_matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</bind_shape_matrix>
<source id="j"><Name_array id="ja" count="2">hip leg</Name_array><technique_common><accessor source="#ja" count="2" stride="1"><param name="JOINT" type="name"/></accessor></technique_common></source>
<source id="b"><float_array id="ba" count="32">1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</float_array><technique_common><accessor source="#ba" count="2" stride="16"><param name="TRANSFORM" type="float4x4"/></accessor></technique_common></source>
<source id="w"><float_array id="wa" count="2">1 0.5</float_array><technique_common><accessor source="#wa" count="2" stride="1"><param name="WEIGHT" type="float"/></accessor></technique_common></source>
<joints><input semantic="JOINT" source="#j"/><input semantic="INV_BIND_MATRIX" source="#b"/></joints><vertex_weights count="4"><input semantic="JOINT" source="#j" offset="0"/><input semantic="WEIGHT" source="#w" offset="1"/><vcount>1 1 2 1</vcount><v>0 0 1 0 0 1 1 1 0 0</v></vertex_weights></skin></controller></library_controllers>
<library_animations><animation id="a"><source id="ti"><float_array id="tia" count="2">0 1</float_array><technique_common><accessor source="#tia" count="2" stride="1"><param name="TIME" type="float"/></accessor></technique_common></source>
<source id="o"><float_array id="oa" count="32">1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1</float_array><technique_common><accessor source="#oa" count="2" stride="16"><param name="TRANSFORM" type="float4x4"/></accessor></technique_common></source>
<source id="k"><Name_array id="ka" count="2">LINEAR LINEAR</Name_array><technique_common><accessor source="#ka" count="2" stride="1"><param name="INTERPOLATION" type="name"/></accessor></technique_common></source>
<sampler id="sa"><input semantic="INPUT" source="#ti"/><input semantic="OUTPUT" source="#o"/><input semantic="INTERPOLATION" source="#k"/></sampler><channel source="#sa" target="hip/transform"/></animation></library_animations>
<library_visual_scenes><visual_scene id="s"><node id="hip" name="hip" sid="hip" type="JOINT"><matrix sid="transform">1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix><node id="leg" name="leg" sid="leg" type="JOINT"><translate>0 0 -1</translate></node></node>
<node id="n" name="body"><instance_controller url="#c"><skeleton>#hip</skeleton><bind_material><technique_common><instance_material symbol="m" target="#m"/></technique_common></bind_material></instance_controller></node></visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>
""")
