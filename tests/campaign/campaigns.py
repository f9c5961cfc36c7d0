# Campaigns as users run them, one case per run: campaigns.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import base64
import json
import os
import pathlib
import re
import shlex
import shutil
import signal
import sqlite3
import subprocess
import time
import zlib

from calls import START, after_mount, bin_dir, folder, interrupted_at, plan, rows, rtse, run_case, source, states


# Rows differ by what varies, a row alone gives what it gave among others, and nothing runs twice.
def sweep():
    p = plan("""vary:
  model/pioneer2dx/pose/yaw: [0, 0.785]
  component/LaserObstacleAvoid0/turn_gain: [1, 3]
measure:
  - path_length: {model: pioneer2dx}
  - clearance: {model: pioneer2dx}
  - value: {port: "LaserObstacleAvoid0:velocity", member: data.vx, take: mean, as: speed}
""")
    first = json.loads(rtse("--json", "sweep", p, "-j", 2).stdout)
    assert (first["rows"], first["passed"], first["stored"]) == (4, 4, 0), first
    found = states()
    assert len({found["1"], found["3"]}) == 2, found
    again = json.loads(rtse("--json", "sweep", p).stdout)
    assert (again["passed"], again["stored"]) == (4, 4), again
    alone = json.loads(rtse("--json", "sweep", p, "--row", 3, "--keep", folder / "alone").stdout)
    assert alone["state"] == found["3"] and (folder / "alone/record.txt").exists(), alone
    assert all(0 < float(row["clearance"]) < 2 and float(row["speed"]) > 0 for row in rows()), rows()
    audited = json.loads(rtse("--json", "sweep", p, "--audit", "100%", "-j", 2).stdout)
    assert (audited["audited"], audited["different"]) == (4, 0), audited
    assert not list(folder.glob("plan.runs/*"))
    # Rows that are the same run once, and count as often as they stand in the plan.
    twins = json.loads(rtse("--json", "sweep", plan("vary: {seed: [1, 2, 1]}\n", "twins.yaml")).stdout)
    assert (twins["rows"], twins["passed"], twins["failed"]) == (3, 3, 0), twins
    # Why rows run again is said: a file that has changed, another question; not for rows that are new.
    system = folder / "system.xml"
    system.write_text(pathlib.Path(f"{source}/worlds/systems/obstacle_avoidance.xml").read_text())
    p = pathlib.Path(plan("repeat: 1\n", "why.yaml"))
    p.write_text(p.read_text().replace(f"{source}/worlds/systems/obstacle_avoidance.xml", str(system)))
    assert "run again" not in rtse("sweep", p).stderr
    p.write_text(p.read_text().replace("repeat: 1", "repeat: 2"))
    assert "run again" not in rtse("sweep", p).stderr
    system.write_text(system.read_text() + "<!-- changed -->\n")
    p.write_text(p.read_text().replace("duration: 1", "duration: 1.5"))
    said = rtse("sweep", p).stderr
    assert f"2 rows run again, because these have changed since the results were made: {system}, the plan's duration, actions or expectations\n" in said, said
    # A number that no sample has is no number that is not there by chance, also of a port whose type the profile does not tell.
    for text in ("measure: [{value: {port: PORT, member: data.wx, take: min}}]\n", "never: [{port: PORT, member: data.wx, min: 1}]\n"):
        done = rtse("sweep", plan(text.replace("PORT", '"RTCPosition2d0:actual_velocity"'), "member.yaml"), code=1)
        assert "have no number data.wx; they have " in done.stderr, done.stderr


