# What rtm-studio shows and does: worlds, systems, signals, images, recordings. One case per run: studio_shows.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import json
import os
import socket
import struct
import subprocess
import threading
import time

from rig import await_
from studio_rig import Studio, case, is_poses, poses_in, rig


# A world is seen, moved, driven, stepped and reset.
def world():
    rig.naming()
    rig.server("-u")
    studio = Studio()
    viewer = studio.viewer()
    assert viewer.event("hello")["read_only"] is False
    seen = viewer.event("world", lambda m: m["present"])
    names = [model["name"] for model in seen["models"]]
    assert "pioneer2dx" in names and any(i["type"] == "laser" and i["model"] == "pioneer2dx" and i["info"]["beams"] > 1 for i in seen["ifaces"]), seen
    assert viewer.do("step", steps=10)["steps"] == 10
    first = viewer.wait_for(is_poses)
    assert first[1] == 1 and len(poses_in(first)) > 10
    reply = viewer.ask("set_pose", model="pioneer2dx", planar=[2, 1, 0.5])
    assert reply["command"] == f"simctl -s {rig.server_id} pose pioneer2dx 2 1 0.5", reply
    moved = viewer.wait_for(lambda m: is_poses(m) and any(abs(p[0] - 2) < 0.01 and abs(p[1] - 1) < 0.01 for p in poses_in(m).values()))
    assert len(poses_in(moved)) < len(poses_in(first)), "only what has moved is sent"
    assert viewer.ask("step", dry=True, steps=7)["command"] == f"simctl -s {rig.server_id} step 7"
    assert rig.stats()["steps"] == 10
    assert "no model or link nobody" in viewer.ask("set_pose", model="nobody", planar=[0, 0, 0])["error"]
    viewer.do("watch", watch=3, topic="/sim/position2d/pioneer2dx/position2d", members=["velocity[0]", "odometry[0]"])
    viewer.do("run")
    end = time.monotonic() + 20
    speed = 0
    while speed < 0.15:
        assert time.monotonic() < end, speed
        viewer.do("drive", iface="pioneer2dx::position2d", velocity=[0.2, 0, 0])
        speed = viewer.event("values", lambda m: "v" in m)["v"][-1][0]
    await_("a drive that nobody renews ends", lambda: rig.robot()["commanded"] is False)
    other = studio.viewer()
    other.do("drive", iface="pioneer2dx::position2d", velocity=[0.2, 0, 0])
    other.close()
    await_("a drive ends with its viewer", lambda: rig.robot()["commanded"] is False)
    viewer.do("pause")
    sdf = "<sdf version='1.6'><model name='box'><static>true</static><link name='l'><collision name='c'><geometry><box><size>1 1 1</size></box></geometry></collision></link></model></sdf>"
    before = viewer.event("world", lambda m: True) if False else seen
    assert viewer.do("spawn", sdf=sdf, name="crate", pose=[5, 5, 0.5, 1, 0, 0, 0])["name"] == "crate"
    grown = viewer.event("world", lambda m: any(model["name"] == "crate" for model in m["models"]))
    assert grown["version"] != before["version"]
    viewer.do("delete_model", model="crate")
    viewer.event("world", lambda m: all(model["name"] != "crate" for model in m["models"]))
    viewer.do("reset_world")
    viewer.event("time", lambda m: m["sim_time"] == 0 and m["paused"])
    assert viewer.do("tree", model="pioneer2dx")["models"][0]["name"] == "pioneer2dx"


