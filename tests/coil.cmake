rtmsim_test(coil_test coil/properties_test.cpp coil/stringutil_test.cpp coil/coil_threads_test.cpp LIBRARIES coil)
rtmsim_headers_alone(coil_headers_alone ROOT ${PROJECT_SOURCE_DIR}/rtm-core/openrtm/include FOLDER coil SOURCES ${PROJECT_SOURCE_DIR}/rtm-core/openrtm/coil LIBRARIES coil)
