rtmsim_test(avoidance_test unit/avoidance_test.cpp LIBRARIES avoidance)
rtmsim_test(iface_components_test unit/conversions_test.cpp LIBRARIES iface_link)
rtmsim_test(video_test unit/picture_test.cpp LIBRARIES video)
