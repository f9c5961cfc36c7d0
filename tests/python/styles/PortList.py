#!/usr/bin/env python
# -*- coding: utf-8 -*-
# -*- Python -*-
import sys
import RTC
import OpenRTM_aist
from omniORB import any
import OpenRTM_aist.NVUtil

class DataListener(OpenRTM_aist.ConnectorDataListenerT):
  def __init__(self, name, obj):
    self._name = name
    self._obj = obj

  def __del__(self):
    print("dtor of ", self._name)

  def __call__(self, info, cdrdata):
    data = OpenRTM_aist.ConnectorDataListenerT.__call__(self, info, cdrdata, RTC.TimedLong(RTC.Time(0,0),0))
    print("------------------------------")
    print("Listener:       ", self._name)
    print("Profile::name:  ", info.name)
    print("Profile::id:    ", info.id)
    print("Profile::data_type:  ", info.properties.getProperty("data_type"))
    print("Profile::properties: ")
    print(info.properties)
    print("Data:           ", data.data)
    print("------------------------------")

class ConnListener(OpenRTM_aist.ConnectorListener):
  def __init__(self, name):
    self._name = name
  def __del__(self):
    print("dtor of ", self._name)
  def __call__(self, info):
    print("Profile::name:", info.name, info.ports, str(info.properties))

portlist_spec = ["implementation_id", "PortList", "type_name", "PortList", "description", "a style", "version", "1.0.0", "vendor", "rtm-sim",
            "category", "test", "activity_type", "STATIC", "max_instance", "1", "language", "Python", "lang_type", "SCRIPT",
            ""]

class PortList(OpenRTM_aist.DataFlowComponentBase):
    def __init__(self, manager):
        OpenRTM_aist.DataFlowComponentBase.__init__(self, manager)
        return
    def onInitialize(self):
        self._data = RTC.TimedLong(RTC.Time(0,0),0)
        self._outport = OpenRTM_aist.OutPort("out", self._data)
        self.addOutPort("out", self._outport)
        self._outport.addConnectorDataListener(OpenRTM_aist.ConnectorDataListenerType.ON_BUFFER_WRITE, DataListener("ON_BUFFER_WRITE", self))
        self._outport.addConnectorListener(OpenRTM_aist.ConnectorListenerType.ON_CONNECT, ConnListener("ON_CONNECT"))
        return RTC.RTC_OK
    def onExecute(self, ec_id):
        self._data.data = 3
        self._outport.write()
        if not hasattr(self, "said"): self.said = print("OK PortList")
        return RTC.RTC_OK

def PortListInit(manager):
    profile = OpenRTM_aist.Properties(defaults_str=portlist_spec)
    manager.registerFactory(profile, PortList, OpenRTM_aist.Delete)

def MyModuleInit(manager):
  PortListInit(manager)

  # Create a component
  print("Creating a component: \"PortList\"....",)
  comp = manager.createComponent("PortList")
  print("succeed.")

  prof = comp.get_component_profile()

  print("=================================================")
  print(" Component Profile")
  print("-------------------------------------------------")
  print("InstanceID:     ", prof.instance_name)
  print("Implementation: ", prof.type_name)
  print("Description:    ", prof.description)
  print("Version:        ", prof.version)
  print("Maker:          ", prof.vendor)
  print("Category:       ", prof.category)
  print("  Other properties   ")
  OpenRTM_aist.NVUtil.dump(prof.properties)
  print("=================================================")
  portlist = comp.get_ports()
  print("Number of Ports: ", len(portlist))
  for idx, port in enumerate(portlist):
      print("Port", idx, " (name): ", port.get_port_profile().name)
      for ifs in port.get_port_profile().interfaces: print(ifs.instance_name, ifs.type_name, ifs.polarity)
      print("- properties -")
      OpenRTM_aist.NVUtil.dump(port.get_port_profile().properties)
  poa = manager.getPOA()
  obj = poa.id_to_reference(poa.servant_to_id(comp))
  rtobj = obj._narrow(RTC.RTObject)
  print(rtobj.get_component_profile().instance_name)
  ecs = rtobj.get_owned_contexts()
  ecs[0].activate_component(rtobj)

def main():
  mgr = OpenRTM_aist.Manager.init(sys.argv)
  mgr.setModuleInitProc(MyModuleInit)
  mgr.activateManager()
  mgr.runManager()

if __name__ == "__main__":
  main()
