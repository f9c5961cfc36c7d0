# The boat, the underwater vehicle and the quadcopter of worlds/ in lock step, five times each: where they must be, and one hash: vehicles.py RTSE SOURCE_DIR SYSTEM SECONDS.
import json
import subprocess
import sys

rtse, source, system, seconds = sys.argv[1:]
run = [rtse, "--json", "run", f"{source}/worlds/systems/{system}.xml", "--world", f"{source}/worlds/{system}.sdf", "--duration", seconds, "--strict",
       "--expect", f"{source}/worlds/systems/{system}.expect.yaml"]
hashes = []
for _ in range(5):
    done = subprocess.run(run, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    hashes.append(json.loads(done.stdout.splitlines()[-1])["state_hash"])
assert len(set(hashes)) == 1, hashes
print("ok", hashes[0])
