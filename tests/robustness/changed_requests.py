# What real tools say, changed: changed_requests.py BIN_DIR LIB_DIR [--messages N] [--seconds T] [--connections N] [--seed S] [--valgrind]
# Each verb of rtse talks to components and to a naming service of ours through two ears that keep every request: the corpus, made anew in each run, so that object keys are those of living
# objects. Then its messages are sent again, changed: octets, lengths, pieces of other messages, fragments. Ends well when components and names still answer, rtcd has ended with 0 and has not taken
# much memory. Changed references may name other hosts: as root it goes on in a network of its own, else addresses stay as they are.
import ctypes
import fcntl
import random as randomness
import re
import shutil
import socket
import struct
import subprocess
import sys
import threading
import time

from attacker import Host, check, drain, head, memory_factor, message, message_options, seeded, watchdog

options = message_options()
random = seeded(options.seed)
components = ["SourceAll", "SinkAll", "EchoProvider", "EchoConsumer", "ConfigDemo", "FailOnRequest"]
# What these do is their business: they end what is to be tried out.
left_out = (b"shutdown", b"exit", b"delete_component", b"unload_module", b"destroy")


def alone():
    """In a network of our own, which has nothing but its loopback; False when this user may not."""
    if ctypes.CDLL(None, use_errno=True).unshare(0x40000000) != 0:  # CLONE_NEWNET
        return False
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        fcntl.ioctl(any_socket, 0x8914, struct.pack("16sh14x", b"lo", 0x1 | 0x40))  # SIOCSIFFLAGS: up and running
    return True


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def whole_messages(buffer):
    """Takes whole GIOP messages from the beginning of a bytearray."""
    while len(buffer) >= 12:
        size = 12 + int.from_bytes(buffer[8:12], "little" if buffer[6] & 1 else "big")
        if len(buffer) < size:
            return
        yield bytes(buffer[:size])
        del buffer[:size]


def exactly(stream, count):
    data = b""
    while len(data) < count:
        piece = stream.recv(count - len(data))
        if not piece:
            raise OSError("closed")
        data += piece
    return data


def renamed(one, operation):
    """The same request for another operation; GIOP 1.2, without service contexts of its own."""
    number, key_size = struct.unpack("<I", one[12:16])[0], struct.unpack("<I", one[24:28])[0]
    at = 28 + key_size + -key_size % 4
    size = struct.unpack("<I", one[at:at + 4])[0]
    at += 4 + size + -size % 4
    contexts = struct.unpack("<I", one[at:at + 4])[0]
    at += 4
    for _ in range(contexts):
        size = struct.unpack("<I", one[at + 4:at + 8])[0]
        at += 8 + size + -size % 4
    return message(0, head(number, one[28:28 + key_size], operation) + one[at + -at % 8:])


class Ear:
    """A port before that of a server. What comes is kept by its operation; what goes back names this port instead of the server's, in references and in texts of them, and what comes names the
    server's again."""

    max_of_one = 24  # messages of one operation

    def __init__(self, port):
        self.server = port
        self.heard = {}
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        names = [b"127.0.0.1\0" + struct.pack("<H", number) for number in (self.server, self.port)]
        self.changes = [tuple(names), tuple(name.hex().encode() for name in names), tuple(name.hex().upper().encode() for name in names)]
        threading.Thread(target=self.listen, daemon=True).start()

    def listen(self):
        while True:
            come, _ = self.listener.accept()
            there = socket.create_connection(("127.0.0.1", self.server))
            for end in (come, there):
                end.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            threading.Thread(target=self.carry, args=(come, there, self.keep), daemon=True).start()
            threading.Thread(target=self.carry, args=(there, come, self.rename), daemon=True).start()

    @staticmethod
    def carry(source, sink, each):
        buffer = bytearray()
        try:
            while piece := source.recv(65536):
                buffer += piece
                for one in whole_messages(buffer):
                    sink.sendall(each(one))
        except OSError:
            pass
        for end in (source, sink):
            try:
                end.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass

    def keep(self, one):
        for old, new in self.changes:
            one = one.replace(new, old)
        if one[7] in (0, 3):
            found = re.search(rb"[a-zA-Z_]{3,}\0", one[20 + int.from_bytes(one[20:24], "little"):]) if one[7] == 0 else None
            kept = self.heard.setdefault(found.group()[:-1] if found else b"locate", [])
            if len(kept) < self.max_of_one and one not in kept:
                kept.append(one)
        return one

    def rename(self, one):
        for old, new in self.changes:
            one = one.replace(old, new)
        return one

    def corpus(self):
        kept = [one for name, kept in self.heard.items() if name not in left_out for one in kept]
        # What ports of one process say to each other is not heard.
        return kept + [renamed(one, "notify_connect") for one in self.heard.get(b"connect", [])]


