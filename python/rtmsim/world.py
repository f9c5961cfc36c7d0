"""World: a simulated world under the control of this program."""
from __future__ import annotations

import atexit
import weakref

from . import _core
from ._core import Device, Error, NotFound, Simulator, TimedOut
from .pose import Pose, Velocity

TYPE_CHECKING = False
if TYPE_CHECKING:
    from .drive import Drive
    from .joints import Joints

_worlds: weakref.WeakSet = weakref.WeakSet()


@atexit.register
def _close_all() -> None:
    for world in list(_worlds):
        world.close()


def _parsed(text: str):
    import json  # with its expressions it takes longer to import than the rest
    return json.loads(text)


class World:
    """A simulated world.

    `world`: an SDFormat or URDF file, or SDFormat text. This World starts a simulator of its own, paused, as fast as possible; the
    simulator ends with close(), or when Python ends, however that happens. Without `world`: attaches to the running simulator
    `server_id`, which runs on afterwards.

    `seed`: of all sensor noise. `timeout`: real seconds that a call waits before it raises TimedOut; of step(): seconds without
    progress of simulated time. `resource_path`: folders with models. `options`: more words for sim-server.

    Errors: Error and its subclasses NotFound, ServerDied, TimedOut, each with one line. Ctrl-C ends a waiting call with
    KeyboardInterrupt and pauses the simulator. One thread at a time. After a fork, use it in the parent alone.
    """

    def __init__(self, world=None, *, seed: int = 1, server_id: int | None = None, timeout: float = 30.0, resource_path=(), options=()):
        self.timeout = timeout
        self._own = None
        self._devices: dict = {}
        self._found: dict = {}  # ifaces by kind and model; forgotten when models come or go
        self._simulator = None
        if (world is None) == (server_id is None):
            raise Error("World: expected a world, or the server_id of a running simulator")
        if world is None:
            self._simulator = Simulator(server_id)
        else:
            from ._server import OwnServer, files, words
            self._own = OwnServer(_core.path("world", world), _core.seed(seed), files("resource_path", resource_path), words("options", options), self.timeout)
            self._simulator = self._own.simulator
        self._step = self._simulator.step
        _worlds.add(self)
        try:
            _ = self._simulator.time  # waits until the world is loaded
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> World:
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def __del__(self) -> None:
        try:
            self.close()
        except Exception:
            pass

    def __repr__(self) -> str:
        if self._simulator is None:
            return "<rtmsim.World, closed>"
        return f"<rtmsim.World {self._simulator.world!r}, simulator {self._simulator.server_id}>"

    def close(self) -> None:
        """Ends what this World started, detaches from what it did not. Arrays stay valid. Several calls are allowed."""
        devices, self._devices = getattr(self, "_devices", {}), {}
        for device in devices.values():
            device.close()
        simulator, self._simulator = getattr(self, "_simulator", None), None
        if simulator is not None:
            simulator.close()
        own, self._own = getattr(self, "_own", None), None
        if own is not None:
            own.close()
        _worlds.discard(self)

    def _line(self) -> Simulator:
        if self._simulator is None:
            raise Error("the World is closed")
        return self._simulator

    @property
    def timeout(self) -> float:
        """Real seconds that a call waits, as the argument of World()."""
        return self._timeout

    @timeout.setter
    def timeout(self, seconds: float) -> None:
        self._timeout = _core.seconds("timeout", seconds)

    # ---- time

    def step(self, count: int = 1) -> float:
        """Makes `count` physics steps as fast as possible and returns the simulated time [s]. All sensors that were due have published.
        A running simulation is paused."""
        return self._step(count, self._timeout)

    def advance(self, seconds: float) -> float:
        """Makes the steps of this many simulated seconds, at least one."""
        return self.step(max(1, round(_core.number("seconds", seconds) / self.step_size)))

    def reset(self, seed: int | None = None) -> None:
        """World and time as at the start. `seed`: of all noise from now on; None: as before. The world is then the same as that of a
        simulator that was started with this seed. Spawned models are gone, deleted ones are back, faults have ended."""
        self._line().reset(False, seed, self.timeout)
        self._found.clear()

    def pause(self) -> None:
        """Pauses the simulation."""
        self._line().pause(self.timeout)

    def run(self, rtf: float | None = None) -> None:
        """Lets time go on by itself. `rtf`: real-time factor; 0: as fast as possible; None: as before (0 with a simulator of its own)."""
        if rtf is not None:
            self._line().set_rtf(rtf, self.timeout)
        self._line().run(self.timeout)

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._line().time

    @property
    def steps(self) -> int:
        """Physics steps since the start or the last reset."""
        return self._line().steps

    @property
    def step_size(self) -> float:
        """Length of a physics step [s]."""
        return self._line().step_size

    @property
    def seed(self) -> int:
        """Seed of all sensor noise."""
        return self._line().seed

    @property
    def is_paused(self) -> bool:
        """True unless time goes on by itself."""
        return self._line().is_paused

    @property
    def server_id(self) -> int:
        """Simulator ID, for simctl -s and other programs."""
        return self._line().server_id

    @property
    def name(self) -> str:
        """Name of the world in its file."""
        return self._line().world

    def hash(self) -> str:
        """Hash of the whole state, 16 hexadecimal digits. Equal hashes: equal worlds."""
        return f"{self._line().hash(self.timeout):016x}"

    # ---- models

    def models(self) -> list[str]:
        """Names of all models."""
        return [model["name"] for model in self._list()["models"]]

    def ifaces(self) -> dict[str, str]:
        """Types of all ifaces, by name. An rgbd camera has a camera and a depth of the same name: "TYPE, TYPE"."""
        found: dict[str, str] = {}
        for iface in self._list()["ifaces"]:
            name = iface["name"]
            found[name] = f"{found[name]}, {iface['type']}" if name in found else iface["type"]
        return found

    def tree(self, model: str = "") -> dict:
        """Links, joints, sensors and plugins of a model; without a name of all models."""
        return _parsed(self._line().tree(model, self.timeout))

    def pose(self, name: str) -> Pose:
        """Pose of MODEL or MODEL::LINK in the world."""
        return Pose(*self._line().pose(name, self.timeout))

    def poses(self) -> dict[str, Pose]:
        """Poses of all models, by name."""
        return {model["name"]: Pose(*model["pose"]) for model in self._list()["models"]}

    def set_pose(self, model: str, pose) -> None:
        """Moves a model. `pose`: x y yaw (height and tilt stay), x y z yaw, x y z roll pitch yaw, or a Pose. Its velocity becomes 0."""
        self._line().set_pose(model, pose, self.timeout)

    def velocity(self, name: str) -> Velocity:
        """Velocity of MODEL or MODEL::LINK."""
        return Velocity(*self._line().velocity(name, self.timeout))

    def set_velocity(self, model: str, linear=(0.0, 0.0, 0.0), angular=(0.0, 0.0, 0.0)) -> None:
        """Sets the velocity of a whole model: linear [m/s], angular [rad/s], world frame."""
        self._line().set_velocity(model, linear, angular, self.timeout)

    def push(self, name: str, force=(0.0, 0.0, 0.0), torque=(0.0, 0.0, 0.0), duration: float = 0.0, persistent: bool = False) -> None:
        """Applies a wrench to MODEL or MODEL::LINK: force [N] at the centre of mass, torque [N m], world frame, for `duration` simulated
        seconds; 0: one step. `persistent`: until the next one of the link that is persistent, or a reset; one of zeros ends it."""
        self._line().push(name, force, torque, duration, persistent, self.timeout)

    def push_joint(self, model: str, joint: str, effort: float, duration: float = 0.0, persistent: bool = False) -> None:
        """Pushes a joint that turns or slides by `effort` [N m or N], beside what its motor does. Times as of push()."""
        self._line().push_joint(model, joint, effort, duration, persistent, self.timeout)

    def contacts(self, model: str) -> list[dict]:
        """Contacts of a model in the last step: link, other, position [m], normal, depth [m]."""
        return _parsed(self._line().contacts(model, self.timeout))["contacts"]

    def spawn(self, source, name: str = "", pose=None) -> str:
        """Adds a model and returns its name. `source`: SDFormat or URDF file, model folder, model://NAME, or SDFormat text."""
        added = self._line().spawn(source, name, pose, self.timeout)
        self._found.clear()
        return added

    def delete(self, model: str) -> None:
        """Removes a model until the next reset."""
        self._line().delete(model, self.timeout)
        self._found.clear()
        self._devices = {key: device for key, device in self._devices.items() if not key[1].startswith(model + "::")}

    # ---- ifaces

    def device(self, type: str, name: str) -> Device:
        """The iface with this type and name, subscribed: its sensor works from now on. Handles are kept until close()."""
        try:
            return self._devices[type, name]
        except (KeyError, TypeError):  # new, or no texts: then Device says so
            device = Device(self._line(), type, name)
        self._devices[type, name] = device
        return device

    def scan(self, name: str):
        """Ranges of a laser: float32 array (beams,) or (layers, beams) [m], counter-clockwise. inf: nothing hit; -inf: nearer than the
        minimum. Each call returns an array of its own."""
        return self.device("laser", name).array(self.timeout)

    def sonar(self, name: str):
        """Ranges of a sonar ring: float32 array (transducers,) [m]."""
        return self.device("sonar", name).array(self.timeout)

    def camera(self, name: str):
        """The latest image: uint8 array (height, width, 3), rows from the top. With another format than rgb8 in the world: channels as the
        format says, (height, width) for one, uint16 for 16 bits. Each call returns an array of its own."""
        return self.device("camera", name).array(self.timeout)

    def depth(self, name: str):
        """The latest depth image: float32 array (height, width) [m] along the optical axis. inf: nothing."""
        return self.device("depth", name).array(self.timeout)

    def points(self, name: str):
        """The latest cloud: float32 array (height, width, 3) x y z [m] in the sensor's frame, or 4 with intensity. NaN: no point."""
        return self.device("points", name).array(self.timeout)

    def read(self, name: str, type: str | None = None) -> dict:
        """All fields of the latest sample of any iface: time [s], sequence, valid, and the fields that docs/shared-memory.md lists.
        Vectors and poses are float64 arrays. `type` is needed where several ifaces have the name."""
        return self.device(type or self._type_of(name), name).read(self.timeout)

    def info(self, name: str, type: str | None = None) -> dict:
        """Constants of an iface, as rate, range, field of view."""
        return self.device(type or self._type_of(name), name).info()

    def wait(self, name: str, type: str | None = None, timeout: float | None = None) -> dict:
        """Waits for the next sample of an iface of a running simulation and returns it as read()."""
        device = self.device(type or self._type_of(name), name)
        limit = self.timeout if timeout is None else _core.seconds("timeout", timeout)
        if not device.wait(device.sequence, limit):
            raise TimedOut(f"{name}: no sample within {limit:g} s")
        return device.read(limit)

    def drive(self, name: str) -> Drive:
        """The drive of a model, or the position2d or position3d iface with this name."""
        from .drive import Drive
        return Drive(self, self._find(name, ("position2d", "position3d"), "drive"))

    def joints(self, name: str) -> Joints:
        """The joints of a model, or the joints iface with this name."""
        from .joints import Joints
        return Joints(self, self._find(name, ("joints",), "joints"))

    def _find(self, name: str, types: tuple, what: str) -> Device:
        if (what, _core.text("name", name)) in self._found:
            return self.device(*self._found[what, name])
        rows = [(iface["type"], iface["name"], iface.get("model", "")) for iface in self._list()["ifaces"] if iface["type"] in types]
        for match in (lambda row: row[1] == name, lambda row: row[2] == name or row[1].startswith(name + "::")):
            found = [row for row in rows if match(row)]
            if len(found) == 1:
                self._found[what, name] = found[0][:2]
                return self.device(*found[0][:2])
            if found:
                raise Error(f"{name} has {len(found)} ifaces of this kind; choose one of {', '.join(row[1] for row in found)}")
        raise NotFound(f"no {what} of {name!r}" + (f"; there is {', '.join(row[1] for row in rows)}" if rows else ""))

    def _type_of(self, name: str) -> str:
        _core.text("name", name)
        for type, known in self._devices:
            if known == name:
                return type
        types = [iface["type"] for iface in self._list()["ifaces"] if iface["name"] == name and iface["type"] != "truth"]
        if len(types) == 1:
            return types[0]
        if types:
            raise Error(f"{name} is a {' and a '.join(types)}: give the type")
        from difflib import get_close_matches
        close = get_close_matches(name, self.ifaces(), 1)
        raise NotFound(f"no iface {name!r}" + (f"; did you mean {close[0]!r}?" if close else ""))

    def write_tag(self, reader: str, id: str, data: str) -> None:
        """Writes data into an RFID tag that this rfid iface has in its reach: at most 127 bytes, for all readers, until a reset."""
        self._line().write_tag(reader, id, data, self.timeout)

    # ---- faults

    def fault(self, iface: str, kind: str, amount: float | None = None, duration: float = 0.0) -> None:
        """Injects a fault into a sensor or drive, as simctl fault: off, stuck, bias, noise, missing, latency, dropout, weak, halted.
        `amount`: None: the usual one. `duration`: simulated seconds; 0: until end_faults() or reset()."""
        self._line().fault(iface, kind, amount, duration, self.timeout)

    def end_faults(self, iface: str = "", kind: str = "") -> int:
        """Ends faults of an iface and of a kind; without, all. Returns how many there were."""
        return self._line().end_faults(iface, kind, self.timeout)

    def faults(self, iface: str = "") -> list[dict]:
        """Faults that are on or still to come: iface, kind, amount, from, until [s], on."""
        return _parsed(self._line().faults(iface, self.timeout))["faults"]

    # ---- images

    def screenshot(self, width: int = 800, height: int = 600, *, top: bool = False, follow: str = "", camera: str = "", eye=None,
                   fov: float = 0.0, span: float = 0.0, centre=(0.0, 0.0), scans: bool = False):
        """An image of the world: uint8 array (height, width, 3), rows from the top, red, green, blue.

        Views: the whole world; `top`: from above, `span` metres across about `centre`; `follow`: behind a model; `camera`: of a camera
        iface; `eye`: from a pose x y z roll pitch yaw or a Pose, with the horizontal field of view `fov` [rad]. `scans`: with rays, trails and
        names. Error when it needs more than 64 MiB."""
        chosen = [name for name, on in (("top", top), ("follow", follow), ("camera", camera), ("from", eye is not None)) if on]
        if len(chosen) > 1:
            raise Error(f"screenshot: expected one view, got {' and '.join(chosen)}")
        view = chosen[0] if chosen else "whole"
        pose = eye if eye is not None else [*_core.numbers("centre", centre, 2), 0.0] if top else None
        return self._line().screenshot(view, width, height, follow or camera, pose, span if top else fov, scans, max(self.timeout, 60.0))

    def _list(self) -> dict:
        return _parsed(self._line().list(self.timeout))


def step_all(worlds, count: int = 1) -> list[float]:
    """Makes `count` steps in each of several worlds at the same time, one simulator per world, and returns their simulated times [s].
    An exception of one world is raised after all have ended their steps."""
    worlds = list(worlds) if hasattr(worlds, "__iter__") else [worlds]
    for world in worlds:
        if not isinstance(world, World):
            raise Error(f"step_all: expected a list of Worlds, got {_core.shown(world)} in it")
    begun: list = []
    problem: BaseException | None = None
    times: list[float] = []
    for world in worlds:
        try:
            world._line().begin_steps(count)
            begun.append(world)
        except Error as error:
            problem = problem or error
    for world in begun:
        try:
            times.append(world._line().end_steps(world.timeout))
        except BaseException as error:
            problem = problem or error
    if problem is not None:
        raise problem
    return times
