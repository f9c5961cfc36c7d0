# Every verb that takes a file says in one line which file is missing: missing_files.py BIN_DIR SOURCE_DIR. Needs no name server and no simulator.
import os
import subprocess
import sys
import tempfile

bin_dir, source = sys.argv[1:]
system = f"{source}/worlds/systems/obstacle_avoidance.xml"
course = f"{source}/worlds/obstacle_course.sdf"
environment = dict(os.environ, RTCTREE_NAMESERVERS="127.0.0.1:1")

# FILE stands for the missing one.
calls = [
    ["rtse", "load", "FILE"], ["rtse", "start", "FILE"], ["rtse", "stop", "FILE"], ["rtse", "teardown", "FILE"], ["rtse", "check", "FILE"],
    ["rtse", "diff", "FILE", system], ["rtse", "diff", system, "FILE"],
    ["rtse", "run", "FILE", "-w", course], ["rtse", "run", system, "-w", "FILE"], ["rtse", "run", system, "-w", course, "--expect", "FILE"],
    ["rtse", "run", system, "-w", course, "--run-file", "FILE"], ["rtse", "run", "--like", "FILE"],
    ["rtse", "new", "--spec", "FILE"],
    ["rtse", "play", "FILE"], ["rtse", "replay", "FILE", "--into", "X0"], ["rtse", "goto", "FILE", "1"], ["rtse", "goto", system, "-w", "FILE", "1"],
    ["rtse", "recording", "info", "FILE"], ["rtse", "recording", "ls", "FILE"], ["rtse", "recording", "cat", "FILE"],
    ["rtse", "recording", "export", "FILE", "-o", "out"], ["rtse", "recording", "compare", "FILE", system], ["rtse", "recording", "repair", "FILE", "-o", "out.mcap"],
    ["rtse", "sweep", "FILE"], ["rtse", "hunt", "FILE"], ["rtse", "results", "FILE"],
    ["sim-server", "FILE"],
]


def said(words, file):
    done = subprocess.run([f"{bin_dir}/{words[0]}", *(word.replace("FILE", file) for word in words[1:])], cwd=folder, env=environment, capture_output=True,
                          text=True, timeout=60)
    return done.returncode, done.stdout + done.stderr


wrong = []
with tempfile.TemporaryDirectory() as folder:
    os.mkdir(f"{folder}/aFolder")
    open(f"{folder}/systm.xml", "w").close()
    for words in calls:
        code, text = said(words, "nothere.xml")
        is_good = code in (1, 2) and text.count("\n") == 1 and "nothere.xml" in text and "no such file" in text and text.startswith(f"{words[0]}: ")
        if not is_good:
            wrong.append(f"{' '.join(words)}: exit {code}: {text.strip()}")
        code, text = said(words, "aFolder")
        if words[0] == "rtse" and not (code in (1, 2) and text.count("\n") == 1 and "aFolder" in text and ("a file is expected" in text or "is not a recording" in text)):
            wrong.append(f"{' '.join(words)} of a folder: exit {code}: {text.strip()}")
    code, text = said(["rtse", "load", "FILE"], "system.xml")
    assert "did you mean systm.xml?" in text, text
    left = sorted(os.listdir(folder))
    assert left == ["aFolder", "systm.xml"], left
assert not wrong, "\n" + "\n".join(wrong)
print("ok")
