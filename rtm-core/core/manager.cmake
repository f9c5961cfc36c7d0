# What a manager reads: rtc.conf, command line, names and arguments; and its timer.
target_sources(rt_core PRIVATE
  component_argument.cpp
  config_file.cpp
  config_keys.cpp
  manager_arguments.cpp
  name_format.cpp
  preconnect.cpp
  signal_watcher.cpp
  task_runner.cpp)
