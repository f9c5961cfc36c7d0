rtmsim_test(ports_first_test ports/first_test.cpp LIBRARIES openrtm)
