# What a campaign sees when processes, machines and disks are in trouble, one case per run: trouble.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import json
import os
import shlex
import shutil
import sqlite3
import subprocess

from calls import after_mount, bin_dir, folder, interrupted_at, plan, rows, rtse, run_case, twice


# What is seen of a component whose host was killed, and is there again.
def kills():
    velocity = "port: \"LaserObstacleAvoid0:velocity\", member: data.vx"
    kill = "one_process_each: true\nfaults: [{at: 0.3, for: 0.2, component: LaserObstacleAvoid0, is: kill}]\n"
    measured = f"measure: [{{value: {{{velocity}, take: count, as: n}}}}]\n"

    def row(text, name, *words, code=0):
        return json.loads(rtse("--json", "sweep", plan(text, name), "--row", 1, "--keep", folder / name[:-5], *words, code=code).stdout)

    whole = row(measured, "whole.yaml")["measures"]["n"]
    back = row(measured + "invariants: true\n" + kill, "back.yaml", "--record")
    assert back["passed"] and 0.7 * whole < back["measures"]["n"] < 0.9 * whole, (whole, back)
    listed = json.loads(rtse("--json", "recording", "info", folder / "back/run.mcap").stdout)
    samples = {channel["topic"]: channel["samples"] for channel in listed["channels"]}
    assert samples["/LaserObstacleAvoid0/velocity"] == back["measures"]["n"], (samples, back)
    # It is judged by what it sends then, and not by what it has sent before.
    done = rtse("sweep", plan(f"never: [{{{velocity}, min: -9, after: 0.7}}]\nexpect: [{{value: {{{velocity}, min: 9}}}}]\n" + kill, "judged.yaml"), "--row", 1, code=1)
    assert "min: -9, after: 0.7}: it was so at 0.7 s" in done.stderr and "min: 9" in done.stderr, done.stderr
    gone = kill.replace("for: 0.2, ", "")
    twice(f"never: [{{{velocity}, min: -9, after: 0.5}}]\n" + gone, "gone.yaml")
    # What is asked of a component that is away does nothing, and is told; the naming service need not be there for what is asked of others.
    away = kill + """  - {at: 0.2, for: 0.7, naming: gone}
  - {at: 0.4, for: 0.1, component: LaserObstacleAvoid0, is: kill}
events:
  - {at: 0.25, set: {component: LaserObstacleAvoid0, parameter: stop_distance, value: 0.9}}
  - {at: 0.4, deactivate: LaserObstacleAvoid0}
  - {at: 0.4, set: {component: LaserObstacleAvoid0, parameter: stop_distance, value: 0.9}}
  - {at: 0.4, disconnect: range-to-avoidance}
never: [{component: RTCLaser0, is: Inactive}]
"""
    away = away.replace("faults: [", "faults:\n  - ").replace("is: kill}]", "is: kill}", 1)
    done = rtse("sweep", plan(away, "away.yaml"), "--row", 1)
    for text in ("disconnect: range-to-avoidance}: did nothing: component LaserObstacleAvoid0 was killed", "deactivate: LaserObstacleAvoid0}: did nothing: ",
                 "its host restarts when the name server responds again", 'at: 0.4, for: 0.1, component: "LaserObstacleAvoid0", is: kill}: did nothing: '):
        assert done.stderr.count(text) == 1, (text, done.stderr)
    assert done.stderr.count("did nothing") == 4, done.stderr
    twice(away, "away.yaml")
    # Who is in the same process goes with it.
    twice("faults: [{at: 0.3, component: LaserObstacleAvoid0, is: kill}]\n", "all.yaml")


