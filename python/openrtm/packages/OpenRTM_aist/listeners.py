"""Listeners of connectors and components, in both generations of their contracts."""
import omniORB
import _openrtm_core as _core
from omniORB import tcInternal as _tc

__all__ = ["ConnectorInfo", "ConnectorListenerStatus", "ConnectorDataListener", "ConnectorDataListenerT", "ConnectorListener",
           "ConnectorDataListenerType", "ConnectorListenerType", "PreComponentActionListenerType", "PostComponentActionListenerType",
           "PortActionListenerType", "ExecutionContextActionListenerType", "PortConnectListenerType", "PortConnectRetListenerType",
           "ConfigurationParamListenerType", "ConfigurationSetListenerType", "ConfigurationSetNameListenerType",
           "PreFsmActionListenerType", "PostFsmActionListenerType", "PreComponentActionListener", "PostComponentActionListener",
           "PortActionListener", "ExecutionContextActionListener", "PortConnectListener", "PortConnectRetListener",
           "ConfigurationParamListener", "ConfigurationSetListener", "ConfigurationSetNameListener", "PreFsmActionListener",
           "PostFsmActionListener", "FsmProfileListenerType", "FsmStructureListenerType", "FsmProfileListener", "FsmStructureListener", "ConnectorListenerHolder",
           "ConnectorDataListenerHolder", "PortType"]


class ConnectorInfo:
    def __init__(self, name, id_, ports, properties):
        self.name = name
        self.id = id_
        self.ports = ports
        self.properties = properties


class ConnectorListenerStatus:
    NO_CHANGE, INFO_CHANGED, DATA_CHANGED, BOTH_CHANGED = range(4)


class ConnectorDataListener(ConnectorListenerStatus):
    """__call__(info, octets): may return None, a status, or (status, octets)."""

    def __call__(self, info, cdrdata):
        pass


class ConnectorDataListenerT(ConnectorDataListener):
    """__call__(info, value): may return None, a status, or (status, value)."""

    # Sources for 1.2 decode by this call: the value has been decoded already.
    def __call__(self, info, cdrdata, data=None, porttype=None):
        if isinstance(cdrdata, (bytes, bytearray)) and data is not None:
            endian = info.properties.getProperty("serializer.cdr.endian", "little") if info is not None else "little"
            return omniORB.cdrUnmarshal(_tc.TypeCode(data._NP_RepositoryId), bytes(cdrdata), endian.split(",")[0].strip() != "big")
        return cdrdata


class ConnectorListener(ConnectorListenerStatus):
    """__call__(info): may return None or a status."""

    def __call__(self, info):
        pass


class PortType:
    OutPortType, InPortType = range(2)


class ConnectorListenerHolder:
    pass


ConnectorDataListenerHolder = ConnectorListenerHolder


def _numbered(class_name, words, prefix=""):
    """A class with a number for each word, and their count."""
    members = {prefix + word: number for number, word in enumerate(words.split())}
    names = tuple(members)
    members["toString"] = staticmethod(lambda number: names[number] if 0 <= number < len(names) else "")
    return type(class_name, (), members)


ConnectorDataListenerType = _numbered(
    "ConnectorDataListenerType", "ON_BUFFER_WRITE ON_BUFFER_FULL ON_BUFFER_WRITE_TIMEOUT ON_BUFFER_OVERWRITE ON_BUFFER_READ ON_SEND "
    "ON_RECEIVED ON_RECEIVER_FULL ON_RECEIVER_TIMEOUT ON_RECEIVER_ERROR CONNECTOR_DATA_LISTENER_NUM")
ConnectorListenerType = _numbered(
    "ConnectorListenerType", "ON_BUFFER_EMPTY ON_BUFFER_READ_TIMEOUT ON_SENDER_EMPTY ON_SENDER_TIMEOUT ON_SENDER_ERROR ON_CONNECT "
    "ON_DISCONNECT CONNECTOR_LISTENER_NUM")
