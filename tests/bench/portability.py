#!/usr/bin/env python3
"""Builds simulator, components and tools with gcc and clang, -O2 and -O3, and prints the hashes of all shipped worlds and systems for each build, and for each once more
with the variants of the C library hidden that use AVX2 and fused multiply-add (same_hashes.py). Exit code 1 if one differs.

usage: portability.py [--jobs N] [--steps N] [--only NAME] [--builds NAME,...] [--first BUILD_DIR] [FOLDER]
  FOLDER              of the builds; default build/portability
  --builds NAME,...   of these: g++-O3, g++-O2, clang++-O3, clang++-O2 (default all)
  --first BUILD_DIR   compare with this build, which has everything, and build only the simulator: minutes in place of hours
"""
import argparse
import os
import pathlib
import subprocess
import sys

source = pathlib.Path(__file__).resolve().parents[2]
parser = argparse.ArgumentParser()
parser.add_argument("--jobs", type=int, default=os.cpu_count())
parser.add_argument("--steps", type=int, default=2000)
parser.add_argument("--only", default="*")
parser.add_argument("--builds", type=lambda text: text.split(","), default=["g++-O3", "g++-O2", "clang++-O3", "clang++-O2"])
parser.add_argument("--first", type=pathlib.Path)
parser.add_argument("folder", nargs="?", type=pathlib.Path, default=source / "build/portability")
options = parser.parse_args()
options.folder = options.folder.resolve()
simulator = ("sim-server", "rtm-asset-reader")
targets = simulator if options.first else (*simulator, "simctl", "rtcd", "rtse", "demo", "demo_farm", "demo_follow")


def build(name):
    compiler, level = name.rsplit("-", 1)
    folder = options.folder / name
    if not (folder / "CMakeCache.txt").exists():
        subprocess.run(["cmake", "--preset", "release", "-B", folder, f"-DCMAKE_CXX_COMPILER={compiler}", f"-DCMAKE_CXX_FLAGS_RELEASE=-{level} -DNDEBUG", "-DRTMSIM_COLD_BUILD=ON",
                        "-DRTMSIM_TESTS=OFF", "-DRTMSIM_BENCH=OFF", "-DRTMSIM_STUDIO=OFF"], cwd=source, check=True, stdout=subprocess.DEVNULL)
    built = subprocess.run(["cmake", "--build", folder, "-j", str(options.jobs), "--target", *targets], capture_output=True, text=True)
    if built.returncode != 0:
        sys.exit(f"portability: {name} cannot be built:\n" + "\n".join(built.stdout.splitlines()[-30:]))
    return folder


builds = [options.first.resolve()] if options.first else []
builds += [build(name) for name in options.builds]
for compiler in ("g++", "clang++"):
    print(subprocess.run([compiler, "--version"], capture_output=True, text=True, check=True).stdout.splitlines()[0])
sys.exit(subprocess.run([sys.executable, source / "tests/bench/same_hashes.py", *builds, "--steps", str(options.steps), "--only", options.only, "--hashes", "--plain-libm"]).returncode)
