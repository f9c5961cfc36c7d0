rtmsim_test(render_test unit/render_test.cpp unit/camera_test.cpp LIBRARIES simrender LABELS render)