def talk(host, ear, names_ear):
    """Every verb of the tool that changes or reads components."""

    def rtse(*words, may_fail=False):
        done = subprocess.run([f"{options.bin_dir}/rtse", "--ns", f"127.0.0.1:{names_ear.port}", *words], capture_output=True, text=True, timeout=2 * watchdog)
        check(may_fail or done.returncode == 0, f"{words}: {done.stderr}", host)
        return done.stdout

    rtse("wait", *(f"{name}0" for name in components), "--state", "any", "--timeout", str(watchdog))
    rtse("ls", "-l", "-R")
    for name in components:
        rtse("cat", "-l", f"{name}0")
        rtse("conf", f"{name}0", "list")
    rtse("conf", "ConfigDemo0", "set", "count", "3")
    rtse("conf", "ConfigDemo0", "use", "default", may_fail=True)
    for kind in ("long", "double", "string", "wstring", "long_seq", "string_seq"):
        rtse("con", f"SourceAll0:{kind}", f"SinkAll0:{kind}", "-i", kind)
    for transport in ("data_service", "shared_memory"):
        rtse("con", "SourceAll0:short", "SinkAll0:short", "-i", transport, "-p", f"dataport.interface_type={transport}", "-p", "dataport.allow_dup_connection=YES")
    rtse("con", "SourceAll0:float", "SinkAll0:float", "-i", "pull", "-p", "dataport.dataflow_type=pull")
    rtse("con", "EchoConsumer0:Echo", "EchoProvider0:Echo", "-i", "echo")
    rtse("act", "SourceAll0", "SinkAll0", "EchoProvider0")
    rtse("ec", "SourceAll0", may_fail=True)
    rtse("ec", "SourceAll0", "rate", "50", may_fail=True)
    rtse("print", "SourceAll0:long", "-n", "2")
    rtse("inject", "SinkAll0:long", "7")
    rtse("inject", "SinkAll0:string", "a text", may_fail=True)
    rtse("deact", "EchoProvider0")
    rtse("reset", "EchoProvider0", may_fail=True)
    rtse("mgr", "list")
    rtse("mgr", "load", "EchoConsumer", may_fail=True)
    rtse("mgr", "create", "ConfigDemo?instance_name=another&conf.default.count=4")
    rtse("save", f"{host.folder.name}/system.xml")
    rtse("check", f"{host.folder.name}/system.xml", may_fail=True)
    rtse("load", f"{host.folder.name}/system.xml", may_fail=True)
    rtse("dis", "SourceAll0:float", "-i", "pull")


numbers = [0, 1, 2, 3, 4, 7, 8, 255, 1 << 15, 1 << 16, (1 << 31) - 1, 1 << 31, (1 << 32) - 1, (1 << 32) - 4]


def sized(kind, body, more=False, minor=2):
    return message(kind, bytes(body), more, minor)