# Calls that share a results file are not in each other's way, and what they leave is one file that anybody can read anywhere.
def shared():
    p = plan("repeat: 24\n")
    lines = rtse("sweep", p, "--engine", "parallel", "--chunk", 2).stdout.splitlines()
    calls = [subprocess.Popen(["sh", "-c", line], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) for line in lines]
    said = [one.communicate(timeout=250) for one in calls]
    assert all(one.returncode == 0 for one in calls), said
    assert len(rows()) == 24 and not list(folder.glob("plan.db-*")), list(folder.iterdir())
    with open(folder / "plan.db", "rb") as file:
        assert file.read(20)[18:] == b"\1\1"  # versions of who writes and who reads: no log
    # One that was killed leaves a log; without anything in it, it is in nobody's way.
    for kind in ("one", "left"):
        place = folder / f"{kind}-place"
        place.mkdir()
        shutil.copy(folder / "plan.db", place / "plan.db")
        if kind == "left":
            with sqlite3.connect(place / "plan.db") as database:
                database.execute("PRAGMA journal_mode=WAL")
            database.close()
        done = on_read_only_disk(place, f"{bin_dir}/rtse", "results", place / "plan.db", "--csv")
        assert done.returncode == 0 and len(done.stdout.splitlines()) == 25, (kind, done)


# A folder as on a disk that is mounted read-only.
def on_read_only_disk(place, *words, **environment):
    quoted = shlex.quote(str(place))
    return after_mount(f"mount --bind {quoted} {quoted} && mount -o remount,bind,ro {quoted}", *words, **environment)


# Trouble of the machine says nothing about rows: it is told, and the same command runs them later.
def machine():
    p = plan("repeat: 2\n")
    tools = folder / "tools"
    tools.mkdir()
    (tools / "omniNames").write_text("#!/bin/sh\necho no room for names >&2\nexit 1\n")
    (tools / "omniNames").chmod(0o755)
    done = subprocess.run([f"{bin_dir}/rtse", "sweep", p], cwd=folder, env={**os.environ, "PATH": f"{tools}:{os.environ['PATH']}"}, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True, timeout=200)
    assert done.returncode == 1 and "2 failed" in done.stdout and "row 1: omniNames " in done.stderr, done
    assert rows() == []
    again = json.loads(rtse("--json", "sweep", p).stdout)
    assert (again["passed"], again["stored"]) == (2, 0), again
    (folder / "tmp").mkdir()
    for verb in ("sweep", "hunt"):
        done = on_read_only_disk(folder / "tmp", f"{bin_dir}/rtse", verb, plan("repeat: 3\n", "other.yaml"), TMPDIR=folder / "tmp")
        assert done.returncode == 1 and done.stderr == f'rtse: folder "{folder}/tmp": Read-only file system\n', (verb, done)


# What a hunt finds is of the system, not of how it is hunted, and it is told as it is.
def finds():
    # What nobody has asked for fits its sensor: the simulator's refusals are no finds.
    drives = plan("hunt: {most: 2}\n", "drives.yaml")
    done = json.loads(rtse("--json", "hunt", drives, "--cases", 16, "-j", 2, code=None).stdout)
    assert not any("fault " in find["problem"] for find in done["finds"]), done
    # Nor is what cannot be done to a component that is away.
    text = """one_process_each: true
hunt:
  most: 4
  faults: [{component: LaserObstacleAvoid0, is: kill}, {component: RTCLaser0, is: kill}, {naming: gone}]
  events: [{deactivate: LaserObstacleAvoid0}, {connect: range-to-avoidance}, {disconnect: range-to-avoidance}]
"""
    done = json.loads(rtse("--json", "hunt", plan(text, "away.yaml"), "--cases", 24, "-j", 2).stdout)
    assert done["finds"] == [], done
    # A find that does not get to its end has no state; its command says so.
    hang = plan("hang_timeout: 1\nhunt: {faults: [{component: LaserObstacleAvoid0, is: hang}]}\n", "hang.yaml")
    find = rtse("hunt", hang, "--finds", 1, "--cases", 16, "-j", 2, code=1).stdout
    assert "did not finish its tick" in find and "hang.finds/find-1.yaml --row 1\n" in find and "--state" not in find, find
    assert "expected" not in rtse("sweep", folder / "hang.finds/find-1.yaml", "--row", 1, "--state", "-", code=1).stderr
    # An interrupt while it is shrunk takes nothing of its reason.
    _, out, _ = interrupted_at("hang.finds/shrinking", "hunt", hang, "--cases", 40)
    assert "did not finish its tick" in out and "run: interrupted" not in out and "interrupted: it may not be the simplest" in out, out
    assert "did not finish its tick" in (folder / "hang.finds/find-1.yaml").read_text()


run_case(globals())
