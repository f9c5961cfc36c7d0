# rtm-studio before viewers of all kinds, one case per run: studio.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import json
import os
import random
import socket
import struct
import subprocess
import sys
import threading
import time

from rig import Rig, await_
from web_peer import Closed, Socket, request

case, *folders = sys.argv[1:]
rig = Rig(*folders)


class Studio:
    def __init__(self, *options, **environment):
        self.process = rig.start(f"{rig.bin_dir}/rtm-studio", "--ns", rig.names, "-s", rig.server_id, "--port", "0", *options, **environment)
        await_("the URL, or an end", lambda: rig.log(self.process).startswith("http") or self.process.poll() is not None)
        assert self.process.poll() is None, (self.process.args, self.process.returncode, rig.log(self.process))
        url = rig.log(self.process).splitlines()[0]
        self.token = url.split("token=")[1]
        self.port = int(url.split(":")[2].split("/")[0])

    def viewer(self, **more):
        socket = Socket(self.port, self.token, **more)
        assert socket.status == 101, socket.head
        return socket

    # With the token, if nothing else is said.
    def get(self, target="/", token=None, **more):
        return request(self.port, target, token=self.token if token is None else token, **more)

    def lives(self):
        assert self.process.poll() is None, self.process.returncode
        viewer = self.viewer()
        viewer.event("hello")
        viewer.close()


def poses_in(frame):
    count = struct.unpack_from("<I", frame, 16)[0]
    return {struct.unpack_from("<I", frame, 24 + 24 * i)[0]: struct.unpack_from("<fff", frame, 28 + 24 * i) for i in range(count)}


def is_poses(message):
    return isinstance(message, bytes) and message[0] == 0x81


# Without the token nothing is read and nothing is done, whoever asks and however. The page itself is the same for everybody and shows nothing.
def doors():
    rig.naming()
    rig.server("-u")
    studio = Studio()
    for target in ("/world.glb", "/access", "/assets/x.js", "/no", "/ws", "//", "/../etc/passwd"):
        for token in ("", "0" * 32, studio.token[:-1], studio.token + "0"):
            status, headers, body = studio.get(target, token=token)
            assert status == (403 if token else 401), (target, token, status)
            assert b"token" in body and studio.token.encode() not in body and b"glTF" not in body, body
            assert "set-cookie" not in headers, headers
        # A URL is in logs and histories: it brings the token to a WebSocket alone, whose clients may have nothing else.
        assert studio.get(f"{target}?token={studio.token}", token="")[0] == 401, target
    for page in ("/", f"/?token={studio.token}", "/?token=wrong"):
        status, headers, body = studio.get(page, token="")
        assert status == 200 and b"rtm-studio" in body and studio.token.encode() not in body, (status, body)
        assert "set-cookie" not in headers, headers
    for host in ("evil.example", f"evil.example:{studio.port}", "", None):
        for target in ("/", "/world.glb"):
            status, _, _ = studio.get(target, headers={"Host": host})
            assert status in (400, 403), (host, status)
    for origin in ("http://evil.example", "null", f"http://127.0.0.1:{studio.port + 1}"):
        assert studio.get("/world.glb", headers={"Origin": origin})[0] == 403
        assert studio.get("/", headers={"Origin": origin})[0] == 403
        assert Socket(studio.port, studio.token, headers={"Origin": origin}).status == 403
    assert Socket(studio.port, "").status == 401
    for in_url in (False, True):
        assert Socket(studio.port, "wrong", in_url=in_url).status == 403
        assert Socket(studio.port, studio.token, in_url=in_url).status == 101
    answered = Socket(studio.port, studio.token)
    assert "sec-websocket-protocol: rtmsim.studio.v1\r\n" in (answered.head + "\r\n").lower() and studio.token not in answered.head, answered.head
    assert Socket(studio.port, "", headers={"Authorization": f"Bearer {studio.token}"}).status == 101
    assert Socket(studio.port, studio.token, headers={"Authorization": "Bearer wrong"}).status == 403
    assert Socket(studio.port, studio.token, protocol="other").status == 400
    for method in ("POST", "PUT", "DELETE", "OPTIONS", "TRACE"):
        assert studio.get("/world.glb", method=method)[0] == 405
    status, headers, body = studio.get("/")
    assert "default-src 'none'" in headers["content-security-policy"] and "unsafe" not in headers["content-security-policy"], headers
    for name, value in {"x-content-type-options": "nosniff", "referrer-policy": "no-referrer", "cache-control": "no-store"}.items():
        assert headers[name] == value, headers
    assert studio.get("/access")[0] == 204
    status, headers, body = studio.get("/world.glb")
    assert status == 200 and body[:4] == b"glTF", status
    assert studio.get("/world.glb", headers={"If-None-Match": headers["etag"]})[0] == 304
    # No cookie counts, whatever is in it.
    for cookie in (f"rtm-studio-{studio.port}={studio.token}", f"token={studio.token}"):
        assert studio.get("/world.glb", token="", headers={"Cookie": cookie})[0] == 401
        assert Socket(studio.port, headers={"Cookie": cookie}).status == 401
    other = Studio("--allow-origin", "https://viewer.example", "--host", "robots.example")
    assert Socket(other.port, other.token, headers={"Origin": "https://viewer.example"}).status == 101
    assert Socket(other.port, other.token, headers={"Host": "robots.example"}).status == 101
    assert other.get("/world.glb", token=studio.token)[0] == 403, "each has its own"
    # For "localhost" a browser may ask an address that is not ours: somebody who listens there would get the token.
    everywhere = Studio("--bind", "0.0.0.0")
    assert rig.log(everywhere.process).startswith(f"http://127.0.0.1:{everywhere.port}/#token="), rig.log(everywhere.process)
    studio.lives()


