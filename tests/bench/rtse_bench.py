# Times the system editor: rtse_bench.py BIN_DIR LIB_DIR SOURCE_DIR. Twenty components in four processes; every command, a load of a hundred connections, and the
# same listing while one process is stopped. Beside each time its limit; exit 1 when one is missed.
import json
import os
import signal
import sys
import time

bin_dir, lib_dir, source = sys.argv[1:]
sys.path.insert(0, f"{source}/tests/scenario")
from rig import Rig, await_  # noqa: E402

rig = Rig(bin_dir, lib_dir, source)
missed = 0


def took(*words, before=None, runs=7):
    """Best of several runs [s]: the machine may be busy with other things."""
    best = float("inf")
    for _ in range(runs):
        if before:
            before()
        start = time.perf_counter()
        rig.rtse(*words)
        best = min(best, time.perf_counter() - start)
    return best


def row(what, seconds, limit):
    global missed
    missed += seconds > limit
    print(f"| {what:<52} | {1000 * seconds:8.1f} ms | {1000 * limit:6.0f} ms | {'ok' if seconds <= limit else 'MISS':<4} |", flush=True)


def connections():
    sources = {port["name"]: port["data_type"] for port in json.loads(rig.rtse("--json", "cat", "SourceAll0"))["ports"]}
    sinks = {port["data_type"]: port["name"] for port in json.loads(rig.rtse("--json", "cat", "SinkAll0"))["ports"]}
    pairs = [(a, sinks[kind]) for a, kind in sources.items() if kind in sinks]
    return [(f"SourceAll{i}:{a}", f"SinkAll{i}:{b}") for i in range(10) for a, b in pairs][:100]


def command_times():
    a, b = "SourceAll3:" + first[0], "SinkAll3:" + first[1]

    def apart():
        rig.try_rtse("dis", a, b)

    def together():
        rig.try_rtse("con", "-d", a, b)

    for words in (["ls"], ["ls", "-lR"], ["tree"], ["cat", "SourceAll3"], ["cat", a], ["conf", "SourceAll3"], ["conf", "SourceAll3", "set", "start", "2"], ["mgr", "list", "-m", manager],
                  ["wait", "SourceAll3", "--state", "any"], ["del", "-z"]):
        row("rtse " + " ".join(words[:2]), took(*words), limit)
    row("rtse con", took("con", a, b, before=apart), limit)
    row("rtse dis", took("dis", a, b, before=together), limit)
    row("rtse act", took("act", "SourceAll3", before=lambda: rig.rtse("deact", "SourceAll3")), period + limit)
    row("rtse deact", took("deact", "SourceAll3", before=lambda: rig.rtse("act", "SourceAll3")), period + limit)


# Commands that name what they mean, among 20 components and among 1000 more: what others have costs little.
def among_many():
    a, b = "SourceAll3:" + first[0], "SinkAll3:" + first[1]

    def times():
        return {"cat": took("cat", "SourceAll3"), "cat of a port": took("cat", a), "con": took("con", a, b, before=lambda: rig.try_rtse("dis", a, b)), "act": took("act", "SourceAll3")}

    few = times()
    for host in range(4):
        names = [f"ConfigDemo?instance_name=Crowd{250 * host + i}&exec_cxt.periodic.rate=1" for i in range(250)]
        rig.host(*names, options=("-o", f"manager.instance_name:crowd{host}", "-o", "naming.formats:%n.rtc"))
    rig.there(*(f"Crowd{250 * host + 249}" for host in range(4)))
    await_("1000 components", lambda: rig.rtse("ls", "-R").count("Crowd") >= 1000)
    for command, seconds in times().items():
        row(f"rtse {command}, 1020 components ({seconds / few[command]:.1f} x of 20)", seconds, 0.2)


def system_times(pairs):
    for number, (a, b) in enumerate(pairs):
        rig.rtse("con", a, b, "-i", f"c{number}")
    file = rig.path("system.xml")
    row("rtse save, 100 connections", took("save", file), limit)
    row("rtse check", took("check", file), limit)
    row("rtse load, 100 connections", took("load", file, before=lambda: rig.rtse("teardown", file), runs=3), 2)
    row("rtse teardown", took("teardown", file, before=lambda: rig.rtse("load", file), runs=3), 2)


def with_a_hung_process(process):
    process.send_signal(signal.SIGSTOP)
    await_("stopped process", lambda: open(f"/proc/{process.pid}/stat").read().rsplit(")", 1)[1].split()[0] == "T")
    try:
        # One time-out of a call, by default a second, and no more however many components hang.
        row("rtse ls -lR, 5 of 20 components hang", took("ls", "-lR", runs=3), 1.2)
        row("rtse --call-timeout 0.2 ls -lR", took("--call-timeout", "0.2", "ls", "-lR", runs=3), 0.4)
        row("rtse cat of a living one", took("cat", "SinkAll9", runs=3), 1.2)
        row("rtse conf of a living one", took("conf", "SinkAll9", runs=3), 1.2)
        listing = rig.rtse("ls", "-lR")
        assert listing.count("Hung") == 5 and listing.count("Inactive") == 15, listing
    finally:
        process.send_signal(signal.SIGCONT)


limit = 0.05   # of one command [s]
period = 0.01  # of the components' contexts [s]: a transition waits for the next cycle
with rig:
    rig.naming()
    hosts = []
    for host in range(4):
        kind = "SourceAll" if host < 2 else "SinkAll"
        names = [f"{kind}?instance_name={kind}{5 * (host % 2) + i}&exec_cxt.periodic.rate=100" for i in range(5)]
        hosts.append(rig.host(*names, options=("-o", f"manager.instance_name:host{host}", "-o", f"naming.formats:%n.rtc", "-o", f"manager.naming_formats:host{host}.mgr")))
    components = [f"{kind}{i}" for kind in ("SourceAll", "SinkAll") for i in range(10)]
    rig.there(*components)
    pairs = connections()
    assert len(pairs) == 100, len(pairs)
    first = (pairs[0][0].split(":")[1], pairs[0][1].split(":")[1])
    manager = next(entry["path"] for entry in json.loads(rig.rtse("--json", "ls", "-R")) if entry["kind"] == "manager")
    print(f"| {'20 components in 4 processes':<52} | {'time':>11} | {'limit':>9} |      |")
    command_times()
    system_times(pairs)
    with_a_hung_process(hosts[0])
    among_many()
sys.exit(1 if missed else 0)
