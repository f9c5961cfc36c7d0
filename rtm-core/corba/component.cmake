# Components of other processes, messages to them.
target_sources(rt_corba PRIVATE courier.cpp remote_participant.cpp)
