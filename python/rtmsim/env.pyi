from typing import Any

from . import BatchEnv as BatchEnv
from . import Env as Env

is_gymnasium: bool
spaces: Any
