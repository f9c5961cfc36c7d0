# The system editor at work on living, hung and dead processes, one case per run: editor.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import json
import os
import select
import signal
import subprocess
import sys
import time

from rig import Rig, await_

case, *folders = sys.argv[1:]
rig = Rig(*folders)


def up(*components, options=()):
    rig.naming()
    host = rig.host(*components, options=options)
    rig.there(*(component.split("?")[0] + "0" for component in components))
    return host


def refused(*words, code=1, says=""):
    done = rig.try_rtse(*words)
    assert done.returncode == code, f"{words}: exit {done.returncode}, expected {code}: {done.stdout}{done.stderr}"
    assert says in done.stderr, f"{words}: {done.stderr!r} does not say {says!r}"
    return done


# What is wrong with the command line itself is exit code 2 and needs no name server.
def wrong_usage():
    for words in (["conf", "X", "get"], ["conf", "X", "set", "a"], ["conf", "X", "use"], ["conf", "X", "list", "a"], ["dis"], ["del"], ["mgr", "create"],
                  ["mgr", "list", "a"], ["check", "f.xml", "--state", "bogus"], ["act", "-e", "-1", "X"], ["print", "X:y", "-n", "-1"], ["new"],
                  ["new", "N", "--rate", "0"]):
        line = refused(*words, code=2, says="--help").stderr
        assert line.count("\n") == 1 and len(line) < 250, line
    refused("--json", "bogus", "x", code=2, says='unknown command "bogus"')


# A system file is a template: {robot} stands for each value of --for. Many components are activated, waited for and listed by one call.
def fleets():
    count = 12
    up("SourceAll", "SinkAll")
    rig.host(*[f"{kind}?instance_name={kind}_r{i}" for i in range(count) for kind in ("SourceAll", "SinkAll")])
    names = [f"{kind}_r{i}" for i in range(count) for kind in ("SourceAll", "SinkAll")]
    rig.rtse("wait", *names, "--state", "any", "--timeout", "30")
    rig.rtse("con", "SourceAll0:long", "SinkAll0:long", "-i", "wire")
    rig.rtse("save", rig.path("one.xml"))
    template = rig.path("fleet.xml")
    with open(template, "w") as file:
        text = open(rig.path("one.xml")).read()
        # Only the first robot of the saved system, as a person would write a template.
        parts = text.split("    <rts:Components ")
        parts = [parts[0]] + [part for part in parts[1:] if "_r" not in part.split("instanceName=")[1].split(" ")[0]]
        rest = text.split("    <rts:DataPortConnectors ", 1)[1]
        text = "    <rts:Components ".join(parts).split("    <rts:DataPortConnectors ")[0] + "    <rts:DataPortConnectors " + rest
        file.write(text.replace("SourceAll0", "SourceAll_{robot}").replace("SinkAll0", "SinkAll_{robot}"))
    lists = ["--for", f"robot=r0..r{count - 1}"]
    refused("load", template, code=2, says="_{robot} is a template; expected --for robot=LIST")
    refused("load", template, *lists, "--for", "side=l,r", code=2, says="does not contain {side}")
    refused("load", template, "--for", "robot=r9..r0", code=2, says="is not a range")
    dry = rig.rtse("load", template, *lists, "--dry-run")
    assert dry.count("connect ") == count, dry
    rig.rtse("load", template, *lists)
    rig.rtse("check", template, *lists)
    rig.rtse("start", template, *lists)
    rig.rtse("check", template, *lists, "--state", "active")
    rig.rtse("wait", *names, "--state", "active", "--timeout", "10")
    rig.rtse("deact", *names)
    rig.rtse("wait", *names, "--state", "inactive", "--timeout", "10")
    rig.rtse("act", *names)
    rig.rtse("stop", template, *lists)
    rig.rtse("wait", *names, "--state", "inactive", "--timeout", "10")
    # Those that are there are activated, and each of the others has its line.
    done = refused("act", "SourceAll_r0", "Nobody", "SourceAll_r1", "SourceAll_r2:long", says="Nobody: no such name; there are")
    assert done.stderr.count("\n") <= 2, done.stderr
    rig.rtse("wait", "SourceAll_r0", "SourceAll_r1", "--state", "active", "--timeout", "10")
    assert "Nobody" in refused("wait", "SourceAll_r0", "Nobody", "--state", "any", "--timeout", "0.2").stderr
    rig.rtse("teardown", template, *lists)
    assert rig.rtse("save").count("DataPortConnectors ") == 1


