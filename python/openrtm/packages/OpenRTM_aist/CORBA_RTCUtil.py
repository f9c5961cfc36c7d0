"""Connects, activates and inspects components by their references."""
import OpenRTM_aist
import RTC
from omniORB import CORBA, any as _any

from . import NVUtil


def _ok(code):
    return code == RTC.RTC_OK


def get_component_profile(rtc):
    properties = OpenRTM_aist.Properties()
    if not CORBA.is_nil(rtc):
        NVUtil.copyToProperties(properties, rtc.get_component_profile().properties)
    return properties


def is_existing(rtc):
    try:
        return not rtc._non_existent()
    except CORBA.SystemException:
        return False


def get_actual_ec(rtc, ec_id=0):
    """The context: 0.. are the component's own, 1000.. those it takes part in."""
    contexts = rtc.get_owned_contexts() if ec_id < 1000 else rtc.get_participating_contexts()
    at = ec_id % 1000
    return contexts[at] if at < len(contexts) else None


def get_ec_id(rtc, ec):
    for base, contexts in ((0, rtc.get_owned_contexts()), (1000, rtc.get_participating_contexts())):
        for number, one in enumerate(contexts):
            if one is not None and one._is_equivalent(ec):
                return base + number
    return -1


def is_alive_in_default_ec(rtc):
    ec = get_actual_ec(rtc)
    return ec is not None and rtc.is_alive(ec)


def _change(operation, rtc, ec_id):
    if CORBA.is_nil(rtc):
        return RTC.BAD_PARAMETER
    ec = get_actual_ec(rtc, ec_id)
    return RTC.BAD_PARAMETER if ec is None else getattr(ec, operation)(rtc)


def activate(rtc, ec_id=0):
    return _change("activate_component", rtc, ec_id)


def deactivate(rtc, ec_id=0):
    return _change("deactivate_component", rtc, ec_id)


def reset(rtc, ec_id=0):
    return _change("reset_component", rtc, ec_id)


def get_state(rtc, ec_id=0, *more):
    """(True, state), or (False, CREATED_STATE). The form of 1.x, get_state(list, rtc, ec_id), puts the state into the list."""
    if isinstance(rtc, list):
        is_known, state = get_state(ec_id, *more)
        rtc[:] = [state]
        return is_known
    ec = None if CORBA.is_nil(rtc) else get_actual_ec(rtc, ec_id)
    return (False, RTC.CREATED_STATE) if ec is None else (True, ec.get_component_state(rtc))


def is_in_inactive(rtc, ec_id=0):
    return get_state(rtc, ec_id) == (True, RTC.INACTIVE_STATE)


def is_in_active(rtc, ec_id=0):
    return get_state(rtc, ec_id) == (True, RTC.ACTIVE_STATE)


def is_in_error(rtc, ec_id=0):
    return get_state(rtc, ec_id) == (True, RTC.ERROR_STATE)


def get_default_rate(rtc):
    return get_current_rate(rtc, 0)


def set_default_rate(rtc, rate):
    return set_current_rate(rtc, 0, rate)


def get_current_rate(rtc, ec_id):
    ec = get_actual_ec(rtc, ec_id)
    return -1.0 if ec is None else ec.get_rate()


def set_current_rate(rtc, ec_id, rate):
    ec = get_actual_ec(rtc, ec_id)
    return RTC.BAD_PARAMETER if ec is None else ec.set_rate(rate)


def add_rtc_to_default_ec(localcomp, othercomp):
    ec = get_actual_ec(localcomp)
    return RTC.BAD_PARAMETER if ec is None else ec.add_component(othercomp)


def remove_rtc_to_default_ec(localcomp, othercomp):
    ec = get_actual_ec(localcomp)
    return RTC.BAD_PARAMETER if ec is None else ec.remove_component(othercomp)


def get_participants_rtc(rtc):
    ec = get_actual_ec(rtc)
    return [] if ec is None else ec.get_profile().participants


def get_port_names(rtc):
    return [port.get_port_profile().name for port in rtc.get_ports()]


def _names_by_type(rtc, type_):
    return [profile.name for profile in (port.get_port_profile() for port in rtc.get_ports())
            if NVUtil.toString(profile.properties, "port.port_type") == type_]


def get_inport_names(rtc):
    return _names_by_type(rtc, "DataInPort")


def get_outport_names(rtc):
    return _names_by_type(rtc, "DataOutPort")


def get_svcport_names(rtc):
    return _names_by_type(rtc, "CorbaPort")


def get_port_by_name(rtc, name):
    """The port of that name, with or without the component's; None if there is none."""
    if CORBA.is_nil(rtc):
        return None
    for port in rtc.get_ports():
        full = port.get_port_profile().name
        if full == name or full.rpartition(".")[2] == name:
            return port
    return None


def get_connector_names(port):
    return [] if CORBA.is_nil(port) else [one.name for one in port.get_connector_profiles()]


