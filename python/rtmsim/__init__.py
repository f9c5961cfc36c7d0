"""Worlds of rtm-sim from Python: start, step, read and control a simulator.

    import rtmsim
    with rtmsim.World("worlds/obstacle_course.sdf", seed=1) as world:
        world.step(100)
        print(world.pose("pioneer2dx"), world.scan("pioneer2dx::laser").min())

Units: m, rad, s, kg, N. x is forward, y left, z up. Times are simulated seconds unless stated otherwise.
"""
from __future__ import annotations

from ._core import Error, NotFound, ServerDied, TimedOut
from .pose import Pose
from .world import World, step_all

__version__ = "0.1.0"
__all__ = [
    "BatchEnv", "Drive", "Env", "Error", "Joints", "NotFound", "Pose", "Recording", "Result", "ServerDied", "TimedOut", "World", "run",
    "step_all",
]

for _class in (Error, NotFound, ServerDied, TimedOut):
    _class.__module__ = "rtmsim"
Error.__doc__ = "The simulator rejected the request, or the arguments are invalid. One line."
NotFound.__doc__ = "No model, link, iface, type or field has this name. Also a LookupError."
ServerDied.__doc__ = "The simulator has exited, or was killed. Also a ConnectionError."
TimedOut.__doc__ = "The simulator did not answer in time, or simulated time did not go on. Also a TimeoutError."

# What few programs need, or what imports numpy, is imported with its first use: import rtmsim takes a few milliseconds.
_later = {
    "BatchEnv": ".env",
    "Drive": ".drive",
    "Env": ".env",
    "Joints": ".joints",
    "Recording": ".recording",
    "Result": ".running",
    "run": ".running",
}


def __getattr__(name: str):
    if name not in _later:
        raise AttributeError(f"module 'rtmsim' has no attribute '{name}'")
    from importlib import import_module
    value = getattr(import_module(_later[name], __name__), name)
    globals()[name] = value
    return value


def __dir__():
    return sorted(set(globals()) | set(_later))
