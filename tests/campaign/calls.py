# What the tests of campaigns share: a folder of their own, plans in it, and calls of rtse. Arguments: CASE BIN_DIR LIB_DIR SOURCE_DIR.
import contextlib
import csv
import io
import json
import os
import pathlib
import signal
import stat
import subprocess
import sys
import tempfile
import time

case, bin_dir, lib_dir, source = sys.argv[1:]
folder = pathlib.Path(tempfile.mkdtemp(prefix="campaigns-"))
START = f"""system: {source}/worlds/systems/obstacle_avoidance.xml
world: {source}/worlds/obstacle_course.sdf
duration: 1
"""


def plan(text, name="plan.yaml", start=START):
    (folder / name).write_text(start + text)
    return str(folder / name)


def call(*words):
    return subprocess.run([f"{bin_dir}/rtse", *map(str, words)], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=200)


def rtse(*words, code=0):
    done = call(*words)
    assert code is None or done.returncode == code, (words, done.returncode, done.stdout, done.stderr)
    return done


def rows(file="plan.db"):
    return list(csv.DictReader(io.StringIO(rtse("results", folder / file, "--csv").stdout)))


def states(file="plan.db"):
    return {row["row"]: row["state"] for row in rows(file)}


# Of a plan with one row: its report, the same in two runs.
def twice(text, name, code=0):
    one, two = (json.loads(rtse("--json", "sweep", plan(text, name), "--row", 1, "--keep", folder / name[:-5], code=code).stdout) for _ in range(2))
    assert one["state"] == two["state"], (text, one, two)
    return one


# Ctrl-C once this has appeared in the folder: exit code, output, errors.
def interrupted_at(pattern, *words):
    process = subprocess.Popen([f"{bin_dir}/rtse", *map(str, words)], cwd=folder, env={**os.environ, "TMPDIR": str(folder)}, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                               text=True)
    deadline = time.monotonic() + 100
    while not list(folder.glob(pattern)):
        assert time.monotonic() < deadline and process.poll() is None, (pattern, process.poll())
        time.sleep(0.02)
    for scratch in folder.glob("rtse-run-*"):
        with contextlib.suppress(FileNotFoundError):  # of a row that has ended
            assert stat.S_IMODE(scratch.stat().st_mode) == 0o700, "other accounts can read what a run writes"
    process.send_signal(signal.SIGINT)
    said = process.communicate(timeout=100)
    return process.returncode, *said


# Runs a command in a mount namespace of its own, after the shell words `mount`. Where no such namespace can be created, as in a chroot, the case ends as skipped (77).
def after_mount(mount, *words, **environment):
    why = ""
    for user in ([], ["--user", "--map-root-user"]):
        apart = ["unshare", *user, "--mount", "sh", "-c"]
        probe = subprocess.run([*apart, mount], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, timeout=60)
        if probe.returncode == 0:
            return subprocess.run([*apart, mount + ' && exec "$@"', "sh", *map(str, words)], cwd=folder, env={**os.environ, **{key: str(value) for key, value in environment.items()}},
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=200)
        why = why or probe.stderr.strip()
    print(f"skipped: {case} needs a mount namespace: {why}")
    sys.exit(77)


# As a program: the case that it is called with.
def run_case(cases):
    try:
        cases[case]()
    finally:
        subprocess.run(["rm", "-rf", str(folder)], check=False)
