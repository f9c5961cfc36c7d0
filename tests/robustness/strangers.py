#!/usr/bin/env python3
# What another account reaches through a process that is open to it: nothing of the processes of our account that are not. strangers.py BIN_DIR LIB_DIR (as root)
import contextlib
import os
import socket
import struct
import subprocess
import sys
import threading
import time
import unittest

from attacker import Host, head, message

bin_dir, lib_dir = sys.argv[1:3]
del sys.argv[1:3]
stranger, ourselves = 65534, 0

# Sends one request to a port of 127.0.0.1 and prints the whole answer; its own program, so that it can be another account.
caller = """
import socket, struct, sys
def take(stream, size):
    data = b""
    while len(data) < size:
        piece = stream.recv(size - len(data))
        if not piece:
            raise OSError("closed")
        data += piece
    return data
with socket.create_connection(("127.0.0.1", int(sys.argv[1])), timeout=30) as stream:
    stream.settimeout(60)
    stream.sendall(bytes.fromhex(sys.argv[2]))
    start = take(stream, 12)
    print((start + take(stream, struct.unpack("<I" if start[6] & 1 else ">I", start[8:12])[0])).hex())
"""


def text(words):
    octets = words.encode() + b"\0"
    return struct.pack("<I", len(octets)) + octets


def aligned(data, piece, size=4):
    return data + bytes(-len(data) % size) + piece


def reference(port, key):
    """An IOR of an object of 127.0.0.1, as an argument that begins on a boundary of 8 octets."""
    profile = b"\x01\x01\x02\x00" + text("127.0.0.1")
    profile = aligned(profile, struct.pack("<H", port), 2)
    profile = aligned(profile, struct.pack("<I", len(key)) + key)
    profile = aligned(profile, struct.pack("<I", 0))
    return aligned(text("IDL:RTM/Manager:1.0"), struct.pack("<III", 1, 0, len(profile)) + profile)


class Answer:
    def __init__(self, octets):
        order = "<" if octets[6] & 1 else ">"
        self.status, contexts = struct.unpack(order + "II", octets[16:24])
        at = 24
        for _ in range(contexts):
            at += -at % 4 + 4
            at += 4 + struct.unpack(order + "I", octets[at:at + 4])[0]
        self.rest = octets[at + -at % 8:]
        self.order = order

    def number(self):
        """Of the return code; nothing for an exception."""
        return struct.unpack(self.order + "i", self.rest[:4])[0] if self.status == 0 else None

    def object_key(self):
        """Of the first profile of an IOR."""
        at = 4 + struct.unpack(self.order + "I", self.rest[:4])[0]
        at += -at % 4 + 12
        profile = self.rest[at:]
        at = 4
        at += 4 + struct.unpack("<I", profile[at:at + 4])[0]
        at += -at % 2 + 2
        at += -at % 4
        size = struct.unpack("<I", profile[at:at + 4])[0]
        return profile[at + 4:at + 4 + size]

    def is_nil(self):
        return self.status == 0 and self.rest[4:5] == b"\0" and struct.unpack(self.order + "I", self.rest[8:12])[0] == 0


def call(account, port, operation, arguments, key=b"manager"):
    def become():
        if account:
            os.setgroups([])
            os.setgid(account)
            os.setuid(account)

    octets = message(0, head(1, key, operation) + arguments)
    done = subprocess.run(["/usr/bin/python3", "-c", caller, str(port), octets.hex()], capture_output=True, text=True, timeout=120, preexec_fn=become, cwd="/")
    answer = Answer(bytes.fromhex(done.stdout.strip()))
    return call(account, port, operation, arguments, answer.object_key()) if answer.status == 3 else answer  # the name of a manager sends on


