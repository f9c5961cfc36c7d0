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

from calls import START, after_mount, bin_dir, case, folder, interrupted_at, lib_dir, plan, rows, rtse, source, states, twice


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


# A folder with all programs but simctl, which no other one needs: conditions and events on models, pictures, a row that fails.
def without_simctl():
    programs = folder / "programs"
    programs.mkdir()
    for name in ("rtse", "rtse-campaign", "rtse-recorder", "rtcd", "sim-server"):
        shutil.copy2(f"{bin_dir}/{name}", programs / name)
    (folder / "lib").symlink_to(lib_dir)  # as beside the programs
    path = os.pathsep.join(one for one in os.environ["PATH"].split(os.pathsep) if not (pathlib.Path(one) / "simctl").exists())
    environment = os.environ | {"PATH": path}
    assert shutil.which("simctl", path=path) is None, path
    p = plan("""repeat: 2
measure: [{contacts: {model: pioneer2dx}}, {clearance: {model: pioneer2dx}}]
events:
  - {at: 0.1, push: {model: pioneer2dx, force: [0, 40, 0], for: 0.1}}
  - {at: 0.2, spawn: {model: "model://cow", name: cow, pose: [3, 3, 0]}}
  - {at: 0.3, pose: {model: cow, to: [4, 3, 0]}}
  - {when: {model: pioneer2dx, region: [-10, -10, 10, 10], after: 0.4}, delete: cow}
never:
  - {model: pioneer2dx, touches: cow}
  - {model: pioneer2dx, region: [-10, -10, 10, 10]}
""")
    found = {}
    for name, where in (("without.db", programs), ("with.db", pathlib.Path(bin_dir))):
        done = subprocess.run([where / "rtse", "--json", "sweep", p, "-o", folder / name, "--record"], cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=200)
        counts = json.loads(done.stdout)
        assert (done.returncode, counts["rows"], counts["failed"]) == (1, 2, 2), (done, counts)
        found[name] = states(name)
    assert found["without.db"] == found["with.db"], found
    assert len(list(folder.glob("*.runs/*/picture.png"))) > 0
    done = subprocess.run([programs / "rtse", "run", f"{source}/worlds/systems/obstacle_avoidance.xml", "-w", f"{source}/worlds/obstacle_course.sdf", "-d", "1", "--picture", folder / "end.png"],
                          cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=200)
    assert done.returncode == 0 and (folder / "end.png").stat().st_size > 1000, done


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
    done = rtse("sweep", plan(""), "-o", "nowhere/plan.db", code=1)
    assert done.stderr == 'rtse: file "nowhere/plan.db": there is no folder nowhere\n' and not (folder / "nowhere").exists(), done.stderr
    assert not (folder / "plan.db").exists()
    done = rtse("results", plan(""), code=1)
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
    done = rtse("results", folder / "plan.db", "--html", folder, code=1)
    assert "is a folder" in done.stderr and len(done.stderr.splitlines()) == 1, done.stderr
    # A disk for temporary files that is full before the first row, or while rows run: one line, and no row is stored as one that has failed.
    (folder / "tmp").mkdir()
    filling = """repeat: 100
events:
  - at: 0.5
    command: setsid sh -c 'LATER; while kill -0 $CALLER; do head -c 100000000 /dev/zero >> $TMPDIR/fill; sleep 0.01; done' > /dev/null 2>&1 &
"""
    begin, go_on = "less than 32 MiB left", "less than 1 MiB left"
    # At once: the row that fills it fails. Later: rows have passed, and the next ones do not begin.
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


