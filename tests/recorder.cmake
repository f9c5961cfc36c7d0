# Recordings: the file format.
rtmsim_test(mcap_test unit/mcap_test.cpp LIBRARIES mcap)
