# Components of cameras and of a drone against a running simulator, one case per run: camera_components.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import json
import math
import os
import struct

import pixels
from component_rig import call, case, close, device, rig, sample
from rig import await_


# Cameras that stand before an orange wall with a hole on the left: one of each kind and format, and a drone.
def camera_world():
    def sensor(name, kind, format, more=""):
        return (f"<sensor name='{name}' type='{kind}'><update_rate>30</update_rate><camera>{more}<horizontal_fov>1.2</horizontal_fov><image><width>24</width><height>16</height>"
                f"<format>{format}</format></image><clip><near>0.1</near><far>20</far></clip></camera></sensor>")

    formats = ("R8G8B8", "B8G8R8", "L8", "L16", "BAYER_GRBG8", "RGBA_INT8", "BGRA_INT8")
    eyes = "".join(sensor(name.lower(), "camera", name) for name in formats)
    return f"""<sdf version='1.9'><world name='w'><gravity>0 0 0</gravity>
<model name='wall'><static>true</static><pose>3.1 -4 0 0 0 0</pose><link name='l'><visual name='v'><geometry><box><size>0.2 8 20</size></box></geometry>
<material><lighting>false</lighting><diffuse>0 0 0 1</diffuse><emissive>1 0.502 0 1</emissive></material></visual></link></model>
<model name='robot'><static>true</static><pose>0 0 0 0 0 0</pose><link name='l'>{eyes}
{sensor("bent", "camera", "R8G8B8", "<distortion><k1>-0.1</k1><p2>0.01</p2></distortion>")}{sensor("deep", "depth_camera", "R_FLOAT32")}
{sensor("left", "camera", "L8", "<pose>0 0 0 0 0 1.57</pose>")}</link></model>
<model name='drone'><pose>0 5 5 0 0 0</pose><link name='l'><collision name='c'><geometry><box><size>.3 .3 .3</size></box></geometry></collision></link>
<plugin filename='gz-sim-velocity-control-system' name='gz::sim::systems::VelocityControl'/></model></world></sdf>"""


def camera_up(*components, options=()):
    with open(rig.path("w.sdf"), "w") as file:
        file.write(camera_world())
    rig.server(*options, world=rig.path("w.sdf"))
    rig.naming()
    rig.host(*components)


