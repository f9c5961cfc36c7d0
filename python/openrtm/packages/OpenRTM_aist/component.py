"""The base class of components."""
import _openrtm_core as _core
import RTC

from .listeners import _Registered
from .logger import Logger
from .ports import InPort, OutPort, CorbaPort
from . import StringUtil

__all__ = ["DataFlowComponentBase", "RTObject_impl", "ConfigAdmin", "Configuration"]


# Operations of the component's CORBA object that are called through its reference.
_REMOTE = ("get_component_profile", "get_ports", "get_owned_contexts", "get_participating_contexts", "get_context", "get_context_handle",
           "attach_context", "detach_context", "is_alive", "get_owned_organizations", "get_sdo_id", "get_sdo_type", "get_device_profile",
           "get_service_profiles", "get_service_profile", "get_sdo_service", "get_configuration", "get_monitoring", "get_organizations",
           "get_status_list", "get_status")


class ConfigAdmin:
    """The configuration sets of a component."""

    def __init__(self, component):
        self._component = component

    def update(self, config_set=None, config_param=None):
        self._component._rtm_config_update(config_set or "", config_param or "")

    def isExist(self, name):
        return self._component._rtm_config_has_parameter(name)

    def unbindParameter(self, name):
        return self._component._rtm_config_unbind(name)

    def isChanged(self):
        return self._component._rtm_config_is_changed()

    def changedParameters(self):
        return []

    def getActiveId(self):
        return self._component._rtm_config_active_id()

    def haveConfig(self, config_id):
        return self._component._rtm_config_have(config_id)

    def isActive(self):
        return self._component._rtm_config_is_active()

    def getConfigurationSets(self):
        return self._component._rtm_config_sets()

    def getConfigurationSet(self, config_id):
        return self._component._rtm_config_set(config_id)

    def getActiveConfigurationSet(self):
        return self._component._rtm_config_set(self.getActiveId())

    def setConfigurationSetValues(self, config_set):
        return self._component._rtm_config_set_values(config_set)

    def addConfigurationSet(self, config_set):
        return self._component._rtm_config_add(config_set)

    def removeConfigurationSet(self, config_id):
        return self._component._rtm_config_remove(config_id)

    def activateConfigurationSet(self, config_id):
        return self._component._rtm_config_activate(config_id)

    def bindParameter(self, name, var, default, trans=None):
        return self._component.bindParameter(name, var, default, trans)

    def addConfigurationParamListener(self, type_, listener, autoclean=True):
        return self._component.addConfigurationParamListener(type_, listener)

    def removeConfigurationParamListener(self, type_, listener):
        self._component.removeConfigurationParamListener(type_, listener)

    def addConfigurationSetListener(self, type_, listener, autoclean=True):
        return self._component.addConfigurationSetListener(type_, listener)

    def removeConfigurationSetListener(self, type_, listener):
        self._component.removeConfigurationSetListener(type_, listener)

    def addConfigurationSetNameListener(self, type_, listener, autoclean=True):
        return self._component.addConfigurationSetNameListener(type_, listener)

    def removeConfigurationSetNameListener(self, type_, listener):
        self._component.removeConfigurationSetNameListener(type_, listener)

    def setOnUpdate(self, function):
        self._component._rtm_add_listener(8, 0, function)

    def setOnUpdateParam(self, function):
        self._component._rtm_add_listener(6, 0, function)

    def setOnSetConfigurationSet(self, function):
        self._component._rtm_add_listener(7, 0, function)

    def setOnAddConfigurationSet(self, function):
        self._component._rtm_add_listener(7, 1, function)

    def setOnRemoveConfigurationSet(self, function):
        self._component._rtm_add_listener(8, 1, function)

    def setOnActivateSet(self, function):
        self._component._rtm_add_listener(8, 2, function)


Configuration = ConfigAdmin


class _Made:
    """An attribute that is created at each access. A stored object that refers to its component would be a reference cycle, which keeps
    both in memory. An author's attribute of the same name replaces it."""

    def __init__(self, function):
        self._function = function

    def __get__(self, owner, cls=None):
        return self if owner is None else self._function(owner)


