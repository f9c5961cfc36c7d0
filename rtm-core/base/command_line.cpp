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

// 'NAME:DESCRIPTION' as zsh's _describe wants it: one line, colons of the name escaped, in single quotes.
std::string zsh_entry(const std::string& name, const std::string& description) {
  std::string entry = "'";
  const auto append = [&](const std::string& text, bool is_name) {
    for (const char c : text) {
      if (c == '\'') entry += "'\\''";
      if (c == ':' && is_name) entry += "\\:";
      if (c == '\n') entry += ' ';
      if (c != '\'' && c != '\n' && (c != ':' || !is_name)) entry += c;
    }
  };
  append(name, true);
  if (!description.empty()) entry += ":";
  append(description, false);
  return entry + "'";
}

std::string zsh_options(const CLI::App& app) {
  std::string entries;
  for (const auto* option : app.get_options([](const CLI::Option* candidate) { return candidate->nonpositional(); })) {
    if (option->get_group().empty()) continue;
    for (const auto& name : option->get_lnames()) entries += " " + zsh_entry("--" + name, option->get_description());
    for (const auto& name : option->get_snames()) entries += " " + zsh_entry("-" + name, option->get_description());
  }
  return entries;
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

}  // namespace

namespace {

// A file _NAME of the function path, which zsh loads by its first line; also good to be sourced.
std::string zsh_completion(const CLI::App& app, const std::string& name) {
  const auto commands = subcommands(app);
  std::string script = "#compdef " + name + "\n_" + name + "() {\n  local -a options commands\n  local command=\"\" word\n";
  script += "  options=(" + zsh_options(app) + ")\n";
  if (!commands.empty()) {
    script += "  commands=(";
    for (const auto* command : commands) script += " " + zsh_entry(command->get_name(), command->get_description());
    script += ")\n  for word in ${words[2,CURRENT-1]}; do\n    case $word in\n";
    for (const auto* command : commands) script += "      " + command->get_name() + ") command=$word; break;;\n";
    script += "    esac\n  done\n  case $command in\n";
    for (const auto* command : commands) script += "    " + command->get_name() + ") options+=(" + zsh_options(*command) + ");;\n";
    script += "  esac\n";
  }
  script += "  if [[ ${words[CURRENT]} == -* ]]; then\n    _describe -o option options\n";
  if (!commands.empty()) script += "  elif [[ -z $command ]]; then\n    _describe command commands\n";
  script += "  else\n    _files\n  fi\n}\n";
  return script + "if [[ ${funcstack[1]} == _" + name + " ]]; then\n  _" + name + " \"$@\"\nelse\n  compdef _" + name + " " + name +
         "\nfi\n";
}

}  // namespace

std::string completion_script(const CLI::App& app, const std::string& name, const std::string& shell) {
  if (shell == "zsh") return zsh_completion(app, name);
  std::string function = "_" + name + "_completion";
  for (char& c : function) c = c == '-' ? '_' : c;
  auto script = function + "() {\n  local words=\"" + join(option_names(app), " ") + "\"\n  local command=\"\"\n  local word\n";
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
  // Where neither an option nor a command can stand, the shell offers files.
  script +=
      "  local current=\"${COMP_WORDS[COMP_CWORD]}\"\n  case \"$command$current\" in ?*) [[ $current == -* || -z $command ]] || return 0;; "
      "esac\n";
  script += "  COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n}\n";
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

CLI::Validator number_between(double low, double high) {
  const auto range = format_number(low) + " - " + format_number(high);
  return CLI::Validator(
      [=](const std::string& text) {
        const auto value = parse_number(text);
        return value && *value >= low && *value <= high ? std::string() : "must be a number in [" + range + "], got " + text;
      },
      "FLOAT in [" + range + "]");
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
