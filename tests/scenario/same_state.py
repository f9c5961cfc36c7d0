# The state of the world after a run is the same with all components in one process, one process each, and beside another run.
import json
import subprocess
import sys

rtse, system, world = sys.argv[1:]
call = [rtse, "--json", "run", system, "--world", world, "--duration", "20", "--seed", "7"]


def start(*more):
    return subprocess.Popen([*call, *more], stdout=subprocess.PIPE, text=True)


def state(process):
    out, _ = process.communicate(timeout=200)
    assert process.returncode == 0, f"exit code {process.returncode}"
    return json.loads(out.splitlines()[-1])["state_hash"]


first = state(start())
together = [start("--one-process-each"), start()]
states = [first] + [state(process) for process in together]
print(states)
assert first and first != "0" * 16 and len(set(states)) == 1, "the states differ"
