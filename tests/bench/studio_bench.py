"""What viewers of rtm-studio cost, in one run on this machine: studio_bench.py BIN_DIR LIB_DIR SOURCE_DIR. Prints each number beside its limit."""
import os
import statistics
import sys
import threading
import time

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "..", "scenario"))
from rig import Rig, await_  # noqa: E402
from web_peer import Closed, Socket  # noqa: E402

rig = Rig(*sys.argv[1:])


def start_studio():
    process = rig.start(f"{rig.bin_dir}/rtm-studio", "--ns", rig.names, "-s", rig.server_id, "--port", "0")
    await_("the URL", lambda: rig.log(process).startswith("http"))
    url = rig.log(process).splitlines()[0]
    return int(url.split(":")[2].split("/")[0]), url.split("token=")[1]


class Reader(threading.Thread):
    """Reads all that comes, as a page does."""

    def __init__(self, port, token):
        super().__init__(daemon=True)
        self.socket = Socket(port, token)
        self.socket.event("world", lambda m: m["present"])
        self.poses = 0
        self.start()

    def run(self):
        try:
            while True:
                opcode, payload = self.socket.frame()
                self.poses += opcode == 2 and payload[0] == 0x81
        except (Closed, OSError):
            pass


def steps_per_second(seconds):
    first, begin = rig.stats()["steps"], time.monotonic()
    time.sleep(seconds)
    return (rig.stats()["steps"] - first) / (time.monotonic() - begin)


with rig:
    rig.naming()
    simulator = rig.server(world=f"{rig.source}/worlds/hundred.sdf")
    port, token = start_studio()
    robots = [i["name"] for i in __import__("json").loads(rig.simctl("--json", "list")) if i["type"] == "position2d"]
    driver = Socket(port, token)
    stop = threading.Event()

    def drive():
        while not stop.is_set():
            for name in robots:
                driver.send({"op": "request", "id": 1, "name": "drive", "args": {"iface": name, "velocity": [0.1, 0, 0.3]}})
            driver.line.setblocking(False)
            try:
                while driver.line.recv(1 << 20):
                    pass
            except BlockingIOError:
                pass
            driver.line.setblocking(True)
            stop.wait(0.25)

    thread = threading.Thread(target=drive, daemon=True)
    thread.start()
    time.sleep(2)
    reader = Reader(port, token)
    time.sleep(1)
    octets, frames, begin = reader.socket.received, reader.poses, time.monotonic()
    time.sleep(5)
    took = time.monotonic() - begin
    rate = (reader.socket.received - octets) / took / 1e6
    print(f"{len(robots)} robots, {(reader.poses - frames) / took:.1f} pictures/s: {rate:.3f} MB/s on the wire (limit 1.5)")
    stop.set()
    thread.join()
    driver.close()
    reader.socket.close()
    rig.simctl("rtf", "0")
    ratios = []
    for _ in range(int(os.environ.get("RTMSIM_BENCH_ROUNDS", "6"))):
        alone = steps_per_second(2)
        reader = Reader(port, token)
        watched = steps_per_second(2)
        reader.socket.close()
        again = steps_per_second(2)
        ratios.append(watched / ((alone + again) / 2))
    print(f"the simulator with one viewer runs at {100 * statistics.median(ratios):.1f} % of its speed without, as fast as it can (limit 98); "
          f"rounds {', '.join(f'{100 * r:.1f}' for r in ratios)}")
