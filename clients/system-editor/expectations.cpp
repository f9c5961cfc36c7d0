#include "expectations.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "base/text.h"

namespace editor {
namespace {

using base::Error;
using base::Result;
using Kind = Expectation::Kind;

const std::map<std::string, Kind> kinds = {{"path_length", Kind::path_length}, {"reach", Kind::reach}, {"stay", Kind::stay},
                                           {"no_contact", Kind::no_contact},   {"value", Kind::value}, {"state", Kind::state},
                                           {"command", Kind::command}};

struct Failure {
  std::string message;
};

std::optional<double> number(const YAML::Node& node, const char* key) {
  if (!node[key]) return std::nullopt;
  const auto value = base::parse_number(node[key].Scalar());
  if (!value) throw Failure{std::string(key) + " must be a number, got " + base::in_quotes(node[key].Scalar())};
  return value;
}

std::string text(const YAML::Node& node, const char* key) {
  if (!node[key] || !node[key].IsScalar() || node[key].Scalar().empty()) throw Failure{std::string("needs ") + key};
  return node[key].Scalar();
}

void read_region(const YAML::Node& node, Expectation& expectation) {
  const auto region = node["region"];
  if (!region || !region.IsSequence() || region.size() != 4) throw Failure{"needs region: [x1, y1, x2, y2]"};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto value = base::parse_number(region[i].Scalar());
    if (!value) throw Failure{"region must hold numbers, got " + base::in_quotes(region[i].Scalar())};
    expectation.region[i] = *value;
  }
  if (expectation.region[0] > expectation.region[2]) std::swap(expectation.region[0], expectation.region[2]);
  if (expectation.region[1] > expectation.region[3]) std::swap(expectation.region[1], expectation.region[3]);
}

Expectation read_one(const std::string& name, const YAML::Node& node) {
  const auto kind = kinds.find(name);
  if (kind == kinds.end())
    throw Failure{"unknown expectation " + base::in_quotes(name) +
                  ", expected path_length, reach, stay, no_contact, value, state or command"};
  Expectation expectation;
  expectation.kind = kind->second;
  YAML::Emitter flow;
  flow << YAML::Flow << node;
  expectation.text = name + ": " + flow.c_str();
  if (expectation.kind == Kind::command) {
    if (!node.IsScalar() || node.Scalar().empty()) throw Failure{"command needs a command line"};
    expectation.command = node.Scalar();
    return expectation;
  }
  if (!node.IsMap()) throw Failure{name + " needs a map"};
  expectation.min = number(node, "min");
  expectation.max = number(node, "max");
  expectation.within = number(node, "within").value_or(0);
  if (expectation.kind == Kind::value) {
    expectation.port = text(node, "port");
    expectation.member = text(node, "member");
  } else if (expectation.kind == Kind::state) {
    expectation.component = text(node, "component");
    expectation.state = text(node, "is");
  } else {
    expectation.model = text(node, "model");
  }
  if (expectation.kind == Kind::reach || expectation.kind == Kind::stay) read_region(node, expectation);
  if (expectation.kind == Kind::no_contact) {
    expectation.except = {"ground_plane"};
    if (node["except"]) expectation.except.clear();
    for (const auto& other : node["except"]) expectation.except.push_back(other.Scalar());
  }
  const bool bounded = expectation.kind == Kind::path_length || expectation.kind == Kind::value;
  if (bounded && !expectation.min && !expectation.max) throw Failure{name + " needs min or max"};
  return expectation;
}

std::string bounds(const Expectation& e) {
  if (e.min && e.max) return "from " + base::format_number(*e.min) + " to " + base::format_number(*e.max);
  return e.min ? "at least " + base::format_number(*e.min) : "at most " + base::format_number(*e.max);
}

bool inside(const RecordedPose& pose, const double* region) {
  return pose.x >= region[0] && pose.y >= region[1] && pose.x <= region[2] && pose.y <= region[3];
}

std::string place(const RecordedPose& pose) {
  return "(" + base::format_number(pose.x) + ", " + base::format_number(pose.y) + ") at " + base::format_number(pose.time) + " s";
}

std::string region_problem(const Expectation& e, const std::vector<RecordedPose>& poses) {
  double nearest = INFINITY;
  for (const auto& pose : poses) {
    if (e.within > 0 && pose.time > e.within) break;
    const bool in = inside(pose, e.region);
    if (e.kind == Kind::reach && in) return "";
    if (e.kind == Kind::stay && !in) return "it was at " + place(pose);
    const double dx = std::max({e.region[0] - pose.x, 0.0, pose.x - e.region[2]});
    const double dy = std::max({e.region[1] - pose.y, 0.0, pose.y - e.region[3]});
    nearest = std::min(nearest, std::hypot(dx, dy));
  }
  return e.kind == Kind::stay ? "" : "it came no nearer than " + base::format_number(nearest) + " m";
}

std::string contact_problem(const Expectation& e, const Record& record) {
  for (const auto& contact : record.contacts) {
    const auto& other = contact.model == e.model ? contact.other : contact.model;
    if (contact.model != e.model && contact.other != e.model) continue;
    if (std::find(e.except.begin(), e.except.end(), other) != e.except.end()) continue;
    return "it touched " + other + " at " + base::format_number(contact.time) + " s";
  }
  return "";
}

std::string problem_of(const Expectation& e, const Seen& seen) {
  const bool about_model = e.kind == Kind::path_length || e.kind == Kind::reach || e.kind == Kind::stay || e.kind == Kind::no_contact;
  const auto poses = seen.record.poses.find(e.model);
  if (about_model && poses == seen.record.poses.end()) return "the world has no moving model " + base::in_quotes(e.model);
  switch (e.kind) {
    case Kind::path_length: {
      const double length = path_length(poses->second);
      const bool fits = (!e.min || length >= *e.min) && (!e.max || length <= *e.max);
      return fits ? "" : "it was " + base::format_number(length) + " m, expected " + bounds(e);
    }
    case Kind::reach:
    case Kind::stay:
      return region_problem(e, poses->second);
    case Kind::no_contact:
      return contact_problem(e, seen.record);
    case Kind::value: {
      const auto value = seen.values.find(e.port + " " + e.member);
      if (value == seen.values.end() || value->second.samples == 0) return "no sample came";
      const bool fits = (!e.min || value->second.lowest >= *e.min) && (!e.max || value->second.highest <= *e.max);
      return fits ? ""
                  : "it ran from " + base::format_number(value->second.lowest) + " to " + base::format_number(value->second.highest) +
                        ", expected " + bounds(e);
    }
    case Kind::state: {
      const auto state = seen.states.find(e.component);
      if (state == seen.states.end()) return "there is no such component";
      return base::equal_ignoring_case(state->second, e.state) ? "" : "it is " + state->second;
    }
    case Kind::command: {
      const auto code = seen.exit_codes.find(e.command);
      if (code == seen.exit_codes.end()) return "it was not run";
      return code->second == 0 ? "" : "it ended with exit code " + std::to_string(code->second);
    }
  }
  return "";
}

}  // namespace

