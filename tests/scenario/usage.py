# Every program answers a wrong command line, and a wrong file of orders that it names, by one line and exit code 2: usage.py BIN_DIR SOURCE_DIR. Nothing is run.
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

bin_dir, source = sys.argv[1:]
system = f"{source}/worlds/systems/obstacle_avoidance.xml"
course = f"{source}/worlds/obstacle_course.sdf"
plan = f"system: {system}\nworld: {course}\nduration: 1\n"
# In a folder with these files.
files = {"key.yaml": plan + "unknown: 1\n", "model.yaml": plan + "expect: [{path_length: {model: nobody, min: 1}}]\n", "world.yaml": f"system: {system}\nworld: none.sdf\nduration: 1\n",
         "five.yaml": plan + "repeat: 5\n", "run.yaml": "processes: []\n", "bad.xml": "<rts/>", "template.xml": pathlib.Path(system).read_text().replace("RTCLaser0", "RTCLaser_{robot}")}
run = ["rtse", "run", system, "-w", course, "-d", "1"]
calls = [
    (["rtse", "sweep", "key.yaml"], 'plan has no key "unknown"'), (["rtse", "hunt", "key.yaml"], 'plan has no key "unknown"'),
    (["rtse", "sweep", "model.yaml"], "nobody"), (["rtse", "hunt", "model.yaml"], "nobody"), (["rtse", "sweep", "world.yaml"], "none.sdf"),
    (["rtse", "sweep", "five.yaml", "--row", "6"], "the plan has 5 rows"), (["rtse", "sweep", "five.yaml", "--rows", "4..6"], "the plan has 5 rows"),
    ([*run, "--junit", system], "something else too"), ([*run, "--picture", "nowhere/x.png"], "there is no folder"), ([*run, "--property", "Nobody:a=b"], "Nobody"),
    ([*run, "--run-file", "run.yaml"], "needs a list"), ([*run, "--for", "robot=a"], "does not contain {robot}"), (["rtse", "run", "bad.xml", "-w", course], "bad.xml"),
    (["rtse", "load", "bad.xml"], "bad.xml"), (["rtse", "check", "bad.xml"], "bad.xml"), (["rtse", "start", "template.xml"], "expected --for robot=LIST"),
    (["rtse", "stop", "template.xml", "--for", "robot=r9..r0"], "is not a range"), (["rtse", "new", "Name", "--param", "gain"], "NAME:TYPE=DEFAULT"),
    (["rtse", "goto", system, "1"], "is not a recording"), (["rtse", "demo", "arms"], 'there is no demo "arms"; there are avoidance, arm, '), (["rtse", "demo", "--wach"], "--wach"),
    (["rtse", "demo", "--duration", "never"], "never"), (["rtse", "dis"], "expected one component or port"), (["rtse", "diff", system], "required"),
    (["simctl", "spawn", "crate", "--for", "robot"], "robot"), (["simctl", "pose", "crate", "1"], "expected X Y YAW"), (["simctl", "rtf", "fast"], "fast"),
    (["sim-server", course, "--shm-mode", "0999"], "0999"), (["sim-server", course, "--shm-group", "no such group"], "no such group"),
    (["sim-server", "none.sdf"], "no such file"), (["sim-server", "bad.xml", "--check"], "bad.xml"), (["sim-server", course, "--gains", "none.yaml"], "none.yaml"),
    (["sim-server", course, "--resource-path", "nowhere"], "expected a folder"), (["sim-server", course, "--resource-path", "run.yaml"], '--resource-path: expected a folder, got "run.yaml"'),
    (["sim-server", course, "--hash-log", "nowhere/x"], "there is no folder"), (["sim-server", course, "--record", "."], "is a folder"),
    (["player-gateway", "--config", "none.yaml"], "no such file"), (["player-gateway", "--config", "."], "is a folder"), (["rtcprof", "none.so"], "none.so"),
    (["sim-server", course, "--ends-with-input"], "expected a pipe"), (["sim-server", course, "--fault", "weak"], "weak"), (["sim-server"], "WORLD"),
]
if shutil.which("ros2-gateway", path=bin_dir):
    calls += [(["ros2-gateway", "--clock-rate", "-1"], "must be from 0 to 10000 Hz, got -1"), (["ros2-gateway", "--wait-for", "cmd_vel=20Hz"], "needs --lockstep")]
environment = dict(os.environ, RTCTREE_NAMESERVERS="127.0.0.1:1", RTMSIM_SERVER_ID="9000")
wrong = []
with tempfile.TemporaryDirectory() as folder:
    for name, text in files.items():
        pathlib.Path(folder, name).write_text(text)
    for words, says in calls:
        done = subprocess.run([f"{bin_dir}/{words[0]}", *words[1:]], cwd=folder, env=environment, capture_output=True, text=True, timeout=100, stdin=subprocess.DEVNULL)
        said = done.stdout + done.stderr
        if done.returncode != 2 or said.count("\n") != 1 or says not in said:
            wrong.append(f"{' '.join(words)}: exit {done.returncode}: {said.strip()}")
    assert sorted(os.listdir(folder)) == sorted(files), os.listdir(folder)
assert not wrong, "\n" + "\n".join(wrong)
print("ok")
