add_executable(picture_fuzz picture_fuzz.cpp)
target_link_libraries(picture_fuzz PRIVATE video turbojpeg rtmsim_settings)
add_test(NAME picture_fuzz COMMAND picture_fuzz --runs 20000)
set_tests_properties(picture_fuzz PROPERTIES TIMEOUT 300 LABELS "fuzz")