Result<std::vector<Expectation>> read_expectations(const std::string& file) {
  int line = 0;
  try {
    auto root = YAML::LoadFile(file);
    if (root.IsMap() && root["expect"]) root = root["expect"];
    if (!root.IsSequence()) return Error{"file " + base::in_quotes(file) + ": must hold a list of expectations"};
    std::vector<Expectation> expectations;
    for (const auto& entry : root) {
      line = entry.Mark().line + 1;
      if (!entry.IsMap() || entry.size() != 1) throw Failure{"each expectation must be one NAME: {...}"};
      expectations.push_back(read_one(entry.begin()->first.Scalar(), entry.begin()->second));
    }
    return expectations;
  } catch (const Failure& failure) {
    return Error{"file " + base::in_quotes(file) + ":" + std::to_string(line) + ": " + failure.message};
  } catch (const YAML::BadFile&) {
    return Error{"file " + base::in_quotes(file) + ": cannot be read"};
  } catch (const YAML::Exception& e) {
    return Error{"file " + base::in_quotes(file) + ":" + std::to_string(e.mark.line + 1) + ": is no YAML: " + e.msg};
  }
}

Result<Record> read_record(const std::string& file) {
  std::ifstream in(file);
  if (!in) return Error{"record " + base::in_quotes(file) + ": cannot be read"};
  Record record;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string first;
    words >> first;
    if (first == "#" || first.empty()) continue;
    if (first == "contact") {
      RecordedContact contact;
      words >> contact.time >> contact.model >> contact.other;
      if (words) record.contacts.push_back(contact);
      continue;
    }
    const auto time = base::parse_number(first);
    RecordedPose pose{time.value_or(0), 0, 0, 0};
    std::string model;
    words >> model >> pose.x >> pose.y >> pose.z;
    if (!time || !words) return Error{"record " + base::in_quotes(file) + ": line " + base::in_quotes(line) + " is no pose"};
    record.poses[model].push_back(pose);
  }
  return record;
}

double path_length(const std::vector<RecordedPose>& poses) {
  double length = 0;
  for (std::size_t i = 1; i < poses.size(); ++i)
    length += std::hypot(poses[i].x - poses[i - 1].x, poses[i].y - poses[i - 1].y, poses[i].z - poses[i - 1].z);
  return length;
}

std::vector<Verdict> judge(const std::vector<Expectation>& expectations, const Seen& seen) {
  std::vector<Verdict> verdicts;
  for (const auto& expectation : expectations) verdicts.push_back({expectation.text, problem_of(expectation, seen)});
  return verdicts;
}

}  // namespace editor
