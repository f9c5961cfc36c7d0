"""CorbaNaming under its own name: scripts write `from CorbaNaming import *`, and rely on the modules that come with it."""
import sys  # noqa: F401
import traceback  # noqa: F401

import CosNaming  # noqa: F401
import omniORB.CORBA as CORBA  # noqa: F401
from OpenRTM_aist.naming import CorbaNaming  # noqa: F401
