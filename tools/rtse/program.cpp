#include "rtse/program.h"

#include <unistd.h>

#include <iostream>
#include <memory>

#include "base/command_line.h"
#include "rtse/command.h"
#include "rtse/names_offered.h"
#include "rtse/output.h"
#include "system/orb.h"

namespace tools {

namespace {

struct Settings {
  std::string server = default_server();
  bool json = false;
  double limit_s = 1;
};

// The command line takes a word in brackets apart at its commas; with a blank before it stays one value, which JSON does not mind.
std::vector<std::string> words_of(int argc, char** argv) {
  std::vector<std::string> words(argv, argv + argc);
  for (auto& word : words) {
    if (word.starts_with('[') && word.ends_with(']')) word.insert(0, " ");
  }
  return words;
}

}  // namespace

int run_program(const std::vector<AddCommand>& commands, int argc, char** argv) {
  base::Command app{
      "rtse: list, connect, configure, start, save and test systems of RT components\n"
      "Paths: /HOST[:PORT]/CONTEXT.KIND/NAME.rtc:PORT, relative to $RTCSH_CWD, or any tail that names one thing (NAME:PORT)."};
  base::add_standard_options(app, "rtse", RTMSIM_VERSION);
  app.require_subcommand(1);
  app.fallthrough();
  Settings settings;
  app.add_option("--ns", settings.server, "Name server HOST[:PORT] (default: the first of $RTCTREE_NAMESERVERS, else localhost:2809)");
  app.add_flag("--json", settings.json, "Print JSON");
  app.add_option("--call-timeout", settings.limit_s, "Timeout of a call to another process [s]")
      ->check(base::number_between(0.01, 600.0))
      ->capture_default_str();
  Chosen chosen;
  for (const AddCommand add : commands) add(app, chosen);
  app.group_subcommands("Look", {"ls", "tree", "cat", "print", "watch", "wait", "check", "diff"})
      ->group_subcommands("Connect and change", {"con", "dis", "conf", "act", "deact", "reset", "inject", "ec", "mgr", "exit", "del"})
      ->group_subcommands("Save and run systems", {"save", "load", "start", "stop", "teardown", "run", "join", "leave", "demo"})
      ->group_subcommands("Record", {"record", "play", "replay", "goto", "recording", "page"})
      ->group_subcommands("Campaign", {"sweep", "hunt", "results"})
      ->group_subcommands("Write components", {"new"});
  const TerminalGuard output(std::cout, STDOUT_FILENO), errors(std::cerr, STDERR_FILENO);
  const auto words = words_of(argc, argv);
  std::vector<const char*> arguments;
  for (const auto& word : words) arguments.push_back(word.c_str());
  if (const auto end = base::parse_command_line(app, "rtse", argc, arguments.data(), names_offered)) return *end;
  try {
    const auto orb = chosen.needs_orb ? std::make_unique<Orb>() : nullptr;
    const Session session(orb ? orb->get() : CORBA::ORB::_nil(), settings.server,
                          std::chrono::milliseconds(static_cast<int>(settings.limit_s * 1000)));
    Console console(settings.json);
    chosen.work(session, console);
    if (!flush_output()) console.fail({"standard output: cannot be written"});
    return console.exit_code();
  } catch (const CORBA::Exception& e) {
    std::cerr << "rtse: " << describe(e) << '\n';
  } catch (const std::exception& e) {
    std::cerr << "rtse: " << e.what() << '\n';
  }
  return 1;
}

}  // namespace tools
