// rtse, the command-line system editor: lists, wires, configures, starts and saves systems of RT components.
#include "rtse/commands/commands.h"
#include "rtse/program.h"
#include "rtse/verbs_elsewhere.h"

int main(int argc, char** argv) {
  editor::become_program_of_verb(argc, argv);
  return editor::run_program({editor::add_list, editor::add_watch, editor::add_state, editor::add_conf, editor::add_context,
                              editor::add_connect, editor::add_data, editor::add_system, editor::add_check, editor::add_join,
                              editor::add_manager, editor::add_run, editor::add_diff, editor::add_new, editor::add_verbs_elsewhere},
                             argc, argv);
}
