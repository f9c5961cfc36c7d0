# Systems with components of other processes (foreign_component.py): what their scenarios share. The words of the program are CASE BIN_DIR LIB_DIR SOURCE_DIR.
import json
import os
import signal
import subprocess
import sys
import tempfile

from system import System

case, bin_dir, lib_dir, source = sys.argv[1:]
empty = f"{source}/worlds/empty.sdf"


def relay(name, **options):
    words = {"exec_cxt.periodic.rate": 100, "instance_name": name, **options}
    return "Relay?" + "&".join(f"{key}={value}" for key, value in words.items())


class Mixed(System):
    def foreign(self, name, *options):
        process = self.start(sys.executable, "-B", f"{source}/tests/scenario/foreign_component.py", name, "--names", self.names,
                             "--journal", f"{self.work}/{name}.journal", *options)
        self.until(f"component {name}", lambda: process.poll() is None and "ready" in self.log(process))
        return process

    # The hosts that `rtse join` has left running.
    def time_hosts(self):
        hosts = []
        for pid in filter(str.isdigit, os.listdir("/proc")):
            try:
                words = open(f"/proc/{pid}/cmdline").read().split("\0")
            except OSError:
                continue  # it has ended meanwhile
            if f"corba.nameservers:{self.names}" in words and any(word.startswith("SimTimeProxy?") for word in words):
                hosts.append(int(pid))
        return hosts

    def end(self):
        for pid in self.time_hosts():
            os.kill(pid, signal.SIGKILL)
        return super().end()

    # The values that a relay of ours has written: "time value".
    def values(self, name):
        return [(float(a), int(b)) for a, b in (line.split() for line in open(f"{self.work}/{name}.txt"))]

    def calls(self, name):
        return [line.split()[:2] for line in open(f"{self.work}/{name}.journal")]

    def state(self, component):
        return json.loads(self.rtse("--json", "cat", component))["state"]

    # From, To: relays of ours around a foreign one; each a tick later than the one before, as its phase is higher.
    def chain(self, *options):
        self.naming()
        self.server(empty, "--lockstep", "--paused", "--rtf", "0")
        self.host(relay("From", **{"exec_cxt.sim_time.phase": 0, "conf.default.source": 1}),
                  relay("To", **{"exec_cxt.sim_time.phase": 2, "conf.default.journal": f"{self.work}/To.txt"}))
        process = self.foreign("Alien", *options)
        self.rtse("wait", "From", "To", "Alien", "--state", "any", "--timeout", "60")
        self.rtse("con", "From:out", "Alien:in", "-p", "dataport.subscription_type=flush")
        self.rtse("con", "Alien:out", "To:in", "-p", "dataport.subscription_type=flush")
        self.until("participants", lambda: len(self.participants()) == 2)
        return process


# A system for `rtse run`: instances with their types, links "From.out" -> "Alien.in".
def profile(path, components, links, subscription="flush"):
    head = ('<?xml version="1.0" encoding="UTF-8"?><rts:RtsProfile xmlns:rts="http://www.openrtp.org/namespaces/rts" xmlns:rtsExt="http://www.openrtp.org/namespaces/rts_ext" '
            'xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" rts:id="RTSystem:rtm-sim:Mixed:1" rts:version="0.2">')
    text = head
    for name, (kind, values) in components.items():
        data = "".join(f'<rts:ConfigurationData rts:name="{key}" rts:data="{value}"/>' for key, value in values.items())
        sets = f'<rts:ConfigurationSets rts:id="default">{data}</rts:ConfigurationSets>' if values else ""
        text += (f'<rts:Components xsi:type="rtsExt:component_ext" rts:id="RTC:any:test:{kind}:1.0.0" rts:pathUri="localhost/{name}.rtc" rts:instanceName="{name}" '
                 f'rts:activeConfigurationSet="{"default" if values else ""}" rts:compositeType="None" rts:isRequired="true">{sets}'
                 f'<rts:ExecutionContexts xsi:type="rtsExt:execution_context_ext" rts:id="0" rts:kind="PERIODIC" rts:rate="10.0"/></rts:Components>')
    for n, (a, b) in enumerate(links):
        def end(tag, port):
            name = port.split(".")[0]
            return (f'<rts:{tag} xsi:type="rtsExt:target_port_ext" rts:componentId="RTC:any:test:{components[name][0]}:1.0.0" rts:instanceName="{name}" rts:portName="{port}">'
                    f'<rtsExt:Properties rtsExt:name="COMPONENT_PATH_ID" rtsExt:value="localhost/{name}.rtc"/></rts:{tag}>')
        text += (f'<rts:DataPortConnectors xsi:type="rtsExt:dataport_connector_ext" rts:connectorId="link{n}" rts:name="link{n}" rts:dataType="IDL:RTC/TimedLong:1.0" '
                 f'rts:interfaceType="corba_cdr" rts:dataflowType="push" rts:subscriptionType="{subscription}">{end("sourceDataPort", a)}{end("targetDataPort", b)}</rts:DataPortConnectors>')
    with open(path, "w") as file:
        file.write(text + "</rts:RtsProfile>")
    return path


# `rtse run` of From -> Alien -> To with a foreign one in the middle.
class Run:
    def __enter__(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = self.folder.name
        self.count = 0
        return self

    def __exit__(self, *_):
        self.folder.cleanup()

    def command(self, *options, name="Alien"):
        return f"{sys.executable} -B {source}/tests/scenario/foreign_component.py {name} --journal {self.path}/{name}-{self.count}.journal {' '.join(options)}"

    def system(self, **aliens):
        self.count += 1
        components = {"From": ("Relay", {"source": 1}), "To": ("Relay", {"journal": f"{self.path}/To-{self.count}.txt", "stamp": 0}),
                      **(aliens or {"Alien": ("Foreign", {})})}
        first = next(iter(aliens or ["Alien"]))
        return profile(f"{self.path}/system.xml", components, [("From.out", f"{first}.in"), (f"{first}.out", "To.in")])

    # Exit code, standard error, what To has read, and what the foreign one was called.
    def run(self, *options, start=(), duration="1"):
        system = self.system()
        starts = [word for one in start for word in ("--start", one)]
        done = subprocess.run([f"{bin_dir}/rtse", "run", system, "--world", empty, "--module-path", lib_dir, "--duration", duration, "--property", "From:exec_cxt.sim_time.phase=0",
                               "--property", "To:exec_cxt.sim_time.phase=2", *starts, *options], text=True, capture_output=True, timeout=120)
        return done.returncode, done.stderr, self.read(f"To-{self.count}.txt"), self.read(f"Alien-{self.count}.journal")

    def read(self, name):
        try:
            return open(f"{self.path}/{name}").read()
        except FileNotFoundError:
            return ""

    def start(self, *options):
        self.count += 1
        command = self.command(*options)
        self.count -= 1
        return [command]
