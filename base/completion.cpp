#include "base/completion.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <utility>

#include "base/text.h"

namespace base {

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  std::vector<const CLI::App*> all;
  for (const auto* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (!command->get_name().empty() && !command->get_group().empty()) all.push_back(command);
  }
  return all;
}

namespace {

std::vector<const CLI::Option*> options_of(const CLI::App& app, bool positional) {
  std::vector<const CLI::Option*> found;
  for (const auto* option : app.get_options()) {
    if (!option->get_group().empty() && option->get_positional() == positional) found.push_back(option);
  }
  return found;
}

const CLI::Option* find_option(const CLI::App& app, const std::string& word) {
  const auto has = [&](const CLI::Option* option) {
    return word.starts_with("--") ? option->check_lname(word.substr(2)) : word.size() == 2 && option->check_sname(word.substr(1));
  };
  const auto all = options_of(app, false);
  const auto found = std::ranges::find_if(all, has);
  return found == all.end() ? nullptr : *found;
}

bool takes_value(const CLI::Option* option) { return option->get_items_expected_max() > 0; }

// Where the words before the cursor have led to.
struct Place {
  const CLI::App* command = nullptr;
  const CLI::Option* pending = nullptr;  // an option that waits for its value
  std::size_t positionals = 0;
  bool only_positionals = false;  // after "--"
};

Place walk(const CLI::App& app, const std::vector<std::string>& words) {
  Place place{&app};
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    const auto& word = words[i];
    if (place.pending) {
      place.pending = nullptr;
    } else if (!place.only_positionals && word == "--") {
      place.only_positionals = true;
    } else if (!place.only_positionals && word.size() > 1 && word.front() == '-') {
      const auto* option = find_option(*place.command, word);
      if (!option) option = find_option(app, word);
      if (option && takes_value(option)) place.pending = option;
    } else {
      const auto commands = commands_of(*place.command);
      const auto command = std::ranges::find_if(commands, [&](const CLI::App* one) { return one->get_name() == word; });
      if (command == commands.end()) {
        ++place.positionals;
      } else {
        place = Place{*command};
      }
    }
  }
  return place;
}

const CLI::Option* positional_at(const CLI::App& app, std::size_t index) {
  std::size_t first = 0;
  for (const auto* option : options_of(app, true)) {
    const auto count = static_cast<std::size_t>(std::max(option->get_items_expected_max(), 1));
    if (index < first + count) return option;
    first += count;
  }
  return nullptr;
}

// "TEXT:{bash,zsh}" -> bash, zsh.
std::vector<std::string> fixed_words(const CLI::Option* option) {
  const auto type = option->get_type_name();
  const auto open = type.find('{'), close = type.find('}');
  if (open == std::string::npos || close == std::string::npos || close < open) return {};
  return split_list(type.substr(open + 1, close - open - 1), ',');
}

void offer_value(const CLI::Option* option, const std::vector<std::string>& words, const std::string& current, const Offers& offers,
                 Completion& completion) {
  const auto name = option->get_positional()       ? option->get_name(true)
                    : option->get_lnames().empty() ? option->get_name()
                                                   : "--" + option->get_lnames().front();
  if (offers) {
    if (auto own = offers(name, {words.begin(), words.end() - 1}, current)) {
      completion.offers = std::move(*own);
      return;
    }
  }
  for (auto& word : fixed_words(option)) completion.offers.push_back({std::move(word)});
  const auto type = option->get_type_name();
  const bool is_number = type.starts_with("INT") || type.starts_with("UINT") || type.starts_with("FLOAT");
  completion.files = completion.offers.empty() && !is_number;
}

void offer_options(const CLI::App& app, Completion& completion) {
  for (const auto* option : options_of(app, false)) {
    for (const auto& name : option->get_lnames()) completion.offers.push_back({"--" + name, option->get_description()});
    for (const auto& name : option->get_snames()) completion.offers.push_back({"-" + name, option->get_description()});
  }
}

}  // namespace

std::optional<UnknownCommand> unknown_command(const Command& program, const std::vector<std::string>& words) {
  const CLI::App& app = program.inner();
  const CLI::App* place = &app;
  bool is_value = false;
  for (const auto& word : words) {
    if (std::exchange(is_value, false)) continue;
    if (word.size() > 1 && word.front() == '-') {
      const auto* own = find_option(*place, word);
      const auto* option = own ? own : find_option(app, word);
      if (!option && word.find('=') == std::string::npos) return std::nullopt;  // it is what is wrong
      is_value = option && takes_value(option);
      continue;
    }
    const auto commands = commands_of(*place);
    if (commands.empty() || (place != &app && !options_of(*place, true).empty())) return std::nullopt;
    const auto found = std::ranges::find_if(commands, [&](const CLI::App* one) { return one->get_name() == word; });
    if (found == commands.end()) {
      UnknownCommand unknown{word, {}};
      for (const auto* command : commands) unknown.known.push_back(command->get_name());
      return unknown;
    }
    place = *found;
  }
  return std::nullopt;
}

