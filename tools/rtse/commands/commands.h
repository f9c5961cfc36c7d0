// The commands of rtse. Each adds its command line to `app`; the selected one stores its work in `chosen`.
#pragma once

namespace base {
class Command;
}

namespace tools {

struct Chosen;

void add_list(base::Command& app, Chosen& chosen);     // ls, tree, cat
void add_join(base::Command& app, Chosen& chosen);     // join, leave
void add_watch(base::Command& app, Chosen& chosen);    // watch
void add_state(base::Command& app, Chosen& chosen);    // act, deact, reset, exit, del, wait
void add_conf(base::Command& app, Chosen& chosen);     // conf
void add_context(base::Command& app, Chosen& chosen);  // ec
void add_connect(base::Command& app, Chosen& chosen);  // con, dis
void add_data(base::Command& app, Chosen& chosen);     // print, inject
void add_system(base::Command& app, Chosen& chosen);   // save, load, start, stop, teardown
void add_check(base::Command& app, Chosen& chosen);    // check
void add_manager(base::Command& app, Chosen& chosen);  // mgr
void add_run(base::Command& app, Chosen& chosen);      // run
void add_diff(base::Command& app, Chosen& chosen);     // diff
void add_new(base::Command& app, Chosen& chosen);      // new

}  // namespace tools
