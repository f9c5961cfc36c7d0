# Components of devices that look, against worlds/devices.sdf, one case per run: seen_devices.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import json
import math
import sys

from rig import Rig, await_

case, *folders = sys.argv[1:]
rig = Rig(*folders)
device = rig.device


def up(component, *options, world=None):
    rig.server(world=world or f"{rig.source}/worlds/devices.sdf")
    rig.naming()
    rig.host(device(component, *options), "SeenProbe")
    rig.there(f"{component}0", "SeenProbe0")
    rig.rtse("act", f"{component}0")


def sample(port):
    return json.loads(rig.rtse("--json", "print", port, "-n", "1", "-t", "60"))["value"]


def ask(what):
    rig.rtse("conf", "SeenProbe0", "set", "call", what)
    rig.rtse("act", "SeenProbe0")
    assert rig.state("SeenProbe0") == "Active", rig.log(rig.running[-1])
    rig.rtse("deact", "SeenProbe0")


def logical_camera():
    up("RTCLogicalCamera", "conf.default.device_id=mast::models")
    names = sample("RTCLogicalCamera0:models")["data"]
    assert {"crate_near", "ball", "tag_0"} <= set(names) and "mast" not in names and "wall" not in names, names
    poses = sample("RTCLogicalCamera0:fiducials")["fiducialsList"]
    tag = next(one for one in poses if one["id"] == names.index("tag_0"))["pose"]["position"]
    assert abs(tag["x"] - 3.5) + abs(tag["y"] - 0.2) + abs(tag["z"] + 0.1) < 1e-6, tag


def boxes():
    up("RTCBoundingBoxes", "conf.default.device_id=mast::boxes")
    labels, numbers = sample("RTCBoundingBoxes0:labels")["data"], sample("RTCBoundingBoxes0:boxes")["data"]
    assert sorted(labels) == ["1 crate_far", "1 crate_near", "2 ball", "3 person"], labels
    assert len(numbers) == 5 * len(labels)
    label, x, y, width, height = numbers[5 * labels.index("2 ball"):][:5]
    focal = 320 / math.tan(0.6)  # the ball of 0.2 m is at (2.6, -0.6, 0.2), the camera 0.9 m high
    assert label == 2 and abs(x - (320 + focal * 0.6 / 2.6)) < 3 and abs(y - (240 + focal * 0.7 / 2.6)) < 3, (x, y)
    assert abs(width - 2 * 0.2 * focal / 2.6) < 4, width
    rig.rtse("conf", "RTCBoundingBoxes0", "set", "device_id", "mast::oriented_boxes")
    oriented = await_("oriented boxes", lambda: len(got := sample("RTCBoundingBoxes0:boxes")["data"]) == 40 and got)
    labels = sample("RTCBoundingBoxes0:labels")["data"]
    crate = oriented[10 * labels.index("1 crate_near"):][:10]
    assert abs(crate[6] - 0.4) < 1e-3 and all(abs(size - 0.6) < 1e-3 for size in crate[7:]), crate


def fiducial():
    up("RTCFiducial", "conf.default.device_id=mast::marks")
    rig.rtse("con", "SeenProbe0:fiducial", "RTCFiducial0:fiducial")
    ids = lambda: sorted(one["id"] for one in sample("RTCFiducial0:fiducials")["fiducialsList"])
    assert ids() == [0, 1, 2], ids()  # the fourth is behind a crate
    first = sample("RTCFiducial0:fiducials")["fiducialsList"][0]
    assert first["size"]["w"] == 0.2 and abs(first["poseUncertainty"]["position"]["x"] - 0.005) < 1e-9, first
    ask("view")
    ask("near")
    await_("only the nearest", lambda: ids() == [1])
    ask("nan")
    await_("all again", lambda: ids() == [0, 1, 2])


def multicamera():
    up("RTCMulticamera", "conf.default.device_id=mast::stereo")
    rig.rtse("con", "SeenProbe0:multicamera", "RTCMulticamera0:multicamera")
    images = sample("RTCMulticamera0:images")
    left, right = images["images"]
    assert left["tm"] == right["tm"] == images["tm"] and (left["width"], left["height"], left["format"]) == (320, 240, "RGB8")
    assert len(left["pixels"]) == 3 * 320 * 240 and left["pixels"] != right["pixels"]
    ask("stereo")


def thermal():
    up("RTCCamera", "conf.default.device_id=mast::thermal")
    image = sample("RTCCamera0:image")
    assert (image["format"], image["bpp"], image["fDiv"]) == ("MONO16", 16, 100), image["format"]
    kelvin = [(low + 256 * high) / image["fDiv"] for low, high in zip(image["pixels"][::2], image["pixels"][1::2])]
    assert 274 < min(kelvin) < 276 and 307 < max(kelvin) < 309, (min(kelvin), max(kelvin))


def map():
    with open(rig.path("w.sdf"), "w") as file:
        file.write("""<sdf version='1.9'><world name='w'><model name='ground_plane'><static>true</static><link name='l'><collision name='c'><geometry><plane/></geometry></collision></link></model>
<model name='box'><static>true</static><pose>2 3 0.5 0 0 0</pose><link name='l'><collision name='c'><geometry><box><size>1 1 1</size></box></geometry></collision></link></model>
<model name='mover'><pose>5 5 0.5 0 0 0</pose><link name='l'><collision name='c'><geometry><box><size>1 1 1</size></box></geometry></collision></link></model></world></sdf>""")
    up("RTCMap", world=rig.path("w.sdf"))
    rig.rtse("con", "SeenProbe0:map", "RTCMap0:map")
    ask("map")
    ask("server")
    rig.rtse("con", "RTCMap0:path", "SeenProbe0:path")
    ask("plan")
    ask("plan_into_the_box")
    await_("a line", lambda: "planner: the goal (2, 3) is nearer than 0.3 m to something" in rig.log(rig.running[-1]))
    ask("plan_nan")
    ask("plan_nothing")
    await_("a line", lambda: "planner: expected 2 to 1000 way points, got 0" in rig.log(rig.running[-1]))
    rig.rtse("deact", "RTCMap0")
    rig.rtse("conf", "RTCMap0", "set", "area", "1,2,0")
    rig.try_rtse("act", "RTCMap0")
    await_("a line", lambda: "area must be four numbers" in rig.log(rig.running[-1]))


cases = {f.__name__: f for f in (logical_camera, boxes, fiducial, multicamera, thermal, map)}
with rig:
    cases[case]()
print("ok")