Completion complete(const Command& program, const std::vector<std::string>& words, const Offers& offers) {
  const CLI::App& app = program.inner();
  Completion completion;
  if (words.empty()) return completion;
  const auto place = walk(app, words);
  const auto& current = words.back();
  const auto equals = current.find('=');
  if (place.pending) {
    offer_value(place.pending, words, current, offers, completion);
  } else if (!place.only_positionals && current.starts_with("--") && equals != std::string::npos) {
    const auto* option = find_option(*place.command, current.substr(0, equals));
    if (!option) option = find_option(app, current.substr(0, equals));
    if (option) offer_value(option, words, current.substr(equals + 1), offers, completion);
    for (auto& offer : completion.offers) offer.text.insert(0, current.substr(0, equals + 1));
  } else if (!place.only_positionals && current.starts_with('-')) {
    offer_options(*place.command, completion);
    if (place.command != &app) offer_options(app, completion);
  } else if (const auto commands = commands_of(*place.command); !commands.empty()) {
    for (const auto* command : commands) completion.offers.push_back({command->get_name(), command->get_description()});
  } else if (const auto* positional = positional_at(*place.command, place.positionals)) {
    offer_value(positional, words, current, offers, completion);
  }
  std::erase_if(completion.offers, [&](const Offer& offer) { return !offer.text.starts_with(current); });
  for (auto& offer : completion.offers)
    std::ranges::replace_if(
        offer.description, [](char c) { return c == '\n' || c == '\t'; }, ' ');
  return completion;
}

namespace {

// Bash takes ':' and '=' for ends of words: what stands before the last of them is left out of the answers. It puts an answer into the line
// as it is, and a world or another component host may have chosen the name: it is quoted, so that Enter runs nothing of it.
constexpr const char* bash_script = R"sh(FUNCTION() {
  local line="${COMP_LINE:0:COMP_POINT}" text rest current cut=""
  local -a words found
  read -ra words <<< "$line"
  [[ $line == *[[:space:]] ]] && words+=("")
  current="${words[${#words[@]}-1]}"
  [[ $COMP_WORDBREAKS == *:* && $current == *:* ]] && cut="${current%:*}:"
  [[ $COMP_WORDBREAKS == *=* && ${current#"$cut"} == *=* ]] && cut="${current%=*}="
  COMPREPLY=()
  while IFS=$'\t' read -r text rest; do
    if [[ $text == :files ]]; then
      compopt -o filenames 2>/dev/null
      mapfile -t found < <(compgen -f -- "${current#"$cut"}")
      COMPREPLY+=("${found[@]}")
    elif [[ $text == "$current"* ]]; then
      printf -v rest %q "${text#"$cut"}"
      COMPREPLY+=("$rest")
      [[ $text == *[:=/] ]] && compopt -o nospace 2>/dev/null
    fi
  done < <("${COMP_WORDS[0]}" --complete "${words[@]:1}" 2>/dev/null)
}
complete -F FUNCTION NAME
)sh";

// A file _NAME of the function path, which zsh loads by its first line; also good to be sourced.
constexpr const char* zsh_script = R"sh(#compdef NAME
_NAME() {
  local -a whole partial
  local line text files=""
  for line in ${(f)"$(${(Q)words[1]} --complete "${(@Q)words[2,CURRENT-1]}" "${(Q)PREFIX}" 2>/dev/null)"}; do
    text=${line%%$'\t'*}
    if [[ $text == :files ]]; then
      files=1
    elif [[ $text == *[:=/] ]]; then
      partial+=("${text//:/\\:}:${line#*$'\t'}")
    else
      whole+=("${text//:/\\:}:${line#*$'\t'}")
    fi
  done
  (( $#whole )) && _describe -t values value whole
  (( $#partial )) && _describe -t values value partial -S ''
  [[ -n $files ]] && _files
  return 0
}
if [[ ${funcstack[1]} == _NAME ]]; then
  _NAME "$@"
else
  compdef _NAME NAME
fi
)sh";

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) text.replace(at, from.size(), to);
}

}  // namespace

std::string completion_script(const std::string& name, const std::string& shell) {
  std::string script = shell == "zsh" ? zsh_script : bash_script;
  std::string function = "_" + name + "_completion";
  std::ranges::replace(function, '-', '_');
  replace_all(script, "FUNCTION", function);
  replace_all(script, "NAME", name);
  return script;
}

}  // namespace base
