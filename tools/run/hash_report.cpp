#include "run/hash_report.h"

#include <array>
#include <bit>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/text.h"
#include "run/run_hashes.h"
#include "system/value_codec.h"

namespace tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array pose_members = {"position.x",    "position.y",    "position.z",   "orientation.w",
                                     "orientation.x", "orientation.y", "orientation.z"};

Json pose_of(const std::string& octets) {
  Json pose = Json::object();
  for (std::size_t i = 0; i < pose_members.size() && octets.size() >= 8 * (i + 1); ++i) {
    std::uint64_t word = 0;
    for (std::size_t k = 0; k < 8; ++k) word |= static_cast<std::uint64_t>(static_cast<unsigned char>(octets[8 * i + k])) << (8 * k);
    pose[pose_members[i]] = std::bit_cast<double>(word);
  }
  return pose;
}

// Null when it is not known, or was too long to be kept.
Json value_of(const base::HashKey& key, const std::optional<base::HashEntry>& entry) {
  if (!entry || entry->value.empty()) return nullptr;
  if (key.kind == base::HashKey::Kind::model) return pose_of(entry->value);
  const auto type = type_code_of(key.type);
  if (CORBA::is_nil(type)) return nullptr;
  auto value = decode(type, {reinterpret_cast<const unsigned char*>(entry->value.data()), entry->value.size()});
  return value ? std::move(*value) : Json(nullptr);
}

struct Member {
  std::string path;
  Json a, b;
};

// The first in which they differ; numbers by their bits.
std::optional<Member> first_member(const Json& a, const Json& b, const std::string& path) {
  const auto below = [&](const std::string& name) { return path.empty() ? name : path + "." + name; };
  if (a.is_object() && b.is_object()) {
    for (const auto& [name, value] : a.items()) {
      if (!b.contains(name)) return Member{below(name), value, nullptr};
      if (auto found = first_member(value, b[name], below(name))) return found;
    }
    return std::nullopt;
  }
  if (a.is_array() && b.is_array()) {
    if (a.size() != b.size()) return Member{path + " (length)", a.size(), b.size()};
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (auto found = first_member(a[i], b[i], path + "[" + std::to_string(i) + "]")) return found;
    }
    return std::nullopt;
  }
  if (a.is_number_float() && b.is_number_float()) {
    const bool is_same = std::bit_cast<std::uint64_t>(a.get<double>()) == std::bit_cast<std::uint64_t>(b.get<double>());
    return is_same ? std::nullopt : std::optional(Member{path, a, b});
  }
  return a == b ? std::nullopt : std::optional(Member{path, a, b});
}

std::string what_differs(const base::HashDifference& difference) {
  if (!difference.b) return "something happened in the first run only";
  if (!difference.a) return "something happened in the second run only";
  const Json a = value_of(difference.key, difference.a), b = value_of(difference.key, difference.b);
  if (a.is_null() || b.is_null()) return "hashes " + hash_text(difference.a->hash) + " and " + hash_text(difference.b->hash);
  if (const auto member = first_member(a, b, "")) return member->path + " is " + member->a.dump() + " and " + member->b.dump();
  if (difference.key.kind == base::HashKey::Kind::model) return "its pose is the same; velocities, joints or drives differ";
  return "several samples, of which the last are the same";
}

std::string seconds(std::chrono::nanoseconds time) { return base::format_number(base::to_seconds(time)) + " s"; }

std::string incomplete(const base::HashComparison& comparison) {
  if (comparison.ticks == 0) return "cannot compare: both logs have no tick";
  if (comparison.is_complete_a && comparison.is_complete_b) return "";
  const std::string which = comparison.is_complete_a   ? "the second run has"
                            : comparison.is_complete_b ? "the first run has"
                                                       : "both runs have";
  return "no difference in " + std::to_string(comparison.ticks) + " ticks, but " + which + " not come to the end";
}

}  // namespace

std::string difference_text(const base::HashComparison& comparison) {
  if (!comparison.first) return incomplete(comparison);
  const auto& first = *comparison.first;
  std::string text = "first difference at " + seconds(first.time) + " (tick " + std::to_string(first.tick) +
                     (first.run > 0 ? ", after reset " + std::to_string(first.run) : "") + "): " + first.key.text() + ": " +
                     what_differs(first);
  constexpr std::size_t enough = 5;
  for (std::size_t i = 0; i < comparison.others.size() && i < enough; ++i)
    text += (i == 0 ? "; in the same tick also " : ", ") + comparison.others[i].text();
  if (comparison.others.size() > enough) text += " and " + std::to_string(comparison.others.size() - enough) + " more";
  return text;
}

Json difference_json(const base::HashComparison& comparison) {
  const auto text = difference_text(comparison);
  Json json{{"same", text.empty()}, {"ticks", comparison.ticks}, {"hash", hash_text(comparison.hash)}, {"difference", text}};
  if (!comparison.first) return json;
  const auto& first = *comparison.first;
  json["first"] = {{"time", base::to_seconds(first.time)},
                   {"tick", first.tick},
                   {"run", first.run},
                   {"where", first.key.text()},
                   {"a", value_of(first.key, first.a)},
                   {"b", value_of(first.key, first.b)}};
  for (const auto& other : comparison.others) json["also"].push_back(other.text());
  return json;
}

}  // namespace tools
