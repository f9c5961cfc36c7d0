add_executable(shm_helper shm/helper.cpp)
target_include_directories(shm_helper PRIVATE ${PROJECT_SOURCE_DIR}/tests)
target_link_libraries(shm_helper PRIVATE simshm rtmsim_settings)

rtmsim_test(shm_test shm/iface_test.cpp shm/iface_types_test.cpp shm/frame_ring_test.cpp shm/control_test.cpp shm/pose_control_test.cpp shm/pose_log_test.cpp shm/request_test.cpp shm/lockstep_test.cpp shm/observer_test.cpp shm/no_system_call_test.cpp shm/spinning_test.cpp shm/squatted_names_test.cpp shm/many_segments_test.cpp
            LIBRARIES simshm)
rtmsim_test(shm_faults_test shm/faults_test.cpp shm/process_test.cpp LIBRARIES simshm LABELS processes)
add_dependencies(shm_faults_test shm_helper)
rtmsim_test(map_path_test shm/map_path_test.cpp LIBRARIES world_map)
rtmsim_test(shm_c_header_test shm/c_header_test.cpp shm/c_client.c LIBRARIES simshm simshm_c)
set_source_files_properties(shm/c_client.c PROPERTIES COMPILE_OPTIONS "-std=c11")

add_test(NAME shm.the_page_on_shared_memory_is_true COMMAND ${PROJECT_SOURCE_DIR}/docs/make_shared_memory.py --check)