# What a profile does not require may be missing: a line each, and the rest is done.
def optional_components():
    up("SourceAll", "SinkAll")
    rig.rtse("con", "SourceAll0:long", "SinkAll0:long", "-i", "wire")
    rig.rtse("con", "SourceAll0:short", "SinkAll0:short", "-i", "another")
    profile = rig.path("system.xml")
    rig.rtse("save", profile)
    text = open(profile).read()
    optional = rig.path("optional.xml")
    for name in ("SinkAll0", "Nobody0"):
        with open(optional, "w") as file:
            file.write(text.replace("SinkAll0", name).replace('isRequired="true"', 'isRequired="false"'))
        for verb in ("load", "start", "stop", "check", "teardown"):
            done = rig.try_rtse(verb, optional)
            said = [line for line in done.stderr.splitlines() if "Nobody0" in line]
            assert done.returncode == 0, (name, verb, done)
            assert len(said) == (1 if name == "Nobody0" else 0), (name, verb, done.stderr)
            assert all("is not on the name server; it is left out, as the profile does not require it" in line for line in said), said
    # A port that the component does not have: the line says which it has.
    with open(optional, "w") as file:
        file.write(text.replace("SourceAll0.long", "SourceAll0.logn"))
    for verb in ("load", "check"):
        refused(verb, optional, says='SourceAll0.rtc has no port "logn"; it has ')


# Where a host cannot listen, and where it looks for modules in vain: one line in words of our own.
def wrong_places():
    rig.naming()
    port = rig.names.split(":")[1]
    for options, says in ((("-o", "corba.endpoints:192.0.2.1:0"), "no network interface of this machine has the address 192.0.2.1"),
                          (("-o", f"corba.endpoints::{port}"), f"port {port} is taken by another process"),
                          (("-o", "corba.endpoints:no-such-host.invalid:0"), 'host "no-such-host.invalid" is not known'),
                          (("-o", "manager.modules.load_path:/a:/b", "NoSuchComponent"), "/a:/b (its folders are separated by commas, not by colons)")):
        done = subprocess.run([f"{rig.bin_dir}/rtcd", "-o", f"corba.nameservers:{rig.names}", "-o", "manager.shutdown_on_nortcs:YES", *options], capture_output=True, text=True,
                              timeout=60, cwd=rig.work)
        said = [line for line in (done.stdout + done.stderr).splitlines() if says in line]
        assert done.returncode != 0 and said and "omniORB" not in done.stdout + done.stderr, (options, done)
    for server in ("[::1", "127.0.0.1:port", "127.0.0.1:99999", "no-such-host.invalid:1"):
        done = subprocess.run([f"{rig.bin_dir}/rtse", "--ns", server, "ls"], capture_output=True, text=True, timeout=60)
        assert done.returncode == 1 and done.stderr.count("\n") == 1 and done.stderr.startswith(f"rtse: name server {server} ") and "omniORB" not in done.stderr, done


