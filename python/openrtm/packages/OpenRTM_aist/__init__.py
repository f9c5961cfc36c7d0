"""Components of OpenRTM-aist-Python over this project's runtime: one flat namespace, as there.

The classes are thin: ports, contexts, configuration and life are those of the C++ runtime (_openrtm_core). docs/python-components.md
lists what is there and what differs.
"""
import sys as _sys

import omniORB as _omniORB
import RTC, RTC__POA, OpenRTM, OpenRTM__POA, SDOPackage, RTM  # noqa: E401,F401: sources rely on them
from _openrtm_core import Properties  # noqa: F401

from . import version  # noqa: F401
from .version import corba_name, openrtm_name, openrtm_version  # noqa: F401
from .listeners import *  # noqa: F401,F403
from .logger import *  # noqa: F401,F403
from . import StringUtil  # noqa: F401
from .StringUtil import *  # noqa: F401,F403
from .ports import *  # noqa: F401,F403
from .component import *  # noqa: F401,F403
from .manager import *  # noqa: F401,F403

# Loaded when they are first used.
_LATER = {
    "CORBA_RTCUtil": ("CORBA_RTCUtil", None), "NVUtil": ("NVUtil", None), "CORBA_SeqUtil": ("CORBA_SeqUtil", None),
    "StaticFSM": ("StaticFSM", None), "Macho": ("Macho", None),
    "CorbaNaming": ("naming", "CorbaNaming"),
    "uuid": ("utility", None), "EventPort": ("EventPort", None), "CSPEventPort": ("CSPEventPort", None),
    "CSPMachine": ("CSPMachine", None),
    # Files of the original whose names are no classes.
    "RTObject": ("component", None), "SystemLogger": ("logger", None), "RTCUtil": ("RTCUtil", None), "Async": ("utility", None),
}
for _name in ("FSM_TOPSTATE", "FSM_SUBSTATE", "Link", "State", "Event", "Machine", "deephistory", "history"):
    _LATER.setdefault(_name, ("StaticFSM", _name))
for _name in ("Async_tInvoker", "Async_ref_tInvoker", "Async_t", "Async_ref_t", "ScopedLock", "Task", "Time", "TimeValue", "TimeMeasure",
              "ClockManager", "SystemClock", "LogicalClock", "AdjustedClock", "Guard", "Timer", "PeriodicTask", "ListenerObject", "ListenerFunc",
              "toTypename", "uuid1"):
    _LATER[_name] = ("utility", _name)
for _name in ("CSPInPort", "CSPOutPort"):
    _LATER[_name] = ("csp", _name)
_LATER["CSPManager"] = ("csp_manager", "CSPManager")
for _name in ("ByteDataStreamBase", "CORBA_CdrMemoryStream", "SerializerFactories", "SerializerFactory"):
    _LATER[_name] = ("serializers", _name)
for _name in ("SdoServiceProviderBase", "SdoServiceConsumerBase", "SdoServiceProviderFactory", "SdoServiceConsumerFactory"):
    _LATER[_name] = ("sdo", _name)
_LATER["PeriodicECSharedComposite"] = ("composite", "PeriodicECSharedComposite")
_LATER["EventInPort"] = ("EventPort", "EventInPort")
for _name in ("newNV", "copyFromProperties", "copyToProperties", "isString", "isStringValue", "toString", "appendStringValue", "append", "dump"):
    _LATER[_name] = ("NVUtil", _name)
for _name in ("for_each", "find", "push_back", "push_back_list", "insert", "front", "back", "erase", "erase_if", "refToVstring"):
    _LATER[_name] = ("CORBA_SeqUtil", _name)
for _name in ("ExecutionContextBase", "PeriodicExecutionContext", "ExtTrigExecutionContext", "ExecutionContextFactory", "ECDelete"):
    _LATER[_name] = ("contexts", _name)
for _name in ("activate", "already_connected", "connect", "connect_by_name", "connect_multi", "create_connector", "deactivate", "disconnect",
              "get_actual_ec", "get_component_profile", "get_ec_id", "get_port_by_name", "get_port_names", "get_state", "is_existing",
              "is_in_active", "is_in_error", "is_in_inactive", "reset"):
    _LATER[_name] = ("CORBA_RTCUtil", _name)
for _name in ("isDataFlowComponent", "isFsmParticipant", "isFsmObject", "isMultiModeObject"):
    _LATER[_name] = ("RTCUtil", _name)
del _name


# `from OpenRTM_aist import *` imports the names that are loaded later, too.
__all__ = sorted({_name for _name in globals() if not _name.startswith("_")} | set(_LATER))


class _File(type(_sys)):
    """Stand-in for a file of OpenRTM-aist-Python, which has one for each class: OpenRTM_aist.X, with the modules that it imports."""

    def __init__(self, name):
        super().__init__("OpenRTM_aist." + name)
        self.__all__ = [name, *self._modules]

    _modules = ("OpenRTM_aist", "CORBA", "CosNaming", "RTC", "sys", "time")

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return _omniORB._import(name) if name in self._modules else getattr(_sys.modules["OpenRTM_aist"], name)


# `import OpenRTM_aist.X` finds these in sys.modules, and does not replace the classes by them.
for _name in __all__:
    if _name[0].isupper() and not isinstance(globals().get(_name), type(_sys)) and _LATER.get(_name, ("", _name))[1]:
        _sys.modules.setdefault("OpenRTM_aist." + _name, _File(_name))
del _name


def __getattr__(name):
    if name in _LATER:
        file, inner = _LATER[name]
        __import__("OpenRTM_aist." + file)
        module = _sys.modules["OpenRTM_aist." + file]
        value = module if inner is None else getattr(module, inner)
        globals()[name] = value
        return value
    raise AttributeError("OpenRTM_aist.%s is not part of this implementation (docs/python-components.md lists what is)" % name)
