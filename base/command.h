// Declares options, positionals and subcommands of a program. CLI11 parses, and writes help and errors; only the implementation includes
// it, because it is a heavy header. Methods have the names and the meaning of CLI11. Declarations live as long as their Command. One thread
// at a time.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace base {

// What a value must be: nothing for a good word, else what is wrong with it.
struct Check {
  std::function<std::string(std::string&)> problem;
  std::string kind = "";  // stands in the help after the option: "INT in [1 - 64]"
};

Check integer_between(int low, int high);
// No NaN either.
Check number_between(double low, double high);
// A file that can be read. What is wrong with it is a BadFile, which parse_command_line tells: the form of the command line is right.
struct BadFile {
  std::string message;
};
Check existing_file();
enum class Case { matters, does_not_matter };
Check one_of(std::vector<std::string> words, Case letters = Case::matters);

// For callbacks: the command line is wrong as `expectation` says, or lacks `what`. parse_command_line tells it in one line.
[[noreturn]] void reject_command_line(const std::string& where, const std::string& expectation);
[[noreturn]] void require_on_command_line(const std::string& what);

class Option final {
 public:
  explicit Option(CLI::Option& inner) : inner_(inner) {}

  Option* required();
  Option* check(const Check& check);
  Option* check(std::function<std::string(const std::string&)> problem);
  Option* seconds_between(double low, double high);  // the value is a time, as parse_seconds reads it: 30, 500ms, 2min
  Option* capture_default_str();                     // the help shows the value that the variable has now
  Option* expected(int count);
  Option* expected(int min, int max);
  Option* description(const std::string& text);
  Option* type_name(const std::string& text);
  Option* group(const std::string& text);
  Option* envname(const std::string& variable);
  Option* needs(const Option* other);
  Option* needs(const std::string& other);
  Option* excludes(const Option* other);
  Option* allow_extra_args(bool allowed);
  Option* delimiter(char letter);
  Option* take_all();
  Option* each(const std::function<void(std::string)>& taken);
  std::size_t count() const;  // how often the user gave it

 private:
  CLI::Option& inner_;
};

class Command final {
 public:
  explicit Command(const std::string& description = "", const std::string& name = "");
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;
  ~Command();

  // For the types of value that command.cpp lists.
  template <class Value>
  Option* add_option(const std::string& names, Value& value, const std::string& description = "");
  template <class Value>
  Option* add_flag(const std::string& names, Value& value, const std::string& description = "");
  Option* add_option(const std::string& names);
  Option* add_flag(const std::string& names);
  Option* option(const std::string& name);  // one that was added

  Command* add_subcommand(const std::string& name, const std::string& description = "");
  // The help and the manual page list these subcommands below `title`. Names that were not added are ignored.
  Command* group_subcommands(const std::string& title, const std::vector<std::string>& names);
  Command* callback(std::function<void()> work);  // when the command line has been read, and names this command
  Command* require_subcommand(int count);
  Command* fallthrough(bool falls = true);
  Command* prefix_command();
  Command* allow_extras();
  Command* footer(const std::string& text);
  Command* without_help();
  std::vector<std::string> remaining() const;
  std::size_t count(const std::string& option) const;  // of one that was added
  bool has(const std::string& option) const;

  CLI::App& inner() { return *inner_; }
  const CLI::App& inner() const { return *inner_; }

 private:
  explicit Command(CLI::App& inner);
  Option* keep(CLI::Option* option);

  std::unique_ptr<CLI::App> own_;  // none in a subcommand, which its parent owns
  CLI::App* inner_;
  std::vector<std::unique_ptr<Command>> commands_;
  std::vector<std::unique_ptr<Option>> options_;
};

}  // namespace base