# The system of the demo from nothing: created, connected, configured, activated, saved, taken down, opened.
def system():
    rig.naming()
    rig.server("-u")
    rig.host()
    studio = Studio()
    viewer = studio.viewer()
    manager = viewer.event("system", lambda m: m["managers"])["managers"][0]["path"]
    assert "loadable" in viewer.do("manager", path=manager)
    for name in ("RTCLaser", "LaserObstacleAvoid", "RTCPosition2d"):
        properties = {} if name == "LaserObstacleAvoid" else {"conf.default.server_id": rig.server_id}
        assert viewer.do("create", manager=manager, type=name, properties=properties)["instance"] == f"{name}0"
    seen = viewer.event("system", lambda m: len(m["components"]) == 3)
    paths = {component["instance"]: component["path"] for component in seen["components"]}
    pair = [f"{paths['RTCLaser0']}:range", f"{paths['LaserObstacleAvoid0']}:range"]
    options = viewer.do("connection_options", ports=pair)
    assert options["problem"] == "" and "flush" in next(o for o in options["properties"] if o["key"] == "dataport.subscription_type")["values"], options
    assert "expected an OutPort and an InPort" in viewer.do("connection_options", ports=[pair[1], f"{paths['RTCPosition2d0']}:velocity"])["problem"]
    connected = viewer.ask("connect", ports=pair, properties={"dataport.subscription_type": "new"})
    assert connected["command"].startswith(f"rtse --ns {rig.names} con {pair[0]} {pair[1]}"), connected
    viewer.event("system", lambda m: any(c["ports"] == pair for c in m["connections"]))
    undo = viewer.do("disconnect", port=pair[0], id=connected["result"]["id"])
    assert sorted(undo["ports"]) == sorted(pair) and undo["properties"]["dataport.subscription_type"] == "new", undo
    viewer.event("system", lambda m: not m["connections"])
    viewer.do("connect", **undo)
    viewer.do("connect", ports=[f"{paths['LaserObstacleAvoid0']}:velocity", f"{paths['RTCPosition2d0']}:velocity"])
    details = viewer.do("component", path=paths["LaserObstacleAvoid0"])
    parameter = next(value for one in details["sets"] if one["active"] for value in one["values"])
    assert {"name", "value", "type", "widget", "constraint"} <= parameter.keys()
    viewer.do("set_configuration", path=paths["LaserObstacleAvoid0"], set="default", values={parameter["name"]: parameter["value"]})
    assert "cannot be" in viewer.ask("set_configuration", path=paths["RTCLaser0"], set="default", values={"server_id": "none"})["error"]
    for path in paths.values():
        viewer.do("activate", path=path)
    await_("states", lambda: all(rig.state(name) == "Active" for name in paths))
    # Who looks on is no part of the system.
    viewer.do("watch", watch=8, topic="/RTCLaser0/range")
    await_("somebody who looks on", lambda: len(json.loads(rig.rtse("--json", "cat", "RTCLaser0:range"))["connectors"]) == 2)
    saved = viewer.do("save_profile", name="saved")
    xml = saved["xml"]
    assert "RTCLaser0" in xml and "saved" in xml and saved["left_out"] == "" and rig.rtse("save", "-").count("<rts:DataPortConnectors ") == 2, saved
    viewer.do("unwatch", watch=8)
    viewer.do("teardown", xml=xml)
    assert not json.loads(rig.rtse("--json", "cat", "RTCLaser0:range")).get("connectors", [])
    viewer.do("open_profile", xml=xml)
    for path in paths.values():
        viewer.do("deactivate", path=path)
    viewer.event("states", lambda m: set(m["states"].values()) == {"Inactive"})
    assert "must be" in viewer.ask("reset", path=paths["RTCLaser0"])["error"]
    viewer.do("exit", path=paths["RTCPosition2d0"])
    viewer.event("system", lambda m: len(m["components"]) == 2)


# The run of lock step is the same to the bit with three viewers that look at everything and with none.
def same_hash():
    runs = int(os.environ.get("RTMSIM_STUDIO_RUNS", "1"))

    def run(viewers):
        with_viewers = []
        simulator = rig.server("--lockstep", "--rtf", "0", "-u", "--wait-for", "3", "--seed", "5")
        host = rig.host(rig.device("RTCLaser"), "LaserObstacleAvoid", rig.device("RTCPosition2d"), options=(
            "-o", "manager.modules.preload:SimTimeContext.so", "-o", "exec_cxt.periodic.type:SimTimeContext"))
        rig.there("RTCLaser0", "LaserObstacleAvoid0", "RTCPosition2d0")
        rig.rtse("con", "RTCLaser0:range", "LaserObstacleAvoid0:range")
        rig.rtse("con", "LaserObstacleAvoid0:velocity", "RTCPosition2d0:velocity")
        rig.rtse("act", "RTCLaser0", "LaserObstacleAvoid0", "RTCPosition2d0")
        await_("participants", lambda: len(rig.participants()) == 3)
        for _ in range(viewers):
            viewer = studio.viewer()
            viewer.event("world", lambda m: m["present"])
            viewer.event("system", lambda m: len(m["components"]) == 3)
            for i, topic in enumerate(("/sim/laser/pioneer2dx/laser", "/sim/position2d/pioneer2dx/position2d", "/RTCLaser0/range", "/LaserObstacleAvoid0/velocity")):
                viewer.do("watch", watch=i, topic=topic)
            with_viewers.append(viewer)
        for viewer in with_viewers:
            for i in range(2):
                viewer.event("values", lambda m: m["watch"] == i)
        rig.simctl("step", "5000")
        stats = rig.stats()
        for viewer in with_viewers:
            viewer.close()
        for process in (host, simulator):
            process.terminate()
            process.wait(20)
        return stats["hash"]

    rig.naming()
    studio = Studio()
    hashes = [run(viewers) for _ in range(runs) for viewers in (0, 3)]
    print(hashes)
    assert len(set(hashes)) == 1 and hashes[0] != "0" * 16, hashes