# Requests that two programs could read in two ways are answered by neither.
def two_ways():
    rig.naming()
    studio = Studio()
    here, bearer = f"Host: 127.0.0.1:{studio.port}", f"Authorization: Bearer {studio.token}"
    get = "GET /access HTTP/1.1"

    def status(*lines, end="\r\n"):
        return studio.get(raw=(end.join(lines) + end + end).encode("latin-1"), limit=5)[0]

    assert status(get, here, bearer, "Connection: close") == 204
    assert status(f"GET http://127.0.0.1:{studio.port}/access HTTP/1.1", here, bearer, "Connection: close") == 204
    for lines in ((get, here, "Host: evil.example", bearer), (get, here, here, bearer), (get, bearer), (get, here, " Host: evil.example", bearer),
                  (get, here, bearer, "X: a", "\tb"), (get, "Host : a", here, bearer), (get, here, "X y: z", bearer), (get, here, "X", bearer),
                  (get, here, bearer, "Content-Length: 0", "Content-Length: 0"), (get, here, bearer, "Content-Length: 0", "Content-Length: 7"),
                  (get, here, bearer, "Content-Length: 0", "Transfer-Encoding: chunked"), (get, here, bearer, "Transfer-Encoding: chunked"),
                  (get, here, bearer, "Content-Length: -1"), (get, here, bearer, "X: a\rHost: b"), (get, here, bearer, "X: a\nHost: b"), (get, here, bearer, "X: \0"),
                  (get, here, bearer, f"Origin: http://127.0.0.1:{studio.port}", "Origin: http://evil.example"), (get, here, bearer, bearer),
                  ("GET http://evil.example/access HTTP/1.1", here, bearer), (f"GET http://127.0.0.1:{studio.port}@evil.example/access HTTP/1.1", here, bearer),
                  ("GET access HTTP/1.1", here, bearer), ("GET /access HTTP/1.1 x", here, bearer), ("GET  /access HTTP/1.1", here, bearer), ("OPTIONS * HTTP/1.1", here, bearer)):
        assert status(*lines) == 400, lines
    assert status(get, here, bearer, end="\n") == 400
    assert status(get, here, bearer, "Content-Length: 7") == 413
    # What follows a refused request is not read.
    smuggled = f"{get}\r\n{here}\r\n{bearer}\r\n\r\n".encode()
    with socket.create_connection(("127.0.0.1", studio.port), timeout=10) as line:
        line.sendall(f"GET / HTTP/1.1\r\n{here}\r\nContent-Length: {len(smuggled)}\r\n\r\n".encode() + smuggled)
        octets = b""
        try:
            while piece := line.recv(65536):
                octets += piece
        except ConnectionResetError:
            pass
        assert octets.count(b"HTTP/1.1") <= 1 and b"204" not in octets, octets
    # Two good ones in one packet are both answered.
    with socket.create_connection(("127.0.0.1", studio.port), timeout=10) as line:
        line.sendall(smuggled + smuggled)
        octets = b""
        while octets.count(b"HTTP/1.1 204") < 2:
            piece = line.recv(65536)
            assert piece, octets
            octets += piece
    studio.lives()


