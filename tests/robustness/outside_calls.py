#!/usr/bin/env python3
"""Callbacks called by clients of the wire, from eight connections at once: no component host ends, and the log stays short.

    outside_calls.py BIN_DIR LIB_DIR SOURCE_DIR [--calls N] [--seconds S] [--seed N] [--only TYPE]

Each client first calls whatever it likes, then as an execution context that the component takes part in: those calls are carried out, one at a time.
"""
import argparse
import os
import random
import socket
import struct
import sys
import threading
import time

from attacker import Host, check, head, message, seeded

parser = argparse.ArgumentParser()
parser.add_argument("bin_dir")
parser.add_argument("lib_dir")
parser.add_argument("source")
parser.add_argument("--calls", type=int, default=300, help="of each client, in each part")
parser.add_argument("--seconds", type=float, help="again and again for this time")
parser.add_argument("--seed", type=int)
parser.add_argument("--only", help="component type")
options = parser.parse_args()

sys.path.append(os.path.join(options.source, "tests", "ports"))
from giop import Ior, Orb, SystemException  # noqa: E402
from idl_client import Idl, Remote, Servant  # noqa: E402

clients = 8
kinds = ["SourceAll", "SinkAll", "ConfigDemo", "RTCLaser", "RTCCamera", "RTCImu", "RTCSimulation"]
with_handle = ["on_execute", "on_state_update", "on_rate_changed", "on_activated", "on_deactivated", "on_startup", "on_shutdown", "on_aborting", "on_error", "on_reset"]
without = ["on_initialize", "on_finalize", "initialize", "finalize"]
codes = ["RTC_OK", "RTC_ERROR", "BAD_PARAMETER", "UNSUPPORTED", "OUT_OF_RESOURCES", "PRECONDITION_NOT_MET"]
idl = Idl(f"{options.source}/idl", "OpenRTM.idl", "Manager.idl")


class Line:
    """A connection with many calls at once: all are sent before the first answer is read, and the ORB carries them out on several threads."""

    def __init__(self, ior):
        host, port, self.key = ior.address()
        self.stream = socket.create_connection((host, port), timeout=60)

    def call(self, calls):
        """(operation, handle) of each call, no handle: None. Returns the codes."""
        requests = b"".join(message(0, head(n, self.key, operation) + (b"" if handle is None else struct.pack("<i", handle))) for n, (operation, handle) in enumerate(calls))
        threading.Thread(target=self.stream.sendall, args=(requests,), daemon=True).start()
        return [self.answer() for _ in calls]

    def take(self, size):
        data = self.stream.recv(size, socket.MSG_WAITALL)
        if len(data) < size:
            raise EOFError("the connection has ended")
        return data

    def answer(self):
        start = self.take(12)
        order = "<" if start[6] & 1 else ">"
        body = self.take(struct.unpack(order + "I", start[8:12])[0])
        if start[7] != 1 or struct.unpack(order + "I", body[4:8])[0] != 0:
            return f"message of kind {start[7]}, status {struct.unpack(order + 'I', body[4:8])[0]}"
        return codes[struct.unpack(order + "I", body[-4:])[0]]


class Context:
    """What a component that ends asks an execution context of."""

    def get_component_state(self, component):
        return "INACTIVE_STATE"

    def deactivate_component(self, component):
        return "RTC_OK"

    def remove_component(self, component):
        return "RTC_OK"


