# Settings, buffers and publishers of data ports.
target_sources(rt_core PRIVATE connector_settings.cpp mailbox.cpp port_status.cpp publisher.cpp ring.cpp sample.cpp send_queue.cpp)
