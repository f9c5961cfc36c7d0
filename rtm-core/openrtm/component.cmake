# Components, execution contexts, configuration, organizations, SDO services.
target_sources(openrtm PRIVATE
  rtm/ComponentObserverConsumer.cpp
  rtm/ConfigAdmin.cpp
  rtm/ECFactory.cpp
  rtm/ExecutionContextBase.cpp
  rtm/ExecutionContextMembers.cpp
  rtm/ExecutionContextWorker.cpp
  rtm/ExtTrigExecutionContext.cpp
  rtm/ExtendedFsmServiceProvider.cpp
  rtm/ListenerNames.cpp
  rtm/LocalComponent.cpp
  rtm/LoggerConsumer.cpp
  rtm/LogicalTimeTriggeredEC.cpp
  rtm/MultilayerCompositeEC.cpp
  rtm/OpenHRPExecutionContext.cpp
  rtm/PeriodicECOrganization.cpp
  rtm/PeriodicECSharedComposite.cpp
  rtm/PeriodicExecutionContext.cpp rtm/PeriodicLoop.cpp
  rtm/RTObject.cpp
  rtm/RTObjectCallbacks.cpp
  rtm/RTObjectContexts.cpp
  rtm/RTObjectOrphans.cpp
  rtm/RTObjectPorts.cpp
  rtm/RTObjectSdo.cpp
  rtm/RTObjectStateMachine.cpp
  rtm/SdoConfiguration.cpp
  rtm/SdoOrganization.cpp
  rtm/SdoServiceAdmin.cpp
  rtm/SimulatorExecutionContext.cpp
  rtm/StaticFSM.cpp)