# A recorded run with events and faults is the same in goto, at its end and before it: in one go, and by steps.
def goes_to():
    deeds = """events:
  - {at: 0.2, push: {model: pioneer2dx, force: [0, 40, 0], for: 0.1}}
  - {at: 0.3, wrench: {model: pioneer2dx, force: [0, 10, 0], torque: [0, 0, 3], persistent: true}}
  - {at: 0.3, spawn: {model: "model://cow", name: cow, pose: [3, 3, 0]}}
  - {at: 0.5, joint_force: {model: pioneer2dx, joint: left_wheel_joint, force: -6, for: 0.2}}
  - {at: 0.6, set: {component: LaserObstacleAvoid0, parameter: stop_distance, value: 0.9}}
  - {when: {model: pioneer2dx, region: [-10, -10, 10, 10], after: 0.7}, delete: cow}
faults:
  - {at: 0.4, for: 0.3, sensor: "pioneer2dx::laser", is: noise, amount: 0.2}
  - {at: 0.7, actuator: "pioneer2dx::position2d", is: weak}
  - {at: 0.2, connector: range-to-avoidance, is: drop}
  - {at: 0.5, for: 0.1, component: LaserObstacleAvoid0, is: slow, amount: 0.001}
"""
    whole = json.loads(rtse("--json", "sweep", plan(deeds, "deeds.yaml"), "--row", 1, "--record", "--keep", folder / "recorded").stdout)["state"]
    quiet = twice("repeat: 1\n", "quiet.yaml")
    assert whole != quiet["state"], quiet
    recording = folder / "recorded/run.mcap"
    stats = f"{bin_dir}/simctl --json stats"
    done = rtse("--json", "goto", recording, "1", "--module-path", lib_dir, "--then", stats)
    assert "is not done again" not in done.stderr, done.stderr
    assert json.loads(done.stdout.split("\n", 1)[1])["hash"] == whole, (done.stdout, whole)
    # By steps, and back: the state at 0.55 s is one, whichever way leads there.
    there = json.loads(rtse("--json", "goto", recording, "0.55", "--module-path", lib_dir, "--then", stats).stdout.split("\n", 1)[1])["hash"]
    stepped = subprocess.run([f"{bin_dir}/rtse", "--json", "goto", recording, "0.25", "--module-path", lib_dir], input="n\nt 0.55\nt 1\nt 0.55\nq\n", cwd=folder,
                             stdout=subprocess.PIPE, timeout=200, text=True)
    assert [json.loads(line)["time"] for line in stepped.stdout.splitlines()][-3:] == [0.55, 1, 0.55], stepped.stdout
    assert there not in (quiet["state"], whole), there
    # A replay sends what ports wrote, not what a faulty connection made of it: it says so instead of a difference that is none.
    done = rtse("replay", recording, "--into", "LaserObstacleAvoid0", "--compare", "--module-path", lib_dir, code=1)
    assert 'replay: cannot compare: connection "RTCLaser0.range_LaserObstacleAvoid0.range" had the fault "drop:0.2:' in done.stderr and len(done.stderr.splitlines()) == 1, done


# What happens at a time or on a condition happens at the same step in every run.
def events():
    measured = "measure: [{contacts: {model: pioneer2dx}}, {path_length: {model: pioneer2dx}}]\n"
    quiet = twice(measured, "quiet.yaml")
    quiet_path = quiet["measures"]["path_length"]
    busy = twice(measured + """events:
  - {at: 0.2, push: {model: pioneer2dx, force: [0, 40, 0], for: 0.1}}
  - {at: 0.3, spawn: {model: "model://cow", name: cow, pose: [3, 3, 0]}}
  - {at: 0.5, set: {component: LaserObstacleAvoid0, parameter: stop_distance, value: 0.9}}
  - {when: {model: pioneer2dx, region: [-10, -10, 10, 10], after: 0.6}, delete: cow}
never:
  - {model: pioneer2dx, region: [0, 0, 6, 6]}
eventually:
  - {port: "LaserObstacleAvoid0:velocity", member: data.vx, min: -1, within: 0.5}
""", "busy.yaml")
    assert busy["state"] != quiet["state"] and busy["passed"], busy
    # Wrenches that stay until they are cleared, and a force on a joint: a wheel that brakes turns the robot.
    pushed = twice(measured + """events:
  - {at: 0.2, wrench: {model: pioneer2dx, force: [0, 10, 0], torque: [0, 0, 3], persistent: true}}
  - {at: 0.5, wrench: {model: pioneer2dx, clear: true}}
  - {at: 0.6, joint_force: {model: pioneer2dx, joint: left_wheel_joint, force: -6, for: 0.2}}
""", "pushed.yaml")
    assert pushed["state"] != quiet["state"] and pushed["passed"], pushed
    # The only model that moves goes: the run goes on, and its way is measured as far as it went.
    gone = twice(measured + "events: [{at: 0.5, delete: pioneer2dx}]\n", "gone.yaml")
    assert gone["passed"] and 0 < gone["measures"]["path_length"] < quiet_path, gone
    # What is spawned stands beside the plan; with another content the row is another one.
    (folder / "things").mkdir()
    box = "<sdf version='1.9'><model name='crate'><pose>3 3 1 0 0 0</pose><link name='l'><collision name='c'><geometry><box><size>0.2 0.2 SIZE</size></box></geometry></collision></link></model></sdf>"
    crate = plan("events: [{at: 0.1, spawn: {model: crate.sdf, name: crate}}]\nmeasure: [{path_length: {model: crate}}]\n", "things/crate.yaml")
    found = {}
    for size in ("0.2", "0.4", "0.2"):
        (folder / "things/crate.sdf").write_text(box.replace("SIZE", size))
        seen = json.loads(rtse("--json", "sweep", crate, "--row", 1, "--keep", folder / "crate").stdout)
        assert seen["passed"] and seen["measures"]["path_length"] > 0 and found.setdefault(size, (seen["key"], seen["state"])) == (seen["key"], seen["state"]), seen
    assert found["0.2"][0] != found["0.4"][0], found
    # Of a model that has gone, or is still to come, nothing is true, and nothing happens to it.
    later = twice("""events:
  - {at: 0.2, push: {model: cow, force: [1, 0, 0]}}
  - {at: 0.4, spawn: {model: "model://cow", name: cow, pose: [3, 3, 0]}}
  - {at: 0.5, spawn: {model: "model://cow", name: cow, pose: [3, 3, 0]}}
  - {at: 0.7, delete: cow}
  - {at: 0.8, delete: cow}
never: [{model: cow, touches: pioneer2dx}]
eventually: [{model: cow, region: [2, 2, 4, 4]}]
""", "later.yaml")
    assert later["passed"], later
    # What is connected stays connected, what is not stays apart; commands find our programs.
    calm = twice("""events:
  - {at: 0.2, connect: range-to-avoidance}
  - {at: 0.3, command: 'simctl stats && rtse --version'}
expect: [{command: 'simctl stats'}]
""", "calm.yaml")
    assert calm["state"] == quiet["state"] and calm["passed"], calm
    twice("events: [{at: 0.2, disconnect: range-to-avoidance}, {at: 0.3, disconnect: range-to-avoidance}, {at: 0.4, connect: range-to-avoidance}]\n", "apart.yaml")
    done = rtse("sweep", plan("""events: [{at: 0.3, deactivate: LaserObstacleAvoid0}]
never: [{component: LaserObstacleAvoid0, is: Inactive}]
eventually: [{model: pioneer2dx, region: [5, 5, 6, 6]}]
""", "never.yaml"), "--row", 1, code=1)
    assert "never: {component: LaserObstacleAvoid0, is: Inactive}: it was so at 0." in done.stderr, done.stderr
    assert "eventually: {model: pioneer2dx, region: [5, 5, 6, 6]}: never became true" in done.stderr, done.stderr


