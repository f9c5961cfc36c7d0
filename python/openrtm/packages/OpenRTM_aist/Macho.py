"""The other name of StaticFSM."""
from .StaticFSM import *  # noqa: F401,F403
