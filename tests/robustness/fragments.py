# Requests in fragments of every kind, many connections at the same time: fragments.py BIN_DIR LIB_DIR [--messages N] [--seconds T] [--seed S] [--valgrind]
# omniORB 4.2 dies of 1,400 of them when they reach it. Half of the connections lead to rtcd, half to the naming service that it has started. Ends well when both still answer, rtcd has ended with 0 and
# neither has taken much memory. With --valgrind both run under it.
import os
import re
import shutil
import socket
import struct
import sys
import tempfile
import threading
import time

from attacker import Host, check, drain, head, locate, memory_factor, message, message_options, name_server, pad, seeded

options = message_options()
random = seeded(options.seed)

keys = [b"manager", b"NameService", b"INIT", b"nobody", b"\xff\x00\x00\x00"]
operations = ["get_profile", "set_configuration", "create_component", "get_components", "nonsense", "put", "_is_a", "_non_existent"]


def burst(rng):
    """Messages of one connection, and whether a good peer could have sent them."""
    identity = rng.randrange(1 << 20)
    first = head(identity, rng.choice(keys), rng.choice(operations))
    tail = struct.pack("<I", 8) + b"key.any\0" + struct.pack("<I", 6) + b"value\0"
    pieces = [pad(tail + bytes(rng.randrange(64)), 8, 16) for _ in range(rng.randrange(1, 5))]
    good = [message(0, first, True)] + [message(7, struct.pack("<I", identity) + piece, i + 1 < len(pieces)) for i, piece in enumerate(pieces)]
    shape = rng.randrange(8)
    if shape < 3:
        return good, True
    if shape == 3:
        return good[:-1] + [message(2, struct.pack("<I", identity))], True  # cancelled
    if shape == 4:
        return good[:1] + [locate(identity + 1)] + good[1:], False
    if shape == 5:
        return good[:1] + [message(7, struct.pack("<I", identity + 1) + bytes(12), True)] + good[1:], False
    if shape == 6:
        return [good[-1]] + good, False
    broken = bytearray(b"".join(good))
    for _ in range(rng.randrange(1, 4)):
        broken[rng.randrange(len(broken))] = rng.randrange(256)
    return [bytes(broken)], False


def files_of(pid):
    return len(os.listdir(f"/proc/{pid}/fd"))


def processor_time(pid):
    """[s]"""
    with open(f"/proc/{pid}/stat") as file:
        fields = file.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class Attack(threading.Thread):
    def __init__(self, host, port, seed, count):
        super().__init__(daemon=True)
        self.port = port
        self.host, self.rng, self.left, self.sent, self.closed = host, __import__("random").Random(seed), count, 0, 0

    def goes_on(self):
        return self.left > 0 and (not until or time.monotonic() < until)

    def run(self):
        while self.goes_on() and self.host.process.poll() is None:
            try:
                with socket.create_connection(("127.0.0.1", self.port), timeout=10) as stream:
                    self.talk(stream)
            except OSError:
                self.closed += 1
                self.left -= 1

    def talk(self, stream):
        reader = threading.Thread(target=drain, args=(stream,), daemon=True)
        reader.start()
        good = True
        while good and self.goes_on():
            messages = []
            while good and len(messages) < 200:
                more, good = burst(self.rng)
                messages += more
            self.left -= len(messages)
            self.sent += len(messages)
            stream.sendall(b"".join(messages))
        try:
            stream.shutdown(1)
        except OSError:
            pass
        reader.join(30)


wrapper = ()
found = tempfile.TemporaryDirectory()
if options.valgrind:
    wrapper = (shutil.which("valgrind") or "valgrind", "--error-exitcode=99", "-q", "--num-callers=20", "--trace-children=yes", f"--log-file={found.name}/%p",
               "--undef-value-errors=no")  # omniORB sends gaps of alignment as they are
with socket.socket() as probe:
    probe.bind(("127.0.0.1", 0))
    names_port = probe.getsockname()[1]
host = Host(options.bin_dir, options.lib_dir, "--with-naming", "-o", f"corba.nameservers:127.0.0.1:{names_port}", wrapper=wrapper)
names = name_server(host.process.pid)
until = options.seconds and time.monotonic() + options.seconds
messages = sys.maxsize if until else options.messages
attacks = [Attack(host, names_port if i % 2 else host.port, random.randrange(1 << 30), messages // options.connections) for i in range(options.connections)]
for attack in attacks:
    attack.start()
for attack in attacks:
    attack.join()
check(host.process.poll() is None, "rtcd has died", host)
check(host.answers(), "rtcd does not answer any more", host)
check(host.answers(port=names_port) and name_server(host.process.pid) == names, "the naming service has died, or does not answer any more", host)
# omniORB 4.2 alone keeps connections of which it expects the rest of a message for ever, and a thread that asks for it without rest.
rested = time.monotonic() + 60
while files_of(names) > 40 and time.monotonic() < rested:
    time.sleep(0.1)
check(files_of(names) <= 40, f"the naming service keeps {files_of(names)} files of connections that have ended", host)
before = processor_time(names)
time.sleep(1)
check(processor_time(names) - before < 0.5, "the naming service works on for nobody", host)
memory = host.memory()
check(options.valgrind or host.memory(names) < 400 * memory_factor, f"the naming service has taken {host.memory(names)} MiB", host)
code = host.end()
reports = []
for name in os.listdir(found.name):
    with open(f"{found.name}/{name}", errors="replace") as file:
        reports += file.read().splitlines()
reports += [line for line in host.text().splitlines() if line.startswith("==")]  # of sanitizers
check(code == 0 and not reports, "\n".join([f"rtcd has ended with {code}", *reports[:200]]), host)
check(options.valgrind or memory < 400 * memory_factor, f"rtcd has taken {memory} MiB", host)
check(not re.search("Invalid (read|write)|ERROR: AddressSanitizer|runtime error:|WARNING: ThreadSanitizer", host.text()), "something was found", host)
print(f"{sum(a.sent for a in attacks)} messages, {sum(a.closed for a in attacks)} connections refused, {memory} MiB at most")
