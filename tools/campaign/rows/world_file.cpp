#include "campaign/rows/world_file.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <pugixml.hpp>

#include "base/text.h"
#include "campaign/rows/model_files.h"

namespace campaign {
namespace fs = std::filesystem;
namespace {

pugi::xml_node child_made(pugi::xml_node parent, const char* name) {
  auto child = parent.child(name);
  return child ? child : parent.append_child(name);
}

Result<std::vector<double>> numbers(const std::string& path, const std::string& value, std::size_t count) {
  std::vector<double> all;
  for (const auto& word : base::split_list(value, ' ')) {
    const auto number = base::parse_number(word);
    if (!number) return Error{path + ": must hold finite numbers, got " + base::in_quotes(value)};
    all.push_back(*number);
  }
  if (all.size() != count)
    return Error{path + ": must be " + (count == 1 ? "a number" : std::to_string(count) + " numbers") + ", got " + base::in_quotes(value)};
  return all;
}

std::string text_of(const std::vector<double>& values) {
  std::vector<std::string> words;
  for (const double value : values) words.push_back(base::format_number(value));
  return base::join(words, " ");
}

// Of a model or an include of one.
Result<void> set_pose(pugi::xml_node node, const std::string& path, const std::string& part, const std::string& value) {
  auto pose = child_made(node, "pose");
  std::vector<double> values = numbers_in(pose.text().get());
  values.resize(6);
  if (part.empty()) {
    const auto count = base::split_list(value, ' ').size();
    if (count != 3 && count != 6) return Error{path + ": must be x y yaw or x y z roll pitch yaw, got " + base::in_quotes(value)};
    const auto given = numbers(path, value, count);
    if (!given) return given.error();
    values = count == 3 ? std::vector<double>{(*given)[0], (*given)[1], values[2], 0, 0, (*given)[2]} : *given;
    pose.remove_attribute("relative_to");
  } else {
    const auto which = std::ranges::find(pose_parts, part);
    if (which == pose_parts.end()) return Error{path + ": a pose has x, y, z, roll, pitch, yaw"};
    const auto given = numbers(path, value, 1);
    if (!given) return given.error();
    values[static_cast<std::size_t>(which - pose_parts.begin())] = given->front();
  }
  pose.remove_attribute("degrees");
  pose.remove_attribute("rotation_format");
  pose.text().set(text_of(values).c_str());
  return {};
}

// What is changed in a model: true when there was something to change.
using Change = std::function<bool(pugi::xml_node model)>;

bool for_links(pugi::xml_node model, const char* what, const std::function<void(pugi::xml_node)>& change) {
  bool found = false;
  for (auto link : model.children("link")) {
    for (auto node : link.children(what)) {
      change(node);
      found = true;
    }
  }
  return found;
}

Change scale_mass(double factor) {
  return [factor](pugi::xml_node model) {
    return for_links(model, "inertial", [&](pugi::xml_node inertial) {
      for (auto node : {inertial.child("mass"), inertial.child("inertia").child("ixx"), inertial.child("inertia").child("iyy"),
                        inertial.child("inertia").child("izz"), inertial.child("inertia").child("ixy"),
                        inertial.child("inertia").child("ixz"), inertial.child("inertia").child("iyz")}) {
        if (node) node.text().set(base::format_number(node.text().as_double() * factor).c_str());
      }
    });
  };
}

Change set_friction(const std::string& value) {
  return [value](pugi::xml_node model) {
    return for_links(model, "collision", [&](pugi::xml_node collision) {
      auto ode = child_made(child_made(child_made(collision, "surface"), "friction"), "ode");
      for (const char* name : {"mu", "mu2"}) child_made(ode, name).text().set(value.c_str());
    });
  };
}

pugi::xml_node sensor_in(pugi::xml_node model, const std::string& name) {
  for (const char* carrier : {"link", "joint"}) {
    for (auto node : model.children(carrier)) {
      if (auto sensor = node.find_child_by_attribute("sensor", "name", name.c_str())) return sensor;
    }
  }
  return {};
}

void set_noise(pugi::xml_node sensor, const std::string& value) {
  const auto change = [&](pugi::xml_node noise) {
    if (noise.attribute("type")) {
      noise.attribute("type").set_value("gaussian");
    } else {
      child_made(noise, "type").text().set("gaussian");
    }
    child_made(noise, "stddev").text().set(value.c_str());
  };
  bool found = false;
  const std::function<void(pugi::xml_node)> walk = [&](pugi::xml_node node) {
    for (auto child : node.children()) {
      if (std::string(child.name()) == "noise") {
        change(child);
        found = true;
      } else {
        walk(child);
      }
    }
  };
  walk(sensor);
  if (found) return;
  for (const std::string kind : {"lidar", "ray", "camera", "altimeter", "air_pressure", "fiducial"}) {
    const char* part = kind == "altimeter" ? "vertical_position" : kind == "fiducial" ? "position" : nullptr;
    if (auto node = sensor.child(kind.c_str())) change(child_made(part != nullptr ? child_made(node, part) : node, "noise"));
  }
}

}  // namespace

struct WorldFile::State {
  const std::string file;
  const WorldSurvey& survey;
  ModelFiles files;
  std::map<std::string, double> masses{};  // of models that were set [kg]
  pugi::xml_document document{};

