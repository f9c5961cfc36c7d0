"""Ports of components. Their inside is in C++ (_openrtm_core): buffers, connections, encoding."""
import _openrtm_core as _core
import omniORB
import RTC
from omniORB import CORBA as _CORBA, tcInternal as _tc

from .logger import Logger
from .listeners import _Registered, data_function as _data_function, event_function as _event_function

__all__ = ["PortBase", "InPortBase", "OutPortBase", "InPort", "OutPort", "CorbaPort", "CorbaConsumer", "CorbaConsumerBase",
           "setTimestamp", "instantiateDataType", "DataPortStatus", "BufferStatus", "RingBuffer", "OnRead", "OnWrite", "OnReadConvert",
           "OnWriteConvert", "ConnectionCallback"]


class DataPortStatus:
    (PORT_OK, PORT_ERROR, BUFFER_ERROR, BUFFER_FULL, BUFFER_EMPTY, BUFFER_TIMEOUT, SEND_FULL, SEND_TIMEOUT, RECV_EMPTY, RECV_TIMEOUT,
     INVALID_ARGS, PRECONDITION_NOT_MET, CONNECTION_LOST, UNKNOWN_ERROR) = range(14)

    @staticmethod
    def toString(status):
        return _STATUS_NAMES[status]


_STATUS_NAMES = [name for name in vars(DataPortStatus) if name.isupper()]


class BufferStatus:
    BUFFER_OK, BUFFER_ERROR, BUFFER_FULL, BUFFER_EMPTY, NOT_SUPPORTED, TIMEOUT, PRECONDITION_NOT_MET = range(7)


class RingBuffer:
    """Taken as an argument of ports: connections bring their own buffers."""

    def __init__(self, length=8):
        self._length = length

    def length(self, n=None):
        if n is not None:
            self._length = n
        return self._length


class _Connector:
    """A connection of a port as the original has it: with methods."""

    def __init__(self, info):
        self._info = info

    def profile(self):
        return self._info

    def id(self):
        return self._info.id

    def name(self):
        return self._info.name


class _Callback:
    def __call__(self, *args):
        return args[0] if args else None


class OnRead(_Callback):
    pass


class OnWrite(_Callback):
    pass


class OnReadConvert(_Callback):
    pass


class OnWriteConvert(_Callback):
    pass


class ConnectionCallback(_Callback):
    pass


class PortBase:
    """What all ports have. Operations of the port's CORBA object are called through its reference."""

    def getPortRef(self):
        return self._reference()

    _this = getPortRef

    def getProfile(self):
        return self._reference().get_port_profile()

    get_port_profile = getPortProfile = getProfile

    @property
    def _profile(self):
        return self.getProfile()

    @property
    def _properties(self):
        return self.properties()

    @property
    def _objref(self):
        return self._reference()

    @property
    def _rtcout(self):
        return Logger(self.getName())

    def get_connector_profiles(self):
        return self._reference().get_connector_profiles()

    def get_connector_profile(self, connector_id):
        return self._reference().get_connector_profile(connector_id)

    def connect(self, profile):
        return self._reference().connect(profile)

    def disconnect_all(self):
        return self._reference().disconnect_all()

    def deactivate(self):
        self._deactivate()

    def setOnPublishInterfaces(self, function):
        self._on_connection(0, function)

    def setOnSubscribeInterfaces(self, function):
        self._on_connection(1, function)

    def setOnConnected(self, function):
        self._on_connection(2, function)

    def setOnUnsubscribeInterfaces(self, function):
        self._on_connection(3, function)

    def setOnDisconnected(self, function):
        self._on_connection(4, function)

    def setOnConnectionLost(self, function):
        self._on_connection(5, function)


class _DataPort(PortBase):
    def name(self):
        return self._name

    def getConnectorProfiles(self):
        return self._connectors

    def connectors(self):
        return [_Connector(one) for one in self._connectors]

    def getConnectorIds(self):
        return [one.id for one in self._connectors]

    def getConnectorNames(self):
        return [one.name for one in self._connectors]

    def isExistingConnection(self):
        return bool(self._connectors)

    def getConnectorById(self, id_):
        return next((one for one in self.connectors() if one.id() == id_), None)

    def getConnectorByName(self, name):
        return next((one for one in self.connectors() if one.name() == name), None)

    def addConnectorDataListener(self, type_, listener, autoclean=True):
        """Call the listener at events of samples. Returns what removeConnectorDataListener takes."""
        registered = _Registered(listener)
        self._add_data_listener(type_, _data_function(registered, self._descriptor()))
        self._registered.append(registered)
        return registered

    def addConnectorListener(self, type_, listener, autoclean=True):
        registered = _Registered(listener)
        self._add_listener(type_, _event_function(registered))
        self._registered.append(registered)
        return registered

    def removeConnectorDataListener(self, type_, listener):
        self._remove(listener)

    def removeConnectorListener(self, type_, listener):
        self._remove(listener)

    def _remove(self, listener):
        if isinstance(listener, _Registered):
            listener.listener = None
        for one in self._registered:
            if one.listener is listener:
                one.listener = None

    def getPortDataType(self):
        return self._type_id()


