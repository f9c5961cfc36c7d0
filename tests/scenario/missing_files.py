# Every program reports a file that is missing, a folder, unreadable, empty or of another kind in one line that names the file, with exit code 2, and leaves
# nothing behind: missing_files.py BIN_DIR SOURCE_DIR. Needs no name server and no simulator.
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

bin_dir, source = sys.argv[1:]
system = f"{source}/worlds/systems/obstacle_avoidance.xml"
course = f"{source}/worlds/obstacle_course.sdf"
environment = dict(os.environ, RTCTREE_NAMESERVERS="127.0.0.1:1", RTMSIM_SERVER_ID="9000")
nobody = 65534
run = ["rtse", "run", system, "-w", course, "-d", "0.1"]

# FILE is replaced by the name of the bad file.
calls = [
    ["rtse", "load", "FILE"], ["rtse", "start", "FILE"], ["rtse", "stop", "FILE"], ["rtse", "teardown", "FILE"], ["rtse", "check", "FILE"],
    ["rtse", "diff", "FILE", "FILE"], ["rtse", "run", "FILE", "-w", course], ["rtse", "run", system, "-w", "FILE"], [*run, "--expect", "FILE"], [*run, "--run-file", "FILE"],
    ["rtse", "run", "--like", "FILE"], ["rtse", "new", "--spec", "FILE"],
    ["rtse", "play", "FILE"], ["rtse", "replay", "FILE", "--into", "X0"], ["rtse", "goto", "FILE", "1"], ["rtse", "goto", system, "-w", "FILE", "1"],
    ["rtse", "page", "FILE", "-o", "x.html"], ["rtse", "recording", "info", "FILE"], ["rtse", "recording", "ls", "FILE"], ["rtse", "recording", "cat", "FILE"],
    ["rtse", "recording", "export", "FILE", "-o", "out"], ["rtse", "recording", "compare", "FILE", "FILE"], ["rtse", "recording", "repair", "FILE", "-o", "out.mcap"],
    ["rtse", "sweep", "FILE"], ["rtse", "hunt", "FILE"], ["rtse", "results", "FILE"],
    ["sim-server", "FILE"], ["sim-server", "FILE", "--check"], ["sim-server", course, "--duration", "0", "--gains", "FILE"],
    ["player-gateway", "--config", "FILE"], ["ros2-gateway", "--config", "FILE"], ["rtcprof", "FILE"],
    ["rtm-studio", "FILE"], ["rtm-studio", "FILE", "-w", course], ["rtm-studio", "-w", "FILE"], ["rtm-studio", system, "-w", "FILE"],
    ["rtse-page", "FILE", "-o", "x.html"], ["rtse-page", "FILE", "-o", "x.html", "--other", "FILE"],
]
# rtc.conf may be empty, and lines of it that are not understood are warnings. Any content can be attached, and IDL is not parsed.
lenient = [["rtcd", "-f", "FILE"], ["ConfigDemoComp", "-f", "FILE"], ["rtse", "record", "-o", "x.mcap", "--all", "--attach", "a=FILE"], ["rtse", "new", "New", "--idl", "FILE"]]
optional = ("ros2-gateway", "rtm-studio", "rtse-page")  # can be left out of a build


def said(words, file, user=None):
    done = subprocess.run([f"{bin_dir}/{words[0]}", *(word.replace("FILE", file) for word in words[1:])], cwd=folder, env=environment, capture_output=True, text=True,
                          timeout=60, user=user, stdin=subprocess.DEVNULL)
    return done.returncode, done.stdout + done.stderr


wrong = []
with tempfile.TemporaryDirectory() as folder:
    os.chmod(folder, 0o755)
    os.mkdir(f"{folder}/aFolder")
    files = {"nothere": None, "aFolder": None, "empty": b"", "garbage": bytes(range(256)), "locked": b"x"}
    for name, octets in files.items():
        if octets is not None:
            pathlib.Path(folder, name).write_bytes(octets)
    os.chmod(f"{folder}/locked", 0)
    is_root = os.geteuid() == 0
    try:  # root reads every file; another account may not reach the programs
        can_be_locked = not is_root or said(["rtse", "--version"], "", nobody)[0] == 0
    except OSError:
        can_be_locked = False
    for file in files:
        if file == "locked" and not can_be_locked:
            print("skipped: a file without the right to read it, as the account nobody cannot run the programs")
            continue
        for words in calls + (lenient if file not in ("empty", "garbage") else []):
            if words[0] in optional and not shutil.which(words[0], path=bin_dir):
                continue
            code, text = said(words, file, nobody if file == "locked" and is_root else None)
            if code != 2 or text.count("\n") != 1 or file not in text or not text.startswith(f"{words[0]}: "):
                wrong.append(f"{' '.join(words)} of {file}: exit {code}: {text.strip()}")
    pathlib.Path(folder, "systm.xml").touch()
    code, text = said(["rtse", "load", "FILE"], "system.xml")
    assert "did you mean systm.xml?" in text, text
    left = set(os.listdir(folder)) - set(files) - {"systm.xml"}
    assert not left, left
assert not wrong, "\n" + "\n".join(wrong)
print("ok")
