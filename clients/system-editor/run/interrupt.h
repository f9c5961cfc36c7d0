// Ctrl-C for commands that have something to take down: SIGINT, SIGTERM and SIGHUP set a mark that whoever waits can see. Any thread.
#pragma once

namespace editor {

// From now on the signals set the mark and do nothing else.
void catch_interrupts();
bool is_interrupted();
// Readable from the first interrupt on, for poll(); -1 before catch_interrupts().
int interrupt_handle();

}  // namespace editor
