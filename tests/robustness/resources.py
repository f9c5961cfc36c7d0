# Machines that have run out of something: resources.py BIN_DIR LIB_DIR SOURCE_DIR [files|memory|disk] [--seconds T] [--seed S]. Programs are started with few descriptors, with little memory and with a disk
# that is full after some octets. None of them dies of a signal, hangs, or fails without a line that says why; one that works all the same ends on demand.
import argparse
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time

arguments = argparse.ArgumentParser()
arguments.add_argument("folders", nargs=3)
arguments.add_argument("what", nargs="?", choices=("files", "memory", "disk"))
arguments.add_argument("--seconds", type=float, default=0)
arguments.add_argument("--seed", type=int)
given = arguments.parse_args()
bin_dir, lib_dir, source = (os.path.abspath(folder) for folder in given.folders)
sys.path.append(f"{source}/tests/scenario")
from attacker import seeded
from system import System
import server_ids

choice = seeded(given.seed)
watchdog = 300 if "RTMSIM_SANITIZED" in os.environ else 60
course = f"{source}/worlds/obstacle_course.sdf"
server = server_ids.claim(3)
nothing = "127.0.0.1:9"  # nobody answers there

servers = {
    "sim-server": [f"{bin_dir}/sim-server", course, "-s", server],
    "rtcd": [f"{bin_dir}/rtcd", "-i", "-f", "none.conf", "-o", "naming.enable:NO", "-o", f"manager.modules.load_path:{lib_dir}", "LaserObstacleAvoid"],
    "component program": [f"{bin_dir}/LaserObstacleAvoidComp", "-f", "none.conf", "-o", "naming.enable:NO"],
    "player-gateway": [f"{bin_dir}/player-gateway", "-s", server, "--port", "0"],
}
if os.path.exists(f"{bin_dir}/rtm-studio"):
    servers["rtm-studio"] = [f"{bin_dir}/rtm-studio", "--ns", nothing, "-s", server, "--port", "0"]
least = {"rtm-studio": 30 << 20, "rtse ls": 27 << 20}  # [octets] with less it ends in the initializers of omniORB's libraries, before its own begin
tools = {
    "rtse ls": [f"{bin_dir}/rtse", "--ns", nothing, "ls"],
    "simctl list": [f"{bin_dir}/simctl", "list", "-a"],
    "sim-server --check": [f"{bin_dir}/sim-server", "--check", course],
    "sim-server --hash": [f"{bin_dir}/sim-server", course, "-s", server, "--hash", "--duration", "0.05", "--rtf", "0"],
}


def run(name, words, limits, folder, is_server, patience=1.0):
    """The exit code and what it said. A server that works is told to end."""

    def prepare():
        for which, most in limits.items():
            resource.setrlimit(which, (most, most))

    log = os.path.join(folder, "log")
    with open(log, "w") as output:
        process = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=output, stderr=output, cwd=folder, preexec_fn=prepare,
                                   restore_signals=False)  # who writes beyond the limit of a file gets an error then, as on a full disk
    try:
        if is_server:
            try:
                process.wait(patience)
            except subprocess.TimeoutExpired:
                process.send_signal(signal.SIGTERM)
        code = process.wait(watchdog)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
        code = "hangs"
    with open(log, errors="replace") as output:
        text = output.read()
    where = f"{name} with {limits}: {code}\n{text[-2000:]}"
    told_early = is_server and code in (-signal.SIGTERM, 128 + signal.SIGTERM)  # before it was there, or while it made itself ready
    assert code != "hangs" and (code >= 0 or told_early), where
    assert code == 0 or told_early or text.strip(), where
    assert "terminate called" not in text and "core dumped" not in text, where
    return code, text


def each(candidates, which, values, patience):
    count = 0
    with tempfile.TemporaryDirectory() as folder:
        for value in values:
            for name, words in candidates.items():
                if which == resource.RLIMIT_AS and value < least.get(name, 0):
                    continue
                run(name, words, {which: value}, folder, words in servers.values(), patience)
                count += 1
    subprocess.run([f"{bin_dir}/simctl", "-s", server, "clean"], capture_output=True, timeout=watchdog)
    return count


def files(values):
    return each({**servers, **tools}, resource.RLIMIT_NOFILE, values, 1)


def memory(values):
    return each({**servers, **tools}, resource.RLIMIT_AS, [value << 20 for value in values], 1)


# What a run keeps, records and writes.
def disk(values):
    system, count = f"{source}/worlds/systems/obstacle_avoidance.xml", 0
    for value in values:
        with tempfile.TemporaryDirectory() as folder:
            files = {"--keep": "kept", "--record": "record.mcap", "--hash-log": "hashes", "--picture": "picture.png", "--junit": "junit.xml"}
            options = [word for option, file in files.items() for word in (option, f"{folder}/{file}")]
            words = [f"{bin_dir}/rtse", "run", system, "--world", course, "--module-path", lib_dir, "--duration", "3", *options]
            code, text = run("rtse run", words, {resource.RLIMIT_FSIZE: value}, folder, False)
            assert code == 1 and "rtse: " in text, text
            with open(f"{folder}/rtc.conf", "w") as file:
                file.write(f"logger.enable: YES\nlogger.file_name: {folder}/rtc.log\nlogger.log_level: PARANOID\n")
            words = [f"{bin_dir}/rtcd", "-i", "-f", f"{folder}/rtc.conf", "-o", "naming.enable:NO", "-o", f"manager.modules.load_path:{lib_dir}", "LaserObstacleAvoid"]
            code, text = run("rtcd", words, {resource.RLIMIT_FSIZE: value}, folder, True)
            assert code == 0, text
            count += 2
    return count


# By hand: values at random between these; in the suite some that were dangerous.
ranges = {"files": (4, 60), "memory": (25, 700), "disk": (0, 200_000)}
usual = {"files": (5, 12, 24), "memory": (25, 80, 100, 120, 265, 330), "disk": (4096,)}
for what in (given.what,) if given.what else ("files", "memory", "disk"):
    work, until = globals()[what], time.monotonic() + given.seconds
    count = work(usual[what])
    while time.monotonic() < until:
        count += work([choice.randrange(*ranges[what])])
    print(f"{what}: {count} programs", flush=True)
