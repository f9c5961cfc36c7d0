include(${PROJECT_SOURCE_DIR}/cmake/headers_alone.cmake)

rtmsim_test(coil_test unit/properties_test.cpp unit/stringutil_test.cpp unit/coil_threads_test.cpp LIBRARIES coil)
rtmsim_headers_alone(coil_headers_alone ROOT ${PROJECT_SOURCE_DIR}/rtm-core/openrtm/include FOLDER coil LIBRARIES coil)
