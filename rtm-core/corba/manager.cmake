# The ORB and the naming service.
target_sources(rt_corba PRIVATE
  bindings.cpp
  naming.cpp
  orb.cpp)
