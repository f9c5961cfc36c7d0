# What others get: the CMake package OpenRTM (for the build tree and installed), rtm-config, pkg-config files, and the install rules.
include(CMakePackageConfigHelpers)

set(package_include ${CMAKE_INSTALL_INCLUDEDIR}/rtm-sim)
set(package_libraries rtmsim_openrtm rtmsim_corba rtmsim_core rtmsim_base rtmsim_coil rtmsim_idl)
list(TRANSFORM package_libraries PREPEND -l OUTPUT_VARIABLE PACKAGE_LINK_LIBRARIES)
list(JOIN PACKAGE_LINK_LIBRARIES " " PACKAGE_LINK_LIBRARIES)
list(TRANSFORM package_libraries REPLACE "(.+)" "lib\\1.so" OUTPUT_VARIABLE PACKAGE_LINK_FILES)
list(JOIN PACKAGE_LINK_FILES " " PACKAGE_LINK_FILES)
list(JOIN package_libraries " " PACKAGE_LIBRARIES)
set(package_cmake ${CMAKE_INSTALL_LIBDIR}/cmake/OpenRTM)

# The same template twice: absolute paths of the build tree, paths relative to the file for the installation.
set(PACKAGE_INIT_TEXT "")
set(PACKAGE_ROOT ${PROJECT_BINARY_DIR})
set(PACKAGE_CMAKE_DIR ${PROJECT_SOURCE_DIR}/cmake)
set(PACKAGE_INCLUDE_DIRS
  "${PROJECT_SOURCE_DIR}/rtm-core/openrtm/include ${PROJECT_BINARY_DIR}/include ${PROJECT_BINARY_DIR}/include/rtm/idl ${PROJECT_BINARY_DIR}/include/rtm/ext")
set(PACKAGE_LIBRARY_DIR ${CMAKE_LIBRARY_OUTPUT_DIRECTORY})
set(PACKAGE_MODULE_DIR ${CMAKE_LIBRARY_OUTPUT_DIRECTORY})
set(PACKAGE_IDL_DIRS "${PROJECT_SOURCE_DIR}/idl ${PROJECT_SOURCE_DIR}/idl/ext")
configure_file(cmake/package/OpenRTMConfig.cmake.in ${PROJECT_BINARY_DIR}/OpenRTMConfig.cmake @ONLY)

string(REGEX REPLACE "[^/]+" ".." up ${package_cmake})
set(PACKAGE_INIT_TEXT "get_filename_component(_openrtm_root \"\${CMAKE_CURRENT_LIST_DIR}/${up}\" ABSOLUTE)")
set(PACKAGE_ROOT "\${_openrtm_root}")
set(PACKAGE_CMAKE_DIR "\${CMAKE_CURRENT_LIST_DIR}")
set(PACKAGE_INCLUDE_DIRS
  "\${_openrtm_root}/${package_include} \${_openrtm_root}/${package_include}/rtm/idl \${_openrtm_root}/${package_include}/rtm/ext")
set(PACKAGE_LIBRARY_DIR "\${_openrtm_root}/${CMAKE_INSTALL_LIBDIR}")
set(PACKAGE_MODULE_DIR "\${_openrtm_root}/lib/rtm-sim")
set(PACKAGE_IDL_DIRS "\${_openrtm_root}/${package_include}/rtm/idl \${_openrtm_root}/${package_include}/rtm/ext")
configure_file(cmake/package/OpenRTMConfig.cmake.in ${PROJECT_BINARY_DIR}/package/OpenRTMConfig.cmake @ONLY)

write_basic_package_version_file(${PROJECT_BINARY_DIR}/OpenRTMConfigVersion.cmake VERSION 2.1.0 COMPATIBILITY AnyNewerVersion)
configure_file(cmake/package/rtm-config.in ${PROJECT_BINARY_DIR}/package/rtm-config @ONLY)
string(REGEX REPLACE "[^/]+" ".." PACKAGE_PC_UP ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
configure_file(cmake/package/openrtm.pc.in ${PROJECT_BINARY_DIR}/package/openrtm.pc @ONLY)

install(FILES ${PROJECT_BINARY_DIR}/package/OpenRTMConfig.cmake ${PROJECT_BINARY_DIR}/OpenRTMConfigVersion.cmake
  cmake/omniorb.cmake cmake/idl.cmake cmake/nil_references.cmake cmake/component.cmake cmake/throw_specifications.cmake cmake/component_main.cpp.in
  DESTINATION ${package_cmake})
foreach(name rtm-core openrtm-aist openrtm2 libcoil)
  install(FILES ${PROJECT_BINARY_DIR}/package/openrtm.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig RENAME ${name}.pc)
endforeach()
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS packaging/man/rtm-skelwrapper.rtm-sim.1)
file(READ packaging/man/rtm-skelwrapper.rtm-sim.1 SKELWRAPPER_MANUAL)
foreach(name rtm rtm2)
  configure_file(cmake/package/rtm-skelwrapper ${PROJECT_BINARY_DIR}/bin/${name}-skelwrapper @ONLY USE_SOURCE_PERMISSIONS)
  install(PROGRAMS ${PROJECT_BINARY_DIR}/package/rtm-config DESTINATION ${CMAKE_INSTALL_BINDIR} RENAME ${name}-config)
  install(PROGRAMS ${PROJECT_BINARY_DIR}/bin/${name}-skelwrapper DESTINATION ${CMAKE_INSTALL_BINDIR} RENAME ${name}-skelwrapper)
