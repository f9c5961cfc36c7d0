# Processes of a running system killed or stopped at random moments: kills.py BIN_DIR LIB_DIR SOURCE_DIR [--rounds N | --seconds T] [--only kill|stop] [--seed S]. A robot drives around obstacles in real time; each
# round takes one process away (simulator, host of the sensors, host of the client, naming service, a tool that listens), by SIGKILL or by SIGSTOP for a while. The others must go on,
# and once the process is there again, the robot must drive again. At the end everything ends in time and nothing is left in shared memory.
import signal
import time

from attacker import seeded, system_options
from driving import Driving, System, robot

arguments = system_options(rounds=4)
arguments.add_argument("--only", choices=("kill", "stop"))
given = arguments.parse_args()
bin_dir, lib_dir, source = given.folders


class Kills(Driving):
    def __init__(self, s, choice):
        super().__init__(s, source)
        self.choice = choice

    def take_away(self, process, is_killed):
        if is_killed:
            self.s.kill(process)
            self.others_go_on(process)
            return
        process.send_signal(signal.SIGSTOP)
        time.sleep(self.choice.uniform(0.1, 3))  # what is tried out
        self.others_go_on(process)
        process.send_signal(signal.SIGCONT)

    def round(self):
        victim = self.choice.choice(("simulator", "sensors", "client", "naming", "tool"))
        is_killed = self.choice.random() < {None: 0.7, "kill": 2, "stop": 0}[given.only]
        print(f"{victim}: {'SIGKILL' if is_killed else 'SIGSTOP'}", flush=True)
        if victim == "tool":
            tool = self.s.start(*self.choice.choice(((f"{bin_dir}/simctl", "-s", self.s.server_id, "echo", f"laser:{robot}::laser", "-n", "1000000"),
                                                     (f"{bin_dir}/rtse", "--ns", self.s.names, "print", "RTCLaser0:range"))))
            time.sleep(self.choice.uniform(0, 1))  # a random moment
            assert tool.poll() is None, self.s.log(tool)
            self.take_away(tool, is_killed)
            if not is_killed:
                self.s.kill(tool)
        else:
            time.sleep(self.choice.uniform(0, 0.5))  # a random moment
            self.take_away(getattr(self, victim), is_killed)
            if is_killed:
                setattr(self, victim, getattr(self, f"start_{victim}")() if victim != "naming" else self.naming_again())
        self.wire()
        self.drives()


choice = seeded(given.seed)
with System(bin_dir, lib_dir) as s:
    campaign = Kills(s, choice)
    campaign.wire()
    campaign.drives()
    rounds, began = 0, time.monotonic()
    while time.monotonic() - began < given.seconds if given.seconds else rounds < given.rounds:
        campaign.round()
        rounds += 1
print(f"{rounds} rounds survived")
