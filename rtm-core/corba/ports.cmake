# Connections between ports and the transports of data ports.
target_sources(rt_corba PRIVATE
  call_timeout.cpp cdr.cpp cdr_transport.cpp connector_keys.cpp event_data.cpp farewell.cpp gate.cpp gather_stream.cpp in_engine.cpp local_connections.cpp memory_segment.cpp nv_list.cpp out_engine.cpp payload.cpp peer_watch.cpp port_servant.cpp shape.cpp
  shared_memory_transport.cpp)