# What fails keeps its files and is shown in every form.
def reports():
    p = plan("""vary: {seed: [1, 2]}
expect:
  - path_length: {model: pioneer2dx, min: 100}
measure:
  - wall_time: {}
""")
    done = rtse("sweep", p, code=1)
    assert "2 rows: 0 passed, 2 failed" in done.stdout and f"rtse sweep {p} --row 1" in done.stderr, done
    kept = sorted(path.name[:5] for path in folder.glob("plan.runs/*"))
    assert kept == ["row-1", "row-2"], kept
    assert all((path / "picture.png").exists() for path in folder.glob("plan.runs/*"))
    text = rtse("results", folder / "plan.db", "--by", "seed").stdout
    assert "path_length: {model: pioneer2dx, min: 100}" in text and "0 of       2" in text, text
    rtse("results", folder / "plan.db", "--html", folder / "page.html", "--junit", folder / "junit.xml")
    page = (folder / "page.html").read_text()
    assert "data:image/png;base64," in page and "http://" not in page.replace("http://www.w3.org", ""), len(page)
    assert (folder / "junit.xml").read_text().count("<failure") == 2
    # Also after a call with relative names, from elsewhere, and when all was moved; with a name that a shell would take apart.
    (folder / "my plan.yaml").write_text(pathlib.Path(p).read_text())
    rtse("sweep", "my plan.yaml", "--rows", 1, code=1)
    (folder / "moved").mkdir()
    for number in range(2):
        place = folder / "moved" if number == 1 else folder
        if number == 1:
            for name in ("my plan.db", "my plan.runs"):
                (folder / name).rename(place / name)
        subprocess.run([f"{bin_dir}/rtse", "results", place / "my plan.db", "--html", folder / "page.html"], cwd="/", check=True, timeout=100)
        page = (folder / "page.html").read_text()
        assert "data:image/png;base64," in page and f"rtse sweep '{folder}/my plan.yaml' --row 1" in page, number
    assert "--by \"unknown\"" in rtse("results", folder / "plan.db", "--by", "unknown", code=2).stderr


# What a page that rtse wrote says about its run.
def page_of(file):
    block = re.search(r'id="run-index">([^<]*)<', file.read_text()).group(1)
    return json.loads(zlib.decompress(base64.b64decode(block)))["hello"]["page"]


# Failed rows and finds leave pages that open at the failure and mark what the plan did; passed rows and recordings leave nothing.
def pages():
    if not os.access(f"{bin_dir}/rtse-page", os.X_OK):
        raise SystemExit(77)
    events = "events: [{at: 0.2, deactivate: LaserObstacleAvoid0}, {at: 0.4, activate: LaserObstacleAvoid0}]\n"
    rtse("sweep", plan("repeat: 1\n", "good.yaml"), "--page")
    assert not (folder / "good.runs").exists()
    p = plan(events + "expect:\n  - path_length: {model: pioneer2dx, max: 0.05}\n")
    rtse("sweep", p, "--page", code=1)
    (row,) = folder.glob("plan.runs/*")
    page = page_of(row / "run.html")
    assert page["passed"] is False and 0 < page["at"] < 1 and page["select"] == "pioneer2dx", page
    assert [(mark["kind"], mark["time"]) for mark in page["marks"] if mark["kind"] == "event"] == [("event", 0.2), ("event", 0.4)], page
    assert page["command"] == f"rtse sweep {p} --row 1" and not (row / "run.mcap").exists(), page
    said = rtse("sweep", p, "--page", code=1).stderr
    assert "  page: " in said and f"plan.runs/{row.name}/run.html\n" in said, said
    rtse("results", folder / "plan.db", "--junit", folder / "rows.xml")
    assert f"<system-out>[[ATTACHMENT|{row / 'run.html'}]]</system-out>" in (folder / "rows.xml").read_text(), row
    rtse("sweep", p, "--row", 1, "--keep", folder / "alone", "--page", "--record", code=1)
    assert page_of(folder / "alone/run.html")["at"] == page["at"] and (folder / "alone/run.mcap").exists()
    hunt = plan("expect: [{path_length: {model: pioneer2dx, max: 0.05}}]\nhunt: {faults: [{connector: range-to-avoidance, is: drop}]}\n", "hunt.yaml")
    find = json.loads(rtse("--json", "hunt", hunt, "--finds", 1, "--cases", 4, "--page", code=1).stdout)["finds"][0]
    assert page_of(pathlib.Path(find["plan"]).with_suffix(".html"))["command"] == f"rtse sweep {find['plan']} --row 1", find
    assert find["repeatable"], find
    # The run that left the page is the run without a page.
    rtse("sweep", find["plan"], "--row", 1, "--state", find["state"], code=1)


