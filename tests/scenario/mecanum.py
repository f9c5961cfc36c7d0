# The base of worlds/mecanum.sdf goes round in lock step, three times: it reaches its poses, touches nothing, one hash: mecanum.py RTSE SOURCE_DIR.
import json
import subprocess
import sys

rtse, source = sys.argv[1:]
run = [rtse, "--json", "run", f"{source}/worlds/systems/mecanum.xml", "--world", f"{source}/worlds/mecanum.sdf", "--duration", "40", "--strict",
       "--expect", f"{source}/worlds/systems/mecanum.expect.yaml"]
hashes = []
for more in ([], [], ["--one-process-each"]):
    done = subprocess.run(run + more, capture_output=True, text=True, timeout=200)
    assert done.returncode == 0, done.stdout + done.stderr
    hashes.append(json.loads(done.stdout.splitlines()[-1])["state_hash"])
assert len(set(hashes)) == 1, hashes
print("ok", hashes[0])
