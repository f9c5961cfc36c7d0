# KDL is what the dynamics are compared with; no program uses it.
find_package(orocos_kdl REQUIRED)
rtmsim_test(physics_test
  physics/physics_test.cpp physics/rolling_test.cpp physics/joints_test.cpp physics/joint_limits_test.cpp physics/joint_couplings_test.cpp physics/rotor_test.cpp physics/joint_control_test.cpp
  physics/joint_dynamics_test.cpp physics/arm_energy_test.cpp physics/mesh_energy_test.cpp physics/mesh_collision_test.cpp physics/crowd_test.cpp physics/tree_solver_test.cpp
  physics/free_rotation_test.cpp physics/impacts_test.cpp physics/weld_test.cpp physics/carried_loads_test.cpp physics/displacement_test.cpp physics/aerodynamics_test.cpp physics/water_test.cpp
  LIBRARIES simserver png orocos-kdl LABELS sim)
