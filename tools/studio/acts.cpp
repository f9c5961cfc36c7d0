#include "studio/acts.h"

#include <algorithm>

namespace studio {

const Act* find_act(std::string_view name) {
  static const std::vector<Act> all = [] {
    std::vector<Act> acts;
    for (const auto& some : {system_acts(), manager_acts(), world_acts(), look_acts()}) acts.insert(acts.end(), some.begin(), some.end());
    return acts;
  }();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Act& act) { return act.name == name; });
  return found == all.end() ? nullptr : &*found;
}

std::string subject_of(const Act& act, const Json& args) {
  return act.is_reading ? std::string() : text_or(args, "path", text_or(args, "model", ""));
}

base::Error read_only() { return {"this studio is read-only"}; }

std::vector<std::string> simctl_words(std::uint32_t server_id) {
  std::vector<std::string> words{"simctl"};
  if (server_id != 0) words.insert(words.end(), {"-s", std::to_string(server_id)});
  return words;
}

}  // namespace studio