# Requests and frames that are too long, no requests, no frames.
def garbage():
    rig.naming()
    rig.server("-u")
    studio = Studio()
    assert studio.get(headers={"X": "x" * 9000})[0] == 431
    assert studio.get(headers={"Content-Length": "5"})[0] == 413
    for raw in (b"\r\n\r\n", b"\0" * 100, b"GET\r\n\r\n", b"GET / HTTP/9.9\r\n\r\n", b"x" * 20000, b"GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n",
                b"GET / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\nffffffffff\r\n", b"\x16\x03\x01\x02\x00\x01\x00"):
        status, _, _ = studio.get(raw=raw, limit=1)
        assert status in (0, 400, 401, 403, 413, 431), (raw[:30], status)
    seed = random.randrange(1 << 30)
    print("seed", seed)
    dice = random.Random(seed)
    mutations = int(os.environ.get("RTMSIM_STUDIO_MUTATIONS", "3000"))
    seeds = [{"op": "request", "id": 1, "name": name, "args": args} for name, args in (
        ("tree", {}), ("set_pose", {"model": "pioneer2dx", "planar": [0, 0, 0]}), ("watch", {"watch": 1, "topic": "/sim/laser/pioneer2dx/laser"}),
        ("component", {"path": "/a/b.rtc"}), ("drive", {"iface": "pioneer2dx::position2d", "velocity": [0, 0, 0]}), ("connection_options", {"ports": ["a:b", "c:d"]}))]
    seeds += [{"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 1}]}, {"op": "unsubscribe", "subscriptionIds": [1]}]
    texts = [json.dumps(one).encode() for one in seeds]
    viewer, opened = None, 0
    for i in range(mutations):
        if viewer is None:
            viewer, opened = studio.viewer(), opened + 1
            viewer.line.setblocking(False)
        octets = bytearray(dice.choice(texts))
        for _ in range(dice.randrange(6)):
            at = dice.randrange(len(octets))
            octets[at:at + dice.randrange(3)] = bytes(dice.randrange(256) for _ in range(dice.randrange(4)))
            octets = octets or bytearray(b" ")
        opcode = dice.choice((1, 1, 1, 1, 1, 1, 2, 0, 8, 9, 10, 3, 15))
        head = dice.choice((None,) * 30 + (dice.randrange(256),))
        try:
            viewer.line.settimeout(5)
            viewer.send(bytes(octets), opcode, mask=dice.random() < 0.98, head=head)
            viewer.line.setblocking(False)
            while viewer.line.recv(1 << 16):
                pass
            raise Closed()
        except BlockingIOError:
            pass
        except (Closed, OSError):
            viewer.close()
            viewer = None
    print(mutations, "frames,", opened, "connections")
    viewer = studio.viewer()
    try:
        viewer.send(b" " * (2 << 20))
        while True:
            viewer.message()
    except (Closed, OSError):
        pass
    studio.lives()


# Holds so many connections that say nothing, and renews each that ends; its own program, so that it can be another account.
crowd_program = """
import os, select, socket, sys
port, count, account = map(int, sys.argv[1:])
if account:
    os.setgroups([])
    os.setgid(account)
    os.setuid(account)
held = {}
watch = select.poll()
while True:
    while len(held) < count:
        line = socket.create_connection(("127.0.0.1", port))
        held[line.fileno()] = line
        watch.register(line, select.POLLIN)
    print("full", flush=True)
    for number, _ in watch.poll():
        watch.unregister(number)
        held.pop(number).close()
"""


# Connections that say nothing lock nobody out, and no viewer has to go for them.
def crowd():
    rig.naming()
    studio = Studio()
    viewer = studio.viewer()
    account = 65534 if os.geteuid() == 0 else 0
    with subprocess.Popen(["/usr/bin/python3", "-c", crowd_program, str(studio.port), "128", str(account)], stdout=subprocess.PIPE, cwd="/") as idle:
        try:
            assert idle.stdout.readline() == b"full\n"
            threading.Thread(target=idle.stdout.read, daemon=True).start()  # nothing waits for us to read
            began = time.monotonic()
            served = [studio.get("/access")[0] for _ in range(60)]
            took = time.monotonic() - began
            assert served == [204] * 60, served
            viewer.event("hello")
            viewer.do("recordings")
        finally:
            idle.kill()
    said = rig.log(studio.process).count("rejected: too many connections")
    assert 1 <= said <= took + 3, (said, took)
    studio.lives()


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


# Nothing is done for those who may only look.
def read_only():
    rig.naming()
    rig.server("-u")
    studio = Studio("--read-only")
    viewer = studio.viewer()
    assert viewer.event("hello")["read_only"] is True
    for name, args in {"run": {}, "step": {"steps": 5}, "set_pose": {"model": "pioneer2dx", "planar": [0, 0, 0]}, "spawn": {"model": "x"}, "delete_model": {"model": "pioneer2dx"},
                       "drive": {"iface": "pioneer2dx::position2d", "velocity": [1, 0, 0]}, "activate": {"path": "/a/b.rtc"}, "create": {"manager": "m", "type": "t"},
                       "open_profile": {"xml": "<x/>"}, "connect": {"ports": ["a:b", "c:d"]}, "disconnect": {"port": "a", "id": "b"}, "exit": {"path": "p"}, "speed": {"rtf": 2},
                       "reset_world": {}, "load_module": {"manager": "m", "file": "f"}, "release": {"iface": "i"}, "push": {"name": "a", "force": [1, 2, 3]}}.items():
        assert viewer.ask(name, **args)["error"] == "this studio is read-only", name
    assert viewer.ask("run", dry=True)["command"].endswith("run")
    assert viewer.do("tree")["models"]
    assert rig.stats()["steps"] == 0 and rig.stats()["paused"]


# Simulator, naming service and components go and come back; the page is told, and the server stays.
def comes_back():
    studio = Studio()
    viewer = studio.viewer()
    assert viewer.event("world")["present"] is False
    assert viewer.event("system")["problem"]
    simulator = rig.server("-u")
    viewer.event("world", lambda m: m["present"])
    viewer.wait_for(is_poses)
    rig.kill(simulator)
    viewer.event("world", lambda m: not m["present"] and "has exited" in m["problem"])
    assert "error" in viewer.ask("run")
    rig.server("-u")
    viewer.event("world", lambda m: m["present"])
    viewer.wait_for(is_poses)
    naming = rig.naming()
    host = rig.host("LaserObstacleAvoid")
    viewer.event("system", lambda m: m["problem"] == "" and any(c["instance"] == "LaserObstacleAvoid0" and not c["problem"] for c in m["components"]))
    rig.kill(naming)
    viewer.event("system", lambda m: m["problem"] != "")
    rig.naming()
    viewer.event("system", lambda m: any(c["instance"] == "LaserObstacleAvoid0" and not c["problem"] for c in m["components"]))
    rig.kill(host)
    dead = viewer.event("system", lambda m: any(c["problem"] for c in m["components"]))
    assert all(c["state"] == "Unknown" for c in dead["components"] if c["problem"])
    viewer.do("run")
    studio.lives()


# One who does not read holds up nobody, costs no memory, and sees the present when it reads on.
def slow_viewer():
    rig.naming()
    rig.server()
    studio = Studio()
    slow = studio.viewer(receive_buffer=4096)
    quick = studio.viewer()
    quick.do("watch", watch=1, topic="/sim/position2d/pioneer2dx/position2d")
    slow.do("watch", watch=1, topic="/sim/laser/pioneer2dx/laser", hz=60)
    begin = quick.event("time")["sim_time"]
    last = begin
    while last < begin + 6:
        last = quick.event("time")["sim_time"]
    quick.do("pause")
    paused_at = quick.event("time", lambda m: m["paused"])["sim_time"]
    received = slow.received
    # What was on the way, at most the buffers of two systems, and then the present.
    now = slow.event("time", lambda m: m["paused"])["sim_time"]
    assert now == paused_at, (now, paused_at)
    print("to the slow one after its sleep:", slow.received - received, "octets")
    assert slow.received - received < 1 << 20


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


with rig:
    globals()[case]()
print("ok")
