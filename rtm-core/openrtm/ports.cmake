# Data ports, service ports and what goes with them.
target_sources(openrtm PRIVATE
  rtm/ByteData.cpp rtm/CORBA_CdrMemoryStream.cpp rtm/CORBA_IORUtil.cpp rtm/CdrBufferBase.cpp rtm/ConnectorBase.cpp rtm/ConnectorListener.cpp rtm/CorbaConsumer.cpp rtm/CorbaPort.cpp rtm/DataPortBase.cpp rtm/DataPortStatus.cpp rtm/EventPort.cpp
  rtm/InPortBase.cpp rtm/InterfacePlugins.cpp rtm/NVUtil.cpp rtm/OutPortBase.cpp rtm/PortBase.cpp rtm/PortConnectListener.cpp rtm/Serializers.cpp rtm/data_port_support.cpp)