def changed(rng, corpus):
    """Some messages for one connection, and whether a good peer could have sent their frames."""
    original = rng.choice(corpus)
    kind, minor, body = original[7], original[5], bytearray(original[12:])
    for _ in range(rng.choice((0, 1, 1, 1, 2, 3, 8))):
        at = rng.randrange(len(body) + 1)
        word = min(at // 4 * 4, max(len(body) - 4, 0))
        deed = rng.randrange(8)
        if deed < 2 and body:
            body[min(at, len(body) - 1)] = rng.randrange(256)
        elif deed == 2:
            body[word:word + 4] = struct.pack("<I", rng.choice(numbers) if rng.random() < 0.8 else rng.randrange(1 << 32))
        elif deed == 3:
            del body[at:at + rng.choice((1, 4, 8, 64))]
        elif deed == 4:
            body[at:at] = rng.randbytes(rng.choice((1, 4, 8, 64)))
        elif deed == 5:
            other = rng.choice(corpus)[12:]
            start = rng.randrange(len(other)) // 4 * 4
            body[word:word + rng.choice((0, 4, 16, 64))] = other[start:start + rng.choice((4, 16, 64, 1024))]
        elif deed == 6:
            body[word:word] = body[max(word - 64, 0):word] * rng.choice((1, 2, 50))
        elif rng.random() < 0.3:
            del body[at:]
    if not has_own_network and addresses(body) != addresses(original[12:]):
        body = bytearray(original[12:])
    frame = rng.randrange(20)
    if frame == 0 and minor == 2 and len(body) > 40:  # in fragments, as a peer may send it
        cut = rng.randrange(16, len(body) - 8) // 8 * 8 + 4
        rest = bytes(body[:4]) + bytes(body[cut:])
        return [sized(kind, body[:cut], True), sized(7, rest)], True
    if frame == 1:
        broken = bytearray(sized(kind, body, minor=minor))
        broken[rng.randrange(12)] = rng.randrange(256)
        return [bytes(broken)], False
    return [sized(kind, body, minor=minor)], True


def addresses(body):
    return re.findall(rb"127\.0\.0\.1\0..|3132372e302e302e310[0-9a-f]{5}|[a-z]+:[a-z]*:?:?[^\0]*", bytes(body), re.DOTALL)


class Attack(threading.Thread):
    def __init__(self, port, corpus, seed, count):
        super().__init__(daemon=True)
        self.port, self.corpus, self.rng, self.left, self.sent, self.closed = port, corpus, randomness.Random(seed), count, 0, 0

    def goes_on(self):
        return self.left > 0 and (not until or time.monotonic() < until) and host.process.poll() is None

    def run(self):
        while self.goes_on():
            try:
                with socket.create_connection(("127.0.0.1", self.port), timeout=30) as stream:
                    self.talk(stream)
            except OSError:
                self.closed += 1

    def talk(self, stream):
        reader = threading.Thread(target=drain, args=(stream,), daemon=True)
        reader.start()
        for _ in range(50):
            batch, good = [], True
            while good and len(batch) < 20:
                more, good = changed(self.rng, self.corpus)
                batch += more
            if not self.goes_on():
                break
            stream.sendall(b"".join(batch))
            self.left -= len(batch)
            self.sent += len(batch)
            if not good:
                break
        try:
            stream.shutdown(socket.SHUT_WR)
        except OSError:
            pass
        reader.join(30)


has_own_network = alone()
wrapper = ()
if options.valgrind:
    wrapper = (shutil.which("valgrind") or "valgrind", "--error-exitcode=99", "-q", "--num-callers=20", "--undef-value-errors=no")  # omniORB sends gaps of alignment as they are
names_port = free_port()
host = Host(options.bin_dir, options.lib_dir, "-o", "corba.unix_socket:NO", "--with-naming", "-o", "naming.enable:YES", "-o", f"corba.nameservers:127.0.0.1:{names_port}", *components, wrapper=wrapper)
ear, names_ear = Ear(host.port), Ear(names_port)
# The names that it binds, and so the references that tools are given, lead to the ear.
names_ear.changes += ear.changes
talk(host, ear, names_ear)
corpora = {ear.server: ear.corpus(), names_ear.server: names_ear.corpus()}
for one, corpus in corpora.items():
    check(len(corpus) > 10, f"only {len(corpus)} messages were heard before port {one}", host)
print(f"{len(ear.heard)} operations of components, {len(names_ear.heard)} of names; {', '.join(str(len(corpus)) for corpus in corpora.values())} messages", flush=True)
until = options.seconds and time.monotonic() + options.seconds
messages = sys.maxsize if until else options.messages
attacks = [Attack(names_port if i % 4 == 3 else host.port, corpora[names_port if i % 4 == 3 else host.port], random.randrange(1 << 30), messages // options.connections)
           for i in range(options.connections)]
for attack in attacks:
    attack.start()
for attack in attacks:
    attack.join()
check(host.process.poll() is None, f"rtcd has ended with {host.process.returncode}", host)
check(host.answers(30), "rtcd does not answer any more", host)
done = subprocess.run([f"{options.bin_dir}/rtse", "--ns", f"127.0.0.1:{names_port}", "ls", "-R"], capture_output=True, text=True, errors="replace", timeout=2 * watchdog)
check(done.returncode == 0, f"the naming service does not answer any more: {done.stderr}", host)
memory = host.memory()
code = host.end()
found = [line for line in host.text().splitlines() if line.startswith("==")]  # of valgrind and the sanitizers
check(code == 0, "\n".join([f"rtcd has ended with {code}", *found[:200]]), host)
check(options.valgrind or memory < 600 * memory_factor, f"rtcd has taken {memory} MiB", host)
print(f"{sum(a.sent for a in attacks)} messages, {sum(a.closed for a in attacks)} connections refused, {memory} MiB at most")