_ACTIONS = "INITIALIZE FINALIZE STARTUP SHUTDOWN ACTIVATED DEACTIVATED ABORTING ERROR RESET EXECUTE STATE_UPDATE RATE_CHANGED"
PreComponentActionListenerType = _numbered("PreComponentActionListenerType", _ACTIONS, "PRE_ON_")
PostComponentActionListenerType = _numbered("PostComponentActionListenerType", _ACTIONS, "POST_ON_")
PortActionListenerType = _numbered("PortActionListenerType", "ADD_PORT REMOVE_PORT")
ExecutionContextActionListenerType = _numbered("ExecutionContextActionListenerType", "EC_ATTACHED EC_DETACHED")
PortConnectListenerType = _numbered("PortConnectListenerType", "ON_NOTIFY_CONNECT ON_NOTIFY_DISCONNECT ON_UNSUBSCRIBE_INTERFACES")
PortConnectRetListenerType = _numbered(
    "PortConnectRetListenerType", "ON_PUBLISH_INTERFACES ON_CONNECT_NEXTPORT ON_SUBSCRIBE_INTERFACES ON_CONNECTED ON_DISCONNECT_NEXT "
    "ON_DISCONNECTED")
ConfigurationParamListenerType = _numbered("ConfigurationParamListenerType", "ON_UPDATE_CONFIG_PARAM")
ConfigurationSetListenerType = _numbered("ConfigurationSetListenerType", "ON_SET_CONFIG_SET ON_ADD_CONFIG_SET")
ConfigurationSetNameListenerType = _numbered(
    "ConfigurationSetNameListenerType", "ON_UPDATE_CONFIG_SET ON_REMOVE_CONFIG_SET ON_ACTIVATE_CONFIG_SET")
_FSM = "INIT ENTRY DO EXIT STATE_CHANGE"
PreFsmActionListenerType = _numbered("PreFsmActionListenerType", _FSM, "PRE_ON_")
PostFsmActionListenerType = _numbered("PostFsmActionListenerType", _FSM, "POST_ON_")
FsmProfileListenerType = _numbered(
    "FsmProfileListenerType", "SET_FSM_PROFILE GET_FSM_PROFILE ADD_FSM_STATE REMOVE_FSM_STATE ADD_FSM_TRANSITION REMOVE_FSM_TRANSITION "
    "BIND_FSM_EVENT UNBIND_FSM_EVENT")
FsmStructureListenerType = _numbered("FsmStructureListenerType", "SET_FSM_STRUCTURE GET_FSM_STRUCTURE")


def _base(name):
    return type(name, (), {"__call__": lambda self, *args: None})


PreComponentActionListener = _base("PreComponentActionListener")
PostComponentActionListener = _base("PostComponentActionListener")
PortActionListener = _base("PortActionListener")
ExecutionContextActionListener = _base("ExecutionContextActionListener")
PortConnectListener = _base("PortConnectListener")
PortConnectRetListener = _base("PortConnectRetListener")
ConfigurationParamListener = _base("ConfigurationParamListener")
ConfigurationSetListener = _base("ConfigurationSetListener")
ConfigurationSetNameListener = _base("ConfigurationSetNameListener")
PreFsmActionListener = _base("PreFsmActionListener")
PostFsmActionListener = _base("PostFsmActionListener")
FsmProfileListener = _base("FsmProfileListener")
FsmStructureListener = _base("FsmStructureListener")


class _Registered:
    """What add... returns and remove... takes: calls the listener until it is removed."""

    def __init__(self, listener):
        self.listener = listener

    def __call__(self, *args):
        return None if self.listener is None else self.listener(*args)


def data_function(registered, descriptor):
    """The function for the runtime: (info, octets, is_little) -> status or (status, octets)."""

    def function(info, octets, is_little):
        listener = registered.listener
        if listener is None:
            return 0
        if not isinstance(listener, ConnectorDataListenerT):
            status, changed = _pair(listener(info, octets))
            return (status, bytes(changed)) if status >= 2 and changed is not None else status
        value = _core.cdr_unmarshal(descriptor, octets, is_little)
        status, changed = _pair(listener(info, value))
        if status < 2:
            return status
        return status, _core.cdr_marshal(descriptor, value if changed is None else changed, is_little)

    return function


def event_function(registered):
    def function(info):
        listener = registered.listener
        status = listener(info) if listener is not None else 0
        return status if isinstance(status, int) else 0

    return function


def _pair(result):
    if isinstance(result, tuple) and len(result) == 2:
        return int(result[0]), result[1]
    return (result, None) if isinstance(result, int) else (0, None)
