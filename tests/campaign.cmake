# Campaigns: plans, rows, results, and whole sweeps.
rtmsim_test(campaign_test campaign/conditions_test.cpp campaign/fault_test.cpp campaign/plan_test.cpp campaign/rows_test.cpp campaign/store_test.cpp LIBRARIES campaign rt_core)
add_dependencies(campaign_test sim-server)  # which it asks for the models of a world
function(campaign_cases script)
  foreach(case ${ARGN})
    add_test(NAME campaigns.${case}
      COMMAND python3 -B ${CMAKE_CURRENT_SOURCE_DIR}/campaign/${script} ${case} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR})
    set_tests_properties(campaigns.${case} PROPERTIES LABELS integration TIMEOUT 300 SKIP_RETURN_CODE 77)
  endforeach()
endfunction()
campaign_cases(campaigns.py sweep reports pages killed warm_killed disk_full interrupted refused)
campaign_cases(plans.py without_simctl events goes_to like_faulty faults models_as_simulated hunts hunts_restarts)
campaign_cases(trouble.py kills shared machine finds)
# On a cluster of one machine; skipped where Slurm is not installed (scripts/setup --with-slurm).
foreach(case rows broken killed other_rows)
  add_test(NAME campaigns.slurm_${case}
    COMMAND python3 -B ${CMAKE_CURRENT_SOURCE_DIR}/campaign/slurm.py ${case} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR})
  set_tests_properties(campaigns.slurm_${case} PROPERTIES LABELS integration TIMEOUT 600 SKIP_RETURN_CODE 77)
endforeach()

# What hunts look for. campaign/hunt/hunt.py runs them all, by hand.
rtmsim_component(HuntSubject campaign/hunt/hunt_subject.cpp)
