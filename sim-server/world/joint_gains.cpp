#include "world/joint_gains.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "base/plain_file.h"
#include "base/text.h"
#include "world/plugin_kind.h"

namespace sim {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t largest_file = std::uintmax_t{1} << 20U;
constexpr int deepest = 32;
constexpr std::size_t max_nodes = 100'000;  // with what aliases repeat

std::string key_of(const YAML::Node& node) { return node.IsScalar() ? node.Scalar() : std::string(); }

class GainsReader {
 public:
  GainsReader(std::string file, std::vector<std::string>& left_out) : file_(std::move(file)), left_out_(left_out) {}

  void look(const YAML::Node& node, int depth) {
    if (depth > deepest || ++nodes_ > max_nodes) return;
    if (node.IsSequence()) {
      for (const auto& one : node) look(one, depth + 1);
    }
    if (!node.IsMap()) return;
    if (node["joint"] && node["pid"] && node["pid"].IsMap() && is_of_effort(node)) add(key_of(node["joint"]), node["pid"]);
    for (const auto& entry : node) {
      const std::string key = key_of(entry.first);
      const bool is_of_gazebo = key.ends_with("pid_gains");
      if (entry.second.IsMap() && (is_of_gazebo || (key == "gains" && is_of_effort(node)))) {
        for (const auto& one : entry.second) add(key_of(one.first), one.second);
      } else {
        look(entry.second, depth + 1);
      }
    }
  }
  std::vector<GainsDef> take() { return std::move(gains_); }

 private:
  std::string place(const YAML::Node& node) const { return file_ + ":" + std::to_string(node.Mark().line + 1); }

  // Of a controller. ROS 2 lists what it commands, ROS 1 says it with its type.
  bool is_of_effort(const YAML::Node& controller) {
    bool is_of_effort = true;
    if (const auto interfaces = controller["command_interfaces"]; interfaces && interfaces.IsSequence()) {
      is_of_effort = std::any_of(interfaces.begin(), interfaces.end(), [](const YAML::Node& one) { return key_of(one) == "effort"; });
    } else if (controller["type"]) {
      is_of_effort = key_of(controller["type"]).starts_with("effort_controllers");
    }
    if (!is_of_effort) left_out_.push_back(place(controller) + ": the gains of a controller that does not command efforts are left out");
    return is_of_effort;
  }

  void add(const std::string& joint, const YAML::Node& node) {
    if (joint.empty() || !node.IsMap()) return;
    bool is_wrong = false;
    const auto number = [&](const char* key) -> std::optional<double> {
      if (!node[key]) return std::nullopt;
      const auto value = base::parse_number(key_of(node[key]));
      if (value) return value;
      is_wrong = true;
      left_out_.push_back(place(node[key]) + ": gain " + key + " of joint " + base::in_quotes(joint) + " must be a number, got " +
                          base::in_quotes(key_of(node[key])) + "; its gains are left out");
      return std::nullopt;
    };
    GainsDef gains;
    gains.joint = joint;
    gains.p = number("p").value_or(0), gains.i = number("i").value_or(0), gains.d = number("d").value_or(0);
    const double clamp = number("i_clamp").value_or(infinite);
    gains.i_high = number("i_clamp_max").value_or(clamp), gains.i_low = number("i_clamp_min").value_or(-clamp);
    gains.source = place(node);
    if (is_wrong) return;
    if (gains.p > 0 && gains.i >= 0 && gains.d >= 0 && gains.i_low <= gains.i_high) return gains_.push_back(std::move(gains));
    left_out_.push_back(place(node) + ": the gains of joint " + base::in_quotes(joint) +
                        " must not be negative and p must be positive; they are left out");
  }

  std::string file_;
  std::vector<std::string>& left_out_;
  std::vector<GainsDef> gains_;
  std::size_t nodes_ = 0;
};

// "$(find PKG)/REST", "$(find-pkg-share PKG)/REST" and "/where/it/was/installed/share/PKG/REST" -> "package://PKG/REST".
std::optional<std::string> package_uri(const std::string& text) {
  if (text.starts_with("$(find")) {
    const auto blank = text.find(' '), end = text.find(')');
    if (blank == std::string::npos || end == std::string::npos || end < blank) return std::nullopt;
    return "package://" + std::string(base::trim(text.substr(blank, end - blank))) + text.substr(end + 1);
  }
  constexpr std::string_view mark = "/share/";
  const auto share = text.rfind(mark);
  return share == std::string::npos ? std::nullopt : std::optional("package://" + text.substr(share + mark.size()));
}

std::optional<fs::path> find_file(const ModelPath& model_path, const std::string& text, const fs::path& folder) {
  std::vector<std::string> names = {text};
  if (auto uri = package_uri(text)) names.push_back(std::move(*uri));
  const std::string own = fs::path(text).filename().string();
  for (const char* beside : {"", "config/", "../config/"}) names.push_back(beside + own);
  for (const auto& name : names) {
    auto found = model_path.find(name, folder);
    std::error_code ignored;
    if (found && fs::is_regular_file(*found, ignored)) return found;
  }
  return std::nullopt;
}

// "file:line" -> its folder.
fs::path folder_of(const std::string& source) {
  std::error_code ignored;
  return fs::absolute(source.substr(0, source.rfind(':')), ignored).parent_path();
}

bool is_for(const GainsDef& gains, const JointDef& joint) {
  return !joint.axes.empty() && (joint.name == gains.joint || joint.name.ends_with("::" + gains.joint));
}

}  // namespace