class DataFlowComponentBase(_core.Component):
    """The base of components. Names that begin with _rtm_ belong to it; all others are free for authors, except those of OpenRTM."""

    def __init__(self, manager=None, orb=None, poa=None):
        _core.Component.__init__(self)
        self._rtm_bind_self(self)
        self._manager = manager
        self._rtm_ports = []
        self._inports = []
        self._outports = []
        self._rtcout = Logger("rtobject")
        self._rtm_registered = []
        for name in ("onDeactivate", "onActivate", "onExcute"):
            if hasattr(type(self), name):
                self._rtcout.RTC_WARN("%s.%s is never called; the callbacks are onActivated, onDeactivated, onExecute",
                                      (type(self).__name__, name))

    # --- callbacks

    def onInitialize(self):
        return RTC.RTC_OK

    def onFinalize(self):
        return RTC.RTC_OK

    def onStartup(self, ec_id):
        return RTC.RTC_OK

    def onShutdown(self, ec_id):
        return RTC.RTC_OK

    def onActivated(self, ec_id):
        return RTC.RTC_OK

    def onDeactivated(self, ec_id):
        return RTC.RTC_OK

    def onExecute(self, ec_id):
        return RTC.RTC_OK

    def onAborting(self, ec_id):
        return RTC.RTC_OK

    def onError(self, ec_id):
        return RTC.RTC_OK

    def onReset(self, ec_id):
        return RTC.RTC_OK

    def onStateUpdate(self, ec_id):
        return RTC.RTC_OK

    def onRateChanged(self, ec_id):
        return RTC.RTC_OK

    def onAction(self, ec_id):
        return RTC.RTC_OK

    # --- ports

    def addInPort(self, name, port):
        added = self._rtm_add_in_port(name, port) if isinstance(port, _core.InPortBase) else self._rtm_add_channel(port)
        if added:
            self._rtm_ports.append(port)
            self._inports.append(port)
        return added

    def addOutPort(self, name, port):
        added = self._rtm_add_out_port(name, port) if isinstance(port, _core.OutPort) else self._rtm_add_channel(port)
        if added:
            self._rtm_ports.append(port)
            self._outports.append(port)
        return added

    def addPort(self, port):
        added = self._rtm_add_port(port)
        if added:
            self._rtm_ports.append(port)
        return added

    # A CSP port, whose settings are those of the component's port.
    def _rtm_add_channel(self, port):
        kind = "inport" if hasattr(port, "readData") else "outport"
        for key in ("port." + kind, "port.%s.%s" % (kind, port.name())):
            port.init(self._rtm_properties_of().getNode(key))
        return self._rtm_add_port(port)

    registerInPort = addInPort
    registerOutPort = addOutPort
    registerPort = addPort

    def removePort(self, port):
        removed = self._rtm_remove_port(port)
        for one in (self._rtm_ports, self._inports, self._outports):
            if port in one:
                one.remove(port)
        return removed

    removeInPort = removeOutPort = deletePort = removePort

    def deletePortByName(self, name):
        for port in list(self._rtm_ports):
            if port.getName().rpartition(".")[2] == name or port.getName() == name:
                self.removePort(port)

    def getInPorts(self):
        return list(self._inports)

    def getOutPorts(self):
        return list(self._outports)

    # --- configuration

    def bindParameter(self, param_name, var, def_val, trans=None):
        """Bind var[0] to a parameter: it is replaced when the active configuration set changes. Its type decides the conversion."""
        self._rtm_bind_parameter(param_name, def_val, _assignment(var, trans))
        return True

    def updateParameters(self, config_set):
        self._rtm_config_update(config_set, "")

    def getConfigService(self):
        return ConfigAdmin(self)

    # --- identity

    def getProperties(self):
        return self._rtm_properties_of()

    @_Made
    def _properties(self):
        return self._rtm_properties_of()

    @_Made
    def _configsets(self):
        return ConfigAdmin(self)

    def getObjRef(self):
        return self._rtm_reference()

    _this = getObjRef

    @_Made
    def _SdoConfigImpl(self):
        return self.get_configuration()

    @_Made
    def _profile(self):
        return self.get_component_profile()

    def getManager(self):
        return self._manager

    @_Made
    def _objref(self):
        return self._rtm_reference()

    @_Made
    def _orb(self):
        from omniORB import CORBA
        return CORBA.ORB_init()

    @_Made
    def _poa(self):
        from omniORB import PortableServer
        return PortableServer.root_poa()

    def _default_POA(self):
        from omniORB import PortableServer
        return PortableServer.root_poa()

    # The runtime calls it when it has let the component go. Listeners may refer to it.
    def _rtm_let_go(self):
        for registered in [self._rtm_registered] + [getattr(port, "_registered", ()) for port in self._rtm_ports]:
            for one in registered:
                one.listener = None

    # --- listeners: (type, function) -> what remove... takes

    def _rtm_listen(self, group, type_, listener):
        registered = _Registered(listener)
        self._rtm_add_listener(group, type_, registered)
        self._rtm_registered.append(registered)
        return registered

    # Of state machines of Python, whose service is written in Python, too.
    def addFsmProfileListener(self, type_, listener, autoclean=True):
        """BIND_FSM_EVENT: listener(RTC.FsmEventProfile) when a port binds an event."""
        return self._rtm_listen_in_python("profile", type_, listener)

    def addFsmStructureListener(self, type_, listener, autoclean=True):
        """listener(RTC.FsmStructure) when a tool sets or asks for the structure of the state machine."""
        return self._rtm_listen_in_python("structure", type_, listener)

    def _rtm_listen_in_python(self, kind, type_, listener):
        registered = _Registered(listener)
        registered.event = (kind, type_)
        self._rtm_registered.append(registered)
        return registered

    def _rtm_tell_listeners(self, kind, type_, value):
        for one in list(self._rtm_registered):
            if getattr(one, "event", None) == (kind, type_):
                try:
                    one(value)
                except Exception:
                    Logger(self.getInstanceName()).RTC_ERROR("a listener of the state machine raised: %s", Logger.print_exception())

    def _rtm_forget(self, type_, listener):
        for one in self._rtm_registered:
            if one is listener or one.listener is listener:
                one.listener = None


