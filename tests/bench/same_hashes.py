#!/usr/bin/env python3
"""Whether simulators of several builds (compilers, levels of optimisation, sanitizers) make the same of the same worlds, to the bit. Each makes so many steps of each
world of `worlds` and `tests/worlds`, and a run of the obstacle avoidance with the components of the first build; their hash logs (docs/hash-logs.md) are compared with
those of the first. Prints n of n; exit code 1 when one differs, with the first difference.

usage: same_hashes.py BUILD_DIR BUILD_DIR... [--steps N]      (each with bin/sim-server; the first with everything)
"""
import argparse
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

source = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(source / "tests/scenario"))
import server_ids

parser = argparse.ArgumentParser()
parser.add_argument("builds", nargs="+", type=lambda path: pathlib.Path(path).resolve())
parser.add_argument("--steps", type=int, default=2000)
options = parser.parse_args()
first = options.builds[0]
watchdog = 900  # [s]; a bound on hanging, not on speed
environment = {**os.environ, "RTMSIM_RESOURCE_PATH": f"{source}/worlds:{source}/tests/worlds/models", "ASAN_OPTIONS": "detect_leaks=0:verify_asan_link_order=0"}
environment.pop("CI", None)
server_id = server_ids.claim(1)


# True: the log is there. False: no world that can be run.
def make_steps(build, world, log):
    server = subprocess.Popen([build / "bin/sim-server", world, "-s", server_id, "--paused", "--rtf", "0", "--hash-log", log], stdout=subprocess.DEVNULL,
                              stderr=subprocess.DEVNULL, env=environment)
    simctl = lambda *words: subprocess.run([first / "bin/simctl", "-s", server_id, *words], capture_output=True, timeout=watchdog).returncode == 0
    end = time.monotonic() + watchdog
    while server.poll() is None and not simctl("stats"):
        assert time.monotonic() < end, f"{build}: {world}: does not answer"
        time.sleep(0.05)
    if server.poll() is not None:
        return False
    stepped = simctl("step", str(options.steps))
    server.send_signal(signal.SIGINT)
    assert server.wait(watchdog) == 0 and stepped, f"{build}: {world}: has failed"
    return True


# The whole tree: with components and what goes through their ports.
def run_system(build, log, folder):
    bin_dir = pathlib.Path(tempfile.mkdtemp(dir=folder)) / "bin"
    bin_dir.mkdir()
    shutil.copy(first / "bin/rtse", bin_dir)
    for program in ("rtcd", "simctl"):
        (bin_dir / program).symlink_to(first / "bin" / program)
    (bin_dir / "sim-server").symlink_to(build / "bin/sim-server")
    done = subprocess.run([bin_dir / "rtse", "run", source / "worlds/systems/obstacle_avoidance.xml", "--world", source / "worlds/obstacle_course.sdf", "--module-path", first / "lib",
                           "--duration", "20", "--seed", "7", "--hash-log", log], capture_output=True, text=True, timeout=watchdog, env=environment)
    assert done.returncode == 0, f"{build}: {done.stderr}"


def main(folder):
    worlds = [path for pattern in ("worlds/*.sdf", "tests/worlds/*.sdf", "tests/worlds/*.world") for path in sorted(source.glob(pattern))]
    failed, left_out = False, []
    logs = {}
    for build in options.builds:
        same = total = 0
        for world in [*worlds, None]:
            name = world.name if world else "obstacle avoidance, with components"
            log = f"{folder}/log"
            if world is None:
                run_system(build, log, folder)
            elif not make_steps(build, world, log):
                if build == first:
                    left_out.append(name)
                continue
            octets = pathlib.Path(log).read_bytes()
            kept = logs.setdefault(name, octets)
            total, same = total + 1, same + (octets == kept)
            if octets != kept:
                failed = True
                pathlib.Path(f"{folder}/first").write_bytes(kept)
                print(f"  {build}: {name}: " + subprocess.run([first / "bin/rtse", "diff", f"{folder}/first", log], capture_output=True, text=True).stderr.strip(), flush=True)
        print(f"{build}: {same} of {total} as {first}" + (f"; left out as no world that runs: {', '.join(left_out)}" if build == first and left_out else ""), flush=True)
        failed = failed or total != len(logs)
    return 1 if failed else 0


with tempfile.TemporaryDirectory() as work:
    sys.exit(main(work))
