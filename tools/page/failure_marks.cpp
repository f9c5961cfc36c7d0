#include "page/failure_marks.h"

#include <algorithm>
#include <cctype>
#include <optional>

namespace page {
namespace {

constexpr std::size_t max_marks = 500;

// As a word of its own: "Laser0" is not in "RTCLaser0".
std::size_t place_of(const std::string& text, const std::string& name) {
  const auto is_part = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  for (auto at = text.find(name); !name.empty() && at != std::string::npos; at = text.find(name, at + 1)) {
    const auto end = at + name.size();
    if ((at == 0 || !is_part(text[at - 1])) && (end == text.size() || !is_part(text[end]))) return at;
  }
  return std::string::npos;
}

std::string named_in(const std::string& text, const studio::RecordingFacts& facts, const Json& models) {
  std::string found;
  auto first = std::string::npos;
  const auto look = [&](const std::string& name) {
    const auto at = place_of(text, name);
    if (at < first) first = at, found = name;
  };
  for (const auto& component : facts.components) look(component.value("instance", ""));
  for (const auto& model : models) look(model.value("name", ""));
  return found;
}

std::optional<double> first_error(const std::string& instance, const studio::RecordingFacts& facts) {
  for (const auto& component : facts.components) {
    const auto states = facts.states.find(component.value("path", ""));
    if (component.value("instance", "") != instance || states == facts.states.end()) continue;
    for (const auto& change : *states) {
      if (change.at(1) == "Error") return change.at(0).get<double>();
    }
  }
  return std::nullopt;
}

}  // namespace

void mark_failures(Json& summary, const studio::RecordingFacts& facts, const Json& models) {
  const double from = facts.seconds(facts.from), to = facts.seconds(facts.to);
  Json marks = summary.value("marks", Json::array());
  for (const auto& failure : summary.value("failures", Json::array())) {
    const auto text = failure.value("text", "");
    auto subject = failure.value("subject", "");
    if (subject.empty()) subject = named_in(text, facts, models);
    const auto error = first_error(subject, facts);
    const double time = failure.contains("time") ? failure.value("time", 0.0) : error.value_or(summary.value("simulated", to));
    marks.push_back({{"time", time}, {"kind", failure.value("kind", "failure")}, {"text", text}, {"subject", subject}});
  }
  for (auto& mark : marks) mark["time"] = std::clamp(mark.value("time", 0.0), from, to);
  std::stable_sort(marks.begin(), marks.end(), [](const Json& a, const Json& b) { return a.at("time") < b.at("time"); });
  for (const auto& mark : marks) {
    const auto kind = mark.value("kind", "");
    if (summary.contains("at") || (kind != "failure" && kind != "difference")) continue;
    summary["at"] = mark.at("time");
    if (!mark.value("subject", "").empty()) summary["select"] = mark.at("subject");
  }
  while (marks.size() > max_marks) marks.erase(marks.size() - 1);
  summary["marks"] = std::move(marks);
  summary.erase("failures");
}

}  // namespace page
