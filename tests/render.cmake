rtmsim_test(render_test
  unit/render_test.cpp unit/render_geometry_test.cpp unit/render_light_test.cpp unit/render_material_test.cpp unit/camera_test.cpp
  LIBRARIES simrender simrays LABELS render)
