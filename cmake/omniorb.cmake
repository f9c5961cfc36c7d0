# The ORB as one target: omniorb, with omniDynamic (type codes, any) and omnithread; and its IDL compiler, RTMSIM_OMNIIDL.
find_path(OMNIORB_INCLUDE_DIR omniORB4/CORBA.h REQUIRED)
find_library(OMNIORB_LIBRARY omniORB4 REQUIRED)
find_library(OMNIORB_DYNAMIC_LIBRARY omniDynamic4 REQUIRED)
find_library(OMNIORB_THREAD_LIBRARY omnithread REQUIRED)
find_program(RTMSIM_OMNIIDL omniidl REQUIRED)
mark_as_advanced(OMNIORB_INCLUDE_DIR OMNIORB_LIBRARY OMNIORB_DYNAMIC_LIBRARY OMNIORB_THREAD_LIBRARY RTMSIM_OMNIIDL)

if(NOT TARGET omniorb)
  add_library(omniorb INTERFACE IMPORTED GLOBAL)
  target_link_libraries(omniorb INTERFACE ${OMNIORB_LIBRARY} ${OMNIORB_DYNAMIC_LIBRARY} ${OMNIORB_THREAD_LIBRARY})
  target_include_directories(omniorb SYSTEM INTERFACE ${OMNIORB_INCLUDE_DIR})
endif()
