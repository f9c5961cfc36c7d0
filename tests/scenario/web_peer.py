"""A client of HTTP and WebSocket of our own, that can also say what no browser would."""
import base64
import json
import os
import re
import socket
import struct
import time

from system import watchdog

states = ("hello", "states", "system", "time", "world")  # events that tell how a thing is now: a newer one replaces an older one


class Closed(Exception):
    pass


def request(port, target="/", headers=None, method="GET", host=None, raw=None, limit=10, token=""):
    """Status, headers (names in lower case) and body of one request; status 0 when nothing came back."""
    with socket.create_connection(("127.0.0.1", port), timeout=limit) as line:
        line.settimeout(limit)
        if raw is None:
            all_headers = {"Host": host or f"127.0.0.1:{port}", "Connection": "close", **({"Authorization": f"Bearer {token}"} if token else {}), **(headers or {})}
            raw = f"{method} {target} HTTP/1.1\r\n".encode() + b"".join(
                f"{k}: {v}\r\n".encode() for k, v in all_headers.items() if v is not None) + b"\r\n"
        try:
            line.sendall(raw)
        except OSError:
            pass
        octets = b""
        try:
            while piece := line.recv(65536):
                octets += piece
        except OSError:
            pass
    head, _, body = octets.partition(b"\r\n\r\n")
    lines = head.decode("latin-1").split("\r\n")
    match = re.match(r"HTTP/1\.[01] (\d+)", lines[0])
    names = {k.strip().lower(): v.strip() for k, _, v in (one.partition(":") for one in lines[1:])}
    return (int(match.group(1)) if match else 0), names, body


class Socket:
    """One WebSocket."""

    # The token goes as a subprotocol, as the page sends it; `in_url`: as viewers send it that are given a URL and nothing else.
    def __init__(self, port, token="", protocol="rtmsim.studio.v1", headers=None, limit=watchdog, receive_buffer=0, in_url=False):
        self.line = socket.socket()
        self.limit = limit  # [s]; of each wait, however many pings and messages come meanwhile
        if receive_buffer:
            self.line.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
        self.end = time.monotonic() + limit
        self.line.settimeout(limit)
        self.line.connect(("127.0.0.1", port))
        self.octets = b""
        key = base64.b64encode(os.urandom(16)).decode()
        all_headers = {"Host": f"127.0.0.1:{port}", "Upgrade": "websocket", "Connection": "Upgrade", "Sec-WebSocket-Version": "13",
                       "Sec-WebSocket-Key": key, "Sec-WebSocket-Protocol": protocol + (f", token.{token}" if token and not in_url else ""), **(headers or {})}
        target = "/ws" + (f"?token={token}" if token and in_url else "")
        self.line.sendall(f"GET {target} HTTP/1.1\r\n".encode() + b"".join(
            f"{k}: {v}\r\n".encode() for k, v in all_headers.items() if v is not None) + b"\r\n")
        while b"\r\n\r\n" not in self.octets:
            self.more()
        head, _, self.octets = self.octets.partition(b"\r\n\r\n")
        self.head = head.decode("latin-1")
        self.status = int(self.head.split()[1])
        self.kept = []  # text messages that nobody has asked for yet
        self.received = 0
        self.last_id = 0

    def more(self):
        self.line.settimeout(max(self.end - time.monotonic(), 0.001))
        piece = self.line.recv(1 << 16)
        self.line.settimeout(self.limit)
        if not piece:
            raise Closed()
        self.octets += piece

    def exactly(self, count):
        while len(self.octets) < count:
            self.more()
        taken, self.octets = self.octets[:count], self.octets[count:]
        return taken

    def frame(self):
        """Opcode and payload of the next frame; pings are answered."""
        self.end = time.monotonic() + self.limit
        while True:
            first, second = self.exactly(2)
            size = second & 0x7F
            if size == 126:
                size = struct.unpack(">H", self.exactly(2))[0]
            elif size == 127:
                size = struct.unpack(">Q", self.exactly(8))[0]
            payload = self.exactly(size)
            self.received += size + 2
            if first & 15 == 9:
                self.send(payload, 10)
            elif first & 15 == 8:
                raise Closed(payload)
            elif first & 15 in (1, 2):
                return first & 15, payload

    def message(self):
        """The next one: a dict, or octets."""
        opcode, payload = self.frame()
        return json.loads(payload) if opcode == 1 else payload

    def send(self, payload, opcode=1, mask=True, head=None):
        if isinstance(payload, (dict, list)):
            payload = json.dumps(payload)
        if isinstance(payload, str):
            payload = payload.encode()
        key = os.urandom(4)
        size = len(payload)
        first = 0x80 | opcode if head is None else head
        bits = 0x80 if mask else 0
        if size < 126:
            octets = struct.pack(">BB", first, bits | size)
        elif size < 65536:
            octets = struct.pack(">BBH", first, bits | 126, size)
        else:
            octets = struct.pack(">BBQ", first, bits | 127, size)
        if mask:
            pad = (key * (size // 4 + 1))[:size]
            payload = (int.from_bytes(payload, "big") ^ int.from_bytes(pad, "big")).to_bytes(size, "big") if size else b""
            octets += key
        self.line.sendall(octets + payload)

    def wait_for(self, fits):
        """The first message that fits, among those that were passed over and those to come. States that are older than the one that fits are forgotten."""
        end = time.monotonic() + self.limit
        next_kept = 0
        while True:
            if next_kept == len(self.kept):
                try:
                    self.kept = self.kept[-1000:] + [self.message()]
                except TimeoutError:
                    raise AssertionError(f"nothing in {self.limit} s; {self.last_messages()}") from None
                next_kept = len(self.kept) - 1
            message = self.kept[next_kept]
            if fits(message):
                op = message.get("op") if isinstance(message, dict) else None
                older = [m for m in self.kept[:next_kept] if not (op in states and isinstance(m, dict) and m.get("op") == op)]
                self.kept = older + self.kept[next_kept + 1:]
                return message
            next_kept += 1
            assert time.monotonic() < end, f"not within {self.limit} s; {self.last_messages()}"

    def last_messages(self):
        return f"the last messages: {[str(m)[:300] for m in self.kept if isinstance(m, dict)][-5:]}"

    def event(self, op, fits=lambda message: True):
        return self.wait_for(lambda m: isinstance(m, dict) and m.get("op") == op and fits(m))

    def ask(self, name, /, dry=False, **args):
        """The whole reply."""
        self.last_id += 1
        mine = self.last_id
        self.send({"op": "request", "id": mine, "name": name, "args": args, "dry": dry})
        return self.event("reply", lambda m: m.get("id") == mine)

    def do(self, name, /, **args):
        """The result; a refusal is a failure."""
        reply = self.ask(name, **args)
        assert "error" not in reply, f"{name} {args}: {reply['error']}"
        return reply["result"]

    def close(self):
        self.line.close()