# Models of a folder above the world's, of a Fuel cache and of a merged model.config are models for a sweep as they are for the simulator.
def models_as_simulated():
    box = "<sdf version='1.9'><model name='{0}'>{1}<link name='l'><inertial><mass>1</mass></inertial><collision name='c'><geometry><box><size>0.4 0.4 0.4</size></box></geometry></collision>" \
          "<visual name='v'><geometry><mesh><uri>{2}</uri></mesh></geometry></visual></link></model></sdf>"
    (folder / "place/worlds").mkdir(parents=True)
    for name, place in (("crate", "place/crate"), ("barrel", "fuel/fuel.gazebosim.org/openrobotics/models/barrel/2")):
        (folder / place / "shapes").mkdir(parents=True)
        shutil.copy(f"{source}/tests/fuzz/assets/text.stl", folder / place / "shapes/shape.stl")
        (folder / place / "body.sdf").write_text(box.format(name, "<static>true</static>" if name == "barrel" else "", "shapes/shape.stl"))
        (folder / place / "model.config").write_text("<model><name>m</name><sdf version='1.5'>old.sdf</sdf><sdf version='1.9'>body.sdf</sdf></model>")
    world = pathlib.Path(f"{source}/worlds/obstacle_course.sdf").read_text()
    more = "<include><uri>model://crate</uri><pose>0 9 0.2 0 0 0</pose></include>" \
           "<include><uri>https://fuel.gazebosim.org/1.0/OpenRobotics/models/Barrel</uri><pose>0 20 0.2 0 0 0</pose></include>"
    (folder / "place/worlds/w.sdf").write_text(world.replace("</world>", more + "</world>"))
    p = pathlib.Path(plan("""vary: {model/crate/mass: [2, 3], model/barrel/pose/x: [1]}
measure: [{clearance: {model: crate, to: barrel, as: apart}}]
scatter: [{models: crate, region: [0, 12, 1, 13]}]
events: [{at: 0.1, spawn: {model: place/crate, name: more, pose: [0, 30, 0]}}]
"""))
    p.write_text(p.read_text().replace(f"{source}/worlds/obstacle_course.sdf", "place/worlds/w.sdf"))
    os.environ["GZ_FUEL_CACHE_PATH"] = str(folder / "fuel")
    first = json.loads(rtse("--json", "sweep", p).stdout)
    assert (first["rows"], first["passed"], first["stored"]) == (2, 2, 0), first
    assert all(6.2 < float(row["apart"]) < 8.2 for row in rows()), rows()
    # What they are made of belongs to what a row is.
    for file in ("place/crate/body.sdf", "fuel/fuel.gazebosim.org/openrobotics/models/barrel/2/shapes/shape.stl"):
        assert json.loads(rtse("--json", "sweep", p).stdout)["stored"] == 2
        with open(folder / file, "a") as more:
            more.write("\n")
        assert json.loads(rtse("--json", "sweep", p).stdout)["stored"] == 0, file


