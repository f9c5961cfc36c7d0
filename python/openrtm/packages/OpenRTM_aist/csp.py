"""CSP ports: a value goes over a connection when the sender has one and the receiver has room for it; each waits for the other.

Connections have dataport.interface_type csp_channel. The receiver has a buffer of buffer.length values (8); with 0 it takes a value only
while a reader waits. channel_timeout [s] (10) limits all waits; both are properties of the port or of a connection.

A sender offers its value first, then asks its receivers for room. A receiver says that it waits, then asks its senders for a value. So
neither can miss the other. put() and get() decide, what is_writable() and is_readable() say is a hint. A value is never taken by get()
while it is on its way by put(). No lock is held during a call of the peer; a peer that does not answer counts as one without room or value.
Any thread.
"""
import collections
import threading
import time

import _openrtm_core as _core
import CSP
import CSP__POA
import OpenRTM
from omniORB import CORBA as _CORBA, PortableServer as _PortableServer, tcInternal as _tc

from .listeners import _Registered
from .logger import Logger
from .ports import PortBase

__all__ = ["CSPInPort", "CSPOutPort"]

# How long a call of a peer waits for a value that this side has promised or is just sending [s].
_PROMISE = 5


class _Connection:
    def __init__(self, name, properties):
        self.name, self.properties = name, properties
        self.servant = self.peer = None


class _Servant:
    def __init__(self, port, connection):
        self._port, self._connection = port, connection


class _InServant(_Servant, CSP__POA.InPortCsp):
    def put(self, data):
        return self._port._put(self._connection, data)

    def is_writable(self, retry):
        return self._port._has_room()


class _OutServant(_Servant, CSP__POA.OutPortCsp):
    def get(self):
        return self._port._get()

    def is_readable(self, retry):
        return self._port._has_value()


class _ChannelPort(_core.ChannelPort, PortBase):
    """What both directions share. _channel is the condition under which their state changes."""

    def __init__(self, name, type_name, kind):
        self._registered = [_Registered(one) for one in (self._publish, self._subscribe, self._unsubscribe)]
        _core.ChannelPort.__init__(self, name, *self._registered)
        self._name = name
        self._channel = threading.Condition()
        self._connections = {}
        self._manager = None
        self._log = Logger("csp")
        self._complaint = _core.Complaint()
        for key, value in (("port.port_type", kind), ("dataport.data_type", type_name), ("dataport.interface_type", "csp_channel"),
                           ("dataport.dataflow_type", "duplex"), ("dataport.subscription_type", "flush")):
            self.addProperty(key, value)
        self._settings = {"channel_timeout": 10.0, "buffer.length": 8.0}

    def _complain(self, text):
        line = self._complaint.next("port %s: %s" % (self._name, text))
        if line:
            self._log.RTC_ERROR(line)

    def name(self):
        return self._name

    def init(self, prop):
        """Settings: channel_timeout [s], buffer.length."""
        for key in self._settings:
            text = prop.getProperty(key) or prop.getProperty("dataport." + key)
            if text:
                self._set(key, text)

    def setManager(self, manager):
        self._manager = manager
        if manager:
            self._enter(manager)

    def releaseManager(self):
        self._manager = None

    def connectors(self):
        return list(self._connections.values())

    # --- connections

    def _set(self, key, text):
        try:
            value = float(text)
            if value < 0:
                raise ValueError
            self._settings[key] = value
        except ValueError:
            self._log.RTC_ERROR("%s of port %s must be a number of at least 0, got '%s'", (key, self._name, text))

    def _publish(self, profile):
        values = {one.name: one.value.value() for one in profile.properties}
        kind = values.get("dataport.interface_type", "csp_channel")
        if kind != "csp_channel":
            self._log.RTC_WARN("connection rejected: port %s has the interface csp_channel, not %s", (self._name, kind))
            return None
        for key in self._settings:
            if isinstance(values.get("dataport." + key), str):
                self._set(key, values["dataport." + key])
        properties = {key[len("dataport."):]: value for key, value in values.items() if key.startswith("dataport.")}
        connection = _Connection(profile.name, properties)
        connection.servant = self._servant_class(self, connection)
        ior = _CORBA.ORB_init().object_to_string(connection.servant._this())
        with self._channel:
            self._connections = {**self._connections, profile.connector_id: connection}
        return [("dataport.corba_cdr.%s_ior" % self._own, ior)]

    def _subscribe(self, profile):
        connection = self._connections.get(profile.connector_id)
        ior = next((one.value.value() for one in profile.properties if one.name == "dataport.corba_cdr.%s_ior" % self._other), None)
        if connection is None or not ior:
            self._log.RTC_WARN("connection rejected: no other end for port %s in %s", (self._name, profile.name))
            return False
        peer = _CORBA.ORB_init().string_to_object(ior)._unchecked_narrow(self._peer_class)
        peer._obj = peer._obj.with_timeout()
        connection.peer = peer
        return True

    def _unsubscribe(self, id_):
        with self._channel:
            ended = self._connections.get(id_)
            self._connections = {key: value for key, value in self._connections.items() if key != id_}
            self._channel.notify_all()
        if ended is not None:
            adapter = _PortableServer.root_poa()
            adapter.deactivate_object(adapter.servant_to_id(ended.servant))

    # The answer of a peer; `failed` if there is none.
    def _ask(self, connection, operation, args, failed):
        if connection.peer is None:
            return failed
        try:
            return getattr(connection.peer, operation)(*args)
        except _CORBA.SystemException as problem:
            self._log.RTC_WARN("port %s: %s of the connection %s failed: %s", (self._name, operation, connection.name, problem))
            return failed


