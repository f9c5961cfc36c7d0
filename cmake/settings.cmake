# Compiler settings of every target of ours, kept in one interface library so that users of the installed libraries never get them.
add_library(rtmsim_settings INTERFACE)
target_compile_options(rtmsim_settings INTERFACE -Wall -Wextra -Wpedantic -Wshadow=local $<$<BOOL:${RTMSIM_WERROR}>:-Werror>)
# GCC 12 warns of overlapping copies inside its own std::string (GCC bug 105651, mended in 13).
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 12 AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  target_compile_options(rtmsim_settings INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Wno-restrict>)
endif()
# Less work when a program starts: a library finds its own functions without a look-up by name.
target_link_options(rtmsim_settings INTERFACE
  "$<$<IN_LIST:$<TARGET_PROPERTY:TYPE>,SHARED_LIBRARY;MODULE_LIBRARY>:LINKER:-Bsymbolic-functions>")
# Several sources at a time: each is included, and its own classes look like those of a header.
if(RTMSIM_COLD_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # The compiler seldom collects what it no longer needs: up to half a GiB each, a tenth of its time less.
  target_compile_options(rtmsim_settings INTERFACE "$<$<COMPILE_LANGUAGE:CXX>:-Wno-subobject-linkage;--param=ggc-min-heapsize=524288>")
endif()
if(RTMSIM_SANITIZE)
  add_compile_options(-fsanitize=${RTMSIM_SANITIZE} -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${RTMSIM_SANITIZE})
endif()

find_program(RTMSIM_CCACHE ccache)
if(RTMSIM_CCACHE)
  set(CMAKE_C_COMPILER_LAUNCHER ${RTMSIM_CCACHE})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${RTMSIM_CCACHE})
endif()
find_program(RTMSIM_MOLD mold)
if(RTMSIM_MOLD)
  add_link_options(-fuse-ld=mold)
endif()