get_connector_names_by_portref = get_connector_names


def get_connector_ids(port):
    return [] if CORBA.is_nil(port) else [one.connector_id for one in port.get_connector_profiles()]


get_connector_ids_by_portref = get_connector_ids


def get_connector_names_by_portname(rtc, port_name):
    return get_connector_names(get_port_by_name(rtc, port_name))


def get_connector_ids_by_portname(rtc, port_name):
    return get_connector_ids(get_port_by_name(rtc, port_name))


def find_port(rtc, name):
    """As get_port_by_name."""
    return get_port_by_name(rtc, name)


def get_port_by_url(port_url):
    """INSTANCE.PORT of this process's manager, or rtcname://..., rtcloc://... with .PORT at its end; None if there is none."""
    path, slash, last = port_url.rpartition("/")
    name, dot, port = last.partition(".") if slash else last.rpartition(".")
    if slash and port.startswith("rtc."):
        name, port = name + ".rtc", port[len("rtc."):]
    found = OpenRTM_aist.Manager.instance().getNaming().string_to_component(path + slash + name) if dot else []
    return get_port_by_name(found[0], port) if found else None


def create_connector(name, prop_arg, port0, port1):
    properties = OpenRTM_aist.Properties(prop=prop_arg)
    for key, value in (("dataport.dataflow_type", "push"), ("dataport.interface_type", "corba_cdr"),
                       ("dataport.subscription_type", "flush")):
        if not properties.getProperty(key):
            properties.setProperty(key, value)
    nvs = []
    NVUtil.copyFromProperties(nvs, properties)
    return RTC.ConnectorProfile(name, "", [one for one in (port0, port1) if one is not None], nvs)


def already_connected(localport, otherport):
    return any(one._is_equivalent(otherport) for profile in localport.get_connector_profiles() for one in profile.ports)


def connect(name, prop, port0, port1):
    if CORBA.is_nil(port0) or CORBA.is_nil(port1) or port0._is_equivalent(port1):
        return RTC.BAD_PARAMETER
    code, _ = port0.connect(create_connector(name, prop, port0, port1))
    return code


def connect_multi(name, prop, port, target_ports):
    codes = [connect(name, prop, port, one) for one in target_ports]
    return next((one for one in codes if not _ok(one)), RTC.RTC_OK)


def connect_by_name(name, prop, rtc0, portName0, rtc1, portName1):
    return connect(name, prop, get_port_by_name(rtc0, portName0), get_port_by_name(rtc1, portName1))


def disconnect(connector_prof):
    ports = connector_prof.ports
    return RTC.BAD_PARAMETER if not ports else ports[0].disconnect(connector_prof.connector_id)


def disconnect_by_connector_name(port, name):
    for one in port.get_connector_profiles():
        if one.name == name:
            return disconnect(one)
    return RTC.BAD_PARAMETER


disconnect_by_portref_connector_name = disconnect_by_connector_name


def disconnect_by_portname_connector_name(port_name, name):
    port = get_port_by_url(port_name)
    return RTC.BAD_PARAMETER if port is None else disconnect_by_connector_name(port, name)


def disconnect_by_connector_id(port, id_):
    return port.disconnect(id_)


disconnect_by_portref_connector_id = disconnect_by_connector_id


def disconnect_by_portname_connector_id(port_name, id_):
    port = get_port_by_url(port_name)
    return RTC.BAD_PARAMETER if port is None else port.disconnect(id_)


def disconnect_all_by_ref(port):
    return port.disconnect_all()


disconnect_all_by_portref = disconnect_all_by_ref


def disconnect_all_by_name(rtc, name):
    port = get_port_by_name(rtc, name)
    return RTC.BAD_PARAMETER if port is None else port.disconnect_all()


def get_configuration(rtc, conf_name):
    properties = OpenRTM_aist.Properties()
    NVUtil.copyToProperties(properties, rtc.get_configuration().get_configuration_set(conf_name).configuration_data)
    return properties


def get_parameter_by_key(rtc, confset_name, value_name):
    return get_configuration(rtc, confset_name).getProperty(value_name)


def get_active_configuration_name(rtc):
    return rtc.get_configuration().get_active_configuration_set().id


get_current_configuration_name = get_active_configuration_name


def get_active_configuration(rtc):
    properties = OpenRTM_aist.Properties()
    NVUtil.copyToProperties(properties, rtc.get_configuration().get_active_configuration_set().configuration_data)
    return properties


def set_configuration(rtc, confset_name, value_name, value):
    service = rtc.get_configuration()
    set_ = service.get_configuration_set(confset_name)
    NVUtil.setValue(set_.configuration_data, value_name, _any.to_any(value))
    done = service.set_configuration_set_values(set_)
    return done and service.activate_configuration_set(confset_name)


def set_active_configuration(rtc, value_name, value):
    return set_configuration(rtc, get_active_configuration_name(rtc), value_name, value)
