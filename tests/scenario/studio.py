# rtm-studio before viewers of all kinds, one case per run: studio.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import json
import os
import random
import signal
import socket
import subprocess
import threading
import time

from studio_rig import Studio, case, is_poses, rig
from web_peer import Closed, Socket


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
    # It is killed between two requests of the studio, and during one: the studio asks every 0.25 s at least, and waits 2 s for an answer.
    for is_asked in (False, True):
        simulator = rig.server("-u")
        viewer.event("world", lambda m: m["present"])
        viewer.wait_for(is_poses)
        if is_asked:
            simulator.send_signal(signal.SIGSTOP)
            time.sleep(0.6)
        rig.kill(simulator)
        gone = viewer.event("world", lambda m: not m["present"])
        assert gone["problem"] == f"simulator {rig.server_id} has exited; this page waits for it to restart", gone
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


rig.run_case(case, globals())
