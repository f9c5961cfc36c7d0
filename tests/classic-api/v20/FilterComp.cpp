// -*- C++ -*-
// <rtc-template block="description">
/*!
 * @file  FilterComp.cpp
 * @brief Standalone component
 */
// </rtc-template>

#include <rtm/Manager.h>
#include <iostream>
#include <string>
#include <cstdlib>
#include "Filter.h"


void MyModuleInit(RTC::Manager* manager)
{
  FilterInit(manager);
  RTC::RtcBase* comp;

  // Create a component
  comp = manager->createComponent("Filter?instance_name=filter7&conf.default.gain=2.0");

  if (comp==NULL)
  {
    std::cerr << "Component create failed." << std::endl;
    abort();
  }

  // Example
  // The following procedure is examples how handle RT-Components.
  // These should not be in this function.

  // Get the component's object reference
  RTC::RTObject_var rtobj;
  rtobj = RTC::RTObject::_narrow(manager->getPOA()->servant_to_reference(comp));

  // Get the port list of the component
  RTC::PortServiceList_var portlist;
  portlist = rtobj->get_ports();

  // getting port profiles
  std::cout << "Number of Ports: ";
  std::cout << portlist->length() << std::endl << std::endl;
  for (CORBA::ULong i(0), n(portlist->length()); i < n; ++i)
  {
    RTC::PortService_var port = RTC::PortService::_duplicate(portlist[i]);
    RTC::PortProfile_var port_prof = port->get_port_profile();
    std::cout << "Port" << i << " (name): ";
    std::cout << port_prof->name << std::endl;

    const RTC::PortInterfaceProfileList& iflist = port_prof->interfaces;
    std::cout << "---interfaces---" << std::endl;
    for (CORBA::ULong j(0); j < iflist.length(); ++j)
    {
      std::cout << "I/F name: " << iflist[j].instance_name << std::endl;
      std::cout << "I/F type: " << iflist[j].type_name << std::endl;
    }
    std::cout << "---properties---" << std::endl;
    NVUtil::dump(port_prof->properties);
    std::cout << "----------------" << std::endl << std::endl;
  }
}

int main (int argc, char** argv)
{
  RTC::Manager* manager;
  manager = RTC::Manager::init(argc, argv);

  // Set module initialization proceduer
  // This procedure will be invoked in activateManager() function.
  manager->setModuleInitProc(MyModuleInit);

  // Activate manager and register to naming service
  manager->activateManager();

  // run the manager in blocking mode
  // runManager(false) is the default.
  manager->runManager();

  return 0;
}
