# Another account of this machine at everything that a running system has open: hostile.py BIN_DIR LIB_DIR SOURCE_DIR. As root, which makes itself that account; else it is skipped (77). Nothing answers, nothing can
# be read or written, and the system goes on.
import os
import socket
import subprocess
import sys
import time

bin_dir, lib_dir, source = sys.argv[1:4]
from attacker import listening_ports, locate
from driving import Driving, System

if os.geteuid() != 0:
    print("needs a second account, so root")
    sys.exit(77)

# The page of rtm-studio itself is the same for everybody, as an installed file is; what it shows needs the token.
# One account does what is in `attack` and prints what it has got; its own program, without anything of ours.
attack = r"""
import os, socket, sys
for port in map(int, sys.argv[1].split(",")):
    for octets in (bytes.fromhex(sys.argv[2]), b"GET /access HTTP/1.1\r\nHost: localhost\r\n\r\n", b"GET /world.glb HTTP/1.1\r\nHost: localhost\r\n\r\n", b"\0" * 64):
        try:
            with socket.create_connection(("127.0.0.1", port), timeout=10) as stream:
                stream.sendall(octets)
                got = stream.recv(64)
                if got and not got.startswith(b"HTTP/1.1 4"):
                    print("port", port, got)
        except OSError:
            pass
for path in sys.argv[3:]:
    for flags in (os.O_RDONLY, os.O_WRONLY, os.O_RDWR):
        try:
            os.close(os.open(path, flags | os.O_NONBLOCK))
            print("opened", path)
        except OSError:
            pass
    try:
        stream = socket.socket(socket.AF_UNIX)
        stream.connect(path)
        print("connected to", path)
    except OSError:
        pass
    for deed in (os.unlink, os.listdir, lambda it: os.rename(it, it + ".mine")):
        try:
            deed(path)
            print("could", deed, path)
        except OSError:
            pass
"""


def become():
    os.setgroups([])
    os.setgid(65534)
    os.setuid(65534)


def open_to_others(port_list, paths):
    done = subprocess.run(["/usr/bin/python3", "-c", attack, ",".join(map(str, port_list)), locate(1).hex(), *paths], capture_output=True, text=True, timeout=300, preexec_fn=become, cwd="/")
    assert done.returncode == 0, done.stderr
    return done.stdout


def own_unix_sockets(pids):
    inodes = set()
    for pid in pids:
        for entry in os.listdir(f"/proc/{pid}/fd"):
            try:
                inodes.add(os.readlink(f"/proc/{pid}/fd/{entry}"))
            except OSError:
                continue
    with open("/proc/net/unix") as table:
        rows = [row.split() for row in table.readlines()[1:]]
    return [row[7] for row in rows if len(row) > 7 and row[7].startswith("/") and f"socket:[{row[6]}]" in inodes]


with System(bin_dir, lib_dir) as s:
    # The naming service of `System` stands for one of others; ours is asked for with --with-naming (doors.py).
    driving = Driving(s, source)
    driving.wire()
    driving.drives()
    tool = s.start(f"{bin_dir}/rtse", "--ns", s.names, "print", "RTCLaser0:range")
    gateway = s.start(f"{bin_dir}/player-gateway", "-s", s.server_id, "--port", "0")
    studio = s.start(f"{bin_dir}/rtm-studio", "--ns", s.names, "-s", s.server_id, "--port", "0")
    ours = {"simulator": driving.simulator, "sensors": driving.sensors, "client": driving.client, "tool": tool, "gateway": gateway, "studio": studio}
    for name in ("sensors", "client", "tool", "gateway", "studio"):
        s.until(f"an open port of {name}", lambda: ours[name].poll() is None and listening_ports(ours[name].pid))
    assert not listening_ports(driving.simulator.pid)
    ports = sorted({port for process in ours.values() for port in listening_ports(process.pid)})
    paths = own_unix_sockets([process.pid for process in ours.values()])
    assert paths, "no unix socket"
    paths += [os.path.dirname(path) for path in paths]
    paths += [f"/dev/shm/{name}" for name in os.listdir("/dev/shm") if name.startswith(f"rtmsim-{os.getuid()}-{s.server_id}.")]
    found = open_to_others(ports, paths)
    assert not found, found
    for name, process in ours.items():
        assert process.poll() is None, f"{name} has ended"
    driving.others_go_on(None)
    driving.drives()
print(f"{len(ports)} ports and {len(paths)} files are closed")
