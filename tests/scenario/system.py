# Processes of a whole system for the scenarios: a naming service, simulators and hosts of components, each run with ports and server ids of its own. Everything
# that was started has ended and no segment is left when a `with System(...)` is over.
import json
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time

import server_ids

watchdog = 300 if "RTMSIM_SANITIZED" in os.environ else 60  # [s]; a bound on hanging, not on speed


# The first true answer; an exception of those that mean "not there yet" is none.
def await_(what, ready, pause=0.02):
    end = time.monotonic() + watchdog
    while True:
        why = ""
        try:
            answer = ready()
            if answer or answer == "":
                return answer
        except (AssertionError, ValueError, KeyError, IndexError, FileNotFoundError) as error:
            why = str(error)
        assert time.monotonic() < end, f"{what}: not within {watchdog} s; {why}"
        time.sleep(pause)


class System:
    def __init__(self, bin_dir, lib_dir):
        self.bin_dir, self.lib_dir = bin_dir, lib_dir
        self.server_id = server_ids.claim(2)
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.names = f"127.0.0.1:{probe.getsockname()[1]}"
        self.folder = tempfile.TemporaryDirectory()
        self.work = self.folder.name
        self.running = []
        self.servers = {self.server_id}

    def __enter__(self):
        return self

    def __exit__(self, kind, *_):
        hung = self.end()
        if kind:
            for process in self.running:
                print(f"--- {process.args} {process.returncode}\n{self.log(process)[-3000:]}", file=sys.stderr)
        self.folder.cleanup()
        if not kind:
            assert not hung, f"did not end: {hung}"
            mine = tuple(f"rtmsim-{os.getuid()}-{server}." for server in self.servers)
            left = [name for name in os.listdir("/dev/shm") if name.startswith(mine)]
            assert not left, left

    # All processes have ended, the last first; the command lines of those that had to be killed.
    def end(self):
        for process in reversed(self.running):
            if process.poll() is None:
                process.send_signal(signal.SIGCONT)
                process.terminate()
        hung = []
        for process in self.running:
            try:
                process.wait(watchdog / 3)
            except subprocess.TimeoutExpired:
                self.kill(process)
                hung.append(process.args)
        return hung

    def kill(self, process):
        process.send_signal(signal.SIGKILL)
        process.wait()

    def start(self, *words, input=None, cwd=None, **environment):
        log = f"{self.work}/{len(self.running)}.log"
        process = subprocess.Popen(words, stdin=input, stdout=open(log, "w"), stderr=subprocess.STDOUT, cwd=cwd,
                                   env={**os.environ, "RTMSIM_SERVER_ID": self.server_id, **environment})
        process.log_file = log
        self.running.append(process)
        return process

    def log(self, process):
        with open(process.log_file) as file:
            return file.read()

    def call(self, *words):
        done = subprocess.run(words, capture_output=True, text=True, timeout=2 * watchdog)
        assert done.returncode == 0, f"{words}: {done.stderr}"
        return done.stdout

    # With an empty folder each time: a naming service that has forgotten everything.
    def naming(self):
        folder = tempfile.mkdtemp(dir=self.work)
        process = self.start("omniNames", "-start", self.names.split(":")[1], "-datadir", folder, "-ORBendPoint", f"giop:tcp:{self.names}")
        self.until("the naming service", lambda: self.rtse("ls") is not None)
        return process

    def server(self, world, *options, server_id=None):
        server_id = server_id or self.server_id
        self.servers.add(server_id)
        process = self.start(f"{self.bin_dir}/sim-server", world, "-s", server_id, *options)
        self.until("simulator", lambda: process.poll() is None and self.simctl("stats", server_id=server_id))
        return process

    # A host of components "Name?option=value&...".
    def rtcd(self, *words, **more):
        return self.start(f"{self.bin_dir}/rtcd", "-o", f"corba.nameservers:{self.names}", "-o", f"manager.modules.load_path:{self.lib_dir}",
                          "-o", "manager.shutdown_auto:NO", *words, **more)

    # The same, on simulated time.
    def host(self, *components, **environment):
        return self.rtcd("-o", "manager.modules.preload:SimTimeContext.so", "-o", "exec_cxt.periodic.type:SimTimeContext", *components, **environment)

    def rtse(self, *words):
        return self.call(f"{self.bin_dir}/rtse", "--ns", self.names, *words)

    # With its exit code.
    def try_rtse(self, *words):
        return subprocess.run([f"{self.bin_dir}/rtse", "--ns", self.names, *words], capture_output=True, text=True, timeout=2 * watchdog)

    def simctl(self, *words, server_id=None):
        return self.call(f"{self.bin_dir}/simctl", "-s", server_id or self.server_id, *words)

    def stats(self, server_id=None):
        return json.loads(self.simctl("--json", "stats", server_id=server_id))

    def seconds(self, server_id=None):
        return float(self.stats(server_id)["sim_time"])

    def participants(self, server_id=None):
        return json.loads(self.simctl("--json", "participants", server_id=server_id))

    def until(self, what, ready, pause=0.02):
        return await_(what, ready, pause)


def is_stopped(process):
    with open(f"/proc/{process.pid}/stat") as file:
        return file.read().rsplit(")", 1)[1].split()[0] == "T"