class _Receiver(_ChannelPort):
    """Takes items out of octets that senders have; _item(connection, octets) makes them."""
    _own, _other, _servant_class, _peer_class = "inport", "outport", _InServant, CSP.OutPortCsp

    def __init__(self, name, type_name, manager):
        _ChannelPort.__init__(self, name, type_name, "DataInPort")
        self._items = collections.deque()
        # While it asks senders, put() waits: the order of its value and the one that a sender offers would not be known.
        self._is_asking = self._has_refused = False
        self._wanted = 0  # readers that wait, and promises of the manager
        self._selected = []
        self._on_read = self._on_read_convert = None
        self.setManager(manager)

    def _enter(self, manager):
        manager.addInPort(self)

    def setOnRead(self, function):
        self._on_read = function

    def setOnReadConvert(self, function):
        self._on_read_convert = function

    def select(self):
        """Whether there is an item for readData()."""
        if not self._selected:
            found, item = self._pull()
            if found:
                self._selected.append(item)
        return bool(self._selected)

    def readData(self):
        """The item that select() or the manager has found."""
        if self._on_read is not None:
            self._on_read()
        found, item = (True, self._selected.pop()) if self._selected else self._take(promised=True)
        return self._converted(item) if found else self._otherwise()

    def read(self):
        """The next item; waits for it. None if time is up."""
        if self._on_read is not None:
            self._on_read()
        found, item = (True, self._selected.pop()) if self._selected else self._pull()
        if not found:
            found, item = self._take(promised=False)
        return self._converted(item) if found else None

    def _converted(self, item):
        return item if self._on_read_convert is None else self._on_read_convert(item)

    def _otherwise(self):
        return None

    # --- the sender calls

    def _limit(self):
        return int(self._settings["buffer.length"])

    # Under the condition.
    def _is_free(self):
        if self._is_asking:
            self._has_refused = True
            return False
        return len(self._items) < max(self._limit(), self._wanted)

    def _has_room(self):
        with self._channel:
            if self._is_free():
                return True
        if self._limit() == 0 and self._manager is not None and self._manager.notify(inport=self):
            with self._channel:
                self._wanted += 1
            return True
        return False

    def _put(self, connection, octets):
        try:
            item = self._item(connection, octets)
        except _CORBA.SystemException as problem:
            self._complain("a value of the connection %s cannot be decoded: %s" % (connection.name, problem))
            return OpenRTM.PORT_ERROR
        with self._channel:
            if not self._is_free():
                return OpenRTM.BUFFER_FULL
            self._items.append(item)
            self._channel.notify_all()
        if self._limit() > 0 and self._manager is not None:
            self._manager.notify(inport=self)
        return OpenRTM.PORT_OK

    # --- the reader calls

    # From the buffer, which then takes what a sender offers; else from a sender.
    def _pull(self):
        with self._channel:
            is_from_buffer = len(self._items) > 0
            item = self._items.popleft() if is_from_buffer else None
            asks = not is_from_buffer or self._limit() > 0
            self._is_asking = asks
        found, offered = self._ask_senders(is_from_buffer) if asks else (False, None)
        return (True, item) if is_from_buffer else (found, offered)

    # With _is_asking set, which it ends. A sender that was refused meanwhile has an offer now, so it is asked again.
    def _ask_senders(self, fills_buffer):
        end = time.monotonic() + self._settings["channel_timeout"]
        try:
            while True:
                found, item = self._fetch()
                with self._channel:
                    if not found and self._has_refused and time.monotonic() < end:
                        self._has_refused = False
                        continue
                    if found and fills_buffer:
                        self._items.append(item)
                    self._is_asking = self._has_refused = False
                    return found, item
        except BaseException:
            with self._channel:
                self._is_asking = False
            raise

    def _fetch(self):
        for connection in list(self._connections.values()):
            if not self._ask(connection, "is_readable", (False,), False):
                continue
            code, octets = self._ask(connection, "get", (), (None, None))
            if code == OpenRTM.PORT_OK:
                try:
                    return True, self._item(connection, octets)
                except _CORBA.SystemException as problem:
                    self._complain("a value of the connection %s cannot be decoded: %s" % (connection.name, problem))
        return False, None

    # Waits for an item: says so first, then asks once more.
    def _take(self, promised):
        found, item = False, None
        if not promised:
            with self._channel:
                self._wanted += 1
                if self._items:
                    found, item = True, self._items.popleft()
                self._is_asking = not found
            if not found:
                found, item = self._ask_senders(False)
        with self._channel:
            try:
                if found:
                    return True, item
                self._channel.wait_for(lambda: self._items, self._settings["channel_timeout"])
                return (True, self._items.popleft()) if self._items else (False, None)
            finally:
                self._wanted = max(self._wanted - 1, 0)


