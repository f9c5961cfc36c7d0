"""The module CORBA under its own name."""
import sys

import omniORB.CORBA

sys.modules[__name__] = omniORB.CORBA
