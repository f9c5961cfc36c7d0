# Systems of many processes in lock step, each case with a naming service and a simulator of its own.
rtmsim_component(Relay scenario/relay.cpp)
scenario_cases(lockstep. lockstep chain_forward chain_backward chain_mixed_at_a_rate_that_is_no_multiple_of_the_step killed stopped dropped hanging_component
  hangs_on_a_shared_thread server_restarted two_servers registers_1000_times time_stamps reset waiting_samples active_over_restarts steps_end pushes_in_a_tick
  refused_in_a_hang observer loaded)

# Components of another make, and what becomes of a run when one of them is slow, wrong or dead.
scenario_cases(lockstep.foreign_ foreign_members join_and_leave started same_state faulty late_receiver one_phase one_phase_in_a_circle between_others interrupted
  kept_hang_timeout recorded lost_link wrong_start)
scenario_cases(lockstep.foreign_ foreign_contexts ticked ticked_by_hand ticked_together ticked_afterwards faulty_ticked clock together one_context host_dies forgotten)

# Components of ours in contexts of other processes.
scenario_cases(lockstep.called_ called_in_time knows_the_time velocity_before_a_reset)

# Runs that depend on nothing, and planted races that are found.
rtmsim_component(Chance scenario/chance.cpp)
scenario_cases(chance. chance links_of_one_phase twice first_difference changed_from_outside sample_between_ticks service_of_one_phase callers_of_one_phase
  same_on_every_processor race_of_a_thread race_of_the_clock race_of_an_address)