# A value that a port would replace by its default is refused, with what is allowed.
def misunderstood_values():
    up("SourceAll", "SinkAll")
    ports = ("SourceAll0:long", "SinkAll0:long")
    for value, allowed in (("publisher.push_policy=nope", "one of all, fifo, skip, new"), ("buffer.length=abc", "an integer from 1"), ("buffer.length=0", "an integer from 1"),
                           ("inport.buffer.write.full_policy=drop", "one of overwrite, do_nothing, block"), ("buffer.read.timeout=-1", "seconds"),
                           ("sync_readwrite=perhaps", "YES or NO"), ("subscription_type=periodic", "a rate above 0 [Hz]"), ("io_mode=often", "flush, new or periodic"),
                           ("serializer.cdr.endian=middle", "a list of little and big"), ("push_rate=often", "a rate [Hz]")):
        key, given = value.split("=")
        line = refused("con", *ports, "-p", value, code=1 if key in ("subscription_type", "io_mode", "serializer.cdr.endian") else 2, says=allowed).stderr
        assert line.count("\n") == 1 and (f'got "{given}"' in line or given == "periodic"), line
    for key, meant in (("subscripton_type", "subscription_type"), ("inport.bufer.length", "buffer.length")):
        refused("con", *ports, "-p", f"{key}=new", code=2, says=f'property "{key}": ports of this runtime do not read it; did you mean {meant}?')
    # A port alone needs a transport of topics, also where nothing would be done for two.
    for more in ((), ("-d",)):
        refused("con", *more, ports[0], says="expected a second port, or a transport of topics as in -p interface_type=ros2")
    assert json.loads(rig.rtse("--json", "cat", "SourceAll0:long"))["connectors"] == []
    done = rig.try_rtse("con", *ports, "-i", "wire", "-p", "publisher.push_policy=FIFO", "-p", "buffer.length=20", "-p", "my.own=thing")
    assert done.returncode == 0 and done.stderr == 'rtse: property "my.own": ports of this runtime do not read it\n', done
    # A profile of others is loaded all the same, and the line says what is not understood.
    rig.rtse("save", rig.path("system.xml"))
    text = open(rig.path("system.xml")).read().replace('"FIFO"', '"nope"')
    with open(rig.path("others.xml"), "w") as file:
        file.write(text)
    rig.rtse("dis", "-i", "wire")
    done = rig.try_rtse("load", rig.path("others.xml"))
    assert done.returncode == 0 and "connection wire: dataport.publisher.push_policy must be one of all, fifo, skip, new" in done.stderr, done


# A name with a slip has the one that was meant in its message.
def suggestions():
    up("SourceAll")
    for words, code, meant in ((["lst"], 2, "ls"), (["activte", "X"], 2, ""), (["recrod"], 2, "record"), (["cat", "SourceAl0"], 1, "SourceAll0"), (["act", "SuorceAll0"], 1, "SourceAll0"),
                               (["recording", "inof", "x"], 2, "info")):
        line = refused(*words, code=code).stderr
        assert line.count("\n") == 1 and (f"; did you mean {meant}?" in line if meant else "did you mean" not in line), line


