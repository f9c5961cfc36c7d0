# What the plans of campaigns say and hunts look for, one case per run: plans.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import json
import os
import pathlib
import shutil
import subprocess

from calls import bin_dir, folder, lib_dir, plan, rows, rtse, run_case, source, states, twice


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
    assert "not repeated" not in done.stderr, done.stderr
    assert json.loads(done.stdout.split("\n", 1)[1])["hash"] == whole, (done.stdout, whole)
    # By steps, and back: the state at 0.55 s is one, whichever way leads there.
    there = json.loads(rtse("--json", "goto", recording, "0.55", "--module-path", lib_dir, "--then", stats).stdout.split("\n", 1)[1])["hash"]
    stepped = subprocess.run([f"{bin_dir}/rtse", "--json", "goto", recording, "0.25", "--module-path", lib_dir], input="n\nt 0.55\nt 1\nt 0.55\nq\n", cwd=folder,
                             stdout=subprocess.PIPE, timeout=200, text=True)
    assert [json.loads(line)["time"] for line in stepped.stdout.splitlines()][-3:] == [0.55, 1, 0.55], stepped.stdout
    assert there not in (quiet["state"], whole), there
    # A replay sends what ports wrote, not what a faulty connection made of it: it says so instead of a difference that is none.
    page, report = folder / "replay.html", folder / "replay.xml"
    page.write_text("of an earlier replay")
    done = rtse("replay", recording, "--into", "LaserObstacleAvoid0", "--compare", "--module-path", lib_dir, "--page", page, "--junit", report, code=1)
    assert page.read_text() == "of an earlier replay" and "ATTACHMENT" not in report.read_text(), report
    assert 'replay: cannot compare: connection "RTCLaser0.range_LaserObstacleAvoid0.range" had the fault "drop:0.2:' in done.stderr and len(done.stderr.splitlines()) == 1, done


# run --like repeats the faults of connections and components. It does not repeat actions between steps, and prints a warning.
def like_faulty():
    found = {}
    for name, deeds in (("drop", "faults: [{at: 0, connector: range-to-avoidance, is: drop, amount: 1}]\n"), ("pushed", "events: [{at: 0.2, push: {model: pioneer2dx, force: [0, 40, 0], for: 0.1}}]\n"), ("quiet", "")):
        found[name] = json.loads(rtse("--json", "sweep", plan(deeds, f"{name}.yaml"), "--row", 1, "--record", "--keep", folder / name).stdout)["state"]
    assert len(set(found.values())) == 3, found
    for name, state, said in (("drop", "drop", ""), ("quiet", "quiet", ""), ("pushed", "quiet", "rtse: events of the campaign's plan and its faults of devices and processes are not repeated\n")):
        done = rtse("--json", "run", "--like", folder / name / "run.mcap", "--module-path", lib_dir)
        assert json.loads(done.stdout)["state_hash"] == found[state] and done.stderr == said, (name, done)


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
    # A system that cannot be started is no find.
    system = pathlib.Path(f"{source}/tests/campaign/hunt/hunt_subject.xml").read_text()
    (folder / "missing_component.xml").write_text(system.replace(":HuntSubject:", ":NoSubject:"))
    p.write_text(p.read_text().replace(f"{source}/tests/campaign/hunt/hunt_subject.xml", "missing_component.xml"))
    done = rtse("hunt", p, "--cases", 8, code=1)
    assert "does not start: component HuntSubject0" in done.stderr or "does not start: host of" in done.stderr, done
    assert len(done.stderr.splitlines()) == 1 and " failures found" not in done.stdout, done


run_case(globals())