# A killed sweep goes on where it was: nothing that has ended is lost, nothing is done twice.
def killed():
    p = plan("repeat: 6\n")
    for _ in range(2):
        process = subprocess.Popen([f"{bin_dir}/rtse", "sweep", p], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        before = ended()
        deadline = time.monotonic() + 100
        while ended() < before + 1 and time.monotonic() < deadline and process.poll() is None:
            time.sleep(0.02)
        process.send_signal(signal.SIGKILL)
        process.wait()
        assert ended() > before
    had = ended()
    then = times()
    last = json.loads(rtse("--json", "sweep", p).stdout)
    assert (last["rows"], last["passed"], last["stored"]) == (6, 6, had), (last, had)
    assert {key: times()[key] for key in then} == then
    assert len(set(states().values())) == 6
    # Two at the same time share the work, and none is in the way of the other.
    words = [f"{bin_dir}/rtse", "--json", "sweep", p, "-o", folder / "shared.db", "-j", "2"]
    both = [subprocess.Popen(words, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) for _ in range(2)]
    said = [process.communicate(timeout=200) for process in both]
    counts = [json.loads(one[0]) for one in said]
    assert all((one["rows"], one["passed"]) == (6, 6) for one in counts) and sum(6 - one["stored"] for one in counts) == 6, (counts, said)
    assert states("shared.db") == states() and not (folder / "shared.runs").exists()


def children(pid):
    return [int(child) for task in pathlib.Path(f"/proc/{pid}/task").glob("*/children") for child in task.read_text().split()]


def is_warm(pid, name):
    try:
        words = pathlib.Path(f"/proc/{pid}/cmdline").read_bytes().split(b"\0")
    except OSError:
        return False
    return b"--warm" in words and words[0].endswith(name.encode())


# A sweep of two rows at a time, whose warm program of that name gets the signal as soon as it has made something, or is there.
def sweep_with_signal(p, name, number, has_made, results):
    process = subprocess.Popen([f"{bin_dir}/rtse", "sweep", p, "-j", "2", "-o", folder / results], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    found, deadline = None, time.monotonic() + 100
    while found is None and time.monotonic() < deadline and process.poll() is None:
        found = next((pid for pid in children(process.pid) if is_warm(pid, name) and (not has_made or children(pid))), None)
    assert found is not None, name
    os.kill(found, number)
    said = process.communicate(timeout=200)
    assert process.returncode == 0 and "4 rows: 4 passed, 0 failed" in said[0], (name, process.returncode, said)
    assert states(results) == states("quiet.db"), name
    return said[1]


# Who makes the programs of rows is killed, and takes along those of the rows that run: these run again, and every row is what it is without
# that. Who is stopped makes none, and is waited for once.
def warm_killed():
    p = plan("repeat: 4\n")
    rtse("sweep", p, "-j", "2", "-o", folder / "quiet.db")
    for name in ("sim-server", "rtcd"):
        sweep_with_signal(p, name, signal.SIGKILL, True, f"{name}-killed.db")
        said = sweep_with_signal(p, name, signal.SIGSTOP, False, f"{name}-stopped.db")
        assert said.count(f"{name}: the prefork server did not respond within") == 1, said


def ended():
    return len(times())


def times():
    if not (folder / "plan.db").exists():
        return {}
    try:
        with sqlite3.connect(folder / "plan.db") as database:
            return dict(database.execute("SELECT key, wall FROM runs"))
    except sqlite3.OperationalError:
        return {}


# One line before the first run, whatever is wrong.
def refused():
    system = pathlib.Path(f"{source}/worlds/systems/obstacle_avoidance.xml").read_text()
    (folder / "pull.xml").write_text(system.replace('dataflowType="push"', 'dataflowType="pull"').replace('dataflow_type" rtsExt:value="push"', 'dataflow_type" rtsExt:value="pull"'))
    for text, expected in [
        ("vary: {component/Nobody0/gain: [1]}", 'component/Nobody0/gain: the system has no component "Nobody0"; components: RTCLaser0'),
        ("vary: {component/LaserObstacleAvoid0/gain: [1]}", 'has no parameter "gain" in the profile\'s active set; parameters: rate, distance_gain'),
        ("vary: {model/pioneer2dx/sensor/nose/noise: [1]}", 'has no sensor "nose"'),
        ("vary: {connector/nobody/buffer.length: [1]}", 'the system has no connection "nobody"; connections: range-to-avoidance'),
        ("vary: {seed: [1.5]}", 'seed: must be a whole number from 0 to 1e18, got "1.5"'),
        ("vary: {weather: [1]}", "weather: is no parameter; expected seed, component/..."),
        ("measure: [{contacts: {model: nobody}}]", 'measure: the world has no model "nobody"'),
        ("expect: nowhere.yaml", "there is no file"),
        ("never: [{model: pioneer2dx, touches: nobody}]", 'never: the world has no model "nobody"; models: '),
        ("faults: [{at: 0, connector: nobody, is: drop}]", 'faults: the system has no connection "nobody"; connections: range-to-avoidance'),
        ("system: pull.xml\nfaults: [{at: 0, connector: range-to-avoidance, is: drop}]", "range-to-avoidance\" carries data by pull; only data that are pushed"),
        ("faults: [{at: 0, component: Nobody0, is: error}]", 'faults: the system has no component "Nobody0"; components: RTCLaser0'),
        ('faults: [{at: 0, sensor: "nobody::laser", is: stuck}]', 'faults: the world has no model "nobody::laser"; models: '),
        ('faults: [{at: 0, sensor: "pioneer2dx::nose", is: stuck}]', "fault stuck: the world has no iface pioneer2dx::nose"),
        ('faults: [{at: 0, sensor: "pioneer2dx::position2d", is: missing}]', "fault missing of pioneer2dx::position2d: only lasers and sonars have beams"),
        ('hunt: {faults: [{actuator: "pioneer2dx::laser"}]}', " of pioneer2dx::laser: it is no position2d"),
        ("events: [{at: 1, push: {model: nobody, force: [1, 0, 0]}}]", 'events: the world has no model "nobody"; models: '),
        ("events: [{at: 1, wrench: {model: nobody, force: [1, 0, 0]}}]", 'events: the world has no model "nobody"; models: '),
        ("events: [{at: 1, wrench: {model: box_1, torque: [1, 0, 0]}}]", 'model "box_1" is static and cannot be pushed'),
        ("events: [{at: 1, wrench: {model: 'pioneer2dx::nose', force: [1, 0, 0]}}]", 'events: model "pioneer2dx" has no link "nose"; links: '),
        ("events: [{at: 1, push: {model: 'pioneer2dx::nose', force: [1, 0, 0]}}]", 'events: model "pioneer2dx" has no link "nose"; links: '),
        ("hunt: {events: [{wrench: {model: 'pioneer2dx::nose', force: [1, 0, 0]}}]}", 'hunt: events: model "pioneer2dx" has no link "nose"; links: '),
        ("events: [{at: 1, wrench: {model: pioneer2dx, force: [1e8, 0, 0]}}]", "force must be below 1e7, got 1e+08"),
        ("events: [{at: 1, wrench: {model: pioneer2dx, torque: [0, 0, -1e7]}}]", "torque must be below 1e7, got -1e+07"),
        ("events: [{at: 1, push: {model: pioneer2dx, force: [0, 0, 1e7]}}]", "force must be below 1e7, got 1e+07"),
        ("events: [{at: 1, joint_force: {model: pioneer2dx, joint: left_wheel_joint, force: 1e9}}]", "force must be below 1e7, got 1e+09"),
        ("events: [{at: 1, joint_force: {model: nobody, joint: nose, force: 1}}]", 'events: the world has no model "nobody"; models: '),
        ("events: [{at: 1, joint_force: {model: pioneer2dx, joint: nose, force: 1}}]", 'events: model "pioneer2dx" has no joint "nose"; joints: '),
        ("events: [{at: 1, set: {component: LaserObstacleAvoid0, parameter: gain, value: 1}}]", 'has no parameter "gain"; parameters: clearance_cap, distance_gain'),
        ("events: [{at: 1, disconnect: nobody}]", 'events: the system has no connection "nobody"'),
        ("events: [{when: {component: Nobody0, is: Error}, delete: pioneer2dx}]", 'events: the system has no component "Nobody0"'),
        ("hunt: {events: [{activate: Nobody0}]}", 'hunt: events: the system has no component "Nobody0"'),
        ("never: [{component: Nobody0, is: Error}]", 'never: the system has no component "Nobody0"'),
        ("vary: {model/pioneer2dx/pose: [1 2]}", 'model/pioneer2dx/pose: must be x y yaw or x y z roll pitch yaw, got "1 2"'),
        ("measure: [{contacts: {model: nobody}}]", "models: box_0, box_1,"),
        ("measure: [{joint: {model: pioneer2dx, name: nose, take: max}}]", 'measure: model "pioneer2dx" has no joint "nose"; joints: '),
        ("measure: [{holds: {gripper: hand, model: box_1}}]", 'measure: the world has no gripper "hand"; grippers: none'),
        ("expect: [{joint: {model: pioneer2dx, name: nose, min: 1}}]", 'model "pioneer2dx" has no joint "nose"; joints: '),
        ("expect: [{holds: {gripper: hand, model: pioneer2dx}}]", 'the world has no gripper "hand"; grippers: none'),
        ("measure: [{value: {port: 'LaserObstacleAvoid0:speed', member: data.vx, take: min}}]",
         'measure: component LaserObstacleAvoid0 has no port "speed" in the profile; ports: range, velocity'),
        ("measure: [{value: {port: LaserObstacleAvoid0, member: data.vx, take: min}}]", 'port "LaserObstacleAvoid0": expected COMPONENT:PORT'),
        ("never: [{port: 'LaserObstacleAvoid0:speed', member: data.vx, min: 1}]", 'never: component LaserObstacleAvoid0 has no port "speed"'),
        ("never: [{port: 'LaserObstacleAvoid0:velocity', member: 'data[', min: 1}]", 'member "data[": expected'),
        ("expect: [{fly: {model: pioneer2dx}}]", 'expect: unknown expectation "fly"'),
        ("expect: [{path_length: {model: nobody, min: 1}}]", 'the world has no moving model "nobody"; moving models: pioneer2dx'),
        ("expect: [{path_length: {model: box_1, min: 1}}]", 'the world has no moving model "box_1"; moving models: pioneer2dx'),
        ("expect: [{value: {port: 'LaserObstacleAvoid0:speed', member: data, min: 1}}]", 'component LaserObstacleAvoid0 has no port "speed"'),
        ("expect: [{state: {component: Nobody0, is: Active}}]", 'the system has no component "Nobody0"'),
        ('properties: ["Nobody0:x=1"]', 'properties: the system has no component "Nobody0"'),
        ("events: [{at: 1, push: {model: box_1, force: [1, 0, 0]}}]", 'model "box_1" is static and cannot be pushed'),
        ("events: [{at: 1, spawn: {model: nobody.sdf}}]", 'events: there is no model "nobody.sdf" to spawn; expected a file'),
        ("events: [{at: 1, spawn: {model: 'model://nobody'}}]", 'events: there is no model "model://nobody" to spawn'),
        ("events: [{at: 0.5, spawn: {model: 'model://cow', name: cow}}, {at: 1, delete: caw}]", 'events: the world has no model "caw"'),
        ("scatter: [{models: [nobody], region: [0, 0, 1, 1]}]", 'plan.yaml": scatter: the world has no model "nobody"'),
        ("vary: {connector/range-to-avoidance/subscripton_type: [new]}", 'no connection has a property "subscripton_type"; properties: allow_dup_connection'),
        ("measure: [{value: {port: 'LaserObstacleAvoid0:velocity', member: data.nope, take: min}}]",
         'measure: port "LaserObstacleAvoid0:velocity" sends no number "data.nope"; it has data.vx, data.vy, data.va'),
        ("expect: [{value: {port: 'LaserObstacleAvoid0:velocity', member: data, min: 1}}]", 'sends no number "data"; it has data.vx'),
        ("never: [{port: 'LaserObstacleAvoid0:velocity', member: 'data.vx[0]', min: 1}]", 'never: port "LaserObstacleAvoid0:velocity" sends no number "data.vx[0]"'),
        ("measure: [{value: {port: 'LaserObstacleAvoid0:range', member: 'ranges[0]', take: min}}]",
         'measure: port "LaserObstacleAvoid0:range" is not an OutPort, so it has no values'),
        ("never: [{model: pioneer2dx, touches: any, within: 0.5}]", ":4:51: within belongs to eventually"),
        ("events: [{when: {model: pioneer2dx, touches: any, within: 0.5}, delete: box_1}]", "within belongs to eventually"),
        ("measure: [{path_length: {model: box_1}}]", 'measure: the world has no moving model "box_1"; moving models: pioneer2dx'),
        ("measure: [{time_to: {model: box_1, region: [0, 0, 1, 1]}}]", 'measure: the world has no moving model "box_1"'),
        ("measure: [{clearance: {model: pioneer2dx, to: pioneer2dx}}]", 'cannot measure the clearance of "pioneer2dx" to itself'),
        ("measure: [{clearance: {model: pioneer2dx, as: passed}}]", 'the results have a column "passed" already'),
        ("vary: {world/step: [0.001]}\nmeasure: [{clearance: {model: pioneer2dx, as: world/step}}]", 'the results have a column "world/step" already'),
        ("events: [{at: 0.5, spawn: {model: 'model://cow', name: box_1}}]", 'events: the world has a model "box_1" already'),
        ("faults: [{at: 0, sensor: nope, is: stuck}]", 'faults: iface "nope": expected MODEL::NAME'),
        ("vary: {light/moon/intensity: [1]}", 'light/moon/intensity: the world has no light "moon"; lights: sun'),
        ("vary: {component/LaserObstacleAvoid0/stop_distance: [0.5, far]}", 'vary: component/LaserObstacleAvoid0/stop_distance: cannot be "far", expected a number'),
        ("events: [{at: 0.9, set: {component: LaserObstacleAvoid0, parameter: stop_distance, value: far}}]", 'value: far}}: cannot be "far", expected a number'),
        ("hunt: {faults: [{naming: gone, component: RTCLaser0}]}", "must have one of sensor, actuator, connector, component, naming"),
        ("unknown: 1", ':4:1: plan has no key "unknown"'),
        ("repeat: 2000000", "has 2e+06 rows, expected at most 1000000"),
    ]:
        path = plan(text + "\n")
        if text.startswith("system: "):
            pathlib.Path(path).write_text(START.split("\n", 1)[1] + text + "\n")
        # Only the components, which are started for it, know what a value must be.
        done = rtse("sweep", path, code=1 if "stop_distance" in text and "far" in text else 2)
        assert expected in done.stderr and len(done.stderr.splitlines()) == 1, (text, done.stderr)
    # Of the path only what rows need: no sbatch, then nothing.
    tools = folder / "tools"
    tools.mkdir()
    for paths, expected, words in [(tools, "program omniNames: cannot be started; expected it beside rtse or in PATH", []),
                                   (tools, "program sbatch: cannot be started; --engine slurm expects it in PATH", ["--engine", "slurm"])]:
        done = subprocess.run([f"{bin_dir}/rtse", "sweep", plan(""), *words], cwd=folder, env={**os.environ, "PATH": str(paths)}, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, timeout=200)
        assert done.returncode == 1 and expected in done.stderr and len(done.stderr.splitlines()) == 1, done
        if not (tools / "omniNames").exists():
            (tools / "omniNames").symlink_to(shutil.which("omniNames"))
    done = rtse("sweep", plan("repeat: 100000\n"), "--engine", "slurm", "--chunk", 2, "--task", "nowhere", code=None)
    assert "--task: expected FOLDER:ATTEMPT:TASK" in done.stderr, done.stderr
    for rows_asked in ("7..9", "3..6"):
        done = rtse("sweep", plan("repeat: 5\n"), "--rows", rows_asked, code=2)
        assert f"--rows {rows_asked}: the plan has 5 rows" in done.stderr and len(done.stderr.splitlines()) == 1, done.stderr
    for verb, *words in (("sweep", "-o", ""), ("sweep", "--keep", ""), ("hunt", "-o", "")):
        done = rtse(verb, plan(""), *words, code=2)
        assert 'expected the name of a file or folder, got ""' in done.stderr and len(done.stderr.splitlines()) == 1, done.stderr
    done = rtse("sweep", plan(""), "-o", "nowhere/plan.db", code=2)
    assert done.stderr == 'rtse: file "nowhere/plan.db": there is no folder nowhere\n' and not (folder / "nowhere").exists(), done.stderr
    assert not (folder / "plan.db").exists()
    done = rtse("results", plan(""), code=2)
    assert "file is not a database" in done.stderr, done.stderr


# A results file that cannot grow is one line, and what is in it stays; so is a page that cannot be written.
def disk_full():
    p = plan("repeat: 20\n")
    rtse("sweep", p, "--rows", "1..2")
    before = times()
    plan("repeat: 200000\n")
    limit = 4096  # kB; enough for the shared memory of the simulator that is asked about the world, and not for a list of all rows
    words = " ".join(map(shlex.quote, [f"{bin_dir}/rtse", "sweep", p, "-j", "2", "--rows", "1..12"]))
    done = subprocess.run(["bash", "-c", f"ulimit -f {limit}; exec {words}"], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          timeout=200)
    lines = done.stderr.splitlines()
    assert done.returncode == 1 and len(lines) == 1 and f'results "{folder}/plan.db": ' in lines[0], done
    assert {key: times()[key] for key in before} == before
    last = json.loads(rtse("--json", "sweep", p, "--rows", "1..3").stdout)
    assert last["passed"] == 3 and last["stored"] >= 2, last
    done = rtse("results", folder / "plan.db", "--html", folder, code=2)
    assert "is a folder" in done.stderr and len(done.stderr.splitlines()) == 1, done.stderr
    # A disk for temporary files that is full before the first row, or while rows run: one line, and no row is stored as one that has failed.
    (folder / "tmp").mkdir()
    filling = """repeat: 100
events:
  - at: 0.5
    command: setsid --wait sh -c '{ LATER; while kill -0 $CALLER; do head -c 100000000 /dev/zero >> $TMPDIR/fill; sleep 0.01; done; } > /dev/null 2>&1 &'
"""
    begin, go_on = "less than 32 MiB left", "less than 1 MiB left"
    # The process that fills the disk has a session of its own before its command returns, so the end of a row does not end it. At once: the row that fills it fails. Later: rows have passed, and the next ones do not begin.
    for size, verb, later, expected in [(16, "sweep", ":", begin), (16, "hunt", ":", begin), (48, "sweep", ":", go_on), (48, "hunt", ":", go_on), (48, "hunt", "sleep 2", go_on)]:
        p = plan(filling.replace("LATER", later), "filling.yaml")
        mount = f"mount -t tmpfs -o size={size}m tmpfs {shlex.quote(str(folder / 'tmp'))} && export CALLER=$$"
        done = after_mount(mount, f"{bin_dir}/rtse", verb, p, TMPDIR=folder / "tmp")
        assert done.returncode == 1 and f'rtse: folder "{folder}/tmp": the disk has {expected}' in done.stderr and len(done.stderr.splitlines()) == 1, (size, verb, later, done)
    with sqlite3.connect(folder / "filling.db") as database:
        stored = database.execute("SELECT passed FROM runs").fetchall()
    assert len(stored) < 100 and all(passed == (1,) for passed in stored), stored
    assert not list(folder.glob("filling.runs/*")) and not list(folder.glob("filling.finds/*")), list(folder.iterdir())


# Ctrl-C ends at once, leaves nothing that runs, and says how to go on.
def interrupted():
    p = plan("repeat: 300\n")
    for words, expected in [(["sweep", p, "-j", "2"], "interrupted after "), (["hunt", p, "-j", "2", "--budget", "200s"], "interrupted after ")]:
        code, out, err = interrupted_at("rtse-run-*/names", *words)
        assert code == 1 and expected in err and len(err.splitlines()) == 1, (words, code, out, err)
        assert not list(folder.glob("rtse-run-*")) and not list(folder.glob("plan.finds/*")), list(folder.iterdir())
    assert json.loads(rtse("--json", "sweep", p, "--rows", "1..1").stdout)["passed"] == 1


run_case(globals())
