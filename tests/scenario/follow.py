# A leader that is driven by RT components, followed by a robot that a Player client drives: follow.py CASE BIN_DIR LIB_DIR SOURCE_DIR. Player is a protocol of real
# time, so simulated time is four times as fast and not more.
import json
import math
import re
import signal
import socket
import subprocess
import sys

from system import System, await_

case, bin_dir, lib_dir, source = sys.argv[1:]
system_file = f"{source}/worlds/systems/leader_follower.xml"


class Rig(System):
    def __init__(self):
        super().__init__(bin_dir, lib_dir)
        self.record = f"{self.work}/record.txt"

    def gateway(self, *options):
        self.process = self.start(f"{bin_dir}/player-gateway", *(options or ("--port", "0")))
        return await_("the port of the follower", lambda: re.search(r"^port (\d+): follower:.*position2d:0.*laser:0", self.log(self.process), re.M)[1]
                      if "follower" in self.log(self.process) else None)

    def speed(self):
        return json.loads(self.simctl("--json", "echo", "follower::position2d", "-n", "1"))["velocity"][0]

    def drives(self):
        return self.speed() > 0.05

    def stands(self):
        return abs(self.speed()) < 0.01

    def place(self, model):
        return [float(word) for word in self.simctl("pose", model).split()[:2]]

    # Puts the leader that far ahead of the follower, which looks along x.
    def lead(self, distance):
        x, y = self.place("follower")
        self.simctl("pose", "leader", str(x + distance), str(y), "0")

    def poses(self):
        poses, contacts = {}, set()
        for line in open(self.record):
            words = line.split()
            if words[0] == "contact":
                contacts.update([] if "ground_plane" in words else words[2:4])
            elif words[0] != "#":
                poses.setdefault(words[1], {})[words[0]] = [float(word) for word in words[2:4]]
        return poses, contacts


def length(path):
    points = list(path.values())
    return sum(math.dist(a, b) for a, b in zip(points, points[1:]))


def leader():
    with Rig() as rig:
        rig.naming()
        rig.server(f"{source}/worlds/leader_follower.sdf", "--paused", "--rtf", "4", "--record", rig.record)
        components = ("RTCLaser0", "LaserObstacleAvoid0", "RTCPosition2d0")
        rig.host(*(f"{name[:-1]}?exec_cxt.periodic.rate=10" for name in components))
        rig.rtse("wait", *components, "--state", "any", "--timeout", "60")
        rig.rtse("load", system_file)
        for name in ("RTCLaser0", "RTCPosition2d0"):
            rig.rtse("conf", name, "set", "server_id", rig.server_id)
        rig.rtse("start", system_file)
        port = rig.gateway()
        follower = rig.start(f"{bin_dir}/follow", "--port", port)
        await_("a follower", lambda: "connected" in rig.log(follower))
        rig.simctl("step", "30000", "--paced")
        poses, contacts = rig.poses()
        assert length(poses["leader"]) > 4, length(poses["leader"])
        assert length(poses["follower"]) > 4, length(poses["follower"])
        apart = [math.dist(place, poses["follower"][time]) for time, place in poses["leader"].items()]
        assert 0.6 < min(apart) and max(apart) < 2.2, (min(apart), max(apart))
        assert not {"leader", "follower"} & contacts, contacts
        assert "leader lost" not in rig.log(follower)

        # The leader stands: the follower comes up to its distance and stands too.
        rig.rtse("deact", "LaserObstacleAvoid0")
        rig.simctl("run")
        await_("a follower that stands", rig.stands)
        await_("the distance", lambda: 0.9 < math.dist(rig.place("leader"), rig.place("follower")) < 1.4)
        follower.terminate()
        assert follower.wait(20) == 0, follower.returncode


