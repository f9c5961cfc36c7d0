# Components of other processes.
target_sources(rt_corba PRIVATE remote_participant.cpp)
