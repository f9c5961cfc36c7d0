# The Python module rtmsim. Each file is a run of pytest, so its cases share the imports.
# Python is built without a sanitizer: the libraries of ours come first, and the memory that it never gives back is its own.
set(python_sanitizer)
if(RTMSIM_SANITIZE MATCHES address)
  foreach(library libasan.so libstdc++.so.6)
    execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-file-name=${library} OUTPUT_VARIABLE path OUTPUT_STRIP_TRAILING_WHITESPACE)
    string(APPEND python_sanitizer "${path} ")
  endforeach()
  set(python_sanitizer ";LD_PRELOAD=${python_sanitizer};ASAN_OPTIONS=detect_leaks=0:verify_asan_link_order=0")
endif()
foreach(file python/world_test.py python/arguments_test.py python/process_test.py python/run_test.py python/env_test.py python/plugin_test.py python/page_test.py python/component_test.py python/types_test.py python/service_test.py python/fsm_test.py python/sdo_test.py python/context_test.py python/names_test.py python/hostile_test.py python/old_sources_test.py python/styles_test.py python/classic_test.py python/stubs_test.py)
  string(REGEX REPLACE "^python/|_test.py$" "" name ${file})
  add_test(NAME python.${name}
    COMMAND ${Python_EXECUTABLE} -B -m pytest -q -p no:cacheprovider ${CMAKE_CURRENT_SOURCE_DIR}/${file})
  set_tests_properties(python.${name} PROPERTIES LABELS "sim;process" TIMEOUT 600
    ENVIRONMENT "PYTHONPATH=${PROJECT_BINARY_DIR}/python:${CMAKE_CURRENT_SOURCE_DIR}/python/whole_lines;RTMSIM_BIN_DIR=${CMAKE_RUNTIME_OUTPUT_DIRECTORY};RTMSIM_LIB_DIR=${CMAKE_LIBRARY_OUTPUT_DIRECTORY}${python_sanitizer}")
endforeach()
