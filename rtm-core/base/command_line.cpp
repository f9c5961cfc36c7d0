#include "base/command_line.h"

#include <iostream>
#include <vector>

#include "base/text.h"

namespace base {
namespace {

// Thrown through CLI11, which ends parsing on it as on --help.
struct Printed : CLI::Success {
  Printed() : CLI::Success("printed", "", CLI::ExitCodes::Success) {}
};

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const auto* option : app.get_options([](const CLI::Option* candidate) { return candidate->nonpositional(); })) {
    if (option->get_group().empty()) continue;
    for (const auto& name : option->get_lnames()) names.push_back("--" + name);
    for (const auto& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

std::vector<const CLI::App*> subcommands(const CLI::App& app) {
  std::vector<const CLI::App*> all;
  for (const auto* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (!command->get_name().empty() && !command->get_group().empty()) all.push_back(command);
  }
  return all;
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
    page += ".TP\n.B " + troff(option->get_name(true)) + "\n" + troff(option->get_description()) + "\n";
  }
}

}  // namespace

std::string completion_script(const CLI::App& app, const std::string& name, const std::string& shell) {
  std::string function = "_" + name + "_completion";
  for (char& c : function) c = c == '-' ? '_' : c;
  std::string script;
  if (shell == "zsh") script += "autoload -U +X bashcompinit && bashcompinit\n";
  script += function + "() {\n  local words=\"" + join(option_names(app), " ") + "\"\n  local command=\"\"\n  local word\n";
  std::vector<std::string> names;
  for (const auto* command : subcommands(app)) names.push_back(command->get_name());
  if (!names.empty()) {
    script += "  for word in \"${COMP_WORDS[@]:1:COMP_CWORD-1}\"; do\n    case \" " + join(names, " ") +
              " \" in *\" $word \"*) command=$word; break;; esac\n  done\n";
    script += "  case \"$command\" in\n    \"\") words=\"$words " + join(names, " ") + "\";;\n";
    for (const auto* command : subcommands(app))
      script += "    " + command->get_name() + ") words=\"$words " + join(option_names(*command), " ") + "\";;\n";
    script += "  esac\n";
  }
  script += "  COMPREPLY=($(compgen -W \"$words\" -- \"${COMP_WORDS[COMP_CWORD]}\"))\n}\n";
  return script + "complete -o default -F " + function + " " + name + "\n";
}

std::string manual_page(const CLI::App& app, const std::string& name, const std::string& version) {
  std::string page = ".TH " + name + " 1 \"\" \"rtm-sim " + version + "\"\n.SH NAME\n" + name + "\n.SH DESCRIPTION\n" +
                     troff(app.get_description()) + "\n";
  page += ".SH OPTIONS\n";
  append_options(page, app);
  const auto commands = subcommands(app);
  if (!commands.empty()) page += ".SH COMMANDS\n";
  for (const auto* command : commands) {
    page += ".SS " + troff(command->get_name()) + "\n" + troff(command->get_description()) + "\n";
    append_options(page, *command);
  }
  return page + ".SH EXIT STATUS\n0: done; 1: failed, the reason is on standard error; 2: the command line was wrong.\n";
}

void add_standard_options(CLI::App& app, const std::string& name, const std::string& version) {
  app.set_version_flag("--version", name + " " + version);
  app.add_option_function<std::string>(
         "--completion",
         [&app, name](const std::string& shell) {
           std::cout << completion_script(app, name, shell);
           throw Printed();
         },
         "Print the completion script of a shell: bash or zsh")
      ->check(CLI::IsMember({"bash", "zsh"}))
      ->trigger_on_parse();
  app.add_flag_callback(
         "--man",
         [&app, name, version] {
           std::cout << manual_page(app, name, version);
           throw Printed();
         },
         "Print the manual page (view it with: man -l)")
      ->trigger_on_parse();
}

std::optional<int> parse_command_line(CLI::App& app, const std::string& name, int argc, const char* const* argv) {
  try {
    app.parse(argc, argv);
    return std::nullopt;
  } catch (const Printed&) {
    return 0;
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);
    std::cerr << name << ": " << e.what() << "; see " << name << " --help\n";
    return 2;
  }
}

}  // namespace base