class CSPInPort(_Receiver):
    """A CSP port that receives values of the type of `value`."""

    def __init__(self, name, value, manager=None):
        self._value = value
        self._descriptor_of_type = _tc.descriptor(_tc.TypeCode(value._NP_RepositoryId))
        _Receiver.__init__(self, name, value._NP_RepositoryId, manager)

    def _item(self, connection, octets):
        return _core.cdr_unmarshal(self._descriptor_of_type, bytes(octets), connection.properties.get("serializer.cdr.endian") != "big")

    def _converted(self, item):
        self._value = item
        return _Receiver._converted(self, item)

    def _otherwise(self):
        return self._value


class CSPOutPort(_ChannelPort):
    """A CSP port that sends values of the type of `value`."""
    _own, _other, _servant_class, _peer_class = "outport", "inport", _OutServant, CSP.InPortCsp

    def __init__(self, name, value, manager=None):
        self._value = value
        self._descriptor_of_type = _tc.descriptor(_tc.TypeCode(value._NP_RepositoryId))
        _ChannelPort.__init__(self, name, value._NP_RepositoryId, "DataOutPort")
        self._offer = None  # octets that any receiver may take
        self._is_sending = False  # the offer is on its way to a receiver
        self._promised = 0  # receivers that the manager has chosen this port for
        self._on_write = self._on_write_convert = None
        self.setManager(manager)

    def _enter(self, manager):
        manager.addOutPort(self)

    def setOnWrite(self, function):
        self._on_write = function

    def setOnWriteConvert(self, function):
        self._on_write_convert = function

    def select(self):
        """Whether a receiver has room, or waits for writeData()."""
        if self._promised:
            return True
        return any(self._ask(one, "is_writable", (False,), False) for one in list(self._connections.values()))

    def write(self, value=None):
        """Send the value to the first receiver that has room; waits for one. False: no connection, time is up, or it does not fit."""
        value = self._value if value is None else value
        if self._on_write is not None:
            self._on_write(value)
        if self._on_write_convert is not None:
            value = self._on_write_convert(value)
        if not self._connections:
            return False
        try:
            octets = _core.cdr_marshal(self._descriptor_of_type, value, True)
        except _CORBA.SystemException as problem:
            self._complain("a value cannot be written: %s" % problem)
            return False
        return self._send(octets)

    writeData = write

    def _send(self, octets):
        end = time.monotonic() + self._settings["channel_timeout"]
        with self._channel:
            if not self._channel.wait_for(lambda: self._offer is None, self._settings["channel_timeout"]):
                return False
            self._offer = octets
            is_promised = self._promised > 0
            self._is_sending = not is_promised
            self._channel.notify_all()
        if not is_promised and self._push(octets):
            return True
        with self._channel:
            self._channel.wait_for(lambda: self._offer is not octets, max(end - time.monotonic(), 0))
            if self._offer is not octets:
                return True
            self._offer = None
            self._promised = 0
            self._channel.notify_all()
        self._log.RTC_ERROR("port %s: no receiver has taken the value within %g s", (self._name, self._settings["channel_timeout"]))
        return False

    # To a receiver that has room. While it lasts get() waits.
    def _push(self, octets):
        is_sent = False
        for connection in list(self._connections.values()):
            if (self._ask(connection, "is_writable", (False,), False)
                    and self._ask(connection, "put", (octets,), None) == OpenRTM.PORT_OK):
                is_sent = True
                break
        with self._channel:
            self._is_sending = False
            if is_sent:
                self._offer = None
            self._channel.notify_all()
        return is_sent

    # --- the receiver calls

    def _has_value(self):
        with self._channel:
            self._channel.wait_for(lambda: not self._is_sending, _PROMISE)
            if self._offer is not None and not self._is_sending:
                return True
        if self._manager is not None and self._manager.notify(outport=self):
            with self._channel:
                self._promised += 1
            return True
        return False

    def _get(self):
        with self._channel:
            self._channel.wait_for(lambda: not self._is_sending and (self._offer is not None or not self._promised), _PROMISE)
            self._promised = max(self._promised - 1, 0)
            if self._offer is None or self._is_sending:
                return OpenRTM.BUFFER_EMPTY, b""
            octets, self._offer = self._offer, None
            self._channel.notify_all()
            return OpenRTM.PORT_OK, octets
