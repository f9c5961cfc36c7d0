"""The kind of a component, by its reference. Each function asks the object, and raises the system exception when it does not answer."""
import RTC
from omniORB import CORBA

from .ports import instantiateDataType  # noqa: F401: a name of this file


def _is(obj, interface):
    return not CORBA.is_nil(obj) and obj._narrow(interface) is not None


def isDataFlowComponent(obj):
    return _is(obj, RTC.DataFlowComponent)


def isFsmParticipant(obj):
    return _is(obj, RTC.FsmParticipant)


def isFsmObject(obj):
    return _is(obj, RTC.FsmObject)


def isMultiModeObject(obj):
    return _is(obj, RTC.MultiModeObject)
