#!/usr/bin/env python3
"""Spawns models with damaged meshes beside a running simulation: a sim-server in real time, one client, a new file for each spawn. Prints a
line per format: files, those that end the reader or are late, lines that the simulator logs, time of a spawn. Then what must not change:
descriptors, processes, shared memory. Exit code 1: the simulator exited, a file has no or two lines, or something has stayed.

usage: PYTHONPATH=build/release/python spawn_bench.py [--runs N] [--seed N] BIN_DIR [FILE...]
"""
import argparse
import json
import os
import pathlib
import random
import statistics
import subprocess
import sys
import tempfile
import time

import rtmsim

source = pathlib.Path(__file__).resolve().parents[2]
formats = (".dae", ".obj", ".ply", ".glb", ".gltf", ".stl", ".fbx", ".bvh")
words = [b"nan", b"inf", b"-1", b"0", b"1e38", b"1e-38", b"4294967295", b"2147483647", b"65536", b"99999999", b"<", b"/>", b'"', b"{", b"}", b"\n", b" ", b"#", b"\xff", b"1 2 3"]
numbers = b"0123456789"


# Changes bytes, words and numbers, or cuts, as tests/fuzz/asset_mutations.cpp does.
def mutated(content, random):
    text = bytearray(content)
    is_gentle = random.random() < 0.5  # only numbers change, so that more than the first line of the file is read
    for _ in range(random.choice((1, 1, 2, 4))):
        if not text:
            break
        at = random.randrange(len(text))
        length = random.choice((1, 4, 12, 200))
        kind = random.choice("number word32".split() if is_gentle else "byte erase insert replace copy cut number word32".split())
        if kind == "byte":
            text[at] = random.randrange(256)
        elif kind == "erase":
            del text[at:at + length]
        elif kind == "insert":
            text[at:at] = random.choice(words)
        elif kind == "replace":
            text[at:at + length] = random.choice(words)
        elif kind == "copy":
            other = random.randrange(len(text))
            text[other:other] = text[at:at + length]
        elif kind == "cut":
            del text[at:]
        elif kind == "number":
            digit = next((i for i in range(at, len(text)) if text[i] in numbers), None)
            if digit is not None:
                end = next((i for i in range(digit, len(text)) if text[i] not in numbers + b".e-"), len(text))
                text[digit:end] = random.choice(words[:10])
        else:
            value = random.choice((0, 1, 0xFF, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0x10000, 0x7F800000, 0x7FC00000)).to_bytes(4, "little")
            text[at:at + 4] = value[:len(text) - at]
    return bytes(text)


class Server:
    def __init__(self, bin_dir, server_id, log):
        self.id = server_id
        with open(log, "w") as out:
            self.process = subprocess.Popen([f"{bin_dir}/sim-server", f"{source}/worlds/obstacle_course.sdf", "-s", str(server_id)], stdout=out, stderr=out)
        self.log = open(log)
        self.simctl = [f"{bin_dir}/simctl", "-s", str(server_id)]
        subprocess.run([*self.simctl, "wait"], check=True, timeout=60)

    def steps(self):
        return json.loads(subprocess.run([*self.simctl, "--json", "stats"], check=True, timeout=60, capture_output=True, text=True).stdout)["steps"]

    def new_lines(self):  # lines of the log since the last call
        return [line for line in self.log.read().splitlines() if line]

    def reader(self):
        children = []
        for task in os.listdir(f"/proc/{self.process.pid}/task"):
            try:
                children += pathlib.Path(f"/proc/{self.process.pid}/task/{task}/children").read_text().split()
            except OSError:
                pass  # the thread ended meanwhile
        return children

    def stays(self):
        own = [p for p in os.scandir("/dev/shm") if p.name.startswith(f"rtmsim-{os.getuid()}-{self.id}.")]
        return {"descriptors": len(os.listdir(f"/proc/{self.process.pid}/fd")), "child processes": len(self.reader()),
                "shared memory [segments]": len(own), "shared memory [bytes]": sum(p.stat().st_blocks * 512 for p in own)}


def spawn(world, mesh):
    shape = f"<geometry><mesh><uri>{mesh}</uri></mesh></geometry>"
    began = time.perf_counter()
    world.spawn(f"<sdf version='1.9'><model name='m'><pose>0 0 50 0 0 0</pose><static>1</static><link name='l'><collision name='c'>{shape}</collision><visual name='v'>{shape}</visual></link></model></sdf>", "m")
    took = time.perf_counter() - began
    world.delete("m")
    return took


def share(times, part):
    return sorted(times)[min(len(times) - 1, int(part * len(times)))] * 1e3


def main():
    options = argparse.ArgumentParser()
    options.add_argument("--runs", type=int, default=100)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--server-id", type=int, default=4711)
    options.add_argument("bin_dir")
    options.add_argument("files", nargs="*", type=pathlib.Path)
    options = options.parse_args()
    seeds = options.files or sorted(f for f in (source / "tests/fuzz/assets").iterdir() if f.suffix in formats)
    with tempfile.TemporaryDirectory() as folder:
        server = Server(options.bin_dir, options.server_id, f"{folder}/log")
        problems = run(server, seeds, options, pathlib.Path(folder))
        server.process.terminate()
        server.process.wait(60)
    print("\n".join(problems))
    return 1 if problems else 0


def run(server, seeds, options, folder):
    world = rtmsim.World(server_id=server.id, timeout=60)
    problems, all_times, total = [], [], 0
    for seed in seeds:  # the first file of each format starts processes and threads that stay
        spawn(world, seed)
    server.new_lines()
    before, first_step, began = server.stays(), server.steps(), time.perf_counter()
    for seed in seeds:
        content, chance = seed.read_bytes(), random.Random(f"{options.seed} {seed.name}")
        times, ended, late, damaged = [], 0, 0, 0
        whole = statistics.median(spawn(world, seed) for _ in range(20)) * 1e3
        server.new_lines()
        mesh = folder / f"mutated{seed.suffix}"
        for i in range(options.runs):
            mesh.unlink(missing_ok=True)
            mesh.write_bytes(mutated(content, chance))
            reader = server.reader()
            try:
                times.append(spawn(world, mesh))
            except rtmsim.Error as e:
                return problems + [f"{seed.name}, mutation {i}: {e}; exit code of sim-server: {server.process.poll()}"]
            lines = server.new_lines()
            ended += bool(reader) and server.reader() != reader
            late += any("in time" in line or "processor time" in line for line in lines)
            damaged += bool(lines)
            if len(lines) > 1:
                problems.append(f"{seed.name}, mutation {i}: {len(lines)} lines: {' | '.join(lines)}")
        all_times += times
        total += len(times)
        print(f"{seed.name:<28} {len(times)} files, {damaged} with a line; {ended} ended the reader, {late} of them late; spawn: whole {whole:.1f} ms, "
              f"median {statistics.median(times) * 1e3:.1f} ms, 99 % {share(times, 0.99):.0f} ms, longest {max(times) * 1e3:.0f} ms", flush=True)
    took, made = time.perf_counter() - began, server.steps() - first_step
    spawn(world, seeds[0])
    after = server.stays()
    print(f"{total} files in {took:.0f} s, sim-server runs; spawn: median {statistics.median(all_times) * 1e3:.1f} ms, 99 % {share(all_times, 0.99):.0f} ms; "
          f"{made} steps meanwhile, {made / took:.0f} a second")
    for what, count in before.items():
        print(f"{what}: {count} before, {after[what]} after")
        if after[what] > count:
            problems.append(f"{what}: {after[what] - count} more than before")
    return problems


sys.exit(main())
