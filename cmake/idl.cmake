# Compiles IDL. Used by our own build and, installed, by every project that does find_package(OpenRTM).
# RTMSIM_IDL_INCLUDE_DIRS is where included IDL files are looked for, besides the file's own folder.

# Writes into OUTPUT_DIRECTORY, for X.idl: X.hh, XSkel.h and XStub.h (all with the types, stubs and skeletons) and the one source X.cc;
# appends the sources to the variable `sources` and the headers to the variable `headers`.
#   rtmsim_generate_idl(sources headers OUTPUT_DIRECTORY dir [OPTIONS omniidl options...] FILES x.idl...)
function(rtmsim_generate_idl sources_variable headers_variable)
  cmake_parse_arguments(PARSE_ARGV 2 arg "" "OUTPUT_DIRECTORY" "OPTIONS;FILES")
  file(MAKE_DIRECTORY ${arg_OUTPUT_DIRECTORY})
  set(nil_references ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/nil_references.cmake)
  list(TRANSFORM RTMSIM_IDL_INCLUDE_DIRS PREPEND -I OUTPUT_VARIABLE include_options)
  foreach(file IN LISTS arg_FILES)
    cmake_path(ABSOLUTE_PATH file NORMALIZE)
    cmake_path(GET file STEM LAST_ONLY name)
    cmake_path(GET file PARENT_PATH folder)
    set(made ${arg_OUTPUT_DIRECTORY}/${name})
    file(GLOB_RECURSE neighbours CONFIGURE_DEPENDS ${folder}/*.idl)
    add_custom_command(
      OUTPUT ${made}.hh ${made}SK.cc ${made}DynSK.cc ${made}Nil.cc
      COMMAND ${RTMSIM_OMNIIDL} -bcxx -Wba -Wbuse-quotes -nf -C${arg_OUTPUT_DIRECTORY} -I${folder} ${include_options} ${arg_OPTIONS} ${file}
      COMMAND ${CMAKE_COMMAND} -DSTUBS=${made}SK.cc -DOUTPUT=${made}Nil.cc -P ${nil_references}
      DEPENDS ${file} ${neighbours} ${nil_references}
      COMMENT "Compiling ${name}.idl"
      VERBATIM)
    foreach(half Skel Stub)
      file(CONFIGURE OUTPUT ${made}${half}.h CONTENT "#pragma once\n#include \"${name}.hh\"\n")
    endforeach()
    file(CONFIGURE OUTPUT ${made}.cc CONTENT "#include \"${name}SK.cc\"\n#include \"${name}DynSK.cc\"\n#include \"${name}Nil.cc\"\n")
    set_source_files_properties(${made}.cc PROPERTIES
      OBJECT_DEPENDS "${made}.hh;${made}SK.cc;${made}DynSK.cc;${made}Nil.cc" COMPILE_OPTIONS -w SKIP_UNITY_BUILD_INCLUSION ON)
    set_source_files_properties(${made}SK.cc ${made}DynSK.cc ${made}Nil.cc PROPERTIES HEADER_FILE_ONLY ON)
    list(APPEND made_sources ${made}.cc)
    list(APPEND made_headers ${made}.hh)
  endforeach()
  set(${sources_variable} ${${sources_variable}} ${made_sources} PARENT_SCOPE)
  set(${headers_variable} ${${headers_variable}} ${made_headers} PARENT_SCOPE)
endfunction()

# Adds the code of a component's own interfaces to a target, which must link rtm_idl (or OpenRTM): #include "XSkel.h" or "XStub.h".
# Several targets of one folder may name the same file.
#   rtmsim_idl(target x.idl...)
function(rtmsim_idl target)
  foreach(file IN LISTS ARGN)
    cmake_path(GET file STEM LAST_ONLY name)
    set(library ${PROJECT_NAME}_idl_${name})
    if(NOT TARGET ${library})
      set(directory ${CMAKE_CURRENT_BINARY_DIR}/idl)
      set(sources)
      set(headers)
      rtmsim_generate_idl(sources headers OUTPUT_DIRECTORY ${directory} FILES ${file})
      add_library(${library} STATIC ${sources} ${headers})
      set_target_properties(${library} PROPERTIES POSITION_INDEPENDENT_CODE ON)
      target_include_directories(${library} SYSTEM PUBLIC ${directory})
      target_link_libraries(${library} PUBLIC ${RTMSIM_IDL_LIBRARY})
    endif()
    target_link_libraries(${target} PUBLIC ${library})
  endforeach()
endfunction()
