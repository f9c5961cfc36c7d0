// rtse, the command-line system editor: lists, wires, configures, starts and saves systems of RT components.
#include "rtse/commands/commands.h"
#include "rtse/program.h"
#include "rtse/verbs_elsewhere.h"

int main(int argc, char** argv) {
  tools::become_program_of_verb(argc, argv);
  return tools::run_program({tools::add_list, tools::add_watch, tools::add_state, tools::add_conf, tools::add_context, tools::add_connect,
                             tools::add_data, tools::add_system, tools::add_check, tools::add_join, tools::add_manager, tools::add_run,
                             tools::add_diff, tools::add_new, tools::add_verbs_elsewhere},
                            argc, argv);
}
