// rtse-recorder: the verbs of rtse that are about recordings. rtse becomes this program when it meets one of them.
#include "rtse/program.h"
#include "rtse/recorder/recorder_commands.h"

int main(int argc, char** argv) {
  return tools::run_program({recorder::add_record, recorder::add_play, recorder::add_replay, recorder::add_goto, recorder::add_run_like,
                             recorder::add_recording, recorder::add_page},
                            argc, argv);
}
