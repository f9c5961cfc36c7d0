# A robot that drives around obstacles in real time, in processes of its own: what campaigns do things to. With the folders BIN_DIR LIB_DIR SOURCE_DIR.
import os
import sys

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "../scenario"))
from system import System

robot = "pioneer2dx"
links = (("RTCLaser0:range", "LaserObstacleAvoid0:range"), ("LaserObstacleAvoid0:velocity", "RTCPosition2d0:velocity"))


class Driving:
    def __init__(self, s, source):
        self.s, self.source = s, source
        self.naming, self.simulator = s.naming(), self.start_simulator()
        self.sensors, self.client = self.start_sensors(), self.start_client()

    def start_simulator(self):
        return self.s.server(f"{self.source}/worlds/obstacle_course.sdf")

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

    def naming_again(self):
        process = self.s.naming()
        self.s.until("names that come back", lambda: len(self.s.rtse("ls", "-R").split()) >= 3, 0.2)
        return process
