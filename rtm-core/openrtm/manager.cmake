# Manager, modules, naming, logging.
target_sources(openrtm PRIVATE
  rtm/CORBA_RTCUtil.cpp
  rtm/ComponentProgram.cpp
  rtm/CorbaNaming.cpp
  rtm/Factory.cpp
  rtm/LocalServiceAdmin.cpp
  rtm/Manager.cpp
  rtm/ManagerComponents.cpp
  rtm/ManagerConfig.cpp
  rtm/ManagerConnections.cpp
  rtm/ManagerCreation.cpp
  rtm/ManagerEnd.cpp
  rtm/ManagerLife.cpp
  rtm/ManagerServant.cpp
  rtm/ManagerTopics.cpp
  rtm/ModuleManager.cpp
  rtm/NamingManager.cpp
  rtm/NumberingPolicy.cpp
  rtm/SystemLogger.cpp
  rtm/Util.cpp)
