#include "base/command.h"

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>

#include "base/plain_file.h"
#include "base/text.h"

namespace base {
namespace {

Check like(const CLI::Validator& validator) {
  return {[validator](std::string& word) { return validator(word); }, validator.get_description()};
}

}  // namespace

Check integer_between(int low, int high) { return like(CLI::Range(low, high)); }

Check number_between(double low, double high) {
  const auto range = format_number(low) + " - " + format_number(high);
  return {[=](const std::string& text) {
            const auto value = parse_number(text);
            return value && *value >= low && *value <= high ? std::string() : "must be a number in [" + range + "], got " + text;
          },
          "FLOAT in [" + range + "]"};
}

Check existing_file() {
  return {[](const std::string& file) {
            if (const auto problem = file_problem(file); !problem.empty()) throw BadFile{"file " + in_quotes(file) + ": " + problem};
            return std::string();
          },
          "FILE"};
}

Check one_of(std::vector<std::string> words, Case letters) {
  return like(letters == Case::matters ? CLI::IsMember(std::move(words)) : CLI::IsMember(std::move(words), CLI::ignore_case));
}

void reject_command_line(const std::string& where, const std::string& expectation) { throw CLI::ValidationError(where, expectation); }

void require_on_command_line(const std::string& what) { throw CLI::RequiredError(what); }

Option* Option::required() {
  inner_.required();
  return this;
}

Option* Option::check(const Check& check) {
  inner_.check(CLI::Validator(check.problem, check.kind));
  return this;
}

Option* Option::check(std::function<std::string(const std::string&)> problem) {
  inner_.check(std::move(problem));
  return this;
}

Option* Option::seconds_between(double low, double high) {
  const auto range = format_number(low) + " - " + format_number(high);
  inner_.transform(CLI::Validator(
      [=](std::string& word) {
        const auto value = parse_seconds(word);
        if (!value || *value < low || *value > high) return "must be a time in [" + range + "] s, as 30, 500ms or 2min, got " + word;
        word = format_number(*value);
        return std::string();
      },
      "SECONDS in [" + range + "]"));
  return this;
}

Option* Option::capture_default_str() {
  inner_.capture_default_str();
  return this;
}

Option* Option::expected(int count) {
  inner_.expected(count);
  return this;
}

Option* Option::expected(int min, int max) {
  inner_.expected(min, max);
  return this;
}

Option* Option::description(const std::string& text) {
  inner_.description(text);
  return this;
}

Option* Option::type_name(const std::string& text) {
  inner_.type_name(text);
  return this;
}

Option* Option::group(const std::string& text) {
  inner_.group(text);
  return this;
}

Option* Option::envname(const std::string& variable) {
  inner_.envname(variable);
  return this;
}

Option* Option::needs(const Option* other) {
  inner_.needs(&other->inner_);
  return this;
}

Option* Option::needs(const std::string& other) {
  inner_.needs(other);
  return this;
}

Option* Option::excludes(const Option* other) {
  inner_.excludes(&other->inner_);
  return this;
}

Option* Option::allow_extra_args(bool allowed) {
  inner_.allow_extra_args(allowed);
  return this;
}

Option* Option::delimiter(char letter) {
  inner_.delimiter(letter);
  return this;
}

Option* Option::take_all() {
  inner_.take_all();
  return this;
}

Option* Option::each(const std::function<void(std::string)>& taken) {
  inner_.each(taken);
  return this;
}

std::size_t Option::count() const { return inner_.count(); }

Command::Command(const std::string& description, const std::string& name)
    : own_(std::make_unique<CLI::App>(description, name)), inner_(own_.get()) {}

Command::Command(CLI::App& inner) : inner_(&inner) {}

Command::~Command() = default;

Option* Command::keep(CLI::Option* option) { return options_.emplace_back(std::make_unique<Option>(*option)).get(); }

template <class Value>
Option* Command::add_option(const std::string& names, Value& value, const std::string& description) {
  return keep(inner_->add_option(names, value, description));
}

template <class Value>
Option* Command::add_flag(const std::string& names, Value& value, const std::string& description) {
  return keep(inner_->add_flag(names, value, description));
}

// The types of values on our command lines.
template Option* Command::add_option(const std::string&, std::string&, const std::string&);
template Option* Command::add_option(const std::string&, std::vector<std::string>&, const std::string&);
template Option* Command::add_option(const std::string&, std::vector<double>&, const std::string&);
template Option* Command::add_option(const std::string&, double&, const std::string&);
template Option* Command::add_option(const std::string&, int&, const std::string&);
template Option* Command::add_option(const std::string&, std::uint16_t&, const std::string&);
template Option* Command::add_option(const std::string&, std::uint32_t&, const std::string&);
template Option* Command::add_option(const std::string&, std::uint64_t&, const std::string&);
template Option* Command::add_option(const std::string&, std::int64_t&, const std::string&);
template Option* Command::add_option(const std::string&, std::optional<double>&, const std::string&);
template Option* Command::add_option(const std::string&, std::optional<std::uint64_t>&, const std::string&);
template Option* Command::add_option(const std::string&, std::optional<std::string>&, const std::string&);
template Option* Command::add_flag(const std::string&, bool&, const std::string&);

Option* Command::add_option(const std::string& names) { return keep(inner_->add_option(names)); }

Option* Command::add_flag(const std::string& names) { return keep(inner_->add_flag(names)); }

Option* Command::option(const std::string& name) { return keep(inner_->get_option(name)); }

Command* Command::add_subcommand(const std::string& name, const std::string& description) {
  commands_.push_back(std::unique_ptr<Command>(new Command(*inner_->add_subcommand(name, description))));
  return commands_.back().get();
}

Command* Command::group_subcommands(const std::string& title, const std::vector<std::string>& names) {
  const auto is_named = [&](const CLI::App* command) { return std::find(names.begin(), names.end(), command->get_name()) != names.end(); };
  for (auto* command : inner_->get_subcommands(is_named)) command->group(title);
  return this;
}

Command* Command::callback(std::function<void()> work) {
  inner_->callback(std::move(work));
  return this;
}

Command* Command::require_subcommand(int count) {
  inner_->require_subcommand(count);
  return this;
}

Command* Command::fallthrough(bool falls) {
  inner_->fallthrough(falls);
  return this;
}

Command* Command::prefix_command() {
  inner_->prefix_command();
  return this;
}

Command* Command::allow_extras() {
  inner_->allow_extras();
  return this;
}

Command* Command::footer(const std::string& text) {
  inner_->footer(text);
  return this;
}

Command* Command::without_help() {
  inner_->set_help_flag();
  return this;
}

std::vector<std::string> Command::remaining() const { return inner_->remaining(); }

std::size_t Command::count(const std::string& option) const { return inner_->count(option); }

bool Command::has(const std::string& option) const { return inner_->get_option_no_throw(option) != nullptr; }

}  // namespace base
