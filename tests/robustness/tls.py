# Certificates between hosts: tls.py BIN_DIR LIB_DIR [unittest arguments]. Loopback does on loopback; BetweenTwoHosts makes two hosts of its own, network namespaces with a
# component on one and tools on the other. It needs root and is skipped (77) where no network namespace can be created.
import os
import shutil
import socket
import ssl
import subprocess
import sys
import tempfile
import time
import unittest

bin_dir, lib_dir = (os.path.abspath(folder) for folder in sys.argv[1:3])
del sys.argv[1:3]
watchdog = 60


def run(*command, **more):
    return subprocess.run(command, capture_output=True, text=True, timeout=watchdog, **more)


# An authority, and a key with a certificate that it signed, in one file as omniORB wants it.
def make_certificates(folder, name):
    def openssl(*words):
        done = run("openssl", *words, cwd=folder)
        assert done.returncode == 0, done.stderr

    openssl("req", "-x509", "-newkey", "rsa:2048", "-nodes", "-keyout", f"{name}-ca.key", "-out", f"{name}-ca.pem", "-days", "2", "-subj", f"/CN={name} authority")
    openssl("req", "-newkey", "rsa:2048", "-nodes", "-keyout", f"{name}.key", "-out", f"{name}.csr", "-subj", f"/CN={name}")
    openssl("x509", "-req", "-in", f"{name}.csr", "-CA", f"{name}-ca.pem", "-CAkey", f"{name}-ca.key", "-CAcreateserial", "-out", f"{name}.crt", "-days", "2")
    with open(f"{folder}/{name}.pem", "w") as whole:
        for part in (f"{name}.key", f"{name}.crt"):
            with open(f"{folder}/{part}") as file:
                whole.write(file.read())


folder = tempfile.TemporaryDirectory()
for authority in ("lab", "stranger"):
    make_certificates(folder.name, authority)


def certificate(name, authority=None):
    return {"RTMSIM_TLS_CERTIFICATE": f"{folder.name}/{name}.pem", "RTMSIM_TLS_AUTHORITY": f"{folder.name}/{authority or name}-ca.pem"}


def text(path):
    with open(path, errors="replace") as file:
        return file.read()


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class System(unittest.TestCase):
    def start(self, *command, log, **more):
        path = f"{folder.name}/{log}"
        with open(path, "wb") as file:
            process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=file, stderr=file, cwd=folder.name, **more)

        def end():
            process.terminate()
            try:
                process.wait(watchdog)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

        self.addCleanup(end)
        return path

    def tool(self, *words, inside=(), as_account=None, **environment):
        def become():
            if as_account:
                os.setgroups([])
                os.setgid(as_account)
                os.setuid(as_account)

        own = {key: value for key, value in os.environ.items() if not key.startswith(("RTMSIM_TLS", "RTCTREE"))}
        return run(*inside, f"{bin_dir}/rtse", *words, env=own | environment, preexec_fn=become, cwd="/")

    def until(self, what, ask):
        end = time.monotonic() + watchdog
        while not (done := ask()):
            self.assertLess(time.monotonic(), end, what)
            time.sleep(0.1)
        return done

    # A host of components and a naming service; both speak TLS at `address`.
    def system(self, address, inside=()):
        port, plain = free_port(), free_port()
        names = f"{folder.name}/names{port}"
        os.mkdir(names)
        preload = {"LD_PRELOAD": "libomnisslTP4.so.2"}
        lab = certificate("lab")
        self.start(*inside, "omniNames", "-start", "-always", "-ignoreport", "-datadir", names, "-ORBendPoint", f"giop:ssl:{address}:{port}", "-ORBsslCAFile",
                   lab["RTMSIM_TLS_AUTHORITY"], "-ORBsslKeyFile", lab["RTMSIM_TLS_CERTIFICATE"], "-ORBsslKeyPassword", "none", "-ORBsslVerifyMode", "peer,fail", log="names.log",
                   env=os.environ | preload)
        server = f"ssliop:{address}:{port}"
        log = self.start(*inside, f"{bin_dir}/rtcd", "-i", "-f", "none.conf", "-d", "-p", str(plain), "-o", f"corba.nameservers:{server}", "-o", "naming.formats:%n.rtc", "-o",
                         f"corba.tls.certificate:{lab['RTMSIM_TLS_CERTIFICATE']}", "-o", f"corba.tls.authority:{lab['RTMSIM_TLS_AUTHORITY']}", "-o",
                         f"corba.tls.endpoints:{address}:", "-o", f"manager.modules.load_path:{lib_dir}", "-o", "manager.modules.preload:SinkAll", "-o",
                         "manager.components.precreate:SinkAll", log="rtcd.log")
        return server, log

    def sees(self, server, **more):
        done = self.tool("--ns", server, "--call-timeout", "5", "ls", "-l", **more)
        return done if done.returncode == 0 and "SinkAll0" in done.stdout else None

    def check(self, server, log, **more):
        self.until(f"the component is seen: {text(log)}", lambda: self.sees(server, **more, **certificate("lab")))
        done = self.tool("--ns", server, "--call-timeout", "5", "act", "SinkAll0.rtc", **more, **certificate("lab"))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("Active", self.sees(server, **more, **certificate("lab")).stdout)
        for who in ({}, certificate("stranger"), certificate("stranger", "lab")):
            self.assertIsNone(self.sees(server, **more, **who), who)
        # Afterwards it still serves those who belong to it.
        self.assertIsNotNone(self.sees(server, **more, **certificate("lab")), text(log))
        self.assertIn("open over TLS to every owner of a certificate", text(log))