# Every format as both image ports say it, each with an instance of its own.
def camera_formats():
    wanted = {
        "r8g8b8": ("RGB8", 24, "CF_RGB", [255, 128, 0], [255, 128, 0]),
        "b8g8r8": ("BGR8", 24, "CF_RGB", [0, 128, 255], [255, 128, 0]),
        "rgba_int8": ("RGBA8", 32, "RGBA", [255, 128, 0, 255], [255, 128, 0, 255]),
        "bgra_int8": ("BGRA8", 32, "RGBA", [0, 128, 255, 255], [255, 128, 0, 255]),
        "l8": ("MONO8", 8, "CF_GRAY", [151], [151]),
        "l16": ("MONO16", 16, "Y16", [0xF9, 0x97], [0xF9, 0x97]),
        "bayer_grbg8": ("BAYER_GRBG8", 8, "RAW", None, None),
    }
    names = [f"Camera_{name}" for name in wanted]
    camera_up(*(device("RTCCamera", f"instance_name=Camera_{name}", f"conf.default.device_id=robot::{name}") for name in wanted))
    rig.there(*names)
    rig.rtse("act", *names)
    for name, (format, bits, img, octets, img_octets) in wanted.items():
        image = sample(f"Camera_{name}:image")
        assert (image["width"], image["height"], image["format"], image["bpp"]) == (24, 16, format, bits), (name, image["format"], image["bpp"])
        timed = sample(f"Camera_{name}:timed_image")["data"]["image"]
        assert (timed["width"], timed["height"]) == (24, 16) and timed["format"] == img, (name, timed["format"])
        rows = [image["pixels"][y * 24 * bits // 8 : (y + 1) * 24 * bits // 8] for y in range(16)]
        assert len(image["pixels"]) == len(timed["raw_data"]) == 24 * 16 * bits // 8
        if octets:
            close(rows[8][-len(octets) :], octets, 1)
            close(timed["raw_data"][-len(img_octets) :], img_octets, 1)
            assert rows[8][: len(octets)] != octets, "the hole on the left"
        else:
            close(rows[8][-4:], [128, 255, 128, 255], 1)  # g r g r
            close(rows[9][-4:], [0, 128, 0, 128], 1)  # b g b g
            assert timed["raw_data"] == image["pixels"]


# The parameters of the camera beside its picture.
def camera_parameters():
    camera_up(device("RTCCamera", "conf.default.device_id=robot::bent"))
    rig.there("RTCCamera0")
    rig.rtse("act", "RTCCamera0")
    value = sample("RTCCamera0:timed_image")
    data = value["data"]
    assert value["tm"] == data["captured_time"] and value["error_code"] == 0
    focal = 12 / math.tan(0.6)
    close(data["intrinsic"]["matrix_element"], [focal, 0, 12, focal, 8], 1e-6)
    close(data["intrinsic"]["distortion_coefficient"], [-0.1, 0, 0, 0.01, 0], 1e-9)
    close([v for row in data["extrinsic"] for v in row], [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1], 1e-9)
    rig.rtse("conf", "RTCCamera0", "set", "device_id", "robot::left")

    def turned():
        close(sample("RTCCamera0:timed_image")["data"]["extrinsic"][0], [math.cos(1.57), -math.sin(1.57), 0, 0], 1e-9)
        return True

    await_("the pose of the other camera", turned)


def camera_service():
    camera_up(device("RTCCamera", "conf.default.device_id=robot::bent"), "DeviceProbe")
    rig.there("RTCCamera0", "DeviceProbe0")
    rig.rtse("act", "RTCCamera0")
    rig.rtse("con", "DeviceProbe0:camera", "RTCCamera0:camera")
    call("camera")


# JPEG on request decodes near the frame; VideoPlayer does it.
def camera_jpeg():
    camera_up(device("RTCCamera", "conf.default.device_id=robot::r8g8b8"), f"VideoPlayer?conf.default.window=0&conf.default.record_dir={rig.path('frames')}")
    rig.there("RTCCamera0", "VideoPlayer0")
    rig.rtse("con", "RTCCamera0:image", "VideoPlayer0:image")
    rig.rtse("act", "VideoPlayer0", "RTCCamera0")
    plain = sample("RTCCamera0:image")
    rig.rtse("conf", "RTCCamera0", "set", "encoding", "jpeg")
    packed = await_("a JPEG", lambda: (got := sample("RTCCamera0:image"))["format"] == "JPEG" and got)
    assert bytes(packed["pixels"][:2]) == b"\xff\xd8" and len(packed["pixels"]) < len(plain["pixels"])
    assert (packed["width"], packed["height"]) == (24, 16)
    assert sample("RTCCamera0:timed_image")["data"]["image"]["format"] == "CF_JPEG"
    rig.rtse("conf", "RTCCamera0", "set", "quality", "30")
    await_("a smaller JPEG", lambda: len(sample("RTCCamera0:image")["pixels"]) < len(packed["pixels"]))
    rig.rtse("conf", "RTCCamera0", "set", "quality", "90")
    await_("the size as before", lambda: len(sample("RTCCamera0:image")["pixels"]) == len(packed["pixels"]))
    shown = lambda: sorted(name for name in os.listdir(rig.path("frames")) if name.endswith(".png"))
    count = len(shown())
    await_("decoded frames", lambda: len(shown()) > count + 2)
    rig.rtse("deact", "RTCCamera0", "VideoPlayer0")
    width, height, rgb = pixels.png(rig.path("frames") + "/" + shown()[-1])
    assert (width, height) == (24, 16)
    # Away from the edge, which 4:2:0 blurs.
    for y in range(16):
        close(list(rgb[(y * 24 + 18) * 3 : (y * 24 + 24) * 3]), plain["pixels"][(y * 24 + 18) * 3 : (y * 24 + 24) * 3], 6)
    log = rig.log(rig.running[-1])
    assert " 0 rejected" in log, log


def depth_camera():
    camera_up(device("RTCDepthCamera", "conf.default.device_id=robot::deep", "conf.default.points_step=2"))
    rig.there("RTCDepthCamera0")
    rig.rtse("act", "RTCDepthCamera0")
    value = sample("RTCDepthCamera0:depth")
    assert (value["width"], value["height"], value["bpp"], value["format"]) == (24, 16, 32, "DEPTH32F"), value
    depths = struct.unpack("<384f", bytes(value["pixels"]))
    for row in range(16):
        close(depths[24 * row + 13 : 24 * row + 24], [3] * 11, 0.003)
        assert set(depths[24 * row : 24 * row + 11]) == {0}, "0 where nothing is"
    points = sample("RTCDepthCamera0:points")["points"]
    assert 8 * 5 <= len(points) <= 8 * 6, len(points)  # every other pixel of every other row of the right half
    focal = 12 / math.tan(0.6)
    seen = {(p["point"]["y"], p["point"]["z"]) for p in points}
    for p in points:
        assert abs(p["point"]["x"] - 3) < 0.003 and p["point"]["y"] < 0.1
    corner = min(seen)
    close(corner, [-(22.5 - 12) / focal * 3, -(14.5 - 8) / focal * 3], 0.01)


def fly(vz):
    rig.rtse("inject", "RTCPosition3d0:velocity", json.dumps({"data": {"vz": vz}}))
    return rig.robot("drone::position3d")["velocity"][2]


def drone():
    camera_up(device("RTCPosition3d", "conf.default.device_id=drone::position3d"))
    rig.there("RTCPosition3d0")
    rig.rtse("act", "RTCPosition3d0")
    await_("a climbing drone", lambda: fly(0.5) > 0.4)
    velocity = sample("RTCPosition3d0:actual_velocity")["data"]
    assert 0.1 < velocity["vz"] < 0.6 and abs(velocity["vx"]) < 0.05, velocity
    pose = sample("RTCPosition3d0:pose")["data"]
    close([pose["position"]["x"], pose["position"]["y"], pose["orientation"]["r"], pose["orientation"]["p"]], [0, 0, 0, 0], 0.05)
    await_("a drone that stands when nobody commands", lambda: abs(rig.robot("drone::position3d")["velocity"][2]) < 0.01)
    odometry = lambda: (pose := sample("RTCPosition3d0:pose")["data"])["position"] | {"yaw": pose["orientation"]["y"]}
    start = odometry()
    order = lambda port, data: rig.rtse("inject", f"RTCPosition3d0:{port}", json.dumps({"data": data}))
    order("pose_control", {"position": {"x": start["x"] + 0.5, "y": start["y"], "z": start["z"] + 0.5}, "orientation": {"r": 0, "p": 0, "y": 0.5}})
    await_("a drone at its goal", lambda: all(abs(odometry()[key] - start[key] - way) < 0.05 for key, way in (("x", 0.5), ("z", 0.5), ("yaw", 0.5))))
    odometry_now = odometry()
    at = lambda dx, dz, yaw: {"position": {"x": odometry_now["x"] + dx, "y": odometry_now["y"], "z": odometry_now["z"] + dz}, "orientation": {"r": 0, "p": 0, "y": yaw}}
    points = [{"target": at(0.4, 0, 0), "distanceTolerance": 0.2, "headingTolerance": 4}, {"target": at(0.4, 0.4, 1), "distanceTolerance": 0, "headingTolerance": 0}]
    rig.rtse("inject", "RTCPosition3d0:path", json.dumps({"waypoints": points}))
    await_("a drone at the end of its path", lambda: all(abs(odometry()[key] - wanted) < 0.06 for key, wanted in (("x", odometry_now["x"] + 0.4), ("z", odometry_now["z"] + 0.4), ("yaw", 1))))
    await_("a drone in another direction", lambda: order("heading_control", {"speed": 0.2, "direction": {"r": 0, "p": 0, "y": -0.5}}) or abs(odometry()["yaw"] + 0.5) < 0.1)
    await_("a drone that stands when nobody commands", lambda: max(map(abs, rig.robot("drone::position3d")["velocity"])) < 0.01)


# What each says when its device is not there, and that it gets well.
def wrong_camera_device():
    components = {"RTCCamera": ("robot::l8", "robot::l9", "image"), "RTCDepthCamera": ("robot::deep", "robot::depp", "depth"), "RTCPosition3d": ("drone::position3d", "drone::position4d", "pose")}
    camera_up(*(device(name, f"conf.default.device_id={wrong}") for name, (_, wrong, _) in components.items()))
    rig.there(*(f"{name}0" for name in components))
    for name, (right, wrong, port) in components.items():
        assert rig.try_rtse("act", f"{name}0").returncode == 1
        await_("the error state", lambda: rig.state(f"{name}0") == "Error")
        line = await_("a line", lambda: next(line for line in rig.log(rig.running[-1]).splitlines() if f"{name}0" in line and wrong in line))
        assert right in line, line
        rig.rtse("conf", f"{name}0", "set", "device_id", right)
        rig.rtse("reset", f"{name}0")
        rig.rtse("act", f"{name}0")
        assert sample(f"{name}0:{port}")


# A simulator that is killed and started anew: each goes on without help.
def restarted_server():
    components = {"RTCCamera": ("robot::l8", "image"), "RTCDepthCamera": ("robot::deep", "depth"), "RTCPosition3d": ("drone::position3d", "pose")}
    camera_up(*(device(name, f"conf.default.device_id={right}") for name, (right, _) in components.items()))
    names = [f"{name}0" for name in components]
    rig.there(*names)
    rig.rtse("act", *names)
    before = {name: sample(f"{name}0:{port}") for name, (_, port) in components.items()}
    await_("a climbing drone", lambda: fly(0.5) > 0.4)
    rig.kill(rig.running[0])
    log = lambda: rig.log(rig.running[2])
    await_("lines that say so", lambda: log().count("is lost") == 3)
    rig.server(world=rig.path("w.sdf"))
    await_("lines that say so", lambda: log().count("is there again") == 3)
    assert sample("RTCCamera0:image")["pixels"] == before["RTCCamera"]["pixels"]
    assert sample("RTCDepthCamera0:depth")["pixels"] == before["RTCDepthCamera"]["pixels"]
    await_("a climbing drone", lambda: fly(0.5) > 0.4)
    assert log().count("is lost") == 3, log()
    assert [rig.state(name) for name in names] == ["Active"] * 3


rig.run_case(case, globals())