def _assignment(var, trans):
    """The function that takes the text of a parameter: in both forms of trans."""

    def assign(text):
        if trans is None or trans is StringUtil.stringTo:
            return StringUtil.stringTo(var, text)
        try:
            result = trans(var[0], text)  # 2.x: (ok, value)
            if isinstance(result, tuple) and len(result) == 2:
                if result[0]:
                    var[0] = result[1]
                return bool(result[0])
        except Exception:
            pass
        return bool(trans(var, text))  # 1.2: writes var[0]

    return assign


def _remote(name):
    def call(self, *args):
        return getattr(self._rtm_reference(), name)(*args)
    call.__name__ = name
    return call


for _name in _REMOTE:
    setattr(DataFlowComponentBase, _name, _remote(_name))

_GROUPS = ("PreComponentActionListener", "PostComponentActionListener", "PortActionListener", "ExecutionContextActionListener",
           "PortConnectListener", "PortConnectRetListener", "ConfigurationParamListener", "ConfigurationSetListener",
           "ConfigurationSetNameListener", "PreFsmActionListener", "PostFsmActionListener")


def _adder(group):
    def add(self, type_, listener, autoclean=True):
        return self._rtm_listen(group, type_, listener)
    return add


for _number, _name in enumerate(_GROUPS):
    setattr(DataFlowComponentBase, "add" + _name, _adder(_number))
    setattr(DataFlowComponentBase, "remove" + _name, DataFlowComponentBase._rtm_forget)
for _name in ("FsmProfileListener", "FsmStructureListener"):
    setattr(DataFlowComponentBase, "remove" + _name, DataFlowComponentBase._rtm_forget)
del _name, _number

RTObject_impl = DataFlowComponentBase
