# The arm of worlds/arm.sdf stacks its boxes in lock step, 20 times: stacked, nothing dropped, one hash: stacking.py RTSE SOURCE_DIR.
import json
import subprocess
import sys

rtse, source = sys.argv[1:]
run = [rtse, "--json", "run", f"{source}/worlds/systems/arm.xml", "--world", f"{source}/worlds/arm.sdf", "--duration", "25", "--strict",
       "--expect", f"{source}/worlds/systems/arm.expect.yaml"]
hashes = []
for _ in range(20):
    done = subprocess.run(run, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    hashes.append(json.loads(done.stdout.splitlines()[-1])["state_hash"])
assert len(set(hashes)) == 1, hashes
print("ok", hashes[0])
