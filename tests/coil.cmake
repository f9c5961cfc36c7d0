rtmsim_test(coil_test unit/properties_test.cpp unit/stringutil_test.cpp unit/coil_threads_test.cpp LIBRARIES coil)

# Every header of a folder compiles alone: one empty source per header.
#   rtmsim_headers_alone(NAME ROOT dir FOLDER sub LIBRARIES targets...)
function(rtmsim_headers_alone name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "ROOT;FOLDER" "LIBRARIES")
  file(GLOB headers CONFIGURE_DEPENDS RELATIVE ${arg_ROOT} ${arg_ROOT}/${arg_FOLDER}/*.h)
  set(sources)
  foreach(header IN LISTS headers)
    string(MAKE_C_IDENTIFIER ${header} identifier)
    set(source ${CMAKE_CURRENT_BINARY_DIR}/alone/${identifier}.cpp)
    file(CONFIGURE OUTPUT ${source} CONTENT "#include <${header}>  // twice, for its guard\n#include <${header}>\n")
    list(APPEND sources ${source})
  endforeach()
  add_library(${name} OBJECT ${sources})
  target_link_libraries(${name} PRIVATE ${arg_LIBRARIES} rtmsim_settings)
endfunction()

rtmsim_headers_alone(coil_headers_alone ROOT ${PROJECT_SOURCE_DIR}/rtm-core/openrtm FOLDER coil LIBRARIES coil)
