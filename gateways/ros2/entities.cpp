#include "entities.h"

#include <regex.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>

#include "bounds.h"

namespace ros2 {
namespace {

using Json = nlohmann::json;
using ros::EntityCategory;
using ros::SimulationResult;
constexpr std::size_t max_pattern = 200;

// The C library unrolls repetitions, one in another too: three characters of a client would fill the memory. It also looks for back
// references, which ERE has not, in a time that grows with each one.
bool is_cheap(const std::string& pattern) {
  constexpr double most = 1000;
  double copies = 1;
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    if (pattern[i] == '\\' && i + 1 < pattern.size() && std::isdigit(static_cast<unsigned char>(pattern[i + 1])) != 0) return false;
    if (pattern[i] != '{') continue;
    const char* at = pattern.c_str() + i + 1;
    char* end = nullptr;
    double count = std::strtod(at, &end);
    if (*end == ',') count = std::max(count, std::strtod(end + 1, &end));
    copies *= std::max(count, 1.0);
  }
  return copies <= most;
}

// A POSIX extended regular expression; one of clients, so its length and its repetitions are limited.
class Pattern {
 public:
  explicit Pattern(const std::string& text) : is_everything_(text.empty()) {
    is_good_ = is_everything_ ||
               (text.size() <= max_pattern && is_cheap(text) && ::regcomp(&compiled_, text.c_str(), REG_EXTENDED | REG_NOSUB) == 0);
  }
  ~Pattern() {
    if (is_good_ && !is_everything_) ::regfree(&compiled_);
  }
  Pattern(const Pattern&) = delete;
  Pattern& operator=(const Pattern&) = delete;
  bool is_good() const { return is_good_; }
  bool fits(const std::string& name) const { return is_everything_ || ::regexec(&compiled_, name.c_str(), 0, nullptr, 0) == 0; }

 private:
  const bool is_everything_;
  bool is_good_ = false;
  regex_t compiled_{};
};

}  // namespace

std::vector<Entity> entities_in(const std::string& list) {
  const auto json = Json::parse(list, nullptr, false);
  std::vector<Entity> entities;
  if (!json.is_object()) return entities;
  // What it feels and moves makes a robot of a model.
  std::set<std::string> robots;
  for (const auto& iface : json.value("ifaces", Json::array())) {
    if (const auto type = iface.value("type", ""); type == "truth" || type == "simulation") continue;  // of any model
    const std::string model = iface.value("model", "");
    robots.insert(model.substr(0, model.find("::")));
  }
  for (const auto& model : json.value("models", Json::array())) {
    Entity entity{.name = model.value("name", "")};
    if (robots.contains(entity.name)) entity.category = EntityCategory::robot;
    if (model.value("static", false)) entity.category = EntityCategory::static_object;
    entities.push_back(std::move(entity));
  }
  return entities;
}

std::optional<SimulationResult> problem_of(const ros::EntityFilters& filters) {
  if (!Pattern(filters.filter).is_good())
    return SimulationResult{SimulationResult::failed,
                            "filter must be a POSIX extended regular expression of at most 200 characters, with {N} of at most 1000 copies "
                            "in all; got \"" +
                                filters.filter + "\""};
  if (!filters.tags.tags.empty()) return SimulationResult{SimulationResult::unsupported, "entities have no tags: tags must be empty"};
  return problem_of(filters.bounds);
}

std::vector<Entity> filtered(std::vector<Entity> entities, const ros::EntityFilters& filters) {
  const Pattern pattern(filters.filter);
  std::erase_if(entities, [&](const Entity& entity) {
    const bool is_of_category = filters.categories.empty() || std::ranges::any_of(filters.categories, [&](const EntityCategory& one) {
                                  return one.category == entity.category;
                                });
    return !is_of_category || !pattern.fits(entity.name);
  });
  return entities;
}

}  // namespace ros2
