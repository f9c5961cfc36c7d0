"""Drives of robots."""
from __future__ import annotations

from ._core import number, numbers

TYPE_CHECKING = False
if TYPE_CHECKING:
    from ._core import Device
    from .world import World


class Drive:
    """The drive of a robot: a position2d or position3d iface. World.drive() makes it.

    The robot follows the newest command of all clients. It stops when this World closes.
    """

    def __init__(self, world: World, device: Device):
        self._world = world
        self._device = device
        self._send = device.velocity
        self.name = device.name
        self.is_3d = device.type == "position3d"

    def velocity(self, vx: float, vy: float = 0.0, va: float = 0.0, *, duration: float = 0.0) -> None:
        """Commands a velocity along the robot's axes: vx, vy [m/s], va [rad/s] about z. `duration`: simulated seconds after which the
        robot stops by itself; 0: until the next command. A position3d moves horizontally."""
        if self.is_3d:
            self._device.command(1, [number("vx", vx), number("vy", vy), 0.0, 0.0, 0.0, number("va", va)], duration)
        else:
            self._send(vx, vy, va, duration)

    def velocity3d(self, linear, angular=(0.0, 0.0, 0.0), *, duration: float = 0.0) -> None:
        """The same with three numbers each, for a position3d: linear [m/s], angular [rad/s], body frame."""
        self._device.command(1, numbers("linear", linear, 3) + numbers("angular", angular, 3), duration)

    def stop(self) -> None:
        """Commands the velocity 0."""
        self.velocity(0.0)

    @property
    def odometry(self):
        """By the wheel encoders: float64 array x y a [m, rad], shape (3,). Of a position3d a pose, shape (7,)."""
        return self._device.value("odometry", self._world.timeout)

    @property
    def measured_velocity(self):
        """By the encoders, robot frame: float64 array vx vy va, shape (3,). Of a position3d shape (6,)."""
        return self._device.value("velocity", self._world.timeout)

    @property
    def stalled(self) -> bool:
        """The robot is commanded to move, but it does not."""
        return bool(self.read().get("stalled", False))

    def read(self) -> dict:
        """All fields of the latest sample, as World.read()."""
        return self._device.read(self._world.timeout)

    def set_odometry(self, x: float, y: float, a: float) -> None:
        """Sets the odometry [m, rad]."""
        self._world._line().reset_odometry(self.name, x, y, a, self._world.timeout)

    def motors(self, on: bool) -> None:
        """Switches the motors on or off."""
        self._world._line().set_motors(self.name, on, self._world.timeout)
