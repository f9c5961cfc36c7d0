find_package(nlohmann_json REQUIRED)
rtmsim_test(idl_test idl/wire_types_test.cpp idl/wire_interfaces_test.cpp idl/cdr_payload_test.cpp idl/any_check_test.cpp LIBRARIES rtm_idl nlohmann_json::nlohmann_json LABELS corba)
