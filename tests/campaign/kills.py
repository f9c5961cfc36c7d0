# Processes of a running system killed or stopped at random moments: kills.py BIN_DIR LIB_DIR SOURCE_DIR [--rounds N] [--seed S]. A robot drives around obstacles in real time; each
# round takes one process away (simulator, host of the sensors, host of the client, naming service, a tool that listens), by SIGKILL or by SIGSTOP for a while. The others must go on,
# and once the process is there again, the robot must drive again. At the end everything ends in time and nothing is left in shared memory.
import argparse
import signal
import sys
import time

arguments = argparse.ArgumentParser()
arguments.add_argument("folders", nargs=3)
arguments.add_argument("--rounds", type=int, default=4)
arguments.add_argument("--seed", type=int)
given = arguments.parse_args()
bin_dir, lib_dir, source = given.folders
sys.path.append(f"{source}/tests/scenario")
sys.path.append(f"{source}/tests/campaign")
from attacker import seeded
from system import System

robot = "pioneer2dx"
links = (("RTCLaser0:range", "LaserObstacleAvoid0:range"), ("LaserObstacleAvoid0:velocity", "RTCPosition2d0:velocity"))


class Campaign:
    def __init__(self, s, choice):
        self.s, self.choice = s, choice
        self.naming, self.simulator = s.naming(), self.start_simulator()
        self.sensors, self.client = self.start_sensors(), self.start_client()

    def start_simulator(self):
        return self.s.server(f"{source}/worlds/obstacle_course.sdf")

    # A connection comes back by itself where the property of the connector says so; here a person connects again, which must always do.
    def start_sensors(self):
        return self.s.rtcd("RTCLaser", "RTCPosition2d")

    def start_client(self):
        return self.s.rtcd("LaserObstacleAvoid")

    def is_connected(self, one, other):
        done = self.s.try_rtse("con", one, other)
        return done.returncode == 0 or "connected" in done.stderr

    def wire(self):
        for one, other in links:
            self.s.until(f"a connection of {one}", lambda: self.is_connected(one, other), 0.2)
        for name in ("RTCPosition2d0", "RTCLaser0", "LaserObstacleAvoid0"):
            self.s.until(f"{name} active", lambda: self.s.try_rtse("act", name).returncode == 0, 0.2)

    def position(self):
        return self.s.simctl("pose", robot)

    def drives(self):
        at = self.position()
        self.s.until("a robot that drives", lambda: self.position() != at, 0.1)

    def others_go_on(self, victim):
        for name, process in (("simulator", self.simulator), ("sensors", self.sensors), ("client", self.client), ("naming", self.naming)):
            assert process is victim or process.poll() is None, f"{name} ended with {process.returncode} when another process was taken away"
        if victim is not self.simulator:
            before = self.s.seconds()
            self.s.until("time that passes", lambda: self.s.seconds() > before, 0.05)
        if victim is not self.naming:
            self.s.rtse("ls")

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
        is_killed = self.choice.random() < 0.7
        print(f"{victim}: {'SIGKILL' if is_killed else 'SIGSTOP'}", flush=True)
        if victim == "tool":
            tool = self.s.start(*self.choice.choice(((f"{bin_dir}/simctl", "-s", self.s.server_id, "echo", f"laser:{robot}::laser", "-n", "1000000"),
                                                     (f"{bin_dir}/rtse", "--ns", self.s.names, "print", "RTCLaser0:range"))))
            time.sleep(self.choice.uniform(0, 1))  # a random moment
            assert tool.poll() is None, self.s.log(tool)
            self.take_away(tool, True)
        else:
            time.sleep(self.choice.uniform(0, 0.5))  # a random moment
            self.take_away(getattr(self, victim), is_killed)
            if is_killed:
                setattr(self, victim, getattr(self, f"start_{victim}")() if victim != "naming" else self.naming_again())
        self.wire()
        self.drives()

    def naming_again(self):
        process = self.s.naming()
        self.s.until("names that come back", lambda: len(self.s.rtse("ls", "-R").split()) >= 3, 0.2)
        return process


choice = seeded(given.seed)
with System(bin_dir, lib_dir) as s:
    campaign = Campaign(s, choice)
    campaign.wire()
    campaign.drives()
    for _ in range(given.rounds):
        campaign.round()
print(f"{given.rounds} rounds survived")
