"""Execution contexts of authors. A class is registered by name, and components name it in execution_contexts or exec_cxt.periodic.type.

PeriodicExecutionContext has a thread of its own, which runs svc(): a class may replace it by a loop that calls invokeWorkerPreDo(),
invokeWorkerDo() and invokeWorkerPostDo() while threadRunning(). ExtTrigExecutionContext makes a cycle for each tick().
ExecutionContextBase has no thread. The methods on... are called at the moments that their names say; what they return ends the operation
unless it is RTC.RTC_OK.
"""
import _openrtm_core as _core
import RTC

from .utility import TimeValue, _Factory

__all__ = ["ExecutionContextBase", "PeriodicExecutionContext", "ExtTrigExecutionContext", "ExecutionContextFactory", "ECDelete"]

_HOOKS = ("svc", "tick", "init", "onStarting", "onStarted", "onStopping", "onStopped", "onGetRate", "onSettingRate", "onSetRate",
          "onAddingComponent", "onAddedComponent", "onRemovingComponent", "onRemovedComponent", "onActivating", "onWaitingActivated",
          "onActivated", "onDeactivating", "onWaitingDeactivated", "onDeactivated", "onResetting", "onWaitingReset", "onReset")


def ECDelete(context):
    """The third argument of registerECFactory: the runtime destroys contexts itself."""


class _Context:
    def _this(self):
        return self.getObjRef()

    def setObjRef(self, reference):
        """Nothing to do: a context has its reference from the beginning."""

    def getPeriod(self):
        return TimeValue(self._period())

    @staticmethod
    def getStateString(state):
        return str(state)

    def getKindString(self, kind=None):
        return str(self.getKind() if kind is None else kind)

    # Of those that this package has itself, the runtime knows what they do.
    def _overridden(self):
        found = []
        for name in _HOOKS:
            owner = next((one for one in type(self).__mro__ if name in vars(one)), None)
            if owner is not None and not owner.__module__.startswith(("OpenRTM_aist", "_openrtm_core")):
                found.append(name)
        return found


def _answer(name, *parameters):
    def method(self, *args):
        return RTC.RTC_OK
    method.__name__ = name
    return method


for _name in _HOOKS[3:]:
    if _name not in ("onStarted", "onStopping", "onGetRate", "onSettingRate"):
        setattr(_Context, _name, _answer(_name))
_Context.onGetRate = _Context.onSettingRate = lambda self, rate: rate
del _name


class ExecutionContextBase(_core.PlainContext, _Context):
    def __init__(self, name=""):
        _core.PlainContext.__init__(self, name)
        self._bind(self, self._overridden())


class PeriodicExecutionContext(_core.PeriodicContext, _Context):
    def __init__(self, name=""):
        _core.PeriodicContext.__init__(self, name)
        self._bind(self, self._overridden())
        self._nowait = False


class ExtTrigExecutionContext(_core.ExtTrigContext, _Context):
    def __init__(self, name=""):
        _core.ExtTrigContext.__init__(self)
        self._bind(self, self._overridden())


class ExecutionContextFactory(_Factory):
    _add, _remove = staticmethod(_core.context_add_factory), staticmethod(_core.context_remove_factory)
    _identifiers = staticmethod(_core.context_identifiers)