# The gateway dies and comes back: the robot stops meanwhile, and the follower goes on. The follower is killed: the robot stops.
def losses():
    with Rig() as rig:
        rig.server(f"{source}/worlds/leader_follower.sdf", "--rtf", "2")
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            first = probe.getsockname()[1]
        config = f"{rig.work}/ports.yaml"
        with open(config, "w") as file:
            file.write(f"ports:\n- port: {first}\n  robots: [follower]\n")
        rig.gateway("--config", config)
        follower = rig.start(f"{bin_dir}/follow", "--port", str(first), "--distance", "0.6")
        await_("a leader", lambda: "leader at" in rig.log(follower))
        await_("a robot that drives", rig.drives)
        rig.kill(rig.process)
        await_("a robot that stands", rig.stands)
        await_("a follower that misses its server", lambda: "trying again" in rig.log(follower))
        rig.lead(1.4)
        rig.gateway("--config", config)
        await_("a robot that drives again", rig.drives)
        rig.lead(1.6)
        await_("a robot that drives on", rig.drives)
        rig.kill(follower)
        await_("a robot that stands without its follower", rig.stands)
        # Told to end it lets the robot stand and says 0; so it does when its time is over.
        rig.lead(1.5)
        for how in (signal.SIGINT, signal.SIGTERM, None):
            again = rig.start(f"{bin_dir}/follow", "--port", str(first), "--duration", "0" if how else "1")
            await_("a leader", lambda: "leader at" in rig.log(again))
            if how:
                again.send_signal(how)
            assert again.wait(30) == 0, again.returncode
            await_("a robot that stands", rig.stands)


# The gateway comes after the follower, which says that it waits; it does not wait for ever.
def late_gateway():
    with Rig() as rig:
        rig.server(f"{source}/worlds/leader_follower.sdf", "--rtf", "2")
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            first = probe.getsockname()[1]
        waiting = rig.start(f"{bin_dir}/follow", "--port", str(first), "--wait", "60")
        await_("a follower that says so", lambda: "waiting for up to 60 s" in rig.log(waiting))
        gone = subprocess.run([f"{bin_dir}/follow", "--port", str(first), "--wait", "0.3"], capture_output=True, text=True, timeout=60)
        assert gone.returncode == 1 and "waiting for up to 0.3 s" in gone.stdout and "refused" in gone.stderr, gone
        config = f"{rig.work}/ports.yaml"
        with open(config, "w") as file:
            file.write(f"ports:\n- port: {first}\n  robots: [follower]\n")
        rig.gateway("--config", config)
        await_("a leader", lambda: "leader at" in rig.log(waiting))
        assert rig.log(waiting).count("waiting for") == 1, rig.log(waiting)


# Servers that are none.
def wrong_servers():
    def follow(port, *words):
        return subprocess.run([f"{bin_dir}/follow", "--port", str(port), *words], capture_output=True, text=True, timeout=60)

    def refused(done, says, code=1):
        assert done.returncode == code and says in done.stderr and len(done.stderr.splitlines()) == 1, done

    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        port = listener.getsockname()[1]
        refused(follow(port, "--wait", "0"), "refused")
        listener.listen()
        for hello, says in ((b"HTTP/1.1 400 Bad Request\r\n\r\n" + bytes(20), "not a Player server"), (b"Player v", "closed"), (b"Player v.3".ljust(32, b"\0") + b"\xff" * 40, "sends")):
            process = subprocess.Popen([f"{bin_dir}/follow", "--port", str(port)], stderr=subprocess.PIPE, text=True)
            peer, _ = listener.accept()
            peer.sendall(hello)
            if says == "closed":
                peer.shutdown(socket.SHUT_WR)  # a follower that has heard enough has reset the connection by itself
            _, errors = process.communicate(timeout=60)
            peer.close()
            assert process.returncode == 1 and says in errors, errors
        for words in (("--distance", "0.1"), ("--max-speed", "nan"), ("--nonsense",)):
            refused(follow(port, *words), "follow:", 2)


{"leader": leader, "losses": losses, "late_gateway": late_gateway, "wrong_servers": wrong_servers}[case]()