class Client(threading.Thread):
    def __init__(self, ior, start, seed):
        super().__init__()
        self.orb = Orb()
        self.orb.kept = threading.local()
        self.component = Remote(idl, self.orb, ior, "OpenRTM::DataFlowComponent")
        self.context = Servant(idl, self.orb, "RTC::ExecutionContextService", Context())
        self.start_together, self.chance = start, random.Random(seed)
        self.answers, self.carried_out, self.problem = {}, 0, None

    def run(self):
        try:
            self.start_together.wait()
            self.as_anybody()
            self.as_a_context()
        except (OSError, EOFError, SystemException, threading.BrokenBarrierError, AssertionError) as problem:
            self.problem = repr(problem)

    def note(self, answer):
        self.answers[answer] = self.answers.get(answer, 0) + 1

    def as_anybody(self):
        calls = [(self.chance.choice(without), None) if self.chance.random() < 0.05 else
                 (self.chance.choice(with_handle[:3] * 8 + with_handle), self.chance.choice([0, 0, 0, 0, 0, -1, 1, 999, 2000])) for _ in range(options.calls)]
        for answer in Line(self.component.ior).call(calls):
            self.note(answer)

    # More callers at once than may wait are refused.
    def insist(self, line, operation, handle):
        until = time.monotonic() + 60
        while (answers := line.call([(operation, handle)])) == ["PRECONDITION_NOT_MET"] and time.monotonic() < until:
            self.note(answers[0])
        assert answers[0] in ("RTC_OK", "RTC_ERROR"), answers

    def as_a_context(self):
        handle = self.component.attach_context(self.context.ior)
        assert handle >= 1000, handle
        line = Line(self.component.ior)
        for _ in range(1 + options.calls // 100):
            self.insist(line, "on_activated", handle)
            for answer in line.call([("on_execute", handle)] * 100):
                self.note(answer)
                self.carried_out += answer != "PRECONDITION_NOT_MET"
            self.insist(line, "on_deactivated", handle)
        assert self.component.detach_context(handle) == "RTC_OK"


def refused_again_and_again(manager, component):
    """Calls that fail, each of which would be logged without a limit."""
    orb = Orb()
    orb.kept = threading.local()
    silent = Ior.make("IDL:omg.org/RTC/RTObject:1.0", "127.0.0.1", orb.listener.getsockname()[1], b"silent", 2)
    contexts, ports = ([Remote(idl, orb, one.ior, name) for one in found] for found, name in (
        (component.get_owned_contexts(), "RTC::ExecutionContextService"), (component.get_ports(), "RTC::PortService")))
    bad = idl.struct("RTC::ConnectorProfile", name="bad", connector_id="", ports=[None], properties=[])
    for _ in range(500):
        contexts[0].add_component(silent)
        assert manager.create_component("NoSuchType") is None
        assert not ports or ports[0].connect(bad)[0] == "BAD_PARAMETER"


def attack(kind, chance):
    host = Host(options.bin_dir, options.lib_dir, kind)
    manager = Remote(idl, Orb(), Ior.make("IDL:RTM/Manager:1.0", "127.0.0.1", host.port, b"manager", 2), "RTM::Manager")
    until = time.monotonic() + 60
    while not (components := manager.get_components()) and time.monotonic() < until:
        time.sleep(0.05)
    check(components, f"{kind} was not made", host)
    start = threading.Barrier(clients)
    threads = [Client(components[0].ior, start, chance.random()) for _ in range(clients)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    problems = [thread.problem for thread in threads if thread.problem]
    check(not problems and host.process.poll() is None, f"{kind}: {problems}, ended with {host.process.poll()}", host)
    check(host.answers(), f"{kind}: the host does not answer", host)
    carried_out = sum(thread.carried_out for thread in threads)
    check(carried_out > 0, f"{kind}: no execution context has its calls carried out", host)
    answers = {}
    for thread in threads:
        for answer, count in thread.answers.items():
            answers[answer] = answers.get(answer, 0) + count
    check(set(answers) <= {"RTC_OK", "RTC_ERROR", "PRECONDITION_NOT_MET"}, f"{kind}: {answers}", host)
    before = host.text().count("\n")
    began = time.monotonic()
    refused_again_and_again(manager, Remote(idl, Orb(), components[0].ior, "OpenRTM::DataFlowComponent"))
    lines, allowed = host.text().count("\n") - before, 80 + 5 * (time.monotonic() - began)
    check(lines < allowed, f"{kind}: {lines} lines about refused calls, expected at most {allowed:.0f}", host)
    # The components' own lines about a simulator that is not there count as well.
    check(len(host.text()) < 1 << 20, f"{kind}: {len(host.text())} bytes of log", host)
    ended = host.end()
    check(ended == 0, f"{kind}: the host ends with {ended}", host)
    print(f"{kind}: {answers}, {carried_out} calls of onExecute")


chance = seeded(options.seed)
end = time.monotonic() + (options.seconds or 0)
while True:
    for kind in [options.only] if options.only else kinds:
        attack(kind, chance)
    if time.monotonic() >= end:
        break
