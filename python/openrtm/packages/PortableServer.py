"""The module PortableServer under its own name."""
import sys

import omniORB.PortableServer

sys.modules[__name__] = omniORB.PortableServer