class SentOn:
    """An object that answers as a manager that is alive, and everything else by: ask over there, for now or for ever."""

    def __init__(self, port, key, status=3):
        self.there = reference(port, key)
        self.status = status
        self.asked = []
        self.listening = socket.create_server(("127.0.0.1", 0))
        self.port = self.listening.getsockname()[1]
        threading.Thread(target=self.serve, daemon=True).start()

    def serve(self):
        with contextlib.suppress(OSError):
            while True:
                connection = self.listening.accept()[0]
                threading.Thread(target=self.answer, args=(connection,), daemon=True).start()

    def answer(self, connection):
        with contextlib.suppress(OSError), connection:
            while start := connection.recv(12, socket.MSG_WAITALL):
                body = connection.recv(struct.unpack("<I" if start[6] & 1 else ">I", start[8:12])[0], socket.MSG_WAITALL)
                self.asked.append(body)
                identity = body[:4] if start[6] & 1 else body[3::-1]
                if start[7] == 3:  # is it there? Yes.
                    connection.sendall(message(4, identity + struct.pack("<I", 1)))
                elif start[7] == 0 and (b"is_master" in body or b"_non_existent" in body):
                    connection.sendall(message(1, identity + struct.pack("<II", 0, 0) + bytes([b"is_master" in body])))
                elif start[7] == 0:
                    connection.sendall(message(1, identity + struct.pack("<II", self.status, 0) + self.there))

    def close(self):
        self.listening.close()