# A command whose reader has gone ends, also when nothing is left to print.
def closed_pipe():
    up("SourceAll")
    rig.rtse("act", "SourceAll0")
    for port in ("SourceAll0:long", "SourceAll0:short"):
        process = subprocess.Popen([f"{rig.bin_dir}/rtse", "--ns", rig.names, "print", port], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        process.stdout.readline()
        if port.endswith("short"):
            rig.rtse("deact", "SourceAll0")
        process.stdout.close()
        process.wait(60)
        said = process.stderr.read()
        assert said == "", f"a closed pipe is nothing to complain of: {said}"
    rig.rtse("act", "SourceAll0")
    for words in (["ls", "-R"], ["print", "SourceAll0:long"], ["--json", "print", "SourceAll0:long"], ["print", "SourceAll0:long", "-n", "1000000"]):
        with open("/dev/full", "w") as full:
            done = subprocess.run([f"{rig.bin_dir}/rtse", "--ns", rig.names, *words], stdout=full, stderr=subprocess.PIPE, text=True, timeout=60)
        assert done.returncode == 1 and done.stderr == "rtse: standard output: cannot be written\n", done


# Ports of different types are connected when one end turns the one type into the other.
def converted_types():
    host = up("SourceAll", "SinkAll", options=("-o", "manager.modules.preload:Wrappers.so"))
    ports = ("SourceAll0:short", "SinkAll0:double")
    refused("con", *ports, says="carry different types")
    refused("con", *ports, "-p", "dataport.outport.marshaling_type=cdr", says="carry different types")
    rig.rtse("con", *ports, "-p", "dataport.outport.marshaling_type=cdr:RTC/TimedDouble:RTC/TimedShort")
    rig.rtse("act", "SinkAll0", "SourceAll0")
    await_("numbers that came as others", lambda: "double: 3.0" in rig.log(host))
    rig.rtse("save", rig.path("converted.xml"))
    rig.rtse("teardown", rig.path("converted.xml"))
    rig.rtse("load", rig.path("converted.xml"))
    rig.rtse("check", rig.path("converted.xml"))


# A process that only hangs is not gone; one that died is.
def hung_is_not_gone():
    up("SourceAll")
    host = rig.host("SinkAll")
    rig.there("SinkAll0")
    rig.rtse("con", "SourceAll0:long", "SinkAll0:long", "-i", "wire")
    host.send_signal(signal.SIGSTOP)
    refused("wait", "SinkAll0", "--state", "gone", "--timeout", "0.2", says="does not answer")
    assert "does not answer" in rig.rtse("cat", "SourceAll0:long")
    refused("save", rig.path("half.xml"), says="leads to a port that does not answer")
    host.send_signal(signal.SIGCONT)
    rig.kill(host)
    rig.rtse("wait", "SinkAll0", "--state", "gone", "--timeout", "60")
    rig.rtse("del", "SinkAll0")
    rig.rtse("wait", "SinkAll0", "--state", "gone", "--timeout", "60")


# A process that was stopped for longer than a call may take has its connections back soon after it goes on, whoever has made them.
def connections_come_back():
    short = ("-o", "corba.call_timeout:0.5")
    up("SourceAll", options=short)
    host = rig.host("SinkAll", options=short)
    rig.there("SinkAll0")
    rig.rtse("con", "SourceAll0:long", "SinkAll0:long", "-i", "wire")
    rig.rtse("save", rig.path("both.xml"))
    rig.rtse("dis", "SourceAll0:long", "SinkAll0:long")
    rig.rtse("load", rig.path("both.xml"))
    rig.host("SourceAll?instance_name=Other", options=(*short, "-o", f"manager.components.preconnect:Other.short?port=rtcname://{rig.names}/*/SinkAll0.short"))
    rig.there("Other")
    ports = {"SourceAll0:long": "wire", "Other:short": "SinkAll0.short"}
    for port, name in ports.items():
        await_(f"the connection of {port}", lambda: name in rig.rtse("cat", "-l", port))
    rig.rtse("act", "SourceAll0", "Other", "SinkAll0")
    host.send_signal(signal.SIGSTOP)
    for port, name in ports.items():
        await_(f"the loss of {port}", lambda: name not in rig.rtse("cat", "-l", port))
    host.send_signal(signal.SIGCONT)
    for port, name in ports.items():
        await_(f"the connection of {port} again", lambda: name in rig.rtse("cat", "-l", port))


# A port that sends nothing is named, with the state of its component.
def a_silent_port_is_named():
    up("SourceAll")
    silent = subprocess.Popen([f"{rig.bin_dir}/rtse", "--ns", rig.names, "print", "SourceAll0:long", "-n", "1"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    said = silent.stderr.readline()
    assert said == "rtse: port SourceAll0.long: no sample in 2 s, print waits; SourceAll0 is Inactive\n", said
    rig.rtse("act", "SourceAll0")
    out, err = silent.communicate(timeout=60)
    assert silent.returncode == 0 and out and err == "", (out, err)


# Two ports of which one hangs with its process are disconnected at the other, whichever is named first.
def disconnect_from_one_that_hangs():
    up("SourceAll")
    host = rig.host("SinkAll")
    rig.there("SinkAll0")
    for ports in (("SourceAll0:long", "SinkAll0:long"), ("SinkAll0:long", "SourceAll0:long")):
        rig.rtse("con", "SourceAll0:long", "SinkAll0:long", "-i", "wire")
        rig.rtse("con", "SourceAll0:short", "SinkAll0:short", "-i", "other")
        host.send_signal(signal.SIGSTOP)
        rig.rtse("dis", *ports)
        assert "wire" not in rig.rtse("cat", "-l", "SourceAll0:long")
        refused("dis", *ports, says="does not answer")
        assert "other" in rig.rtse("cat", "-l", "SourceAll0:short")
        host.send_signal(signal.SIGCONT)
        rig.rtse("dis", "SourceAll0:short", "SinkAll0:short")
        for connector, port in (("wire", "SinkAll0:long"), ("other", "SinkAll0:short")):
            await_("the news at the one that hung", lambda: connector not in rig.rtse("cat", "-l", port))


# Several hosts on one machine: one has the name of the manager, nobody complains, and another takes it when that one has gone.
def managers_of_one_machine():
    first = up("SourceAll")
    second = rig.host("SinkAll")
    rig.there("SinkAll0")
    listed = rig.rtse("mgr", "list")
    assert "SourceAll0" in listed and "SinkAll0" not in listed, listed
    rig.kill(first)
    await_("the other's components", lambda: "SinkAll0" in rig.rtse("mgr", "list"))
    for host in (first, second):
        assert "belongs to another" not in rig.log(host), rig.log(host)


# Values that a component has said that it does not want are refused, from a file too; the others are taken.
def bad_values_in_files():
    up("ConfigDemo")
    saved = rig.path("system.xml")
    rig.rtse("save", saved)
    text = open(saved).read()
    assert 'rts:name="count" rts:data="1"' in text and 'rts:name="gain" rts:data="0.5"' in text, text
    with open(saved, "w") as file:
        file.write(text.replace('rts:name="count" rts:data="1"', 'rts:name="count" rts:data="many"').replace('rts:name="gain" rts:data="0.5"', 'rts:name="gain" rts:data="0.75"'))
    refused("load", saved, says='default.count cannot be "many"')
    assert rig.rtse("conf", "ConfigDemo0", "get", "count").strip() == "1"
    assert rig.rtse("conf", "ConfigDemo0", "get", "gain").strip() == "0.75"
    answer = json.loads(refused("--json", "check", saved).stdout)
    assert not answer["same"] and len(answer["differences"]) == 1 and "count" in answer["differences"][0], answer
    with open(saved, "w") as file:
        file.write(text)
    rig.rtse("load", saved)
    assert json.loads(rig.rtse("--json", "check", saved)) == {"same": True, "differences": []}
    # A key that the component does not have is told, and set as other tools do.
    with open(saved, "w") as file:
        file.write(text.replace('rts:name="gain"', 'rts:name="gian"'))
    done = rig.try_rtse("load", saved)
    assert done.returncode == 0 and done.stderr.count("\n") == 1 and "has no parameter gian" in done.stderr and "gain" in done.stderr, done


# The forms in which tools of the field name a name server.
def name_servers():
    up("SourceAll")
    for path in (f"/{rig.names}/", f"/iiop:{rig.names}/", f"/localhost:{rig.names.split(':')[1]}/"):
        context = next(name for name in rig.rtse("ls", path).split() if name.endswith(".host_cxt/"))
        assert "SourceAll" in rig.rtse("cat", f"{path}{context}SourceAll0.rtc"), path
    for server in (f"{rig.names}/", f"/{rig.names}", f"iiop:{rig.names}", f"corbaloc::{rig.names}/NameService"):
        assert "SourceAll" in rig.call(f"{rig.bin_dir}/rtse", "--ns", server, "cat", "SourceAll0"), server


# Names of the living are deleted with a word, contexts full of them only by force.
def delete_names():
    up("SourceAll")
    assert "it lives" in rig.rtse("del", "SourceAll0")
    context = next(name for name in rig.rtse("ls").split() if name.endswith(".host_cxt/")).strip("/")
    refused("del", context, says="--force")
    assert "deleted" in rig.rtse("del", "--force", context)


# A component that is connected to itself has each connection twice; it is taken apart once.
def disconnect_own_ports():
    up("Filter")
    rig.rtse("con", "Filter0:out", "Filter0:in", "-i", "loop")
    rig.rtse("dis", "Filter0")
    refused("dis", "-i", "loop", says="no port has it")


# A context that is stopped has no rate, though it is the only one and the component is active in it.
def stopped_context():
    up("SourceAll")
    rig.rtse("act", "SourceAll0")

    def row():
        return next(line.split() for line in rig.rtse("ls", "-lR").splitlines() if "SourceAll0" in line)
    assert row()[0] == "Active" and row()[2] == "Hz", row()
    rig.rtse("ec", "SourceAll0", "stop")
    assert row()[:2] == ["Active", "stopped"], row()
    rig.rtse("ec", "SourceAll0", "start")
    assert row()[2] == "Hz", row()


# The reasons are told apart.
def why_not():
    up("SourceAll", "SinkAll", "EchoProvider")
    rig.rtse("con", "SourceAll0:long", "SinkAll0:long", "-i", "one")
    refused("con", "SourceAll0:long", "SinkAll0:long", says="are connected already")
    refused("con", "SourceAll0:long", "SinkAll0:long", "-i", "one", says='id "one" is in use')
    refused("con", "EchoProvider0:Echo", "EchoProvider0:Echo", says="to itself")
    refused("mgr", "create", "SourceAll?instance_name=SinkAll0", says="there is a component SinkAll0 already")
    rig.rtse("mgr", "create", "SinkAll?instance_name=SinkAll0")  # it is there
    refused("mgr", "create", "NoSuchType", says='no type "NoSuchType"')
    refused("mgr", "unload", "SinkAll.so", says="components of it exist")
    refused("inject", "SinkAll0:float", "1e39", says="at most 3.4e38", code=2)


# A name can be a command for a terminal: it is shown there, not carried out. Programs get the octets as they are.
def names_of_others():
    try:
        terminal, line = os.openpty()
    except OSError as why:
        print(f"skipped: no pseudo-terminal: {why}")
        sys.exit(77)
    name = "evil\x1b[31m"
    up("SourceAll", "SinkAll")
    rig.rtse("con", "SourceAll0:long", "SinkAll0:long", "-n", name)
    assert name in rig.rtse("cat", "SourceAll0:long")
    # XML holds no control characters of ASCII, but those of C1, and those that turn the direction of writing.
    model = "evil\u009b31m\u202e"
    world = rig.path("evil.sdf")
    with open(world, "w", encoding="utf-8") as out:
        out.write(f"<sdf version='1.6'><world name='w'><model name='{model}'><static>true</static><link name='l'/></model></world></sdf>")
    rig.server(world=world)
    assert model in rig.simctl("tree")
    for program, words, shown in (("rtse", ["--ns", rig.names, "cat", "SourceAll0:long"], b"evil\\x1b[31m"), ("rtse", ["--ns", rig.names, "cat", "-l", "SourceAll0:long"], b"evil\\x1b[31m"),
                                  ("rtse", ["--ns", rig.names, "cat", name], b"evil\\x1b[31m"), ("simctl", ["-s", rig.server_id, "tree"], b"evil\\xc2\\x9b31m\\xe2\\x80\\xae")):
        process = subprocess.Popen([f"{rig.bin_dir}/{program}", *words], stdout=line, stderr=line)
        said, end = b"", time.monotonic() + 60
        while select.select([terminal], [], [], 0.1)[0] or process.poll() is None:
            assert time.monotonic() < end, f"{words} has not ended"
            if select.select([terminal], [], [], 0)[0]:
                said += os.read(terminal, 65536)
        assert shown in said and not any(bad in said for bad in (b"\x1b", b"\xc2\x9b", "\u202e".encode())), said
    # What the studio offers for copying of names that begin as options do.
    for words, missing in ((["simctl", "-s", rig.server_id, "pose", "--", "--help", "1", "-2", "0"], "--help"), (["rtse", "--ns", rig.names, "cat", "--", "--help"], "--help"),
                           (["rtse", "--ns", rig.names, "act", "-e", "2", "--", "-e"], "-e")):
        done = subprocess.run([f"{rig.bin_dir}/{words[0]}", *words[1:]], capture_output=True, text=True, timeout=60)
        assert done.returncode == 1 and missing in done.stderr, done
    rig.rtse("con", "-n-n", "-p-k=v", "--", "SourceAll0:float", "SinkAll0:float")
    assert "-n" in rig.rtse("cat", "-l", "SourceAll0:float")


# Deactivating means that time stands still. A simulator that is gone cannot go on; one that is slow is waited for.
def simulation_that_is_gone():
    simulator = rig.server()
    rig.naming()
    rig.host(rig.device("RTCSimulation"))
    rig.there("RTCSimulation0")
    rig.rtse("act", "RTCSimulation0")
    simulator.send_signal(signal.SIGSTOP)
    slow = subprocess.Popen([f"{rig.bin_dir}/rtse", "--ns", rig.names, "deact", "RTCSimulation0"], stderr=subprocess.PIPE, text=True)
    # The context gives up after half a second; the command must not.
    time.sleep(1)
    assert slow.poll() is None, slow.stderr.read()
    simulator.send_signal(signal.SIGCONT)
    assert slow.wait(60) == 0, slow.stderr.read()
    assert json.loads(rig.simctl("--json", "stats"))["paused"], "time goes on"
    rig.rtse("act", "RTCSimulation0")
    rig.kill(simulator)
    rig.rtse("deact", "RTCSimulation0")
    assert rig.state("RTCSimulation0") == "Inactive"
    rig.server()
    rig.rtse("act", "RTCSimulation0")


with rig:
    globals()[case]()
print("ok")
