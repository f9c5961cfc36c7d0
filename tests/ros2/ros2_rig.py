# What the scenarios of ros2-gateway share: a simulator, the gateway and peers by Cyclone DDS, in a DDS domain of their own on 127.0.0.1.
import json
import os
import socket
import struct
import subprocess
import sys
import threading

case, bin_dir, lib_dir, source = sys.argv[1:]
sys.path.insert(0, f"{source}/tests/scenario")
sys.dont_write_bytecode = True

import wire
from system import System, await_

cyclone = """<CycloneDDS><Domain><General><Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces><AllowMulticast>false</AllowMulticast></General>
<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32</MaxAutoParticipantIndex><Peers><Peer address="127.0.0.1"/></Peers>
<SPDPInterval>1s</SPDPInterval></Discovery></Domain></CycloneDDS>"""

claims = []


# A domain that no other test of this machine uses now: a bound socket says that it is taken.
def claim_domain():
    begin = 10 + os.getpid() % 90
    for domain in list(range(begin, 100)) + list(range(10, begin)):
        claim = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            claim.bind(("127.0.0.1", 16000 + domain))
        except OSError:
            claim.close()
            continue
        claims.append(claim)
        return str(domain)
    raise RuntimeError("no DDS domain is free")


jazzy_hash = "typehash=RIHS01_91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e;"


class Peer:
    def __init__(self, domain, user_data="enclave=/;"):
        self.process = subprocess.Popen([f"{bin_dir}/ros2_peer", domain, user_data], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
                                        env={**os.environ, "CYCLONEDDS_URI": cyclone})
        self.samples, self.decoded, self.guids, self.counts, self.peers, self.list = {}, {}, {}, {}, None, []
        self.is_ready = False
        self.thread = threading.Thread(target=self.listen, daemon=True)
        self.thread.start()
        await_("the peer", lambda: self.is_ready)

    def listen(self):
        for line in self.process.stdout:
            words = line.rstrip("\n").split(" ", 5)
            if words[0] == "ready":
                self.is_ready = True
            elif words[0] == "sample":
                self.samples[words[1]].append(bytes.fromhex(words[2]))
            elif words[0] in ("reader", "writer"):
                self.guids[words[1]] = words[2]
            elif words[0] == "matched":
                self.counts[words[1]] = int(words[2])
            elif words[0] == "peer" and words[2].startswith("DCPS"):
                continue  # of Cyclone itself
            elif words[0] == "peer":
                self.list.append(words[1:])
            elif words[0] == "end":
                self.peers, self.list = self.list, []

    def say(self, line):
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()

    def reader(self, name, topic, kind, reliability="reliable", durability="volatile", user_data="-"):
        self.samples[name] = []
        for key in [key for key in self.decoded if key[0] == name]:
            del self.decoded[key]
        self.say(f"reader {name} {topic} {kind} {reliability} {durability} {user_data}")
        return await_(f"reader {name}", lambda: self.guids[name])

    def writer(self, name, topic, kind, reliability="reliable", durability="volatile", user_data="-"):
        self.say(f"writer {name} {topic} {kind} {reliability} {durability} {user_data}")
        return await_(f"writer {name}", lambda: self.guids[name])

    # A topic of ROS, by its full name.
    def subscribe(self, topic, kind, reliability="reliable", durability="volatile"):
        self.reader(topic, "rt" + topic, wire.type_on_wire(kind), reliability, durability)

    def advertise(self, topic, kind, reliability="reliable"):
        self.writer(topic, "rt" + topic, wire.type_on_wire(kind), reliability)

    def put(self, name, kind, value):
        self.say(f"put {name} {wire.encode(kind, value).hex()}")

    # Messages received so far. Each is decoded once, because waiting tests read them repeatedly.
    def messages(self, topic, kind):
        known = self.decoded.setdefault((topic, kind), [])
        known += [wire.decode(kind, data) for data in self.samples[topic][len(known):]]
        return known

    # The newest message, or the newest one that satisfies the condition.
    def message(self, topic, kind, good=lambda message: True):
        def found():
            return next(message for message in reversed(self.messages(topic, kind)) if good(message))

        def ready():
            try:
                return found()
            except StopIteration:
                return None

        return await_(f"a message on {topic}", ready)

    def await_matched(self, name, count=1):
        def is_matched():
            self.say(f"matched {name}")
            return self.counts.get(name, 0) >= count

        await_(f"a match of {name}", is_matched, 0.05)

    # All endpoints of others: [reader or writer, topic, type, guid, user data].
    def endpoints(self, good):
        def ready():
            self.peers = None
            self.say("peers")
            await_("the list of endpoints", lambda: self.peers is not None)
            return self.peers if good(self.peers) else None

        return await_("endpoints", ready, 0.1)

    def end(self):
        self.process.stdin.close()
        try:
            self.process.wait(20)
        except subprocess.TimeoutExpired:  # on a busy machine it may still write samples
            self.process.kill()
            self.process.wait(20)