@unittest.skipUnless(os.geteuid() == 0, "needs a second account, so root")
class Strangers(unittest.TestCase):
    def host(self, *options):
        host = Host(bin_dir, lib_dir, *options)
        self.addCleanup(lambda: self.assertEqual(host.end(), 0, host.text()))
        return host

    def test_a_closed_process_is_no_slave_for_strangers(self):
        ours = self.host("-o", "corba.open_to:host")
        closed = self.host("-o", "manager.instance_name:closed")
        slave = reference(closed.port, b"manager")
        self.assertNotEqual(call(stranger, ours.port, "add_slave_manager", slave).number(), 0)
        self.assertIn("asked for _non_existent for another account of this machine and was rejected", closed.text())
        self.assertEqual(call(ourselves, ours.port, "add_slave_manager", slave).number(), 0)
        wanted = text("SinkAll?manager_name=closed")
        self.assertFalse(call(stranger, ours.port, "create_component", wanted).is_nil())  # here: there is no such slave
        self.assertEqual(call(ourselves, closed.port, "get_components", b"").number(), 0)
        self.assertFalse(call(ourselves, ours.port, "create_component", wanted).is_nil())
        self.assertEqual(call(ourselves, closed.port, "get_components", b"").number(), 1)
        self.assertEqual(call(ourselves, ours.port, "get_components", b"").number(), 2)
        self.assertEqual(call(stranger, ours.port, "get_components", b"").number(), 1)
        self.assertEqual(call(stranger, ours.port, "delete_component", text("SinkAll0")).number(), 0)
        self.assertNotEqual(call(stranger, ours.port, "delete_component", text("SinkAll0")).number(), 0)
        self.assertEqual(call(ourselves, closed.port, "get_components", b"").number(), 1)

    def test_an_open_process_is_one(self):
        ours = self.host("-o", "corba.open_to:host")
        other = self.host("-o", "corba.open_to:host", "-o", "manager.instance_name:other")
        self.assertEqual(call(stranger, ours.port, "add_slave_manager", reference(other.port, b"manager")).number(), 0)
        self.assertFalse(call(stranger, ours.port, "create_component", text("SinkAll?manager_name=other")).is_nil())
        self.assertEqual(call(ourselves, other.port, "get_components", b"").number(), 1)

    def test_a_composite_takes_no_members_of_closed_processes_for_strangers(self):
        ours = self.host("-o", "corba.open_to:host")
        closed = self.host("-o", "manager.components.precreate:SinkAll")
        wanted = text(f"PeriodicECSharedComposite?conf.default.members=rtcloc://127.0.0.1:{closed.port}/*/SinkAll0")
        call(stranger, ours.port, "create_component", wanted)
        self.assertIn("for another account of this machine and was rejected", closed.text())

    def test_strangers_see_no_secrets(self):
        os.environ["RTMSIM_TEST_SECRET"] = "swordfish"
        ours = self.host("-o", "corba.open_to:host", "-o", "corba.tls.password:sesame")
        self.assertIn(b"sesame", call(ourselves, ours.port, "get_configuration", b"").rest)
        seen = call(stranger, ours.port, "get_configuration", b"").rest
        self.assertIn(b"corba.tls.password", seen)
        self.assertNotIn(b"sesame", seen)
        for argument in ("naming.formats=${RTMSIM_TEST_SECRET}.rtc", "config_file=/etc/hostname", "exec_cxt.sim_time.hash_log=/tmp"):
            self.assertTrue(call(stranger, ours.port, "create_component", text("SinkAll?" + argument)).is_nil(), argument)
        self.assertEqual(call(stranger, ours.port, "set_configuration", aligned(text("naming.formats"), text("$(RTMSIM_TEST_SECRET).rtc"))).number(), 1)
        self.assertFalse(call(ourselves, ours.port, "create_component", text("SinkAll?naming.formats=${RTMSIM_TEST_SECRET}.rtc")).is_nil())

    # Callbacks of a component, and its end, need the right to change something; its own account needs none to tick it.
    def test_strangers_call_no_callback_and_end_no_component_where_they_may_only_look(self):
        ours = self.host("-o", "corba.open_to:host", "-o", "manager.remote_rights:read", "SinkAll")
        until = time.monotonic() + 60
        while (found := call(ourselves, ours.port, "get_components", b"")).number() != 1 and time.monotonic() < until:
            time.sleep(0.05)
        found.rest = found.rest[4:]
        key = found.object_key()
        handle = struct.pack("<i", 0)
        refused, not_now = 1, 5  # RTC_ERROR, PRECONDITION_NOT_MET
        for operation in ("on_execute", "on_activated", "on_deactivated", "on_startup", "on_rate_changed", "on_reset", "detach_context"):
            self.assertEqual(call(stranger, ours.port, operation, handle, key).number(), refused, operation)
        for operation in ("on_initialize", "on_finalize", "initialize", "finalize", "exit"):
            self.assertEqual(call(stranger, ours.port, operation, b"", key).number(), refused, operation)
        self.assertIn("for onExecute: rejected, manager.remote_rights is read", ours.text().replace("on_execute", "onExecute"))
        context = SentOn(ours.port, b"manager", 0)
        self.addCleanup(context.close)
        self.assertEqual(call(stranger, ours.port, "attach_context", reference(context.port, b"context"), key).number(), -1)
        self.assertEqual(call(ourselves, ours.port, "on_execute", handle, key).number(), not_now)
        self.assertGreaterEqual(call(ourselves, ours.port, "attach_context", reference(context.port, b"context"), key).number(), 1000)
        for operation, answer in (("on_execute", not_now), ("on_activated", 0), ("on_execute", 0), ("on_deactivated", 0)):
            self.assertEqual(call(ourselves, ours.port, operation, struct.pack("<i", 1000), key).number(), answer, operation)
        self.assertEqual(call(stranger, ours.port, "on_execute", struct.pack("<i", 1000), key).number(), refused)
        self.assertEqual(call(ourselves, ours.port, "exit", b"", key).number(), 0)

    # It takes leave of its masters, on a thread that works for nobody.
    def test_calls_that_an_answer_sends_on_are_for_strangers(self):
        ours, closed = Host(bin_dir, lib_dir, "-o", "corba.open_to:host"), self.host()
        sent_on = SentOn(closed.port, b"manager")
        self.addCleanup(sent_on.close)
        self.assertEqual(call(stranger, ours.port, "add_master_manager", reference(sent_on.port, b"any")).number(), 0)
        self.assertEqual(ours.end(), 0)
        self.assertIn("asked for remove_slave_manager for another account of this machine and was rejected", closed.text())

    # LOCATION_FORWARD_PERM: the ORB would take the new reference for the one that was given.
    def test_calls_that_an_answer_sends_on_for_ever_do_not_go_there_unmarked(self):
        ours = Host(bin_dir, lib_dir, "-o", "corba.open_to:host")
        there = SentOn(ours.port, b"manager")
        sent_on = SentOn(there.port, b"any", 4)
        for each in (there, sent_on):
            self.addCleanup(each.close)
        self.assertEqual(call(stranger, ours.port, "add_master_manager", reference(sent_on.port, b"any")).number(), 0)
        self.assertEqual(ours.end(), 0)
        self.assertTrue(any(b"remove_slave_manager" in body for body in sent_on.asked))
        mark = struct.pack("<I", 0x52545303)
        self.assertFalse([body for body in there.asked if b"remove_slave_manager" in body and mark not in body])


unittest.main()
