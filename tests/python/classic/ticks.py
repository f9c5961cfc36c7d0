"""Finds a component by the name server, activates it and ticks its context, which is triggered from outside, until standard input ends."""
from __future__ import print_function
import sys

from omniORB import CORBA
import RTC
import OpenRTM
import OpenRTM_aist

orb = CORBA.ORB_init(sys.argv)
naming = OpenRTM_aist.CorbaNaming(orb, sys.argv[1])
found = OpenRTM_aist.CorbaConsumer()
context = OpenRTM_aist.CorbaConsumer(interfaceType=OpenRTM.ExtTrigExecutionContextService)
found.setObject(naming.resolve("Ticked0.rtc"))
component = found.getObject()._narrow(RTC.RTObject)
component.get_ports()[0].disconnect_all()
contexts = component.get_owned_contexts()
contexts[0].activate_component(component)
context.setObject(contexts[0])
profile = RTC.ConnectorProfile("loop", "", list(component.get_ports()), [])
OpenRTM_aist.CORBA_SeqUtil.push_back(profile.properties, OpenRTM_aist.NVUtil.newNV("dataport.interface_type", "corba_cdr"))
OpenRTM_aist.CORBA_SeqUtil.push_back(profile.properties, OpenRTM_aist.NVUtil.newNV("dataport.dataflow_type", "push"))
OpenRTM_aist.CORBA_SeqUtil.push_back(profile.properties, OpenRTM_aist.NVUtil.newNV("dataport.subscription_type", "Flush"))
print("connect", component.get_ports()[0].connect(profile)[0], flush=True)
for line in sys.stdin:
    context._ptr().tick()
