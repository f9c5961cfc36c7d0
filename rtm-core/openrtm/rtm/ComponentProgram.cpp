#include "rtm/ComponentProgram.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <iostream>
#include <new>
#include <string_view>
#include <system_error>

#include "rtm/Manager.h"

namespace RTC {
namespace {

struct OptionText {
  const char* name;
  const char* value;  // empty: takes none
  const char* meaning;
};

// What the manager reads, and what is answered here; --help, the manual page and the completion are made of it.
constexpr std::array options{
    OptionText{"-f", "FILE", "configuration file (rtc.conf)"},
    OptionText{"-o", "KEY:VALUE", "one setting, e.g. corba.nameservers:127.0.0.1:2809 (many)"},
    OptionText{"-a", "", "no manager service for tools"},
    OptionText{"-d", "", "be the master manager"},
    OptionText{"-p", "PORT", "port of the manager"},
    OptionText{"--help", "", "print this and end"},
    OptionText{"--version", "", "print the version and end"},
    OptionText{"--completion", "SHELL", "print the completion script of a shell: bash or zsh"},
    OptionText{"--man", "", "print the manual page"},
};

std::string description(const std::string& component) {
  return "makes one component of type " + component + " and runs until Ctrl+C or SIGTERM";
}

std::string spelled(const OptionText& option) { return std::string(option.name) + (*option.value == '\0' ? "" : " ") + option.value; }

std::string help(const std::string& program, const std::string& component) {
  auto text = program + ": " + description(component) + "\nusage: " + program + " [OPTIONS]\n";
  for (const auto& option : options) {
    auto name = spelled(option);
    name.resize(std::max<std::size_t>(name.size(), 20), ' ');
    text += "  " + name + " " + option.meaning + "\n";
  }
  return text + "Its parameters, ports and state: rtse cat " + component + "0\n";
}

std::string with_hyphens(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '-') result += '\\';
    result += c;
  }
  return result;
}

std::string manual(const std::string& program, const std::string& component, const std::string& version) {
  auto page = ".TH " + program + " 1 \"\" \"rtm-sim " + version + "\"\n.SH NAME\n" + program + " \\- " + description(component) +
              "\n.SH DESCRIPTION\nIts parameters, ports and state: rtse cat " + component + "0\n.SH OPTIONS\n";
  for (const auto& option : options) page += ".TP\n.B " + with_hyphens(spelled(option)) + "\n" + with_hyphens(option.meaning) + "\n";
  return page + ".SH EXIT STATUS\n0: ended as asked; 1: failed, the reason is on standard error; 2: the command line was wrong.\n";
}

std::string bash_script(const std::string& program) {
  std::string names;
  for (const auto& option : options) names += std::string(names.empty() ? "" : " ") + option.name;
  return "_" + program +
         "_completion() {\n  local current=\"${COMP_WORDS[COMP_CWORD]}\"\n  COMPREPLY=()\n"
         "  if [[ ${COMP_WORDS[COMP_CWORD-1]} == --completion ]]; then\n    COMPREPLY=($(compgen -W \"bash zsh\" -- \"$current\"))\n"
         "  elif [[ $current == -* ]]; then\n    COMPREPLY=($(compgen -W \"" +
         names +
         "\" -- \"$current\"))\n  fi\n}\n"
         "complete -o default -F _" +
         program + "_completion " + program + "\n";
}

std::string zsh_script(const std::string& program) {
  std::string specifications;
  for (const auto& option : options) {
    const std::string_view value = option.value;
    specifications += std::string(" \\\n    '") + option.name + "[" + option.meaning + "]";
    if (value == "FILE") specifications += ":file:_files";
    if (value == "SHELL") specifications += ":shell:(bash zsh)";
    if (value == "KEY:VALUE" || value == "PORT") specifications += ":value:";
    specifications += "'";
  }
  return "#compdef " + program + "\n_" + program + "() {\n  _arguments" + specifications + "\n}\nif [[ ${funcstack[1]} == _" + program +
         " ]]; then\n  _" + program + " \"$@\"\nelse\n  compdef _" + program + " " + program + "\nfi\n";
}

}  // namespace

std::optional<int> answerForItself(int argc, char** argv, const std::string& component, const std::string& version) {
  const auto program = component + "Comp";
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    std::string text;
    if (word == "--help" || word == "-h") text = help(program, component);
    if (word == "--version") text = program + " " + version + "\n";
    if (word == "--man") text = manual(program, component, version);
    if (word == "--completion") {
      const std::string_view shell = i + 1 < argc ? argv[i + 1] : "";
      if (shell != "bash" && shell != "zsh") {
        std::cerr << program << ": --completion: expected bash or zsh, got \"" << shell << "\"\n";
        return 2;
      }
      text = shell == "bash" ? bash_script(program) : zsh_script(program);
    }
    if (text.empty()) continue;
    std::cout << text << std::flush;
    if (std::cout.good()) return EXIT_SUCCESS;
    std::cerr << program << ": the output cannot be written\n";
    return EXIT_FAILURE;
  }
  return std::nullopt;
}

namespace {

// The manager calls back with itself only.
struct Program {
  std::string component;
  void (*init)(Manager*) = nullptr;
  bool is_made = false;
};

Program& program() {
  static Program one;
  return one;
}

void make_component(Manager* manager) {
  program().init(manager);
  program().is_made = manager->createComponent(program().component.c_str()) != nullptr;
}

}  // namespace

int runComponentProgram(int argc, char** argv, const std::string& component, const std::string& version, void (*init)(Manager*)) try {
  if (const auto answered = answerForItself(argc, argv, component, version)) return *answered;
  program() = {component, init};
  Manager* manager = Manager::init(argc, argv);
  manager->setModuleInitProc(make_component);
  manager->activateManager();
  if (!program().is_made) {
    std::cerr << component << "Comp: the component could not be created" << std::endl;
    manager->shutdown();
    return EXIT_FAILURE;
  }
  manager->runManager();
  return EXIT_SUCCESS;
} catch (const std::system_error& e) {
  std::cerr << component << "Comp: out of system resources (threads or files): " << e.what() << std::endl;
  std::_Exit(EXIT_FAILURE);  // what has been started cannot be ended in order
} catch (const std::bad_alloc&) {
  std::cerr << component << "Comp: out of memory" << std::endl;
  std::_Exit(EXIT_FAILURE);
}

}  // namespace RTC
