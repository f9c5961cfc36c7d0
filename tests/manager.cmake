# The manager and what it stands on: rtc.conf, names, ORB, naming service, modules, rtcd.
rtmsim_test(manager_core_test manager/config_test.cpp manager/names_test.cpp manager/task_runner_test.cpp LIBRARIES rt_corba)
rtmsim_test(manager_orb_test manager/orb_test.cpp LIBRARIES rt_corba LABELS process)
if(TARGET rtcd)
  rtmsim_test(manager_test manager/manager_test.cpp LIBRARIES openrtm)
  rtmsim_test(manager_process_test manager/process_test.cpp LIBRARIES openrtm LABELS process)
  add_dependencies(manager_process_test rtcd rtcprof SourceAll SinkAll FailOnRequest)
endif()