class InPort(_core.InPort, _DataPort):
    """A port that receives values of the type of `value`."""

    def __init__(self, name, value, buffer=None, read_block=False, write_block=False, read_timeout=0, write_timeout=0):
        _core.InPort.__init__(self, name, value)
        self._name = name
        self._on_read = self._on_read_convert = None
        self._registered = []

    @property
    def _connectors(self):
        return _core.InPortBase._connectors(self)

    def read(self, name=None):
        """The oldest unread value as a new object; the last one again if there is no new one."""
        if self._on_read is not None:
            self._on_read()
        value = self._read(name or "")
        if self._on_read_convert is not None:
            value = self._on_read_convert(value)
        return value

    def update(self):
        self.read()

    def isEmpty(self, names=None):
        return not self.isNew(names)

    def write(self, data):
        raise NotImplementedError("an InPort is written by its connections")

    def setOnRead(self, function):
        self._on_read = function

    def setOnReadConvert(self, function):
        self._on_read_convert = function


class OutPort(_core.OutPort, _DataPort):
    """A port that sends values of the type of `value`."""

    def __init__(self, name, value, buffer=None):
        _core.OutPort.__init__(self, name, value)
        self._name = name
        self._on_write = self._on_write_convert = None
        self._registered = []

    @property
    def _connectors(self):
        return _core.OutPort._connectors(self)

    def write(self, value=None):
        """Send the value, or the one of the constructor. False: no connection, one of them failed, or the value does not fit."""
        if self._on_write is None and self._on_write_convert is None:
            return self._write(value)
        if not value:
            value = self._value
        if self._on_write is not None:
            self._on_write(value)
        if self._on_write_convert is not None:
            value = self._on_write_convert(value)
        return self._write(value)

    def getStatusList(self):
        return self._statuses()

    def getStatus(self, index):
        return self._statuses()[index]

    def setOnWrite(self, function):
        self._on_write = function

    def setOnWriteConvert(self, function):
        self._on_write_convert = function


InPortBase = InPort
OutPortBase = OutPort


def setTimestamp(data):
    """Write the time of the clock in force: simulated time in simulated contexts."""
    tm = data.tm
    if tm is None:  # the templates of 1.x begin with None in all members
        tm = data.tm = RTC.Time(0, 0)
    tm.sec, tm.nsec = _core.current_time()


# --- service ports

class CorbaPort(_core.CorbaPort, PortBase):
    """A port of service interfaces: providers, which others call, and consumers, which call others."""

    def __init__(self, name):
        _core.CorbaPort.__init__(self, name)
        self._name = name
        self._providers = []
        self._consumers = []

    def registerProvider(self, instance_name, type_name, provider):
        self._providers.append(provider)
        return self._register_provider(instance_name, type_name, provider._core_servant())

    def registerConsumer(self, instance_name, type_name, consumer):
        self._consumers.append(consumer)
        return self._register_consumer(instance_name, type_name, consumer._take, consumer.releaseObject)


class CorbaConsumer:
    """The place where a component calls a service of another one: None until a connection brings the reference."""

    def __init__(self, interfaceType=None, consumer=None):
        if consumer is not None:
            self._interface = consumer._interface
            self._object, self._servant = consumer._object, consumer._servant
            return
        self._interface = interfaceType
        self._object = self._servant = None

    def setObject(self, obj):
        if obj is None:
            return False
        own = obj._as(type(obj))
        own._obj = obj._obj.with_timeout()
        return self._take(own)

    def _take(self, obj):
        if obj is None:
            return False
        narrowed = obj
        if self._interface is not None:
            try:
                narrowed = obj._narrow(self._interface)
            except _CORBA.OBJECT_NOT_EXIST:  # a provider that is not active yet cannot say what it is
                narrowed = obj._unchecked_narrow(self._interface)
            except _CORBA.SystemException:
                return False
            if narrowed is None:
                return False
        self._object = narrowed
        self._servant = narrowed._obj.local_servant()
        return True

    def getObject(self):
        return self._object

    def releaseObject(self):
        self._object = self._servant = None

    def setIOR(self, text):
        """Connect to the object of an IOR."""
        return self.setObject(_CORBA.ORB_init().string_to_object(text))

    def equals(self, other):
        return self._object is not None and other is not None and self._object._is_equivalent(other._object)

    def _ptr(self, get_ref=False):
        """The servant itself if it is in this process (get_ref: the stub all the same), else a stub; None if not connected."""
        return self._object if get_ref or self._servant is None else self._servant

    def __call__(self):
        return self._ptr()


CorbaConsumerBase = CorbaConsumer


# --- default values

_ZERO = {_tc.tv_short: 0, _tc.tv_long: 0, _tc.tv_ushort: 0, _tc.tv_ulong: 0, _tc.tv_longlong: 0, _tc.tv_octet: 0, _tc.tv_boolean: 0,
         _tc.tv_char: 0, _tc.tv_float: 0.0, _tc.tv_double: 0.0, _tc.tv_wchar: 0}


def instantiateDataType(type_):
    """A value of an IDL type: numbers 0, texts "", sequences []."""
    descriptor = _tc.descriptor(type_)
    return _instantiate(descriptor)


def _instantiate(descriptor):
    if not isinstance(descriptor, tuple):
        return _ZERO.get(descriptor)
    kind = descriptor[0]
    if kind == _tc.tv__indirect:
        return None
    if kind in (_tc.tv_string, _tc.tv_wstring):
        return ""
    if kind in (_tc.tv_sequence, _tc.tv_array):
        return []
    if kind == _tc.tv_enum:
        return 0
    if kind == _tc.tv_alias:
        return _instantiate(descriptor[3])
    if kind in (_tc.tv_struct, _tc.tv_except):
        return descriptor[1](*[_instantiate(one) for one in descriptor[5::2]])
    return None
