"""Joints of arms, hands and other models."""
from __future__ import annotations

from ._core import Error, NotFound, number, numbers

TYPE_CHECKING = False
if TYPE_CHECKING:
    from ._core import Device
    from .world import World


class Joints:
    """The joints of an arm, a hand or another model: a joints iface. World.joints() makes it.

    Arrays have one element per joint, in the order of `names`. Units: rad, rad/s, N m of joints that turn; m, m/s, N of those that slide.
    """

    _modes = {"position": 1, "velocity": 2, "effort": 3, "free": 4, "brake": 5}

    def __init__(self, world: World, device: Device):
        self._world = world
        self._device = device
        self.name = device.name
        joints = device.info()["joints"]
        self.names: list[str] = list(joints["name"])
        self.lower, self.upper = joints["lower"], joints["upper"]
        self.max_velocity, self.max_effort = joints["max_velocity"], joints["max_effort"]

    def read(self) -> dict:
        """Arrays `position`, `velocity`, `effort`, `target`, `mode`, `status`, each of the shape (joints,)."""
        return self._device.value("joints", self._world.timeout)

    @property
    def position(self):
        """float64 array (joints,) [rad or m]."""
        return self.read()["position"]

    @property
    def velocity(self):
        """float64 array (joints,) [rad/s or m/s]."""
        return self.read()["velocity"]

    @property
    def effort(self):
        """Of the motors in the last step: float64 array (joints,) [N m or N]."""
        return self.read()["effort"]

    def command(self, position=None, velocity=None, effort=None) -> None:
        """Commands one of position, velocity and effort: a number for each joint, or a dict of numbers by joint name. Joints that the
        dict does not name keep their command."""
        given = [(mode, values) for mode, values in (("position", position), ("velocity", velocity), ("effort", effort))
                 if values is not None]
        if len(given) != 1:
            raise Error("joints: expected one of position, velocity and effort")
        mode, values = given[0]
        self._command(mode, self._by_index(values))

    def brake(self, *names: str) -> None:
        """Stops the joints with their brakes; without names all."""
        self._command("brake", {self._index(name): 0.0 for name in names or self.names})

    def _index(self, name: str) -> int:
        try:
            return self.names.index(name)
        except ValueError:
            raise NotFound(f"{self.name} has no joint {name!r}; it has {', '.join(self.names)}") from None

    def _by_index(self, values) -> dict:
        if hasattr(values, "items"):
            return {self._index(name): number(name, value) for name, value in values.items()}
        try:
            count = len(values)
        except TypeError:
            count = len(self.names)  # a generator, or what is no list: numbers() says so
        if count != len(self.names):
            raise Error(f"{self.name}: expected {len(self.names)} numbers, one per joint, got {count}")
        return dict(enumerate(numbers(self.name, values, count)))

    def _command(self, mode: str, values: dict) -> None:
        numbers = [0.0] * (4 * len(self.names))
        for index, value in values.items():
            numbers[4 * index] = self._modes[mode]
            numbers[4 * index + 1] = value
        self._device.command(3, numbers, 0.0)
