# Cameras and what becomes of their frames, in real processes.
add_executable(camera_reader scenario/camera_reader.cpp)
target_include_directories(camera_reader PRIVATE ${PROJECT_SOURCE_DIR}/tests)
target_link_libraries(camera_reader PRIVATE simshm rtmsim_settings)
foreach(case slow_reader only_for_readers restarted_server stopped_player killed_player_and_server large_frames recorded_formats recorded_end)
  add_test(NAME cameras.${case}
    COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/cameras.py ${case} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY})
  set_tests_properties(cameras.${case} PROPERTIES LABELS integration TIMEOUT 300)
endforeach()

# VideoPlayer on a display of its own.
find_package(X11 REQUIRED COMPONENTS Xtst)
rtmsim_component(FrameSource scenario/frame_source.cpp)
add_executable(x11_window scenario/x11_window.cpp)
target_include_directories(x11_window PRIVATE ${PROJECT_SOURCE_DIR}/tests)
target_link_libraries(x11_window PRIVATE X11::X11 X11::Xtst rtmsim_settings)
foreach(case formats keys resize bad_images two_players no_display wrong_display killed_display kept_records slow_recording stopped_display)
  add_test(NAME video_player.${case}
    COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/video_player.py ${case} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY})
  set_tests_properties(video_player.${case} PROPERTIES LABELS integration TIMEOUT 300)
endforeach()
