rtmsim_test(render_test
  render/render_test.cpp render/render_geometry_test.cpp render/render_light_test.cpp render/render_material_test.cpp render/render_media_test.cpp render/camera_test.cpp
  LIBRARIES simrender simrays asset_jobs LABELS render)
add_test(NAME pictures.of_every_view_and_every_bad_value
  COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/pictures.py ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR})
set_tests_properties(pictures.of_every_view_and_every_bad_value PROPERTIES LABELS "render;integration" TIMEOUT 300)
