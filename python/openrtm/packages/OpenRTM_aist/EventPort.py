"""InPorts whose samples are events of a state machine (StaticFSM).

A connection names its event by the property dataport.fsm_event_name; without it the name of the connection counts. Events wait until the
component calls the machine's run_event().
"""
import _openrtm_core as _core
from omniORB import tcInternal as _tc

from .listeners import ConnectorDataListenerType, _Registered
from .ports import _DataPort
from .StaticFSM import Event

__all__ = ["EventInPort"]


def event_name(properties, connection_name):
    return properties.getProperty("fsm_event_name") or connection_name


class EventInPort(_core.EventPort, _DataPort):
    """A port of events for `fsm`, a StaticFSM.Machine. Samples of any type come in."""

    def __init__(self, name, fsm):
        _core.EventPort.__init__(self, name)
        self._name = name
        self._fsm = fsm
        self._registered = []

    @property
    def _connectors(self):
        return _core.InPortBase._connectors(self)

    def bindEvent0(self, name, handler):
        """The event calls the method of the current state that has the name of `handler`, a method of the top state."""
        self._bind(name, handler, None)

    def bindEvent1(self, name, handler, data_type):
        """The same, with the sample as argument. data_type: a value of its type."""
        self._bind(name, handler, _tc.TypeCode(data_type._NP_RepositoryId))

    def _bind(self, name, handler, type_):
        descriptor = None if type_ is None else _tc.descriptor(type_)
        service = getattr(self._fsm, "_service", None)
        if service is not None:
            service.add_event(name, "" if type_ is None else type_.id())

        def received(info, octets, is_little):
            if event_name(info.properties, info.name) == name:
                args = () if descriptor is None else (_core.cdr_unmarshal(descriptor, octets, is_little),)
                self._fsm.enqueue(Event(handler, *args))
            return 0

        self._registered.append(_Registered(received))
        self._add_data_listener(ConnectorDataListenerType.ON_RECEIVED, self._registered[-1])

    def _descriptor(self):
        raise TypeError("port %s takes samples of any type: its listeners must be ConnectorDataListener" % self._name)

    def getPortDataType(self):
        return "any"

    def read(self, name=None):
        return None
