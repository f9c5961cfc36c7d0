rtmsim_test(component_core_test unit/execution_context_test.cpp unit/configuration_test.cpp LIBRARIES rt_core LABELS core)
