rtmsim_test(component_core_test unit/execution_context_test.cpp unit/configuration_test.cpp LIBRARIES rt_core LABELS core)
rtmsim_test(component_test corba/component_test.cpp corba/component_context_test.cpp corba/component_service_test.cpp LIBRARIES openrtm LABELS corba)