# A client of another make (npm) reads what the simulator shows and what a port sends.
def foreign():
    rig.naming()
    rig.server("--rtf", "1")
    rig.host(rig.device("RTCLaser"))
    rig.there("RTCLaser0")
    rig.rtse("act", "RTCLaser0")
    studio = Studio()
    topics = ("/tf", "/sim/laser/pioneer2dx/laser", "/RTCLaser0/range")
    script = f"{rig.source}/tests/foreign/watch.mjs"
    lines = [json.loads(line) for line in rig.call("node", script, f"ws://127.0.0.1:{studio.port}/ws?token={studio.token}", *topics).splitlines()]
    assert "time" in lines[0]["info"]["capabilities"], lines[0]
    seen = {line["topic"]: line for line in lines[1:]}
    assert set(seen) == set(topics), seen.keys()
    assert seen["/tf"]["schema"] == "tf2_msgs/msg/TFMessage"
    assert any(one["child_frame_id"] == "pioneer2dx" for one in seen["/tf"]["message"]["transforms"])
    assert len(seen["/sim/laser/pioneer2dx/laser"]["message"]["ranges"]) == len(seen["/RTCLaser0/range"]["message"]["ranges"])
    viewer = studio.viewer(protocol="foxglove.websocket.v1")
    viewer.send({"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 60000}]})
    assert "is not there" in viewer.event("status")["message"]
    viewer.send({"op": "request", "id": 1, "name": "run"})
    assert "rtmsim.studio.v1" in viewer.event("status")["message"]
    # Who sends to whom, for newer clients too; told again when that changes.
    newer = studio.viewer(protocol="foxglove.sdk.v1")
    assert "connectionGraph" in newer.event("serverInfo")["capabilities"]
    newer.send({"op": "subscribeConnectionGraph"})
    newer.event("connectionGraphUpdate", lambda m: {"name": "/RTCLaser0/range", "publisherIds": ["RTCLaser0"]} in m["publishedTopics"])
    rig.host("LaserObstacleAvoid")
    rig.there("LaserObstacleAvoid0")
    rig.rtse("con", "RTCLaser0:range", "LaserObstacleAvoid0:range")
    newer.event("connectionGraphUpdate", lambda m: {"name": "/RTCLaser0/range", "subscriberIds": ["LaserObstacleAvoid0"]} in m["subscribedTopics"])
    rig.rtse("dis", "RTCLaser0:range", "LaserObstacleAvoid0:range")
    newer.event("connectionGraphUpdate", lambda m: {"name": "/RTCLaser0/range", "subscriberIds": []} in m["subscribedTopics"])


# A client of another make sets parameters, calls services and publishes to an InPort.
def controls():
    rig.naming()
    rig.server("--rtf", "1")
    rig.host(rig.device("RTCPosition2d"), "LaserObstacleAvoid")
    rig.there("RTCPosition2d0", "LaserObstacleAvoid0")
    rig.rtse("act", "RTCPosition2d0")
    studio = Studio()
    studio.viewer().event("system", lambda m: len(m["components"]) == 2)
    name = "LaserObstacleAvoid0.max_turn"
    words = [f"ws://127.0.0.1:{studio.port}/ws?token={studio.token}", name, "55", "/RTCPosition2d0/velocity", json.dumps({"data": {"vx": 0.3}})]
    client = subprocess.Popen(["node", f"{rig.source}/tests/foreign/control.mjs", *words], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    timer = threading.Timer(120, client.kill)
    timer.start()

    def said(key):
        line = json.loads(client.stdout.readline())
        assert key in line, (key, line)
        return line

    def do(what):
        client.stdin.write(what + "\n")
        client.stdin.flush()

    try:
        offer = said("services")
        assert {"parameters", "parametersSubscribe", "services", "clientPublish"} <= set(offer["capabilities"]) and "json" in offer["encodings"], offer
        assert "/simulator/pause" in offer["services"] and "/simulator/spawn" in offer["services"], offer
        assert said("all")["all"][name] == 40
        assert said("before")["before"] == {name: 40}
        assert said("set")["set"] == {name: 55}
        assert said("after")["after"] == {name: 55}
        assert "55" in rig.rtse("conf", "LaserObstacleAvoid0", "get", "max_turn")
        assert said("call")["answer"] == {}
        await_("a pause", lambda: rig.stats()["paused"])
        assert said("call")["answer"]["steps"] >= 10
        assert "nobody" in said("call")["answer"]
        assert said("call")["answer"] == "rtf: expected a number"
        assert "no InPort has this topic" in said("refused")["refused"]
        rig.simctl("run")
        do("again")
        rig.driving("a published velocity")
        rig.rtse("conf", "LaserObstacleAvoid0", "set", "max_turn", "33")
        do("other")
        assert said("other")["other"] == {name: 33}
        do("end")
        assert client.wait(60) == 0
    finally:
        timer.cancel()
        client.kill()
        client.wait()
    # One who may only look reads, and changes nothing.
    watched = Studio("--read-only").viewer(protocol="foxglove.websocket.v1")
    assert "clientPublish" not in watched.event("serverInfo")["capabilities"]
    services = {one["name"]: one["id"] for one in watched.event("advertiseServices")["services"]}
    assert "/simulator/tree" in services and "/simulator/pause" not in services, services
    watched.send({"op": "setParameters", "parameters": [{"name": name, "value": 1}], "id": "x"})
    assert "read-only" in watched.event("status")["message"]
    watched.send({"op": "advertise", "channels": [{"id": 1, "topic": "/RTCPosition2d0/velocity", "encoding": "json", "schemaName": ""}]})
    assert "read-only" in watched.event("status")["message"]
    watched.send(struct.pack("<BIII", 2, 2, 7, 4) + b"json{}", opcode=2)  # pause
    assert watched.event("serviceCallFailure")["message"] == "this studio is read-only"
    watched.send(b"\x09", opcode=2)
    assert "binary frame" in watched.event("status")["message"]


# Joints obey as long as their command is renewed, and brake when it is released, not renewed, or its viewer has left.
def joints():
    rig.server("--rtf", "1", world=f"{rig.source}/worlds/arm.sdf")
    studio = Studio()
    viewer = studio.viewer()
    viewer.event("world", lambda m: m["present"])

    def waist():
        return next(joint for joint in json.loads(rig.simctl("--json", "joints", "arm")) if joint["name"] == "waist")

    def move(value, mode="position", joint="waist", by=viewer):
        return by.ask("move_joints", iface="arm::joints", joints={joint: {"mode": mode, "value": value}})

    def moved(value, by=viewer):
        return "error" not in move(value, by=by) and abs(waist()["position"] - value) < 0.01

    reply = move(0.3)
    assert reply["command"] == f"simctl -s {rig.server_id} joints arm waist=0.3", reply
    await_("the waist", lambda: moved(0.3))
    viewer.do("release", iface="arm::joints")
    await_("its brake", lambda: waist()["mode"] == "brake")
    await_("the waist", lambda: moved(-0.2))
    await_("a command that is not renewed", lambda: waist()["mode"] == "brake")
    other = studio.viewer()
    await_("the waist", lambda: moved(0.1, by=other))
    other.close()
    await_("a viewer that has left", lambda: waist()["mode"] == "brake")
    assert "waist, shoulder" in move(0, joint="knee")["error"]
    assert "expected position, velocity, effort, free or brake" in move(0, mode="fast")["error"]
    assert move(None)["error"] == "value of joint \"waist\": expected a number"
    assert "expected an object" in viewer.ask("move_joints", iface="arm::joints", joints={})["error"]
    assert "nobody" in viewer.ask("move_joints", iface="nobody::joints", joints={"a": {"mode": "free"}})["error"]
    looker = Studio("--read-only").viewer()
    assert move(0, by=looker)["error"] == "this studio is read-only"


# Pictures of a camera as JPEG, and a line when there is none.
def pictures():
    rig.naming()
    rig.server(world=f"{rig.source}/worlds/farm.sdf")
    studio = Studio()
    viewer = studio.viewer()
    world = viewer.event("world", lambda m: m["present"])
    camera = next(iface["name"] for iface in world["ifaces"] if iface["type"] == "camera")
    viewer.do("watch_image", watch=5, iface=camera)
    picture = viewer.wait_for(lambda m: isinstance(m, bytes) and m[0] == 0x83)
    assert struct.unpack_from("<I", picture, 4)[0] == 5 and picture[16:18] == b"\xff\xd8" and picture[-2:] == b"\xff\xd9", picture[:20]
    viewer.do("watch_image", watch=6, iface="nobody")
    assert "nobody" in viewer.event("values", lambda m: m["watch"] == 6)["error"]
    viewer.do("unwatch", watch=5)


# A recorded run without anything that runs: each viewer is shown the moment that it asks for, and nothing can be done to it.
def recording():
    file = rig.path("run.mcap")
    rig.call(f"{rig.bin_dir}/rtse", "run", f"{rig.source}/worlds/systems/obstacle_avoidance.xml", "-w", f"{rig.source}/worlds/obstacle_course.sdf", "-d", "6", "--record", file,
             "--module-path", rig.lib_dir)
    studio = Studio(file)
    viewer, other = studio.viewer(), studio.viewer()
    hello = viewer.event("hello")
    assert hello["read_only"] and hello["recording"]["from"] == 0 and hello["recording"]["to"] == 6, hello
    world = viewer.event("world", lambda m: m["present"])
    assert "pioneer2dx" in [model["name"] for model in world["models"]], world
    states = hello["recording"]["states"]
    assert len(states) == 3 and all(changes[0][1] == "Active" for changes in states.values()), states

    def places_at(who, seconds):
        who.send({"op": "request", "id": 999, "name": "look", "args": {"time": seconds, "whole": True}})
        frame = who.wait_for(lambda m: is_poses(m) and m[1] == 1 and struct.unpack_from("<Q", m, 8)[0] == round(seconds * 1e9))
        return sorted(poses_in(frame).items())

    there = places_at(viewer, 5.5)
    assert places_at(viewer, 1) != there
    assert places_at(other, 5.5) == there, "another viewer is shown the same"
    for step in range(51, 276):
        viewer.do("look", time=step / 50)  # by steps, as it plays: what comes of it is the same as by a jump
    assert places_at(viewer, 5.5) == there
    viewer.do("watch", watch=1, topic="/LaserObstacleAvoid0/velocity", members=["data.vx"])
    now = viewer.event("values", lambda m: m["watch"] == 1 and "v" in m)
    series = viewer.do("series", topic="/LaserObstacleAvoid0/velocity", members=["data.vx"])
    assert len(series["t"]) == 61 and series["left_out"] == 0 and dict(zip(series["t"], [v[0] for v in series["v"]]))[now["t"][0]] == now["v"][0][0], now
    thin = viewer.do("series", topic="/LaserObstacleAvoid0/velocity", members=["data.vx"], points=20, **{"from": 1, "to": 3})
    assert 15 <= len(thin["t"]) <= 21 and thin["left_out"] + len(thin["t"]) == 21 and 1 <= thin["t"][0] and thin["t"][-1] <= 3, thin
    viewer.do("watch", watch=2, topic="/sim/sonar/pioneer2dx/sonar")
    assert len(viewer.event("values", lambda m: m["watch"] == 2)["value"]["ranges"]) > 1
    viewer.do("watch", watch=3, topic="/nothing")
    assert viewer.event("values", lambda m: m["watch"] == 3)["error"] == "it was not recorded"
    path = next(path for path in states if "LaserObstacleAvoid0" in path)
    assert {"name": "stop_distance", "value": "0.5"}.items() <= next(v for v in viewer.do("component", path=path)["sets"][0]["values"] if v["name"] == "stop_distance").items()
    for name, args in {"activate": {"path": path}, "run": {}, "step": {"steps": 1}, "set_pose": {"model": "pioneer2dx", "planar": [0, 0, 0]}, "nonsense": {}}.items():
        assert "a recording shows what was" in viewer.ask(name, **args)["error"], name
    for name, args in {"look": {}, "series": {"topic": "/nothing", "members": ["a"]}, "component": {"path": "/no"}, "watch": {"watch": "x"}}.items():
        assert "error" in viewer.ask(name, **args), name
    viewer.do("look", time=1e300)
    viewer.do("look", time=-1e300)
    assert studio.get("/world.glb")[2][:4] == b"glTF"
    foreign = studio.viewer(protocol="foxglove.websocket.v1")
    assert "a recording is open here" in foreign.event("status")["message"]
    studio.lives()


# Where nothing runs, the lines that the page shows start a world and a system when they are pasted.
def hints():
    studio = Studio()
    viewer = studio.viewer()
    start = viewer.event("hello")["start"]
    assert viewer.event("world")["present"] is False
    rig.start("sh", "-c", f"exec {start['simulator']}")
    viewer.event("world", lambda m: m["present"] and m["server_id"] == int(rig.server_id))
    rig.start("sh", "-c", f"exec {start['components']}")
    viewer.event("system", lambda m: sum(not c["problem"] for c in m["components"]) == 3)
    viewer.do("run")
    viewer.event("time", lambda m: m["sim_time"] > 0.1)


# One command starts a world, a name server, an empty host and the browser, which gets the token by a file of this account alone. Signals end all.
def opens():
    browser = rig.path("browser")
    with open(browser, "w") as script:
        script.write(f"#!/bin/sh\necho \"$1\" > {rig.path('address')}.new\nmv {rig.path('address')}.new {rig.path('address')}\n")
    os.chmod(browser, 0o700)
    studio = Studio("--open", BROWSER=browser)
    viewer = studio.viewer()
    rig.servers.add(rig.server_id)
    assert viewer.event("world", lambda m: m["present"])["server_id"] == int(rig.server_id)
    manager = viewer.event("system", lambda m: any(not one["problem"] for one in m["managers"]))["managers"][0]["path"]
    viewer.do("create", manager=manager, type="LaserObstacleAvoid")
    viewer.event("system", lambda m: any(c["instance"] == "LaserObstacleAvoid0" for c in m["components"]))
    await_("the browser", lambda: os.path.exists(rig.path("address")))
    with open(rig.path("address")) as file:
        address = file.read().strip()
    assert address.startswith("file://") and studio.token not in address, address
    page = address.removeprefix("file://")
    with open(page) as file:
        assert f"#token={studio.token}" in file.read()
    assert os.stat(os.path.dirname(page)).st_mode & 0o077 == 0
    studio.process.terminate()
    assert studio.process.wait(30) == 0
    assert not os.path.exists(page)
    with socket.socket() as probe:
        assert probe.connect_ex(("127.0.0.1", int(rig.names.split(":")[1]))) != 0, "the name server runs on"


# A saved system with its world, started paused, and gone with the studio.
def started():
    studio = Studio(f"{rig.source}/worlds/systems/obstacle_avoidance.xml", "--world", f"{rig.source}/worlds/obstacle_course.sdf")
    viewer = studio.viewer()
    hello = viewer.event("hello")
    rig.servers.add(str(hello["server_id"]))
    assert viewer.event("time")["paused"]
    viewer.event("system", lambda m: len(m["components"]) == 3 and len(m["connections"]) == 2 and all(c["state"] == "Active" for c in m["components"]))
    viewer.do("run")
    viewer.event("time", lambda m: m["sim_time"] > 0.5)
    studio.process.terminate()
    assert studio.process.wait(30) == 0
    alone = Studio("--world", f"{rig.source}/worlds/empty.sdf")
    assert alone.viewer().event("world", lambda m: m["present"])["server_id"] == int(rig.server_id)


rig.run_case(case, globals())
