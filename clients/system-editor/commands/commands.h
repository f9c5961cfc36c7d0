// The commands of rtse. Each adds its part of the command line to `app`; the one that the user names leaves in `chosen` what is to be done.
#pragma once

namespace CLI {
class App;
}

namespace editor {

struct Chosen;

void add_list(CLI::App& app, Chosen& chosen);     // ls, tree, cat
void add_join(CLI::App& app, Chosen& chosen);     // join, leave
void add_watch(CLI::App& app, Chosen& chosen);    // watch
void add_state(CLI::App& app, Chosen& chosen);    // act, deact, reset, exit, del, wait
void add_conf(CLI::App& app, Chosen& chosen);     // conf
void add_connect(CLI::App& app, Chosen& chosen);  // con, dis
void add_data(CLI::App& app, Chosen& chosen);     // print, inject
void add_system(CLI::App& app, Chosen& chosen);   // save, load, start, stop, teardown
void add_check(CLI::App& app, Chosen& chosen);    // check
void add_manager(CLI::App& app, Chosen& chosen);  // mgr
void add_run(CLI::App& app, Chosen& chosen);      // run
void add_diff(CLI::App& app, Chosen& chosen);     // diff
void add_new(CLI::App& app, Chosen& chosen);      // new

}  // namespace editor
