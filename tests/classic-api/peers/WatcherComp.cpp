// -*- C++ -*-
/*!
 * @file  WatcherComp.cpp
 * @brief A program that wires its components itself
 */

#include <rtm/Manager.h>
#include <rtm/CORBA_RTCUtil.h>
#include <rtm/ManagerActionListener.h>
#include <iostream>
#include <string>
#include <cstdlib>
#include "Watcher.h"

#if defined(RTM_OS_VXWORKS) && not defined(__RTP__)
extern "C" int componentmain();
#endif

class Farewell
  : public RTM::ManagerActionListener
{
 public:
  void preShutdown() override { std::cout << "about to end" << std::endl; }
  void postShutdown() override { std::cout << "ended" << std::endl; }
};

void MyModuleInit(RTC::Manager* manager)
{
  WatcherInit(manager);

  // Create components
  RTC::RTObject_impl* first = manager->createComponent("Watcher?instance_name=first&exec_cxt.periodic.rate=200");
  RTC::RtcBase* second = manager->createComponent("Watcher?instance_name=second&conf.default.limit=40");
  if (first == nullptr || second == nullptr)
  {
    std::cerr << "Component create failed." << std::endl;
    abort();
  }
  std::cout << first->getInstanceName() << " of " << first->getCategory() << " by " << first->getVendor() << std::endl;

  RTC::RTObject_var source = RTC::RTObject::_duplicate(first->getObjRef());
  RTC::RTObject_var target = RTC::RTObject::_duplicate(second->getObjRef());
  coil::Properties prop;
  prop["dataport.subscription_type"] = "new";
  prop["dataport.buffer.length"] = "4";
  RTC::ReturnCode_t ret = CORBA_RTCUtil::connect_by_name("wire", prop, source, "out", target, "in");
  std::cout << "connected by name: " << (ret == RTC::RTC_OK) << std::endl;
  for (auto& rtc : manager->getComponents())
  {
    RTC::RTObject_var ref = RTC::RTObject::_duplicate(rtc->getObjRef());
    CORBA_RTCUtil::activate(ref, 0);
  }
}

int main(int argc, char** argv)
{
  RTC::Manager* manager = RTC::Manager::init(argc, argv);
  manager->addManagerActionListener(new Farewell());
  coil::Properties& config(manager->getConfig());
  std::cout << "naming " << config["naming.type"] << std::endl;

  // Set module initialization procedure
  manager->setModuleInitProc(MyModuleInit);
  // Activate manager and register to naming service
  manager->activateManager();
  // run the manager in non-blocking mode
  manager->runManager(true);
  manager->join();
  return 0;
}