endforeach()

# Where and under which names older build files look: folders of headers by version, libraries by name.
configure_file(cmake/package/library.so.in ${PROJECT_BINARY_DIR}/package/library.so @ONLY)
foreach(name RTC RTCSkel coil RTC2 coil2 hrtm rtmCamera rtmManipulator rtmCamera2 rtmManipulator2)
  install(FILES ${PROJECT_BINARY_DIR}/package/library.so DESTINATION ${CMAKE_INSTALL_LIBDIR} RENAME lib${name}.so)
endforeach()
foreach(link openrtm-2.1:rtm-sim coil-2.1:rtm-sim rtm/idl:../rtm-sim/rtm/idl)
  string(REPLACE ":" ";" link ${link})
  list(GET link 0 name)
  list(GET link 1 target)
  install(CODE "
    set(link \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_INCLUDEDIR}/${name}\")
    if(NOT EXISTS \"\${link}\")
      message(STATUS \"Installing: \${link}\")
      cmake_path(GET link PARENT_PATH folder)
      file(MAKE_DIRECTORY \"\${folder}\")
      file(CREATE_LINK ${target} \"\${link}\" SYMBOLIC)
    endif()")
endforeach()

# What authors include, the IDL, and the code made from it: nothing of the inside.
install(DIRECTORY rtm-core/openrtm/include/ DESTINATION ${package_include} FILES_MATCHING PATTERN "*.h")
install(DIRECTORY ${PROJECT_BINARY_DIR}/include/ DESTINATION ${package_include} FILES_MATCHING PATTERN "*.h" PATTERN "*.hh")
install(DIRECTORY idl/ DESTINATION ${package_include}/rtm/idl FILES_MATCHING PATTERN "*.idl" PATTERN ext EXCLUDE)
install(DIRECTORY idl/ext/ DESTINATION ${package_include}/rtm/ext FILES_MATCHING PATTERN "*.idl")

set(package_shared_libraries base rt_core rt_corba openrtm coil rtm_idl)
set_target_properties(${package_shared_libraries} PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION ${RTMSIM_SOVERSION} INSTALL_RPATH "$ORIGIN")
install(TARGETS ${package_shared_libraries} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS own_account_door LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/rtm-sim)
install(TARGETS rtcprof RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
# Manual page and completion of each program, printed by the program itself.
set(package_share ${PROJECT_BINARY_DIR}/share)
set(package_pages)
get_property(package_component_programs GLOBAL PROPERTY RTMSIM_COMPONENT_PROGRAMS)
set(package_programs rtcd rtse sim-server rtm-asset-reader simctl player-gateway follow)
if(RTMSIM_STUDIO)
  list(APPEND package_programs rtm-studio rtse-page)
endif()
if(RTMSIM_ROS2)
  list(APPEND package_programs ros2-gateway follow-ros2)
endif()
foreach(program ${package_programs} ${package_component_programs})
  if(NOT program IN_LIST package_component_programs)
    install(TARGETS ${program} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  endif()
  set(page ${package_share}/man/man1/${program}.1)
  set(bash ${package_share}/bash-completion/completions/${program})
  set(zsh ${package_share}/zsh/site-functions/_${program})
  add_custom_command(OUTPUT ${page} ${bash} ${zsh}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${package_share}/man/man1 ${package_share}/bash-completion/completions ${package_share}/zsh/site-functions
    COMMAND $<TARGET_FILE:${program}> --man > ${page}
    COMMAND $<TARGET_FILE:${program}> --completion bash > ${bash}
    COMMAND $<TARGET_FILE:${program}> --completion zsh > ${zsh}
    DEPENDS ${program} openrtm VERBATIM)  # which has the words that all programs of components share
  list(APPEND package_pages ${page})
  install(FILES ${page} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
  install(FILES ${bash} DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
  install(FILES ${zsh} DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
endforeach()
add_custom_target(manuals ALL DEPENDS ${package_pages})
install(DIRECTORY worlds/ DESTINATION ${CMAKE_INSTALL_DATADIR}/rtm-sim/worlds PATTERN __pycache__ EXCLUDE)
