# What the campaigns share: an rtcd of their own on a port of loopback, and connections that send it whatever they like. Traffic goes to 127.0.0.1 only.
import argparse
import ctypes
import os
import random
import resource
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time

# Programs with sanitizers take several times as much of both (no_report.py).
sanitized = "RTMSIM_SANITIZED" in os.environ
watchdog = 300 if sanitized else 60
memory_factor = 4 if sanitized else 1


def message(kind, body, more=False, minor=2):
    return b"GIOP" + bytes([1, minor, 1 | 2 * more, kind]) + struct.pack("<I", len(body)) + body


def pad(data, size=8, offset=12):
    return data + bytes(-(len(data) + offset) % size)


def head(identity, key, operation):
    """The head of a request of GIOP 1.2, up to its arguments."""
    data = struct.pack("<IBxxxHxxI", identity, 3, 0, len(key)) + key
    data = data + bytes(-len(data) % 4)
    name = operation.encode() + b"\0"
    return pad(data + struct.pack("<I", len(name)) + name + bytes(-len(name) % 4) + struct.pack("<I", 0))


def locate(identity, key=b"manager"):
    return message(3, struct.pack("<IHxxI", identity, 0, len(key)) + key)


def listening_ports(pid):
    """Of 127.0.0.1, where that process listens."""
    sockets = set()
    for entry in os.listdir(f"/proc/{pid}/fd"):
        try:
            sockets.add(os.readlink(f"/proc/{pid}/fd/{entry}"))
        except OSError:
            continue
    with open(f"/proc/{pid}/net/tcp") as table:
        rows = [row.split() for row in table.readlines()[1:]]
    return [int(row[1].split(":")[1], 16) for row in rows if row[3] == "0A" and f"socket:[{row[9]}]" in sockets]


def name_server(above):
    """The process of omniNames that this one, or one below it, has started."""
    for entry in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{entry}/stat") as stat, open(f"/proc/{entry}/cmdline") as words:
                parent, command = int(stat.read().rsplit(")", 1)[1].split()[1]), words.read()
        except OSError:
            continue
        if parent != above:
            continue
        if "-datadir" in command:
            return int(entry)
        if found := name_server(int(entry)):
            return found
    return None


class Host:
    """An rtcd; with `wrapper` a program before it, as valgrind. Ended by pid."""

    def __init__(self, bin_dir, lib_dir, *options, wrapper=(), files=None, **environment):
        bin_dir, lib_dir = os.path.abspath(bin_dir), os.path.abspath(lib_dir)
        self.folder = tempfile.TemporaryDirectory()
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.port = probe.getsockname()[1]
        self.log = open(f"{self.folder.name}/log", "wb")
        command = [*wrapper, f"{bin_dir}/rtcd", "-i", "-f", "none.conf", "-d", "-p", str(self.port), "-o", "naming.enable:NO", "-o", f"manager.modules.load_path:{lib_dir}", *options]

        def prepare():
            ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG: it ends with us, however we end
            if files:
                resource.setrlimit(resource.RLIMIT_NOFILE, (files, files))

        self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=self.log, stderr=self.log, cwd=self.folder.name, preexec_fn=prepare, env={**os.environ, **environment})
        until = time.monotonic() + watchdog
        while not self.answers():
            if self.process.poll() is not None or time.monotonic() > until:
                raise AssertionError("rtcd does not start: " + self.text())
            time.sleep(0.05)

    def text(self):
        with open(self.log.name, errors="replace") as log:
            return log.read()

    def connect(self, timeout=10, port=None):
        return socket.create_connection(("127.0.0.1", port or self.port), timeout=timeout)

    # One whole request is answered; at another port by what it has started.
    def answers(self, timeout=10, port=None):
        try:
            with self.connect(timeout, port) as stream:
                stream.sendall(locate(7))
                return stream.recv(12)[:4] == b"GIOP"
        except OSError:
            return False

    def memory(self, pid=None):
        with open(f"/proc/{pid or self.process.pid}/status") as status:
            return next(int(line.split()[1]) for line in status if line.startswith("VmHWM:")) // 1024  # [MiB]

    def end(self):
        self.process.send_signal(signal.SIGTERM)
        try:
            return self.process.wait(watchdog)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
            return "hangs"
        finally:
            self.log.close()


def check(condition, what, host):
    if not condition:
        print(what, host.text()[-4000:], sep="\n", file=sys.stderr)
        if host.process.poll() is None:
            host.process.kill()
            host.process.wait()
        sys.exit(1)


def seeded(given):
    seed = given if given is not None else int.from_bytes(os.urandom(4), "little")
    print(f"seed {seed}", flush=True)
    return random.Random(seed)


# Of a campaign that sends messages.
def message_options():
    parser = argparse.ArgumentParser()
    parser.add_argument("bin_dir")
    parser.add_argument("lib_dir")
    parser.add_argument("--messages", type=int, default=20000)
    parser.add_argument("--seconds", type=float, help="again and again for so long")
    parser.add_argument("--connections", type=int, default=8)
    parser.add_argument("--seed", type=int)
    parser.add_argument("--valgrind", action="store_true")
    return parser.parse_args()


# The parser of a campaign against a whole system, for a number of rounds or for so long; it may get more options.
def system_options(rounds):
    parser = argparse.ArgumentParser()
    parser.add_argument("folders", nargs=3)
    parser.add_argument("--rounds", type=int, default=rounds)
    parser.add_argument("--seconds", type=float)
    parser.add_argument("--seed", type=int)
    return parser


# What is answered does not matter, but it must be taken.
def drain(stream):
    try:
        while stream.recv(65536):
            pass
    except OSError:
        pass
