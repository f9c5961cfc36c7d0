rtmsim_test(coil_test unit/properties_test.cpp unit/stringutil_test.cpp LIBRARIES coil)
