# What the page of a run costs beside its recording: page_bench.py BIN_DIR LIB_DIR SOURCE_DIR [cost] [memories]. Runs of the obstacle course with --record, and with --record --page, in
# turn: the ratio of their speeds in the simulated time, without what is written afterwards. Then the memory of rtse-page for runs with a camera. Exit 1 when a limit is missed.
import json
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
    words = [f"{bin_dir}/rtse", "--json", "run", f"{source}/worlds/systems/{system}.xml", "--world", f"{source}/worlds/{world}.sdf", "--module-path", lib_dir, *more]
    return json.loads(subprocess.run(words, check=True, stdout=subprocess.PIPE, text=True, timeout=3600).stdout.splitlines()[0])


# Simulated seconds a second.
def speed(*more):
    result = run("obstacle_avoidance", "obstacle_course", "--duration", seconds, *more)
    return result["simulated"] / result["wall"]


def cost(folder):
    record = ("--record", f"{folder}/run.mcap")
    ratios = []
    for _ in range(rounds):
        before, with_page, after = speed(*record), speed(*record, "--page", f"{folder}/run.html"), speed(*record)
        ratios.append(with_page / statistics.mean((before, after)))
    ratio = 100 * statistics.median(ratios)
    row(f"speed with --record --page, of that with --record, {rounds} rounds", f"{ratio:.1f} %", ">= 98 %", ratio >= 98)
    print("  rounds " + ", ".join(f"{100 * one:.1f}" for one in ratios))


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
    for name, system, world, length in (("obstacle course", "obstacle_avoidance", "obstacle_course", "600"), ("farm with a camera", "farm", "farm", "120")):
        file = f"{place}/{world}.mcap"
        run(system, world, "--duration", length, "--record", file)
        peak = memory(file, f"{place}/{world}.html")
        row(f"memory of rtse-page, {name}, {length} s ({os.path.getsize(file) / 1e6:.0f} MB)", f"{peak:.0f} MiB", "64 MiB", peak <= 64)


with tempfile.TemporaryDirectory() as folder:
    for part in (memories, cost):
        if not chosen or part.__name__ in chosen:
            part(folder)
sys.exit(1 if missed else 0)
