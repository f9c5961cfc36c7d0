# What rtse hunt finds in twenty-one small faulty components, and that it leaves their right twins alone:
#   hunt.py BIN_DIR LIB_DIR SOURCE_DIR [--cases N] [--twin-cases N] [--repeats N] [--only KIND] [--plain]
# Prints a row for each kind. --plain: beside it what rtse sweep finds with seeds alone, in as many runs. --repeats: runs the plan of each find
# so often, and counts the runs that break it in the same state. --cases 0: only the twins.
import argparse
import concurrent.futures
import json
import pathlib
import subprocess
import sys
import tempfile
import time

parser = argparse.ArgumentParser()
parser.add_argument("bin_dir")
parser.add_argument("lib_dir")
parser.add_argument("source")
parser.add_argument("--cases", type=int, default=64)
parser.add_argument("--twin-cases", type=int, default=8)
parser.add_argument("--only", action="append")
parser.add_argument("--repeats", type=int, default=0)
parser.add_argument("--plain", action="store_true")
parser.add_argument("-j", "--jobs", type=int, default=2)
arguments = parser.parse_args()
arguments.lib_dir, arguments.source = (pathlib.Path(path).resolve() for path in (arguments.lib_dir, arguments.source))

KINDS = ["speed_doubles_when_activated_again", "speed_doubles_in_the_third_activation", "exception_when_deactivated", "first_scan_is_taken_for_granted", "error_without_scan",
         "drives_on_without_scan", "speeds_up_without_scan", "infinite_ranges_are_added", "mean_of_no_ranges", "divides_by_time_between_scans",
         "time_runs_backwards", "gap_in_time", "integral_without_limit", "same_scan_twice", "root_of_short_range", "index_from_range",
         "gives_up_when_blind", "no_limit_of_speed", "turns_into_obstacles", "old_scan_is_as_good", "noise_is_obstacle"]
# These do harm by running into things, which a right one does too when its laser lies.
RUNS_INTO = {"drives_on_without_scan", "turns_into_obstacles", "old_scan_is_as_good"}
folder = pathlib.Path(tempfile.mkdtemp(prefix="hunt-"))


def plan(kind, faulty):
    here = pathlib.Path(__file__).resolve().parent
    honest = "{sensor: 'pioneer2dx::laser', is: [off, dropout]}" if kind in RUNS_INTO else "{sensor: 'pioneer2dx::laser'}"
    contact = "  - no_contact: {model: pioneer2dx}\n" if kind in RUNS_INTO else ""
    path = folder / f"{kind}-{faulty}.yaml"
    path.write_text(f"""system: {here}/hunt_subject.xml
world: {arguments.source}/worlds/obstacle_course.sdf
duration: {20 if kind in RUNS_INTO else 6}
expect:
  - value: {{port: "HuntSubject0:velocity", member: data.vx, min: -0.31, max: 0.31}}
{contact}vary:
  model/pioneer2dx/pose/yaw: {{uniform: [0, 6.28]}}
samples: 8
properties: ["HuntSubject0:kind={kind}", "HuntSubject0:faulty={faulty}"]
module_path: {arguments.lib_dir}
invariants: true
hang_timeout: 60
hunt:
  most: 3
  faults:
    - {honest}
    - {{connector: range-to-avoidance}}
  events:
    - {{deactivate: HuntSubject0}}
    - {{activate: HuntSubject0}}
    - {{set: {{component: HuntSubject0, parameter: speed, value: 0.1}}}}
""")
    return str(path)


def rtse(*words):
    done = subprocess.run([f"{arguments.bin_dir}/rtse", "--json", *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        return json.loads(done.stdout)
    except ValueError:
        sys.exit(f"{words}: {done.stderr}")


# Of the plan of a find: how many of so many runs break it, and end in its state.
def repeats(find):
    def once(number):
        words = ["sweep", find["plan"], "--row", "1", "--state", find["state"] or "-", "--keep", str(folder / f"again-{number}")]
        done = subprocess.run([f"{arguments.bin_dir}/rtse", "--json", *words], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        said = json.loads(done.stdout)
        return not said["passed"] and said["state"] == find["state"]
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        return sum(pool.map(once, range(arguments.repeats)))


found = alarms = same = twin_runs = 0
began = time.monotonic()
kinds = [kind for kind in KINDS if not arguments.only or kind in arguments.only]
for kind in kinds:
    hunted = {"finds": [], "cases": 0}
    if arguments.cases > 0:
        hunted = rtse("hunt", plan(kind, "YES"), "--finds", 1, "--cases", arguments.cases, "-j", arguments.jobs, "--budget", "10m")
    find = hunted["finds"][0] if hunted["finds"] else None
    found += find is not None
    row = f"{kind:36} " + (f"case {find['case']:3}, {find['after']:4.0f} s, {find['deeds']} deeds, {'repeats' if find['repeatable'] else 'DOES NOT REPEAT'}: {find['what']}"
                           if find else f"NOT FOUND in {hunted['cases']} cases")
    if find and arguments.repeats:
        again = repeats(find)
        same += again
        row += f"\n  again: {again} of {arguments.repeats}"
    if arguments.twin_cases:
        twin = rtse("hunt", plan(kind, "NO"), "--finds", 1, "--cases", arguments.twin_cases, "-j", arguments.jobs, "--budget", "2h")
        twin_runs += twin["cases"]
        alarms += len(twin["finds"])
        row += "".join(f"\n  FALSE ALARM of the twin: {alarm['problem']}; {alarm['what']}" for alarm in twin["finds"])
    if arguments.plain and find:
        path = pathlib.Path(plan(kind, "YES"))
        text = path.read_text().replace("samples: 8", f"samples: {find['case']}")
        path.write_text(text)
        row += f"\n  seeds alone: {rtse('sweep', path, '-j', arguments.jobs)['failed']} of {find['case']} runs fail"
    print(row, flush=True)
print(f"{found} of {len(kinds)} found, {same} of {found * arguments.repeats} runs again, {alarms} false alarms in {twin_runs} runs, {time.monotonic() - began:.0f} s")
subprocess.run(["rm", "-rf", str(folder)], check=False)
sys.exit(0 if alarms == 0 else 1)
