// rtse-campaign: the verbs of rtse that are about campaigns. rtse becomes this program when it meets one of them.
#include <csignal>

#include "rtse/campaign/campaign_commands.h"
#include "rtse/program.h"

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is told like a full disk
  return tools::run_program({campaign::add_sweep, campaign::add_hunt, campaign::add_results}, argc, argv);
}
