#include <rtm/Manager.h>
#include <iostream>
#include <string>
#include <cstdlib>
#include "Outside.h"

void MyModuleInit(RTC::Manager* manager)
{
  OutsideInit(manager);
  RTC::RtcBase* comp;
  comp = manager->createComponent("Outside");
  if (comp == NULL)
    {
      std::cerr << "Component create failed." << std::endl;
      abort();
    }
}

int main (int argc, char** argv)
{
  RTC::Manager* manager;
  manager = RTC::Manager::init(argc, argv);
  manager->init(argc, argv);
  manager->setModuleInitProc(MyModuleInit);
  manager->activateManager();
  manager->runManager();
  return 0;
}