# Each fault changes the run, and changes it in the same way each time.
def faults():
    quiet = twice("", "quiet.yaml")
    laser, drive = "pioneer2dx::laser", "pioneer2dx::position2d"
    for number, fault in enumerate([
        f'sensor: "{laser}", is: "off"', f'sensor: "{laser}", is: noise, amount: 0.4', f'sensor: "{laser}", is: bias, amount: -1',
        f'actuator: "{drive}", is: weak', "connector: velocity-to-robot, is: drop, amount: 1",
        "component: LaserObstacleAvoid0, is: exception", "component: LaserObstacleAvoid0, is: error",
    ]):
        seen = twice(f"faults: [{{at: 0, {fault}}}]\n", f"fault{number}.yaml")
        assert seen["state"] != quiet["state"] and seen["passed"], (fault, seen)
    # What the system does not need while it runs, and what takes only real time, changes nothing.
    for fault in ("naming: gone", "for: 0.3, component: LaserObstacleAvoid0, is: slow"):
        seen = twice(f"faults: [{{at: 0.2, {fault}}}]\n", "harmless.yaml")
        assert seen["state"] == quiet["state"] and seen["passed"], (fault, seen)
    # A vehicle in the air: slower, deaf, or with a rotor that has lost half of its thrust. Without a list a hunt breaks its drive, too.
    flight = lambda text, name: plan(f"system: {source}/worlds/systems/quadcopter.xml\nworld: {source}/worlds/quadcopter.sdf\nduration: 3\n" + text, name, start="")
    found = {}
    for number, fault in enumerate(["", 'actuator: "quadcopter::position3d", is: weak', 'actuator: "quadcopter::position3d", is: stuck',
                                    'actuator: "quadcopter::joints::motor_0", is: weak']):
        text = "measure: [{path_length: {model: quadcopter}}]\n" + (f"faults: [{{at: 1, {fault}}}]\n" if fault else "")
        row = [json.loads(rtse("--json", "sweep", flight(text, f"flight{number}.yaml"), "--row", 1, "--keep", folder / f"flight{turn}").stdout) for turn in range(2)]
        assert row[0]["passed"] and row[0]["state"] == row[1]["state"], (fault, row)
        assert found.setdefault(row[0]["state"], fault) == fault, (fault, found)
    seen = json.loads(rtse("--json", "hunt", flight("", "search.yaml"), "--cases", 1).stdout)
    assert seen["finds"] == [], seen
    done = rtse("sweep", flight('faults: [{at: 0, actuator: "quadcopter::imu", is: weak}]\n', "imu.yaml"), code=2)
    assert "fault weak of quadcopter::imu: it is no position2d or position3d and has no joints" in done.stderr, done.stderr
    # A host that is killed comes back; the run with it is the same each time.
    twice("one_process_each: true\nfaults: [{at: 0.3, for: 0.3, component: LaserObstacleAvoid0, is: kill}]\n", "kill.yaml")
    done = rtse("sweep", plan("hang_timeout: 1\nfaults: [{at: 0.3, component: LaserObstacleAvoid0, is: hang}]\n"), "--row", 1, code=1)
    assert "LaserObstacleAvoid0: did not finish its tick" in done.stderr, done.stderr


# A fault that only the third activation shows is found, and the find has no more than what is needed; what is being shrunk is said first.
def hunts_restarts():
    p = pathlib.Path(plan(f"""properties: ["HuntSubject0:kind=speed_doubles_in_the_third_activation", "HuntSubject0:faulty=YES"]
module_path: {lib_dir}
expect: [{{value: {{port: "HuntSubject0:velocity", member: data.vx, min: -0.31, max: 0.31}}}}]
hunt:
  faults: [{{sensor: "pioneer2dx::laser"}}]
  events: [{{deactivate: HuntSubject0}}, {{activate: HuntSubject0}}, {{set: {{component: HuntSubject0, parameter: speed, value: 0.1}}}}]
""", "restarts.yaml"))
    p.write_text(p.read_text().replace(f"{source}/worlds/systems/obstacle_avoidance.xml", f"{source}/tests/campaign/hunt/hunt_subject.xml").replace("duration: 1", "duration: 6"))
    said = rtse("hunt", p, "--finds", 1, "--cases", 64, "-j", 2, "--budget", "10m", code=1).stdout
    shrinking, found = said.index("shrinking it: "), said.index("find 1 after ")
    what = said[found:].splitlines()[1]
    assert shrinking < found and "data.vx" in said[:shrinking], said
    assert what.count("deactivate") == 2 and what.count("activate") == 4, said


