"""CSP ports whose values are events of a state machine: what they read is called, which handles the event."""
import _openrtm_core as _core
from omniORB import tcInternal as _tc

from .StaticFSM import Event
from .csp import _Receiver
from .logger import Logger

__all__ = ["CSPEventPort"]


class CSPEventPort(_Receiver):
    """A port of events for `fsm`. A connection names its event by dataport.fsm_event_name; without it its own name counts."""

    def __init__(self, name, fsm=None, manager=None):
        self._fsm = fsm
        self._events = {}
        _Receiver.__init__(self, name, "any", manager)

    def bindEvent0(self, name, handler):
        self._events[name] = (handler, None)

    def bindEvent1(self, name, handler, data_type):
        self._events[name] = (handler, _tc.descriptor(_tc.TypeCode(data_type._NP_RepositoryId)))

    def _item(self, connection, octets):
        name = connection.properties.get("fsm_event_name") or connection.name
        if name not in self._events:
            Logger("csp").RTC_WARN("port %s has no event '%s'; it has %s", (self._name, name, ", ".join(sorted(self._events))))
            return _nothing
        handler, descriptor = self._events[name]
        is_little = connection.properties.get("serializer.cdr.endian") != "big"
        args = () if descriptor is None else (_core.cdr_unmarshal(descriptor, bytes(octets), is_little),)
        return lambda: self._fsm.dispatch(Event(handler, *args))

    def _otherwise(self):
        return _nothing


def _nothing():
    """What is called when there is no event."""
