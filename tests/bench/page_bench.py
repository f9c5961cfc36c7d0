# What the page of a run costs beside its recording: page_bench.py BIN_DIR LIB_DIR SOURCE_DIR [cost] [memories]. Pairs of runs of the obstacle course with --record and with --record --page:
# the median of the ratios of their processor times, without what is written afterwards. Then the memory of rtse-page for runs with a camera. Exit 1 when a limit is missed.
import json
import math
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time

bin_dir, lib_dir, source, *chosen = sys.argv[1:]
rounds = int(os.environ.get("RTMSIM_BENCH_ROUNDS", "6"))
seconds = os.environ.get("RTMSIM_BENCH_SECONDS", "600")
missed = 0


def row(what, value, limit, is_good):
    global missed
    missed += not is_good
    print(f"| {what:<66} | {value:>12} | {limit:>8} | {'ok' if is_good else 'MISS':<4} |", flush=True)


def run(system, world, *more):
    words = [f"{bin_dir}/rtse", "--json", "run", system, "--world", f"{source}/worlds/{world}.sdf", "--module-path", lib_dir, *more]
    return json.loads(subprocess.run(words, check=True, stdout=subprocess.PIPE, text=True, timeout=3600).stdout.splitlines()[0])


# Processor time [s] of all processes below this one, as long as its simulator runs: of the run, and of rtse-page with what it starts.
def used_beside_run(pid):
    ticks = os.sysconf("SC_CLK_TCK")
    used = {"run": {}, "page": {}}
    simulator = None

    def look(one, part):
        nonlocal simulator
        try:
            with open(f"/proc/{one}/task/{one}/children", encoding="ascii") as file:
                children = file.read().split()
            with open(f"/proc/{one}/stat", encoding="utf8") as file:
                name, state, rest = re.match(r"\d+ \((.*)\) (\S) (.*)", file.read()).groups()
        except OSError:
            return  # it has ended meanwhile
        if name == "rtse-page":
            part = "page"
        if name == "sim-server" and part == "run" and state != "Z":
            simulator = one
        used[part][one] = sum(int(value) for value in rest.split()[10:12]) / ticks
        for child in children:
            look(child, part)

    def is_over():
        if simulator is None:
            return not os.path.exists(f"/proc/{pid}/exe")
        try:
            with open(f"/proc/{simulator}/stat", encoding="utf8") as file:
                return ") Z " in file.read()
        except OSError:
            return True

    while not is_over():
        look(str(pid), "run")
        time.sleep(0.05)
    return sum(used["run"].values()), sum(used["page"].values())


# Of one run: processor time [s] of its own processes and of rtse-page beside it, wall-clock time [s].
def measured(*more):
    words = [f"{bin_dir}/rtse", "--json", "run", f"{source}/worlds/systems/obstacle_avoidance.xml", "--world", f"{source}/worlds/obstacle_course.sdf", "--module-path", lib_dir, "--duration", seconds, *more]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as process:
        own, page = used_beside_run(process.pid)
        result = json.loads(process.communicate(timeout=3600)[0].splitlines()[0])
    assert process.returncode == 0
    return {"own": own, "page": page, "wall": result["wall"]}


# A confidence interval of 90 % or more of the median: two of the sorted values.
def interval(values):
    values, n = sorted(values), len(values)
    outside, k = 0.5**n, 0
    while k + 1 < n / 2 and 2 * (outside + math.comb(n, k + 1) * 0.5**n) <= 0.1:
        k += 1
        outside += math.comb(n, k) * 0.5**n
    return values[k], values[-1 - k]


# Pairs of runs, one after the other, in both orders. With processors to spare a run is slower by its own processor time alone; when all are busy,
# also by that of rtse-page. On a shared machine: as root, `chrt -f 10 python3 ...`.
def cost(folder):
    rows = {"share": [], "own": [], "all": [], "speed": []}
    for number in range(rounds):
        runs = {}
        for name in ("plain", "paged") if number % 2 else ("paged", "plain"):
            runs[name] = measured("--record", f"{folder}/{name}.mcap", *(("--page", f"{folder}/run.html") if name == "paged" else ()))
        plain, paged = runs["plain"], runs["paged"]
        rows["own"].append(100 * paged["own"] / plain["own"])
        rows["all"].append(100 * (paged["own"] + paged["page"]) / plain["own"])
        rows["share"].append(100 * paged["page"] / paged["wall"])
        rows["speed"].append(100 * plain["wall"] / paged["wall"])
        print(f"  pair {number}, {plain['wall']:.1f} and {paged['wall']:.1f} s: " + ", ".join(f"{name} {values[-1]:.2f} %" for name, values in rows.items()), flush=True)
    for name, what, limit in (("share", "processor time of rtse-page beside the run, of one processor", 2), ("own", "processor time of the run with --record --page, of --record", 102),
                              ("all", "the same with that of rtse-page", 102)):
        median, (low, high) = statistics.median(rows[name]), interval(rows[name])
        row(what, f"{median:.1f} %", f"<= {limit} %", median <= limit)
        print(f"  {rounds} pairs, 90 % interval of the median {low:.2f} to {high:.2f} %")
    median, (low, high) = statistics.median(rows["speed"]), interval(rows["speed"])
    row("speed of the run with --record --page, of --record", f"{median:.1f} %", ">= 98 %", median >= 98)
    print(f"  {rounds} pairs, 90 % interval of the median {low:.2f} to {high:.2f} %")


# Of rtse-page at its most [MiB], without the simulator that makes the scene of the world before the first part.
def memory(recording, page, *more):
    peak = 0
    with subprocess.Popen([f"{bin_dir}/rtse-page", recording, "-o", page, *more], stdout=subprocess.DEVNULL) as process:
        while process.poll() is None:
            with open(f"/proc/{process.pid}/status", encoding="ascii") as status:
                found = re.search(r"VmHWM:\s+(\d+)", status.read())
            peak = max(peak, int(found[1]) if found else 0)
            time.sleep(0.02)
    assert process.returncode == 0
    return peak / 1024


def memories(place):
    avoid, farm = (f"{source}/worlds/systems/{name}.xml" for name in ("obstacle_avoidance", "farm"))
    hundred = f"{place}/hundred.xml"
    with open(avoid, encoding="utf8") as file, open(hundred, "w", encoding="utf8") as copy:
        copy.write(file.read().replace("pioneer2dx", "pioneer_0"))
    for name, system, world, length in (("obstacle course", avoid, "obstacle_course", "600"), ("farm with a camera", farm, "farm", "120"), ("100 robots", hundred, "hundred", "20")):
        file = f"{place}/{world}.mcap"
        run(system, world, "--duration", length, "--record", file)
        peak = memory(file, f"{place}/{world}.html")
        row(f"memory of rtse-page, {name}, {length} s ({os.path.getsize(file) / 1e6:.0f} MB)", f"{peak:.0f} MiB", "64 MiB", peak <= 64)


with tempfile.TemporaryDirectory() as folder:
    for part in (memories, cost):
        if not chosen or part.__name__ in chosen:
            part(folder)
sys.exit(1 if missed else 0)
