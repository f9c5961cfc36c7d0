# A component in the classic way: sources with a function <Name>Init(RTC::Manager*) become the module <Name>.so, which rtcd loads, and the
# program <Name>Comp, which makes one component and runs.
#   rtmsim_component(Name sources... [MAIN main.cpp] [IDL x.idl...] [LIBRARIES targets...] [INSTALL])
# MAIN: the program's own main(); without it one is made. INSTALL: also install module and program.
function(rtmsim_component name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "INSTALL" "MAIN" "IDL;LIBRARIES")
  add_library(${name}_objects OBJECT ${arg_UNPARSED_ARGUMENTS})
  set_target_properties(${name}_objects PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_include_directories(${name}_objects PUBLIC ${CMAKE_CURRENT_SOURCE_DIR})
  target_link_libraries(${name}_objects PUBLIC openrtm ${arg_LIBRARIES})
  if(arg_IDL)
    rtmsim_idl(${name}_objects ${arg_IDL})
  endif()
  if(TARGET rtmsim_settings)  # not in the projects of authors
    target_link_libraries(${name}_objects PRIVATE rtmsim_settings)
  endif()

  if(NOT arg_MAIN)
    set(arg_MAIN ${CMAKE_CURRENT_BINARY_DIR}/${name}Comp.cpp)
    set(RTMSIM_COMPONENT ${name})
    configure_file(${RTMSIM_CMAKE_DIR}/component_main.cpp.in ${arg_MAIN} @ONLY)
  endif()
  add_library(${name} MODULE)
  set_target_properties(${name} PROPERTIES PREFIX "")
  add_executable(${name}Comp ${arg_MAIN})
  foreach(target ${name} ${name}Comp)
    target_link_libraries(${target} PRIVATE ${name}_objects)
  endforeach()

  if(arg_INSTALL)
    set_target_properties(${name} PROPERTIES INSTALL_RPATH "$ORIGIN/../../${CMAKE_INSTALL_LIBDIR}")
    install(TARGETS ${name} LIBRARY DESTINATION lib/rtm-sim)  # the same on every system: programs find it beside themselves
    install(TARGETS ${name}Comp RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
    set_property(GLOBAL APPEND PROPERTY RTMSIM_COMPONENT_PROGRAMS ${name}Comp)
  endif()
endfunction()

set(RTMSIM_CMAKE_DIR ${CMAKE_CURRENT_LIST_DIR} CACHE INTERNAL "where component_main.cpp.in is")
