# The manager and what it stands on: rtc.conf, names, ORB, naming service, modules, rtcd.
rtmsim_test(manager_core_test manager/config_test.cpp manager/names_test.cpp manager/task_runner_test.cpp manager/orb_test.cpp LIBRARIES rt_corba LABELS process)
rtmsim_test(manager_test
  manager/manager_test.cpp manager/locks_test.cpp manager/process_test.cpp manager/servant_test.cpp manager/keys_test.cpp manager/topics_test.cpp manager/composite_test.cpp manager/precedence_test.cpp
  LIBRARIES openrtm LABELS process)
add_library(Hangs MODULE manager/hangs.cpp)
set_target_properties(Hangs PROPERTIES PREFIX "")
target_link_libraries(Hangs PRIVATE openrtm rtmsim_settings)
add_library(EndsOnLoad MODULE manager/ends_on_load.cpp)
set_target_properties(EndsOnLoad PROPERTIES PREFIX "" LIBRARY_OUTPUT_DIRECTORY "${CMAKE_LIBRARY_OUTPUT_DIRECTORY}/damaged")
add_dependencies(manager_test rtcd rtcprof SimTimeProxy SourceAll SinkAll FailOnRequest EchoProvider EchoConsumer EndsOnLoad Hangs LoopECs CycleEC StepEC Wrappers Postbox)
