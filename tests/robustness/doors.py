# Who is let in, and what idle or lying connections cost: doors.py BIN_DIR LIB_DIR [unittest arguments]. What needs a second account is skipped unless run by root.
import os
import resource
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
import unittest

from attacker import Host, head, listening_ports, locate, message, name_server, watchdog

sys.path.append(os.path.join(os.path.dirname(__file__), "../scenario"))
from system import System

bin_dir, lib_dir = sys.argv[1:3]
del sys.argv[1:3]

# Sends one whole request to a port of 127.0.0.1 and prints what comes back; its own program, so that it can be another account.
asker = """
import socket, sys
try:
    with socket.create_connection(("127.0.0.1", int(sys.argv[1])), timeout=10) as stream:
        stream.sendall(bytes.fromhex(sys.argv[2]))
        print(stream.recv(4).decode("latin-1"))
except OSError:
    print("")
"""


def ask_as(account, port, octets=locate(1)):
    def become():
        if account:
            os.setgroups([])
            os.setgid(account)
            os.setuid(account)

    done = subprocess.run(["/usr/bin/python3", "-c", asker, str(port), octets.hex()], stdout=subprocess.PIPE, text=True, timeout=60, preexec_fn=become, cwd="/")
    return done.stdout.strip()


class Doors(unittest.TestCase):
    def host(self, *options, **more):
        host = Host(bin_dir, lib_dir, *options, **more)

        def end():
            self.assertEqual(host.end(), 0, host.text())

        self.addCleanup(end)
        return host

    @unittest.skipUnless(os.geteuid() == 0, "needs a second account, so root")
    def test_another_account_is_not_let_in_and_the_log_says_who(self):
        host = self.host()
        self.assertEqual(ask_as(0, host.port), "GIOP")
        self.assertEqual(ask_as(65534, host.port), "")
        self.assertIn("(account 65534) rejected", host.text())
        self.assertTrue(host.answers())

    @unittest.skipUnless(os.geteuid() == 0, "needs a second account, so root")
    def test_one_key_opens_the_door_to_other_accounts_and_the_log_says_so(self):
        host = self.host("-o", "corba.open_to:host")
        self.assertEqual(ask_as(65534, host.port), "GIOP")
        self.assertIn("open to every account of this machine", host.text())

    @unittest.skipUnless(os.geteuid() == 0, "needs a second account, so root")
    def test_the_naming_service_that_rtcd_starts_is_as_closed(self):
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        host = self.host("--with-naming", "-o", f"corba.nameservers:127.0.0.1:{port}")
        root = locate(1, b"NameService")
        self.assertEqual(ask_as(0, port, root), "GIOP")
        self.assertEqual(ask_as(65534, port, root), "")
        until = time.monotonic() + watchdog
        while "name server: account 65534 rejected" not in host.text() and time.monotonic() < until:
            time.sleep(0.01)
        self.assertIn("name server: account 65534 rejected: it serves account 0 alone", host.text())

    def test_a_naming_service_that_stands_does_not_hold_the_end_of_rtcd(self):
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        host = self.host("--with-naming", "-o", f"corba.nameservers:127.0.0.1:{port}")
        os.kill(name_server(host.process.pid), signal.SIGSTOP)

    @unittest.skipUnless(os.geteuid() == 0, "needs a second account, so root")
    def test_a_tool_that_listens_is_as_closed(self):
        with System(bin_dir, lib_dir) as s:
            s.naming()
            s.rtcd("LaserObstacleAvoid")
            s.until("a component", lambda: s.try_rtse("cat", "LaserObstacleAvoid0").returncode == 0, 0.1)
            tool = s.start(f"{bin_dir}/rtse", "--ns", s.names, "print", "LaserObstacleAvoid0:velocity")
            s.until("a connection to the tool", lambda: s.rtse("--json", "cat", "-l", "LaserObstacleAvoid0").count("rtse") > 0, 0.1)
            ports = listening_ports(tool.pid)
            self.assertTrue(ports)
            for port in ports:
                self.assertEqual(ask_as(0, port), "GIOP")
                self.assertEqual(ask_as(65534, port), "")

    def test_what_48_octets_claim_takes_no_memory(self):
        host = self.host()
        before = host.memory()
        streams = [host.connect() for _ in range(20)]
        for stream in streams:
            claim = head(1, b"manager", "set_configuration")
            stream.sendall(b"GIOP\x01\x02\x01\x00" + struct.pack("<I", 128 << 20) + claim[:36])
        time.sleep(0.2)
        self.assertTrue(host.answers())
        self.assertLess(host.memory() - before, 100)
        for stream in streams:
            stream.close()

    def test_idle_connections_lock_nobody_out(self):
        host = self.host(files=256)
        idle = []
        for _ in range(400):
            try:
                idle.append(host.connect())
            except OSError:
                break
        self.assertTrue(host.answers(30), "the owner's tool was locked out")
        for stream in idle:
            stream.close()
        self.assertTrue(host.answers())

    def test_idle_connections_lock_nobody_out_of_the_naming_service(self):
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        self.host("--with-naming", "-o", f"corba.nameservers:127.0.0.1:{port}", files=256)
        root = locate(1, b"NameService")
        self.assertEqual(ask_as(0, port, root), "GIOP")
        idle = [socket.create_connection(("127.0.0.1", port), timeout=10) for _ in range(400)]
        self.assertEqual(ask_as(0, port, root), "GIOP", "the owner's tool was locked out")
        for stream in idle:
            stream.close()
        self.assertEqual(ask_as(0, port, root), "GIOP")

    def test_what_a_killed_keeper_of_names_leaves_behind_goes_with_the_next_start(self):
        with tempfile.TemporaryDirectory() as folder:
            def start():
                with socket.socket() as probe:
                    probe.bind(("127.0.0.1", 0))
                    port = probe.getsockname()[1]
                return self.host("--with-naming", "-o", f"corba.nameservers:127.0.0.1:{port}", "-o", "corba.unix_socket:NO", TMPDIR=folder)

            names = name_server(start().process.pid)
            with open(f"/proc/{names}/stat") as stat:
                keeper = int(stat.read().rsplit(")", 1)[1].split()[1])
            left = os.listdir(folder)
            self.assertEqual([name[:11] for name in left], ["rtcd-names-"])
            os.kill(keeper, signal.SIGKILL)
            until = time.monotonic() + 60
            while os.path.exists(f"/proc/{names}/fd") and time.monotonic() < until:  # it ends with its keeper
                time.sleep(0.01)
            self.assertEqual(os.listdir(folder), left)
            start()
            self.assertNotIn(left[0], os.listdir(folder))
            self.assertEqual(len(os.listdir(folder)), 1)

    def test_who_sends_no_whole_request_is_sent_away(self):
        host = self.host()
        with host.connect(timeout=30) as silent, host.connect(timeout=30) as slow:
            slow.sendall(locate(1)[:5])
            self.assertEqual(silent.recv(1), b"")
            while slow.recv(100):
                pass
        self.assertIn("no whole message", host.text())
        with host.connect(timeout=30) as polite:
            polite.sendall(locate(1))
            self.assertEqual(polite.recv(4), b"GIOP")

    @unittest.skipUnless(os.geteuid() == 0, "needs an account without threads, so root")
    def test_hosts_of_components_without_threads_say_so_in_one_line(self):
        def become():
            resource.setrlimit(resource.RLIMIT_NPROC, (1, 1))
            os.setgroups([])
            os.setgid(65533)
            os.setuid(65533)

        with tempfile.TemporaryDirectory() as folder:
            os.chmod(folder, 0o777)
            for program in ("rtcd", "LaserObstacleAvoidComp"):
                done = subprocess.run([f"{bin_dir}/{program}", "-i", "-f", "none.conf", "-o", "naming.enable:NO"], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60, preexec_fn=become, cwd=folder)
                self.assertEqual(done.returncode, 1, done.stderr)
                self.assertIn(f"{program}: out of system resources", done.stderr)
                self.assertNotIn("terminate", done.stderr)

    # As root, an account of the test's own, since its threads count.
    @unittest.skipUnless(os.geteuid() == 0 and os.path.exists(f"{bin_dir}/rtm-studio"), "needs an account without threads, so root, and rtm-studio")
    def test_rtm_studio_without_threads_says_so_in_one_line(self):
        for most in range(3, 13):
            def become():
                resource.setrlimit(resource.RLIMIT_NPROC, (most, most))
                os.setgroups([])
                os.setgid(65532)
                os.setuid(65532)

            done = subprocess.run([f"{bin_dir}/rtm-studio", "-p", "0"], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60, preexec_fn=become, cwd="/")
            self.assertEqual(done.returncode, 1, (most, done.stderr))
            self.assertRegex(done.stderr, "^rtm-studio: out of system resources.*\n$", most)

    def test_output_to_a_full_device_is_a_failure(self):
        for program, *words in (["rtcd", "--help"], ["rtse", "--help"], ["simctl", "--help"], ["sim-server", "--help"], ["player-gateway", "--help"], ["rtm-studio", "--help"], ["follow", "--help"],
                                ["rtse", "record", "--help"], ["rtse", "sweep", "--help"], ["SinkAllComp", "--help"], ["rtcprof", f"{lib_dir}/SinkAll.so"], ["rtcprof", "--help"], ["rtm-skelwrapper", "--help"]):
            if not os.path.exists(f"{bin_dir}/{program}"):
                continue
            for where in ("/dev/full", "&-"):
                done = subprocess.run(["sh", "-c", f'exec "$@" >{where}', "sh", f"{bin_dir}/{program}", *words], stderr=subprocess.PIPE, text=True, timeout=60)
                self.assertEqual((program, words, where, done.returncode), (program, words, where, 1))
                self.assertIn("cannot be written", done.stderr)

    def test_the_entry_to_the_campaigns_says_in_one_line_what_is_wrong(self):
        entry = os.path.join(os.path.dirname(os.path.abspath(__file__)), "run")

        def run(*words, **more):
            done = subprocess.run([entry, *words], stderr=subprocess.PIPE, text=True, timeout=60, **more)
            self.assertEqual(done.returncode, 1, done.stderr)
            return done.stderr

        self.assertRegex(run("stores", "--build", "/nowhere"), "^run: build /nowhere: .*\n$")
        with tempfile.TemporaryDirectory() as build:
            os.mkdir(f"{build}/bin")
            self.assertRegex(run("stores", "--build", build), f"^run: stores: {build}/bin/campaign_steps: No such file or directory\nfailed: stores\n$")
        with open("/dev/full", "w") as full:
            self.assertEqual(run("--list", stdout=full), "run: the output cannot be written\n")
        reader, writer = os.pipe()
        os.close(reader)
        self.assertEqual(run("--list", stdout=writer), "")
        os.close(writer)

    def test_fragments_are_put_together(self):
        host = self.host()
        with host.connect() as stream:
            first = head(9, b"manager", "_non_existent")
            stream.sendall(message(0, first, True) + message(7, struct.pack("<I", 9) + bytes(4)))
            self.assertEqual(stream.recv(4), b"GIOP")


unittest.main()
