"""A tool at the SDO services of a component: what it offers, an observer, and a service for its consumer. sdo_client.py HOST:PORT NAME"""
import sys
import threading

import OpenRTM
import OpenRTM__POA
import OpenRTM_aist
import RTC
import RTC__POA
import SDOPackage
from omniORB import CORBA, any

heard = threading.Event()
asked = threading.Event()


class Observer(OpenRTM__POA.ComponentObserver):
    def update_status(self, kind, hint):
        print("status", kind, hint, flush=True)
        if kind == OpenRTM.RTC_STATUS and hint.startswith("ACTIVE"):
            heard.set()


class Service(RTC__POA.ExtendedFsmService):
    def get_current_state(self):
        asked.set()
        return "of the tool"


orb = CORBA.ORB_init(sys.argv)
orb.resolve_initial_references("RootPOA").the_POAManager.activate()
rtc = OpenRTM_aist.CorbaNaming(orb, sys.argv[1]).resolve(sys.argv[2] + ".rtc")._narrow(RTC.RTObject)
for profile in rtc.get_service_profiles():
    print("profile", profile.id, profile.interface_type)
service = rtc.get_sdo_service("mine")._narrow(RTC.ExtendedFsmService)
print("state", service.get_current_state())
print("structure", service.get_fsm_structure())
print("same", rtc.get_service_profile("mine").interface_type == RTC.ExtendedFsmService._NP_RepositoryId)
try:
    rtc.get_sdo_service("nothing")
except SDOPackage.InvalidParameter:
    print("no service of that id")
configuration = rtc.get_configuration()
observer = Observer()
kinds = [SDOPackage.NameValue("observed_status", any.to_any("RTC_STATUS"))]
print("observer", configuration.add_service_profile(SDOPackage.ServiceProfile("observer", OpenRTM.ComponentObserver._NP_RepositoryId, kinds, observer._this())))
attached = Service()
print("consumer", configuration.add_service_profile(SDOPackage.ServiceProfile("tool", RTC.ExtendedFsmService._NP_RepositoryId, [], attached._this())))
print("again", configuration.add_service_profile(SDOPackage.ServiceProfile("tool", RTC.ExtendedFsmService._NP_RepositoryId, [], attached._this())))
print("unknown", configuration.add_service_profile(SDOPackage.ServiceProfile("other", "IDL:nobody/knows:1.0", [], attached._this())))
OpenRTM_aist.CORBA_RTCUtil.activate(rtc)
print("heard", heard.wait(30), "asked", asked.wait(30))
print("removed", configuration.remove_service_profile("tool"), configuration.remove_service_profile("observer"))