base::Result<std::vector<GainsDef>> read_gains_text(const std::string& text, const std::string& name, std::vector<std::string>& left_out) {
  try {
    GainsReader reader(name, left_out);
    for (const auto& document : YAML::LoadAll(text)) reader.look(document, 0);
    return reader.take();
  } catch (const YAML::Exception& problem) {
    return base::Error{"gains " + base::in_quotes(name) + ": is no YAML: line " + std::to_string(problem.mark.line + 1) + ": " +
                       problem.msg};
  }
}

base::Result<std::vector<GainsDef>> read_gains(const fs::path& file, std::vector<std::string>& left_out) {
  const auto text = base::read_plain_file(file, largest_file);
  if (!text) return base::Error{"gains " + base::in_quotes(file.string()) + ": " + text.error().message};
  return read_gains_text(*text, file.string(), left_out);
}

base::Result<void> add_named_gains(const std::string& text, ModelDef& model, std::vector<std::string>& left_out) {
  if (text.empty()) return {};
  auto gains = read_gains_text(text, "--gains", left_out);
  if (!gains) return gains.error();
  for (auto& one : *gains) one.is_named = true;
  if (add_gains(*gains, model) > 0) {
    for (const auto& line : gains_of_no_joint(*gains, {&model, 1}, "model " + model.name)) left_out.push_back(line);
    return {};
  }
  const std::string first = left_out.empty() ? "" : "; " + left_out.front();
  return base::Error{"gains: " + why_no_gains(*gains, left_out, "model " + model.name) + first};
}

std::string why_no_gains(const std::vector<GainsDef>& gains, const std::vector<std::string>& left_out, const std::string& where) {
  if (!gains.empty()) return "they are of no joint of " + where;
  return left_out.empty() ? "the file has no gains of joints" : "none of them can be used";
}

base::Result<void> set_initial_positions(const std::string& lines, ModelDef& model) {
  for (const std::string& line : base::split_list(lines, '\n')) {
    const auto equals = line.rfind('=');
    const auto value = equals == std::string::npos ? std::nullopt : base::parse_number(line.substr(equals + 1));
    if (!value || !(std::abs(*value) < 1e6)) return base::Error{"joint " + base::in_quotes(line) + ": expected JOINT=NUMBER"};
    const std::string name = line.substr(0, equals);
    std::vector<std::string> movable;
    JointDef* found = nullptr;
    for (JointDef& joint : model.joints) {
      if (joint.axes.empty()) continue;
      movable.push_back(joint.name);
      if (joint.name == name) found = &joint;
    }
    if (found == nullptr)
      return base::Error{"model " + model.name + " has no joint " + base::in_quotes(name) + " that moves; it has " +
                         base::join(movable, ", ")};
    AxisDef& axis = found->axes[0];
    if (*value < axis.lower || *value > axis.upper)
      return base::Error{"joint " + name + ": a position must be within " + base::format_number(axis.lower) + " and " +
                         base::format_number(axis.upper) + ", got " + base::format_number(*value)};
    axis.initial_position = *value;
  }
  return {};
}

std::vector<std::string> gains_of_no_joint(const std::vector<GainsDef>& gains, std::span<const ModelDef> models, const std::string& where) {
  std::vector<std::string> lines;
  for (const GainsDef& one : gains) {
    const auto has_it = [&](const ModelDef& model) {
      return std::ranges::any_of(model.joints, [&](const JointDef& joint) { return is_for(one, joint); });
    };
    if (std::ranges::none_of(models, has_it))
      lines.push_back(one.source + ": gains of joint " + base::in_quotes(one.joint) + ": " + where + " has no such joint that moves");
  }
  return lines;
}

std::size_t add_gains(const std::vector<GainsDef>& gains, ModelDef& model) {
  std::size_t count = 0;
  for (const GainsDef& one : gains) {
    for (const JointDef& joint : model.joints) {
      if (!is_for(one, joint)) continue;
      ++count;
      const auto is_same = [&](const GainsDef& other) { return other.joint == joint.name && other.is_named == one.is_named; };
      if (std::ranges::any_of(model.gains, is_same)) continue;
      model.gains.push_back(one);
      model.gains.back().joint = joint.name;
    }
  }
  return count;
}

void add_plugin_gains(const ModelPath& model_path, ModelDef& model, Complaints& complaints) {
  for (const PluginDef& plugin : model.plugins) {
    if (kind_of(plugin) != PluginKind::joint_controller) continue;
    for (const ParameterNode& child : plugin.parameters.children) {
      if (child.name != "parameters" || child.text.empty()) continue;
      const auto warn = [&](const std::string& line) { complaints.add(Finding::Severity::warning, {plugin.source, 0}, line); };
      const auto file = find_file(model_path, child.text, folder_of(plugin.source));
      if (!file) {
        warn("gains: the file " + base::in_quotes(child.text) +
             " is not found; the gains of its joints are derived, or name it with --gains");
        continue;
      }
      std::vector<std::string> left_out;
      const auto gains = read_gains(*file, left_out);
      if (!gains) {
        warn(gains.error().message);
        continue;
      }
      for (const auto& line : left_out)
        complaints.add(Finding::Severity::warning, {line.substr(0, line.find(": ")), 0}, line.substr(line.find(": ") + 2));
      add_gains(*gains, model);
    }
  }
}

}  // namespace sim