# A small component that divides by zero when its laser goes on without news is found, with one fault, by one command.
def hunts():
    p = pathlib.Path(plan(f"""properties: ["HuntSubject0:kind=same_scan_twice", "HuntSubject0:faulty=YES"]
module_path: {lib_dir}
hunt:
  faults: [{{sensor: "pioneer2dx::laser", is: [stuck, dropout]}}]
""", "hunt.yaml"))
    p.write_text(p.read_text().replace(f"{source}/worlds/systems/obstacle_avoidance.xml", f"{source}/tests/campaign/hunt/hunt_subject.xml"))
    first, second = (json.loads(rtse("--json", "hunt", p, "--finds", 1, "--cases", 40, "-j", 2, code=1).stdout) for _ in range(2))
    find = first["finds"][0]
    assert find["repeatable"] and find["deeds"] == 1 and "NaN" in find["problem"] and "stuck" in find["what"], first
    assert [one["what"] for one in second["finds"]] == [find["what"]], (first, second)
    assert "NaN" in rtse("sweep", find["plan"], "--row", 1, "--state", find["state"], code=1).stderr
    p.write_text(p.read_text().replace("faulty=YES", "faulty=NO"))
    assert json.loads(rtse("--json", "hunt", p, "--cases", 8, "-j", 2).stdout)["finds"] == []
    # A find is not made too short for what is expected: without its fault it passes. Deeds may stand in lines of their own.
    deeds = "events:\n  - at: 0.1\n    command: |\n      true\nnever:\n  - model: pioneer2dx\n    region: [90, 90, 91, 91]\n"
    way = pathlib.Path(plan(deeds + "expect: [{path_length: {model: pioneer2dx, min: 0.3}}]\nhunt: {faults: [{connector: range-to-avoidance, is: drop}]}\n", "way.yaml"))
    way.write_text(way.read_text().replace("duration: 1", "duration: 4"))
    find = json.loads(rtse("--json", "hunt", way, "--finds", 1, "--cases", 40, "-j", 2, code=1).stdout)["finds"][0]
    lines = pathlib.Path(find["plan"]).read_text().splitlines()
    way.write_text("\n".join(line for line in lines if "drop" not in line and line != "faults:"))
    rtse("sweep", way, "--row", 1)
    # What failed is a comment of the plan, however many lines its text has.
    failing = "expect:\n  - command: |\n      true\n      duration: 99\n      exit 3\nhunt: {faults: [{connector: range-to-avoidance, is: drop}]}\n"
    find = json.loads(rtse("--json", "hunt", plan(failing, "lines.yaml"), "--finds", 1, "--cases", 4, "-j", 2, code=1).stdout)["finds"][0]
    text = pathlib.Path(find["plan"]).read_text()
    assert text.startswith("# command") and "duration: 99" in text.splitlines()[0], text
    assert "exit code 3" in rtse("sweep", find["plan"], "--row", 1, "--state", find["state"], code=1).stderr
    # A system that nobody can start is no find.
    system = pathlib.Path(f"{source}/tests/campaign/hunt/hunt_subject.xml").read_text()
    (folder / "nobody.xml").write_text(system.replace(":HuntSubject:", ":NoSubject:"))
    p.write_text(p.read_text().replace(f"{source}/tests/campaign/hunt/hunt_subject.xml", "nobody.xml"))
    done = rtse("hunt", p, "--cases", 8, code=1)
    assert "does not start: component HuntSubject0" in done.stderr or "does not start: host of" in done.stderr, done
    assert len(done.stderr.splitlines()) == 1 and " failures found" not in done.stdout, done


try:
    {"sweep": sweep, "reports": reports, "pages": pages, "killed": killed, "warm_killed": warm_killed, "without_simctl": without_simctl, "disk_full": disk_full, "interrupted": interrupted, "refused": refused, "events": events, "goes_to": goes_to, "faults": faults, "models_as_simulated": models_as_simulated, "hunts": hunts, "hunts_restarts": hunts_restarts}[case]()
finally:
    subprocess.run(["rm", "-rf", str(folder)], check=False)
