# Shared memory that somebody has gone mad in: segments.py BIN_DIR LIB_DIR SOURCE_DIR [--seconds T | --rounds N] [--seed S]. Everybody who uses the memory of a simulator does so at the same time:
# components, player-gateway, rtm-studio, tools; meanwhile anything is written anywhere into all of its segments, and files of them are cut, made longer or put in the place of others. The simulator and
# all servers go on, tools end with a line at worst, nobody by a signal; and with the next simulator the robot drives again.
import mmap
import os
import signal
import time

from attacker import seeded, system_options
from driving import Driving, System, robot
from player_peer import LASER, POSITION2D, Client
from web_peer import Socket

given = system_options(rounds=2).parse_args()
bin_dir, lib_dir, source = given.folders
choice = seeded(given.seed)
each_round = 3  # [s]


class Mad:
    """The segments of a server, open for writing."""

    def __init__(self, server_id):
        self.maps = {}
        self.files = [f"/dev/shm/{name}" for name in os.listdir("/dev/shm") if name.startswith(f"rtmsim-{os.getuid()}-{server_id}.")]
        for path in self.files:
            file = os.open(path, os.O_RDWR)
            self.maps[path] = mmap.mmap(file, 0)
            os.close(file)

    def scribble(self, paths):
        memory = self.maps[choice.choice(paths)]
        size = choice.choice((1, 4, 8, 64, 4096))
        at = choice.choice((0, choice.randrange(len(memory)), choice.randrange(min(len(memory), 8192)))) // 8 * 8
        count = min(size, len(memory) - at)
        what = choice.choice((choice.randbytes(count), bytes(count), b"\xff" * count, (1).to_bytes(4, "little") * (count // 4 + 1)))[:count]
        memory[at:at + count] = what

    # The length of a file changes; what was mapped of it is gone, or there is more.
    def resize(self):
        path = choice.choice(self.files)
        os.truncate(path, choice.choice((0, 8, 4096, os.path.getsize(path) // 2, os.path.getsize(path) + 4096)))
        del self.maps[path]
        self.files.remove(path)


class Everybody(Driving):
    def watchers(self):
        """Those who only look, and may give up."""
        s = self.s
        return [s.start(f"{bin_dir}/simctl", "-s", s.server_id, "echo", f"{robot}::laser", "-n", "1000000"),
                s.start(f"{bin_dir}/simctl", "-s", s.server_id, "velocity", f"{robot}::position2d", "0.2", "0", "0.1"),
                s.start(f"{bin_dir}/rtse", "--ns", s.names, "print", "RTCLaser0:range")]

    def serve(self):
        s = self.s
        self.gateway = s.start(f"{bin_dir}/player-gateway", "-s", s.server_id, "--port", "0")
        self.studio = s.start(f"{bin_dir}/rtm-studio", "--ns", s.names, "-s", s.server_id, "--port", "0")
        port = int(s.until("a port of the gateway", lambda: s.log(self.gateway).split("port ")[1].split(":")[0]))
        url = s.until("the URL of the studio", lambda: next((line for line in s.log(self.studio).splitlines() if line.startswith("http")), None))
        self.player = Client(port)
        self.player.subscribe(LASER)
        self.player.subscribe(POSITION2D)
        self.viewer = Socket(int(url.split(":")[2].split("/")[0]), url.split("token=")[1])

    def nobody_has_died(self, watchers):
        for name in ("simulator", "sensors", "client", "naming", "gateway", "studio"):
            process = getattr(self, name)
            assert process.poll() is None, f"{name} has ended with {process.returncode}: {self.s.log(process)[-3000:]}"
        for process in watchers:
            code = process.poll()
            assert code is None or code >= 0, f"{process.args} has ended with {code}: {self.s.log(process)[-3000:]}"

    def round(self):
        s, watchers = self.s, self.watchers()
        mad = Mad(s.server_id)
        # Who the server's own segment is scribbled over for does not find it any more; half of the rounds leave that one alone.
        paths = [path for path in mad.maps if choice.random() < 0.7] or list(mad.maps)
        end, deeds = time.monotonic() + each_round, 0
        while time.monotonic() < end:
            for _ in range(200):
                mad.scribble(paths)
            deeds += 200
            self.nobody_has_died(watchers)
        for _ in range(min(3, len(mad.files))):
            mad.resize()
            time.sleep(0.1)  # somebody looks meanwhile
            self.nobody_has_died(watchers)
        # Whatever it stands at, it ends when it is told to; and so do those who looked on.
        for process in (*watchers, self.simulator):
            process.send_signal(signal.SIGTERM)
        for process in watchers:
            code = process.wait(60)
            assert code in (0, 1, -signal.SIGTERM, 128 + signal.SIGTERM), f"{process.args} has ended with {code}: {s.log(process)[-3000:]}"
        code = self.simulator.wait(60)
        assert code == 0, f"the simulator has ended with {code}: {s.log(self.simulator)[-3000:]}"
        self.simulator = self.start_simulator()
        self.nobody_has_died(())
        self.wire()
        self.drives()
        return deeds


with System(bin_dir, lib_dir) as s:
    campaign = Everybody(s, source)
    campaign.wire()
    campaign.drives()
    campaign.serve()
    rounds, deeds, began = 0, 0, time.monotonic()
    while time.monotonic() - began < given.seconds if given.seconds else rounds < given.rounds:
        deeds += campaign.round()
        rounds += 1
print(f"{rounds} rounds, {deeds} scribbles survived")
