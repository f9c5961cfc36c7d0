#include "base/command_line.h"

#include <fcntl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <vector>

#include "base/descriptors.h"
#include "base/suggestion.h"
#include "base/text.h"

namespace base {
namespace {

// Thrown through CLI11, which ends parsing on it as on --help.
struct Printed : CLI::Success {
  Printed() : CLI::Success("printed", "", CLI::ExitCodes::Success) {}
};

// What was printed may still wait in a buffer for a device that is full. At the end of a program that would succeed.
void check_output(int code, void*) {
  if (code != 0) return;
  const bool is_good = std::cout.flush().good() && std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  if (is_good || output_is_closed()) return;
  std::fputs("the output cannot be written\n", stderr);
  _exit(1);
}

// Troff takes a leading dot or quote for a request, and a bare hyphen for a typographic one.
std::string troff(const std::string& text) {
  std::string result;
  bool line_start = true;
  for (const char c : text) {
    if (line_start && (c == '.' || c == '\'')) result += "\\&";
    if (c == '-' || c == '\\') result += '\\';
    result += c;
    line_start = c == '\n';
  }
  return result;
}

void append_options(std::string& page, const CLI::App& app) {
  for (const auto* option : app.get_options()) {
    if (option->get_group().empty()) continue;
    page += ".TP\n.B " + troff(option->get_positional() ? option->get_name(true) : option->get_name(false, true)) + "\n" +
            troff(option->get_description()) + "\n";
  }
}

// The first line of the description, for lists of manual pages: "rtse: list, wire ..." -> "list, wire ...".
std::string summary(const CLI::App& app, const std::string& name) {
  auto line = app.get_description().substr(0, app.get_description().find('\n'));
  if (line.starts_with(name + ": ")) line.erase(0, name.size() + 2);
  return line;
}

// One that is closed would be the number of the next file that is opened, and what is printed would go there. In its place comes one that
// can be neither read nor written, so that whoever looks finds out.
void keep_standard_files() {
  for (const int file : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(file, F_GETFD) != -1 || errno != EBADF) continue;
    (void)open("/dev/null", file == STDIN_FILENO ? O_WRONLY : O_RDONLY);  // the lowest number that is free
  }
}

void append_option_names(std::vector<std::string>& names, const CLI::App& app) {
  for (const auto* option : app.get_options()) {
    for (const auto& name : option->get_lnames()) names.push_back("--" + name);
  }
}

// The line for a word that the chosen command does not take. Of several, the first of the command line that looks like an option.
std::string unexpected_word(const CLI::App& app, const std::vector<std::string>& words) {
  const auto left = app.remaining(true);
  const auto is_left = [&](const std::string& word) { return std::find(left.begin(), left.end(), word) != left.end(); };
  auto at = std::find_if(words.begin(), words.end(), [&](const std::string& word) { return word.starts_with("-") && is_left(word); });
  if (at == words.end()) at = std::find_if(words.begin(), words.end(), is_left);
  if (at == words.end()) return "unexpected arguments";
  if (!at->starts_with("--")) return (at->starts_with("-") ? "unknown option " : "unexpected argument ") + in_quotes(*at);
  std::vector<std::string> known;
  const CLI::App* command = &app;
  append_option_names(known, *command);
  while (!command->get_subcommands().empty()) append_option_names(known, *(command = command->get_subcommands().front()));
  const std::string name = at->substr(0, at->find('='));
  return "unknown option " + in_quotes(name) + suggestion(name, known);
}

}  // namespace

std::string manual_page(const Command& program, const std::string& name, const std::string& version) {
  const CLI::App& app = program.inner();
  std::string page = ".TH " + name + " 1 \"\" \"rtm-sim " + version + "\"\n.SH NAME\n" + troff(name) + " \\- " + troff(summary(app, name)) +
                     "\n.SH DESCRIPTION\n" + troff(app.get_description()) + "\n";
  page += ".SH OPTIONS\n";
  append_options(page, app);
  std::vector<std::string> groups;
  const auto commands = commands_of(app);
  for (const auto* command : commands) {
    if (std::find(groups.begin(), groups.end(), command->get_group()) == groups.end()) groups.push_back(command->get_group());
  }
  for (const auto& group : groups) {
    page += groups.size() == 1 ? ".SH COMMANDS\n" : ".SH COMMANDS: " + troff(group) + "\n";
    for (const auto* command : commands) {
      if (command->get_group() != group) continue;
      page += ".SS " + troff(command->get_name()) + "\n" + troff(command->get_description()) + "\n";
      append_options(page, *command);
    }
  }
  return page + ".SH EXIT STATUS\n0: done; 1: failed, the reason is on standard error; 2: the command line was wrong.\n";
}

void add_standard_options(Command& program, const std::string& name, const std::string& version) {
  CLI::App& app = program.inner();
  static const bool is_checked = on_exit(&check_output, nullptr) == 0;
  (void)is_checked;
  app.set_version_flag("--version", name + " " + version);
  app.add_option_function<std::string>(
         "--completion",
         [name](const std::string& shell) {
           std::cout << completion_script(name, shell);
           throw Printed();
         },
         "Print the completion script of a shell: bash or zsh")
      ->check(CLI::IsMember({"bash", "zsh"}))
      ->trigger_on_parse();
  app.add_flag_callback(
         "--man",
         [&program, name, version] {
           std::cout << manual_page(program, name, version);
           throw Printed();
         },
         "Print the manual page (view it with: man -l)")
      ->trigger_on_parse();
}

std::optional<int> parse_command_line(Command& program, const std::string& name, int argc, const char* const* argv, const Offers& offers) {
  keep_standard_files();
  (void)std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error of who writes it, and has a name
  if (argc > 1 && std::string_view(argv[1]) == "--complete") {
    const auto completion = complete(program, {argv + 2, argv + argc}, offers);
    if (completion.files) std::cout << ":files\n";
    for (const auto& offer : completion.offers) std::cout << offer.text << '\t' << offer.description << '\n';
    return 0;
  }
  if (const auto unknown = unknown_command(program, {argv + 1, argv + argc})) {
    std::cerr << name << ": unknown command " << in_quotes(unknown->word) << suggestion(unknown->word, unknown->known) << "; see " << name
              << " --help\n";
    return 2;
  }
  try {
    program.inner().parse(argc, argv);
    return std::nullopt;
  } catch (const Printed&) {
    return 0;
  } catch (const BadFile& e) {
    std::cerr << name << ": " << e.message << '\n';
    return 2;
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return program.inner().exit(e);
    // A required option may be there with a wrong name, which is what is to be said then.
    const bool is_about_words = dynamic_cast<const CLI::ExtrasError*>(&e) != nullptr ||
                                (dynamic_cast<const CLI::RequiredError*>(&e) != nullptr && !program.inner().remaining(true).empty());
    std::cerr << name << ": " << (is_about_words ? unexpected_word(program.inner(), {argv + 1, argv + argc}) : e.what()) << "; see " << name
              << " --help\n";
    return 2;
  }
}

}  // namespace base