  pugi::xml_node world() const { return document.child("sdf").child("world"); }
  fs::path folder() const { return fs::path(file).parent_path(); }

  // The model or the include of that name.
  pugi::xml_node entry(const std::string& name) const {
    for (auto node : world().children()) {
      if (std::string(node.name()) == "model" && name == node.attribute("name").value()) return node;
      if (std::string(node.name()) == "include" && name == files.name_of(node, folder())) return node;
    }
    return {};
  }

  // Changes a model, be it written here or included; what is included is copied first.
  bool change(pugi::xml_node node, const fs::path& at, const std::string& copy_name, const Change& what) {
    if (std::string(node.name()) == "include") return change_included(node, at, copy_name, what);
    bool found = what(node);
    int number = 0;
    for (auto inner : node.children()) {
      const std::string kind = inner.name();
      if (kind == "model" || kind == "include") found |= change(inner, at, copy_name + "-" + std::to_string(number++), what);
    }
    return found;
  }

  bool change_included(pugi::xml_node include, const fs::path& at, const std::string& copy_name, const Change& what) {
    const bool is_copy = files.copies().contains(copy_name);
    const auto name = files.name_of(include, at);
    const auto copy = files.copy(include, at, copy_name);
    if (!copy) return false;
    if (!change(copy->model, copy->file.parent_path(), copy_name, what)) {
      if (!is_copy) files.drop_copy(copy_name);
      return false;
    }
    if (!include.child("name") && !include.attribute("merge")) child_made(include, "name").text().set(name.c_str());
    include.child("uri").text().set(("model://" + copy_name).c_str());
    return true;
  }

