"""A script outside of components: finds two by the name server, connects and activates them."""
import sys

import CosNaming
import OpenRTM_aist
import RTC
from omniORB import CORBA, any as any_, cdrMarshal, findTypeCode

import SDOPackage

orb = CORBA.ORB_init(sys.argv)
naming = OpenRTM_aist.CorbaNaming(orb, sys.argv[1])
counter = naming.resolve("Counter0.rtc")._narrow(RTC.RTObject)
printer = naming.resolve([CosNaming.NameComponent("Printer0", "rtc")])._narrow(RTC.RTObject)
try:
    naming.resolve("Nothing0.rtc")
except CosNaming.NamingContext.NotFound as problem:
    print("not found", problem.why, problem.rest_of_name[0].id)
print([one.binding_name[0].id for one in naming.list()])

ports = [counter.get_ports()[0], printer.get_ports()[0]]
profile = RTC.ConnectorProfile("connector0", "", ports, [
    SDOPackage.NameValue("dataport.interface_type", any_.to_any("corba_cdr")),
    SDOPackage.NameValue("dataport.dataflow_type", any_.to_any("push")),
    SDOPackage.NameValue("dataport.subscription_type", any_.to_any("flush"))])
code, connected = ports[0].connect(profile)
print("connect", code, code == RTC.RTC_OK, connected.name)
print("profile", counter.get_component_profile().type_name, OpenRTM_aist.NVUtil.toString(ports[0].get_port_profile().properties, "dataport.data_type"))
for one in (counter, printer):
    context = one.get_owned_contexts()[0]
    print("activate", context.activate_component(one), context.get_profile().rate)
print("active", OpenRTM_aist.CORBA_RTCUtil.is_in_active(printer) or OpenRTM_aist.CORBA_RTCUtil.get_state(printer))
state = [None]
print("as in 1.x", OpenRTM_aist.CORBA_RTCUtil.get_state(state, printer, 0), state[0])
print("root", naming._rootContext.list(10)[0][0].binding_type == CosNaming.nobject)
print("by url", OpenRTM_aist.CORBA_RTCUtil.get_port_by_url("rtcname://%s/Counter0.rtc.number" % sys.argv[1])._is_equivalent(ports[0]))
print("by name", OpenRTM_aist.get_port_by_name(counter, "Counter0.number")._is_equivalent(ports[0]))
# As scripts write to a port: the connection's only partner is this process.
sink = printer.get_ports()[0]
code, direct = sink.connect(RTC.ConnectorProfile("direct", "", [sink], [
    SDOPackage.NameValue("dataport." + key, any_.to_any(value)) for key, value in (
        ("data_type", "IDL:RTC/TimedLong:1.0"), ("interface_type", "corba_cdr"), ("dataflow_type", "push"), ("subscription_type", "new"))]))
found = dict((one.name, one.value.value()) for one in direct.properties)
print("direct", code, found["dataport.corba_cdr.inport_ref"].put(cdrMarshal(findTypeCode("IDL:RTC/TimedLong:1.0"), RTC.TimedLong(RTC.Time(0, 0), 4712), 1)))
print("parameter", OpenRTM_aist.CORBA_RTCUtil.get_parameter_by_key(counter, "default", "step"))
print("set", OpenRTM_aist.CORBA_RTCUtil.set_configuration(counter, "default", "step", "1000"))
