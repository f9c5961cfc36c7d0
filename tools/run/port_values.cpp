#include "run/port_values.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "run/expectation_check.h"
#include "system/value_codec.h"

namespace tools {
namespace {

using Json = nlohmann::ordered_json;

void add_numbers(const Json& json, const std::string& path, std::vector<std::string>& names) {
  constexpr std::size_t enough = 12;
  if (names.size() == enough) return;
  if (json.is_object()) {
    for (const auto& [key, value] : json.items()) add_numbers(value, path.empty() ? key : path + "." + key, names);
  } else if (json.is_array()) {
    if (!json.empty()) add_numbers(json.front(), path + "[0]", names);
  } else if (json.is_number() || json.is_boolean()) {
    names.push_back(path);
  }
}

std::string numbers_of(const Json& json) {
  std::vector<std::string> names;
  add_numbers(json, "", names);
  return names.empty() ? "none" : base::join(names, ", ");
}

void take_all(const Json& json, SeenValue& seen) {
  if (json.is_number()) return seen.take(json.get<double>());
  if (!json.is_structured()) return;
  for (const auto& value : json) take_all(value, seen);
}

std::string key_of(const Expectation& expectation) { return expectation.port + " " + expectation.member; }

bool is_within(const Expectation& limit, double number) {
  return !(limit.min && !(number >= *limit.min)) && !(limit.max && !(number <= *limit.max));  // NaN is not within
}

// [s]; not a number for a sample without a stamp.
double stamp_of(const Json& sample) {
  const auto stamp = sample.is_object() ? sample.find("tm") : sample.end();
  if (!sample.is_object() || stamp == sample.end() || !stamp->is_object()) return NAN;
  return stamp->value("sec", 0.0) + stamp->value("nsec", 0.0) * 1e-9;
}

const Json* find(const Json& sample, const std::vector<std::string>& path) {
  const Json* at = &sample;
  for (const auto& step : path) {
    const auto index = base::parse_integer(step);
    if (at->is_object() && at->contains(step)) {
      at = &(*at)[step];
    } else if (at->is_array() && index && static_cast<std::size_t>(*index) < at->size()) {
      at = &(*at)[static_cast<std::size_t>(*index)];
    } else {
      return nullptr;
    }
  }
  return at;
}

}  // namespace

Result<void> PortValues::listen(CORBA::ORB_ptr orb, const Session& session, const std::vector<Expectation>& expectations) {
  for (const auto& expectation : expectations) {
    if (expectation.kind != Expectation::Kind::value) continue;
    if (expectation.min || expectation.max) seen_.lock()->limits[key_of(expectation)].push_back(&expectation);
    const bool is_known = std::ranges::any_of(listening_, [&](const Listening& one) {
      return one.expectation->port == expectation.port && one.expectation->member == expectation.member;
    });
    if (is_known) continue;
    auto attached = attach(orb, session, expectation);
    if (!attached) return attached.error();
    listening_.push_back(std::move(*attached));
  }
  return {};
}

Result<PortValues::Listening> PortValues::attach(CORBA::ORB_ptr orb, const Session& session, const Expectation& expectation) {
  if (const auto good = check_value(session, expectation); !good) return good.error();
  auto port = session.port(expectation.port);
  if (!port) return port.error();
  const auto type = type_code_of(port->port.data_type());
  const auto path =
      expectation.member.empty() ? Result<std::vector<std::string>>(std::vector<std::string>()) : member_path(expectation.member);
  if (!path) return path.error();
  auto tap = Tap::connect(orb, port->port, {{"dataport.allow_dup_connection", "YES"}},
                          [this, type, &expectation, path = *path](std::span<const unsigned char> payload, bool little) {
                            take(type, expectation, path, payload, little);
                          });
  if (!tap) return tap.error();
  return Listening{&expectation, port->component.instance, std::move(*tap)};
}

void PortValues::forget(const std::set<std::string>& instances) {
  for (const auto& one : listening_) {
    if (!instances.contains(one.instance)) continue;
    auto all = seen_.lock();
    if (const auto found = all->values.find(key_of(*one.expectation)); found != all->values.end()) found->second.is_over = true;
  }
}

Result<void> PortValues::listen_again(CORBA::ORB_ptr orb, const Session& session, const std::set<std::string>& instances) {
  for (auto& one : listening_) {
    if (!instances.contains(one.instance)) continue;
    auto attached = attach(orb, session, *one.expectation);
    if (!attached) return attached.error();
    one = std::move(*attached);
  }
  return {};
}

std::optional<SeenValue> PortValues::so_far(const std::string& port, const std::string& member) const {
  const auto all = seen_.lock();
  const auto found = all->values.find(port + " " + member);
  return found == all->values.end() || found->second.is_over ? std::nullopt : std::optional(found->second);
}

std::map<std::string, SeenValue> PortValues::end() {
  listening_.clear();
  return seen_.lock()->values;
}

void PortValues::take(CORBA::TypeCode_ptr type, const Expectation& expectation, const std::vector<std::string>& path,
                      std::span<const unsigned char> payload, bool little) {
  const auto sample = decode(type, payload, little);
  if (sample && path.empty()) {
    auto all = seen_.lock();
    return take_all(*sample, all->values[key_of(expectation)]);
  }
  const Json* member = sample ? find(*sample, path) : nullptr;
  std::string problem;
  double number = 0;
  if (!sample) {
    problem = "the samples cannot be decoded: " + sample.error().message;
  } else if (member && member->is_boolean()) {
    number = member->get<bool>() ? 1 : 0;
  } else if (member && member->is_number()) {
    number = member->get<double>();
  } else {
    problem = "the samples have no number " + expectation.member + "; they have " + numbers_of(*sample);
  }
  auto all = seen_.lock();
  auto& seen = all->values[key_of(expectation)];
  if (!problem.empty()) {
    seen.problem = problem;
    return;
  }
  seen.take(number);
  for (const auto* limit : all->limits[key_of(expectation)]) {
    if (!is_within(*limit, number)) seen.violated_at.try_emplace(limit->text, stamp_of(*sample));
  }
}

}  // namespace tools