  Result<void> set_model(const std::string& path, const std::vector<std::string>& words, const std::string& value);
  Result<void> set_sensor(pugi::xml_node node, const std::string& path, const std::vector<std::string>& words, const std::string& value);
  pugi::xml_node light_in_world(const std::string& name, std::vector<std::string>& names);
  Result<void> set_light(const std::string& path, const std::vector<std::string>& words, const std::string& value);
  Result<void> set_world(const std::string& path, const std::string& what, const std::string& value);
  void name_files(pugi::xml_node node, const fs::path& at) const;
  std::string model_names() const;
};

// Writes absolute names: the document is read from another folder.
void WorldFile::State::name_files(pugi::xml_node node, const fs::path& at) const {
  const std::string name = node.name();
  const bool is_file = name == "uri" || name == "filename" || name == "diffuse" || name == "normal" || name.ends_with("_map");
  if (is_file && node.text()) node.text().set(files.absolute(node.text().get(), at).c_str());
  for (auto child : node.children()) {
    if (!is_file) name_files(child, at);
  }
}

std::string WorldFile::State::model_names() const {
  std::vector<std::string> names;
  for (const auto& [name, model] : survey.models) names.push_back(name);
  if (names.size() > 12) names.resize(12), names.emplace_back("...");
  return names.empty() ? "none" : base::join(names, ", ");
}

Result<void> WorldFile::State::set_sensor(pugi::xml_node node, const std::string& path, const std::vector<std::string>& words,
                                          const std::string& value) {
  if (words.size() != 5 || (words[4] != "noise" && words[4] != "rate"))
    return Error{path + ": of a sensor noise or rate can be set, as in model/NAME/sensor/SENSOR/noise"};
  const auto number = base::parse_number(value);
  if (!number || *number < 0) return Error{path + ": must be a number that is not negative, got " + base::in_quotes(value)};
  const auto changed = change(node, folder(), "row-" + words[1], [&](pugi::xml_node model) {
    auto sensor = sensor_in(model, words[3]);
    if (!sensor) return false;
    if (words[4] == "rate") child_made(sensor, "update_rate").text().set(value.c_str());
    if (words[4] == "noise") set_noise(sensor, value);
    return true;
  });
  if (!changed) return Error{path + ": model " + words[1] + " has no sensor " + base::in_quotes(words[3])};
  return {};
}

Result<void> WorldFile::State::set_model(const std::string& path, const std::vector<std::string>& words, const std::string& value) {
  auto node = entry(words[1]);
  if (!node) return Error{path + ": the world has no model " + base::in_quotes(words[1]) + "; models: " + model_names()};
  const auto what = words.size() > 2 ? words[2] : "";
  if (what == "pose" && words.size() <= 4) return set_pose(node, path, words.size() == 4 ? words[3] : "", value);
  if (what == "sensor") return set_sensor(node, path, words, value);
  const bool is_mass = what == "mass";
  if ((!is_mass && what != "friction") || words.size() != 3)
    return Error{path + ": of a model pose, mass, friction and sensor/NAME/... can be set"};
  const auto number = base::parse_number(value);
  if (!number || *number < 0 || (is_mass && *number == 0))
    return Error{path + ": must be a number " + (is_mass ? "more than 0" : "that is not negative") + ", got " + base::in_quotes(value)};
  const auto known = survey.models.find(words[1]);
  double& now = known == survey.models.end() ? masses[words[1]] : masses.try_emplace(words[1], known->second.mass).first->second;
  if ((is_mass && now <= 0) || !change(node, folder(), "row-" + words[1], is_mass ? scale_mass(*number / now) : set_friction(value)))
    return Error{path + ": model " + words[1] + " has no " + (is_mass ? "mass" : "collision")};
  if (is_mass) now = *number;
  return {};
}

// One that is included is written into the world in place of its include; the file stays as it is.
pugi::xml_node WorldFile::State::light_in_world(const std::string& name, std::vector<std::string>& names) {
  for (auto node : world().children()) {
    const bool is_included = std::string(node.name()) == "include";
    if (!is_included && std::string(node.name()) != "light") continue;
    const auto opened = is_included ? files.open_light(node, folder()) : std::nullopt;
    if (is_included && !opened) continue;
    const std::string own = is_included ? opened->model.attribute("name").value() : node.attribute("name").value();
    const std::string given = node.child("name").text().get();
    names.push_back(given.empty() ? own : given);
    if (names.back() != name) continue;
    if (!is_included) return node;
    auto light = world().insert_copy_after(opened->model, node);
    light.attribute("name").set_value(name.c_str());
    if (const auto pose = node.child("pose")) {
      light.remove_child("pose");
      light.prepend_copy(pose);
    }
    world().remove_child(node);
    return light;
  }
  return {};
}

Result<void> WorldFile::State::set_light(const std::string& path, const std::vector<std::string>& words, const std::string& value) {
  std::vector<std::string> names;
  auto light = light_in_world(words[1], names);
  if (!light)
    return Error{path + ": the world has no light " + base::in_quotes(words[1]) +
                 "; lights: " + (names.empty() ? "none" : base::join(names, ", "))};
  const auto what = words.size() == 3 ? words[2] : "";
  if (what != "intensity" && what != "diffuse" && what != "direction")
    return Error{path + ": a light supports intensity, diffuse and direction only"};
  const auto count = what == "intensity" ? 1U : what == "direction" ? 3U : base::split_list(value, ' ').size() == 3 ? 3U : 4U;
  const auto given = numbers(path, value, count);
  if (!given) return given.error();
  child_made(light, what.c_str()).text().set(text_of(*given).c_str());
  return {};
}

Result<void> WorldFile::State::set_world(const std::string& path, const std::string& what, const std::string& value) {
  if (what != "gravity" && what != "step") return Error{path + ": of the world gravity and step can be set"};
  const auto given = numbers(path, value, what == "gravity" ? 3 : 1);
  if (!given) return given.error();
  if (what == "step" && given->front() <= 0) return Error{path + ": must be more than 0, got " + base::in_quotes(value)};
  auto node = what == "gravity" ? child_made(world(), "gravity") : child_made(child_made(world(), "physics"), "max_step_size");
  node.text().set(text_of(*given).c_str());
  return {};
}

WorldFile::WorldFile(std::unique_ptr<State> state) : state_(std::move(state)) {}
WorldFile::WorldFile(WorldFile&&) noexcept = default;
WorldFile& WorldFile::operator=(WorldFile&&) noexcept = default;
WorldFile::~WorldFile() = default;

Result<WorldFile> WorldFile::read(const std::string& file, const WorldSurvey& survey) {
  auto state = std::unique_ptr<State>(new State{fs::absolute(file).string(), survey, ModelFiles(survey.found)});
  const auto loaded = state->document.load_file(file.c_str());
  if (!loaded) return Error{"world " + base::in_quotes(file) + ": " + loaded.description()};
  if (!state->world()) return Error{"world " + base::in_quotes(file) + ": has no <sdf><world>"};
  return WorldFile(std::move(state));
}

Result<void> WorldFile::set(const std::string& path, const std::string& value) {
  const auto words = base::split_list(path, '/');
  if (words.size() < 2) return Error{path + ": expected model/NAME/..., light/NAME/... or world/..."};
  if (words[0] == "model") return state_->set_model(path, words, value);
  if (words[0] == "light") return state_->set_light(path, words, value);
  return state_->set_world(path, words.size() == 2 ? words[1] : "", value);
}

Result<void> WorldFile::write(const std::string& folder) const {
  std::error_code error;
  fs::create_directories(folder, error);
  const auto save = [&](const pugi::xml_document& original, const fs::path& at, const fs::path& path) {
    pugi::xml_document document;
    document.reset(original);
    state_->name_files(document, at);
    return document.save_file(path.c_str(), " ");
  };
  if (!save(state_->document, state_->folder(), fs::path(folder) / "world.sdf"))
    return Error{"file " + base::in_quotes(folder + "/world.sdf") + ": cannot be written"};
  for (const auto& [name, copy] : state_->files.copies()) {
    const auto place = fs::path(folder) / "models" / name;
    fs::create_directories(place, error);
    if (!save(copy->document, copy->file.parent_path(), place / "model.sdf"))
      return Error{"file " + base::in_quotes((place / "model.sdf").string()) + ": cannot be written"};
  }
  return {};
}

std::string WorldFile::folder() const { return state_->folder().string(); }

bool is_world_path(const std::string& path) {
  return path.starts_with("model/") || path.starts_with("light/") || path.starts_with("world/");
}

}  // namespace campaign
