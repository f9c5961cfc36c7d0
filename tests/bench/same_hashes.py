#!/usr/bin/env python3
"""Compares the hashes of several builds (compilers, levels of optimisation, sanitizers). Each build makes N steps of each world of `worlds` and `tests/worlds`, and a run
of each system of `worlds/systems`, with its own components if it has them, else with those of the first build. Their hash logs (docs/hash-logs.md) must equal those of the
first. Prints n of n, or with --hashes each hash; exit code 1 if one differs, with the first difference.

usage: same_hashes.py BUILD_DIR... [--steps N] [--only NAME] [--hashes] [--plain-libm]      (each with bin/sim-server; the first with everything)
  --only NAME    worlds and systems with this name alone, which may have * in it (obstacle*)
  --plain-libm   once more for each build with the variants of the C library hidden that use AVX2 and fused multiply-add
"""
import argparse
import fnmatch
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
parser.add_argument("--only", default="*", metavar="NAME")
parser.add_argument("--hashes", action="store_true")
parser.add_argument("--plain-libm", action="store_true")
options = parser.parse_args()
first = options.builds[0]
watchdog = 900  # [s]; a bound on hanging, not on speed
environment = {**os.environ, "RTMSIM_RESOURCE_PATH": f"{source}/worlds:{source}/tests/worlds/models", "ASAN_OPTIONS": "detect_leaks=0:verify_asan_link_order=0"}
environment.pop("CI", None)
plain_libm = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-AVX512F,-AVX512VL,-AVX512BW,-FMA,-FMA4"}
systems = {"obstacle_avoidance": "obstacle_course", "leader_follower": "leader_follower", "farm": "farm"}  # and their worlds
server_id = server_ids.claim(1)


# True: the log is there. False: no world that can be run.
def make_steps(build, world, log, env):
    server = subprocess.Popen([build / "bin/sim-server", world, "-s", server_id, "--paused", "--rtf", "0", "--hash-log", log], stdout=subprocess.DEVNULL,
                              stderr=subprocess.DEVNULL, env=env)
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


# With components and the samples of their ports. `rtse run` itself hides the variants that use fused multiply-add.
def run_system(build, system, log, folder, env):
    bin_dir = pathlib.Path(tempfile.mkdtemp(dir=folder)) / "bin"
    bin_dir.mkdir()
    components = build if (build / "bin/rtcd").exists() else first
    shutil.copy(components / "bin/rtse", bin_dir)
    for program in ("rtcd", "simctl"):
        (bin_dir / program).symlink_to(components / "bin" / program)
    for program in ("sim-server", "rtm-asset-reader"):
        (bin_dir / program).symlink_to(build / "bin" / program)
    done = subprocess.run([bin_dir / "rtse", "run", source / f"worlds/systems/{system}.xml", "--world", source / f"worlds/{systems[system]}.sdf", "--module-path",
                           components / "lib", "--duration", "20", "--seed", "7", "--hash-log", log], capture_output=True, text=True, timeout=watchdog, env=env)
    assert done.returncode == 0, f"{build}: {system}: {done.stderr}"


def whole_hash(log):
    done = subprocess.run([first / "bin/rtse", "diff", log, log], capture_output=True, text=True, timeout=watchdog)
    return done.stdout.split()[-1]


def main(folder):
    worlds = [path for pattern in ("worlds/*.sdf", "tests/worlds/*.sdf", "tests/worlds/*.world") for path in sorted(source.glob(pattern)) if fnmatch.fnmatch(path.stem, options.only)]
    chosen_systems = [name for name in systems if fnmatch.fnmatch(name, options.only)]
    failed, left_out = False, []
    logs = {}
    for build, settings in [(build, more) for build in options.builds for more in ({}, plain_libm)[:1 + options.plain_libm]]:
        same = total = 0
        called = f"{build}, plain libm" if settings else f"{build}"
        for world in [*worlds, *chosen_systems]:
            name = world.name if isinstance(world, pathlib.Path) else f"system {world}"
            log = f"{folder}/log"
            if world in systems:
                run_system(build, world, log, folder, {**environment, **settings})
            elif not make_steps(build, world, log, {**environment, **settings}):
                if build == first and not settings:
                    left_out.append(name)
                continue
            octets = pathlib.Path(log).read_bytes()
            kept = logs.setdefault(name, octets)
            total, same = total + 1, same + (octets == kept)
            if options.hashes:
                print(f"  {whole_hash(log)}  {name}", flush=True)
            if octets != kept:
                failed = True
                pathlib.Path(f"{folder}/first").write_bytes(kept)
                print(f"  {called}: {name}: " + subprocess.run([first / "bin/rtse", "diff", f"{folder}/first", log], capture_output=True, text=True).stderr.strip(), flush=True)
        print(f"{called}: {same} of {total} as {first}" + (f"; left out as no world that runs: {', '.join(left_out)}" if left_out else ""), flush=True)
        left_out.clear()
        failed = failed or total != len(logs)
    return 1 if failed else 0


with tempfile.TemporaryDirectory() as work:
    sys.exit(main(work))