class Loopback(System):
    def test_who_has_a_certificate_comes_in(self):
        server, log = self.system("127.0.0.1")
        self.check(server, log)

    @unittest.skipUnless(os.geteuid() == 0, "needs a second account, so root")
    def test_another_account_comes_in_by_a_certificate_alone(self):
        server, log = self.system("127.0.0.1")
        os.chmod(folder.name, 0o755)
        for name in os.listdir(folder.name):
            if name.endswith(".pem"):
                os.chmod(f"{folder.name}/{name}", 0o644)
        self.check(server, log, as_account=65534)

    def test_what_cannot_be_is_said_in_one_line(self):
        for environment, says in (({"RTMSIM_TLS_CERTIFICATE": "/no/such.pem", "RTMSIM_TLS_AUTHORITY": "/no/such.pem"}, "/no/such.pem"),
                                  ({"RTMSIM_TLS_CERTIFICATE": f"{folder.name}/lab.pem"}, "authority is missing")):
            done = self.tool("--ns", f"127.0.0.1:{free_port()}", "ls", **environment)
            self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done.stderr)
            self.assertIn(says, done.stderr)

        useless = f"{folder.name}/useless.pem"
        with open(useless, "w") as file:
            file.write("no certificate")
        done = self.tool("--ns", f"127.0.0.1:{free_port()}", "ls", RTMSIM_TLS_CERTIFICATE=useless, RTMSIM_TLS_AUTHORITY=f"{folder.name}/lab-ca.pem")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn(f'rtse: tls: certificate "{useless}" with its key, or authority', done.stderr)

    def test_who_has_no_certificate_is_in_the_log(self):
        port = free_port()
        log = self.start(f"{bin_dir}/rtcd", "-i", "-f", "none.conf", "-d", "-p", str(free_port()), "-o", "naming.enable:NO", "-o", f"corba.tls.certificate:{folder.name}/lab.pem", "-o",
                         f"corba.tls.authority:{folder.name}/lab-ca.pem", "-o", f"corba.tls.endpoints:127.0.0.1:{port}", log="nobody.log")
        context = ssl.create_default_context(cafile=f"{folder.name}/lab-ca.pem")
        context.check_hostname = False

        def is_sent_away():
            try:
                with socket.create_connection(("127.0.0.1", port), timeout=watchdog) as plain, context.wrap_socket(plain) as stream:
                    stream.recv(1)
            except OSError:
                pass
            return "rejected: no certificate of corba.tls.authority" in text(log)

        self.until("a line in the log", is_sent_away)


class BetweenTwoHosts(System):
    @unittest.skipUnless(os.geteuid() == 0, "needs network namespaces, so root")
    @unittest.skipUnless(shutil.which("ip"), "needs network namespaces, so the program ip (Debian's package iproute2)")
    def test_between_two_hosts(self):
        names = [f"rtmsim{os.getpid()}{side}" for side in "ab"]
        veth = [f"rs{os.getpid()}{side}" for side in "ab"]

        def ip(*words):
            return run("ip", *words)

        # Not `ip netns exec` and `ip -n`: they also make a mount namespace, which fails where / is no mount point, as in a chroot.
        inside = [("nsenter", f"--net=/run/netns/{name}") for name in names]
        if (done := ip("netns", "add", names[0])).returncode != 0:
            self.skipTest(f"no network namespace can be created here: {done.stderr.strip()}")
        self.addCleanup(lambda: ip("netns", "delete", names[0]))
        if (done := run(*inside[0], "true")).returncode != 0:
            self.skipTest(f"a network namespace cannot be entered here: {done.stderr.strip()}")
        self.assertEqual(ip("netns", "add", names[1]).returncode, 0)
        self.addCleanup(lambda: ip("netns", "delete", names[1]))
        if ip("link", "add", veth[0], "netns", names[0], "type", "veth", "peer", "name", veth[1], "netns", names[1]).returncode != 0:
            self.skipTest("no virtual network link can be created here")
        for side in range(2):
            for words in (("addr", "add", f"10.77.0.{side + 1}/24", "dev", veth[side]), ("link", "set", veth[side], "up"), ("link", "set", "lo", "up")):
                done = run(*inside[side], "ip", *words)
                self.assertEqual(done.returncode, 0, done.stderr)
        server, log = self.system("10.77.0.1", inside=inside[0])
        self.check(server, log, inside=inside[1])


program = unittest.main(exit=False)
if not program.result.wasSuccessful():
    sys.exit(1)
if program.result.testsRun == len(program.result.skipped):
    sys.exit(77)
