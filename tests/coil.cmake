rtmsim_test(coil_test coil/properties_test.cpp coil/stringutil_test.cpp coil/coil_threads_test.cpp LIBRARIES coil)
rtmsim_headers_alone(coil_headers_alone ROOT ${PROJECT_SOURCE_DIR}/rtm-core/openrtm/include FOLDER coil SOURCES ${PROJECT_SOURCE_DIR}/rtm-core/coil LIBRARIES coil)
# Authors may stay with C++17: what C++20 adds by itself is there too.
add_library(coil_as_cpp17 OBJECT coil/as_cpp17.cpp)
target_link_libraries(coil_as_cpp17 PRIVATE coil rtmsim_settings)
set_target_properties(coil_headers_alone coil_as_cpp17 PROPERTIES CXX_STANDARD 17)
