# A whole system of real processes under test: a naming service, simulators, hosts of components, and the tools that work them. All on ports and server ids of its
# own; close() ends what was started and says what was left in shared memory.
import json
import os
import signal
import socket
import subprocess
import tempfile
import time

watchdog = 60  # [s]; a bound on hanging, not on speed


def await_(what, ready):
    end = time.monotonic() + watchdog
    problem = ""
    while True:
        try:
            got = ready()
            if got:
                return got
        except (AssertionError, ValueError, KeyError, IndexError) as error:
            problem = f": {error}"  # not there yet
        assert time.monotonic() < end, f"{what}: not within {watchdog} s{problem}"
        time.sleep(0.05)


class Rig:
    def __init__(self, bin_dir, lib_dir, source):
        self.bin, self.lib, self.source = bin_dir, lib_dir, source
        self.server_id = 1000 + os.getpid() % 9000
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.names = f"127.0.0.1:{probe.getsockname()[1]}"
        self.work = tempfile.TemporaryDirectory()
        self.running = []
        self.servers = set()

    def path(self, name):
        return f"{self.work.name}/{name}"

    def start(self, *words):
        log = self.path(f"{len(self.running)}.log")
        process = subprocess.Popen(words, stdout=open(log, "w"), stderr=subprocess.STDOUT, cwd=self.work.name)
        process.log = log
        self.running.append(process)
        return process

    def call(self, *words):
        done = subprocess.run(words, capture_output=True, text=True, timeout=2 * watchdog)
        assert done.returncode == 0, f"{' '.join(words)}: {done.stderr}"
        return done.stdout

    def rtse(self, *words):
        return self.call(f"{self.bin}/rtse", "--ns", self.names, *words)

    def try_rtse(self, *words):
        return subprocess.run([f"{self.bin}/rtse", "--ns", self.names, *words], capture_output=True, text=True, timeout=2 * watchdog)

    def simctl(self, *words, server=None):
        return self.call(f"{self.bin}/simctl", "-s", str(server or self.server_id), *words)

    def naming(self):
        # An empty folder each time: a naming service that has forgotten everything.
        folder = tempfile.mkdtemp(dir=self.work.name)
        process = self.start("omniNames", "-start", self.names.split(":")[1], "-datadir", folder, "-ORBendPoint", f"giop:tcp:{self.names}")
        await_("the naming service", lambda: self.rtse("ls") is not None)
        return process

    def server(self, *options, world=None, server=None):
        server = server or self.server_id
        self.servers.add(server)
        process = self.start(f"{self.bin}/sim-server", world or f"{self.source}/worlds/obstacle_course.sdf", "-s", str(server), *options)
        await_("the simulator", lambda: process.poll() is None and self.simctl("--json", "stats", server=server))
        return process

    def device(self, component, *more):
        return f"{component}?" + "&".join([f"conf.default.server_id={self.server_id}", *more])

    def host(self, *components, options=()):
        return self.start(f"{self.bin}/rtcd", "-o", f"corba.nameservers:{self.names}", "-o", f"manager.modules.load_path:{self.lib}", "-o", "manager.shutdown_auto:NO",
                          "-o", "naming.update.interval:1", *options, *components)

    def there(self, *components):
        self.rtse("wait", *components, "--state", "any", "--timeout", str(watchdog))

    def state(self, component):
        return json.loads(self.rtse("--json", "cat", component))["state"]

    def robot(self, iface="pioneer2dx::position2d", server=None):
        return json.loads(self.simctl("--json", "echo", iface, "-n", "1", server=server))

    def speed(self, iface="pioneer2dx::position2d", server=None):
        return self.robot(iface, server)["velocity"][0]

    def driving(self, what, iface="pioneer2dx::position2d", server=None):
        await_(what, lambda: self.speed(iface, server) > 0.1)

    def standing(self, what, iface="pioneer2dx::position2d", server=None):
        await_(what, lambda: abs(self.speed(iface, server)) < 0.01 and not self.robot(iface, server)["commanded"])

    def kill(self, process):
        process.send_signal(signal.SIGKILL)
        process.wait()

    def logs(self):
        for process in self.running:
            lines = open(process.log).read().splitlines()[-15:]
            print("----", " ".join(process.args)[-150:], process.returncode, *lines, sep="\n", flush=True)

    def close(self):
        for process in reversed(self.running):
            if process.poll() is None:
                process.terminate()
        for process in self.running:
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        mine = tuple(f"rtmsim-{os.getuid()}-{server}." for server in self.servers)
        leftover = [name for name in os.listdir("/dev/shm") if mine and name.startswith(mine)]
        assert not leftover, leftover
