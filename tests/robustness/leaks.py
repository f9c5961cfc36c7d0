# What comes and goes, again and again: leaks.py BIN_DIR LIB_DIR SOURCE_DIR [--seconds T | --rounds N] [--seed S]. While a robot drives, connections are made and ended, components
# created and deleted, models spawned and deleted, tools started, bare connections opened and closed. Before and after, each process has as many files and threads, and hardly more memory.
import os
import socket
import time

from attacker import listening_ports, locate, sanitized, seeded, system_options
from driving import Driving, System

box = "<sdf version='1.9'><model name='box'><pose>3 3 1 0 0 0</pose><link name='l'><collision name='c'><geometry><box><size>.1 .1 .1</size></box></geometry></collision></link></model></sdf>"
few = 320 if sanitized else 16  # [MiB] that heaps of many threads may come to, whatever the number of rounds
each_round = 16 / 1024  # [MiB]
given = system_options(rounds=4).parse_args()
bin_dir, lib_dir, source = given.folders
choice = seeded(given.seed)


def resident(pid):
    with open(f"/proc/{pid}/status") as status:
        return next(int(line.split()[1]) for line in status if line.startswith("VmRSS:")) / 1024  # [MiB]


def use_of(pid):
    return {"files": len(os.listdir(f"/proc/{pid}/fd")), "threads": len(os.listdir(f"/proc/{pid}/task"))}


class Hosts(Driving):
    # Calls to processes that are gone leave connections behind until they have been idle for long; here that is short.
    short = ("-o", "corba.args:-ORBoutConScanPeriod 3 -ORBscanGranularity 1")

    def start_sensors(self):
        return self.s.rtcd(*self.short, "RTCLaser", "RTCPosition2d")

    def start_client(self):
        return self.s.rtcd(*self.short, "LaserObstacleAvoid")


with System(bin_dir, lib_dir) as s:
    driving = Hosts(s, source)
    driving.wire()
    driving.drives()
    watched = {"simulator": driving.simulator, "sensors": driving.sensors, "client": driving.client, "naming": driving.naming}
    ports = [port for process in (driving.sensors, driving.client, driving.naming) for port in listening_ports(process.pid)]

    def connections():
        s.rtse("con", "RTCLaser0:range", "LaserObstacleAvoid0:range", "-p", "dataport.allow_dup_connection=YES", "-i", "another")
        s.rtse("dis", "RTCLaser0:range", "-i", "another")

    def samples():
        s.rtse("print", "RTCLaser0:range", "-n", "1")
        s.simctl("echo", "laser:pioneer2dx::laser", "-n", "1")

    def models():
        s.simctl("delete", s.simctl("spawn", box).strip())

    def sets():
        s.rtse("conf", "LaserObstacleAvoid0", "list")
        s.rtse("ls", "-R")

    def bare_connections():
        for port in ports:
            for octets in (b"", locate(1)[:7], locate(1), b"GET / HTTP/1.1\r\n\r\n"):
                with socket.create_connection(("127.0.0.1", port), timeout=10) as stream:
                    stream.sendall(octets)

    deeds = [connections, samples, models, sets, bare_connections]

    def rounds(count):
        for _ in range(count):
            choice.shuffle(deeds)
            for deed in deeds:
                deed()

    # The same as before, or fewer: what belongs to connections goes some time after them.
    def settled(before):
        for name, process in watched.items():
            s.until(f"{name} as before: {before[name]}", lambda: all(now <= then for now, then in zip(use_of(process.pid).values(), before[name].values())), 0.2)

    rounds(2)
    s.rtse("ls")
    time.sleep(5)  # what is measured is a state of rest
    before = {name: use_of(process.pid) for name, process in watched.items()}
    memory = {name: resident(process.pid) for name, process in watched.items()}
    done, began = 0, time.monotonic()
    while time.monotonic() - began < given.seconds if given.seconds else done < given.rounds:
        rounds(1)
        done += 1
    settled(before)
    driving.others_go_on(None)
    driving.drives()
    for name, process in watched.items():
        more = resident(process.pid) - memory[name]
        print(f"{name}: {before[name]['files']} files, {before[name]['threads']} threads, {more:+.1f} MiB of {memory[name]:.0f}")
        assert more < few + done * each_round, f"{name} has grown by {more:.1f} MiB in {done} rounds"
print(f"{done} rounds, nothing has leaked")
