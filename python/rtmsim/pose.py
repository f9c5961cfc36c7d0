"""Poses and velocities."""
from __future__ import annotations

import math
from collections import namedtuple


class Pose(namedtuple("Pose", "x y z qw qx qy qz")):
    """A pose in the world: position [m] and unit quaternion. numpy.array(pose) has the shape (7,)."""

    __slots__ = ()

    @property
    def yaw(self) -> float:
        """Rotation about z [rad], in (-pi, pi]."""
        return math.atan2(2 * (self.qw * self.qz + self.qx * self.qy), 1 - 2 * (self.qy * self.qy + self.qz * self.qz))

    @property
    def position(self) -> tuple:
        """x, y, z [m]."""
        return self[:3]


class Velocity(namedtuple("Velocity", "vx vy vz wx wy wz")):
    """Linear [m/s] and angular [rad/s] velocity along the axes of the world."""

    __slots__ = ()
