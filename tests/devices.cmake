rtmsim_test(devices_test unit/devices_test.cpp LIBRARIES simserver LABELS sim)
