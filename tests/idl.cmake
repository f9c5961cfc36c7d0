find_package(nlohmann_json REQUIRED)
rtmsim_test(idl_test unit/wire_types_test.cpp unit/cdr_payload_test.cpp unit/any_check_test.cpp LIBRARIES rtm_idl nlohmann_json::nlohmann_json LABELS corba)