class Rig(System):
    def __init__(self):
        super().__init__(bin_dir, lib_dir)
        self.domain = claim_domain()
        self.peers = []

    def __exit__(self, *words):
        for peer in self.peers:
            peer.end()
        super().__exit__(*words)

    def sim(self, world, *options):
        path = world
        if world.startswith("<"):
            path = f"{self.work}/world.sdf"
            with open(path, "w") as file:
                file.write(world)
        self.simulator = self.server(path, *options)

    def gateway(self, *options, robots=1, **environment):
        self.process = self.start(f"{bin_dir}/ros2-gateway", "--domain", self.domain, "--network", "loopback", *options, **environment)
        await_("the gateway", lambda: self.is_serving(robots))

    def is_serving(self, robots):
        assert self.process.poll() is None, self.log(self.process)
        return f"domain {self.domain}: {robots} robots" in self.log(self.process)

    # The robots that have an iface of this type.
    def models_with(self, kind):
        return [one["name"].split("::")[0] for one in json.loads(self.simctl("--json", "list")) if one["type"] == kind]

    def peer(self, user_data="enclave=/;"):
        self.peers.append(Peer(self.domain, user_data))
        return self.peers[-1]


two = f"{source}/worlds/leader_follower.sdf"


# A client of a service in the form of rmw_cyclonedds.
class CycloneClient:
    count = 0

    def __init__(self, peer, service, request, response, more=""):
        CycloneClient.count += 1
        self.peer, self.service, self.number = peer, service, 0
        self.id = struct.pack("<Q", 77 + CycloneClient.count)
        mark = f"clientid=1.f.{CycloneClient.count:x};" + more
        self.replies = f"reply{CycloneClient.count}"
        self.requests = f"request{CycloneClient.count}"
        peer.reader(self.replies, f"rr{service}Reply", response, user_data=mark)
        peer.writer(self.requests, f"rq{service}Request", request, user_data=mark)
        peer.await_matched(self.requests)
        peer.await_matched(self.replies)

    def call(self, kind, value, reply_kind):
        return self.reply(self.start(kind, value), reply_kind)

    def start(self, kind, value):
        self.number += 1
        head = self.id + struct.pack("<q", self.number)
        body = wire.encode(kind, value)
        self.peer.say(f"put {self.requests} {(body[:4] + head + body[4:]).hex()}")
        return head

    def reply(self, head, reply_kind):
        def reply():
            for data in list(self.peer.samples[self.replies]):
                if data[4:20] == head:
                    return wire.decode(reply_kind, data[:4] + data[20:])

        return await_(f"the reply of {self.service}", reply)


class PortRig(Rig):
    def relay(self, *components, **more):
        self.naming()
        host = self.rtcd("-o", f"ros2.domain.id:{self.domain}", "-o", "ros2.network:loopback", "-o", "ros2.distro:jazzy", "-o", "ros2.node.name:relay",
                         "-o", "exec_cxt.periodic.rate:200", *(components or ("TopicRelay",)), **more)
        self.until("the component", lambda: self.rtse("act", "TopicRelay0") is not None)
        return host

    def connect(self, port, topic, *words, transport="ros2"):
        self.rtse("con", f"TopicRelay0:{port}", "-p", f"interface_type={transport}", "-p", f"{transport}.topic={topic}", *words)
