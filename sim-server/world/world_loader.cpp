#include "world/world_loader.h"

#include <algorithm>
#include <map>
#include <memory>
#include <set>

#include "base/text.h"
#include "world/checks.h"
#include "world/complaints.h"
#include "world/foreign_file.h"
#include "world/frame_references.h"
#include "world/frame_skeleton.h"
#include "world/iface_names.h"
#include "world/joint_gains.h"
#include "world/materials.h"
#include "world/model_builder.h"
#include "world/model_files.h"
#include "world/population.h"
#include "world/repairs.h"
#include "world/saved_state.h"
#include "world/sdf_library.h"
#include "world/taken_names.h"
#include "world/unseen_models.h"
#include "world/xml_file.h"
#include "world/xml_values.h"

namespace sim {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t max_frames = 5000;            // of one model; libsdformat resolves them in a time that grows with the square: 9 s
constexpr std::size_t max_frames_of_world = 10000;  // where models stand relative to each other
// A small file may include a large model many times. One of these elements costs 0.6 to 0.8 KiB once it is simulated: 1.5 GiB.
constexpr std::size_t max_elements_of_world = 10000000;
constexpr std::size_t batch_text = 48 * 1024;  // libsdformat needs some hundred times the text it reads; this is what it gets at once

// A model as it is written, however often it stands in the world.
struct DistinctModel {
  pugi::xml_node node;  // checked and repaired
  bool is_usable = false;
  std::size_t elements = 0;  // as element_count() counts
  std::string skeleton;
  std::optional<ModelDef> built;
};

struct Instance {
  std::size_t distinct = 0;
  std::string name;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // as written
  pugi::xml_node pose_node;
  Place place;
};

// Everything of the element but its own name and pose.
std::string key_of(pugi::xml_node node, std::initializer_list<std::string_view> without) {
  std::string key;
  for (const pugi::xml_attribute& attribute : node.attributes()) {
    const std::string_view name = attribute.name();
    if (name != "name" && !name.starts_with('_')) key.append(name).append("=").append(attribute.value()).append(";");
  }
  for (pugi::xml_node child : node.children()) {
    if (std::find(without.begin(), without.end(), child.name()) == without.end()) key += to_xml(child, false);
  }
  return key;
}

class Loader {
 public:
  explicit Loader(ModelPath model_path)
      : model_path_(std::move(model_path)), files_(model_path_, library_, complaints_), materials_(model_path_, complaints_) {
    copies_ = holder_.append_child("sdf");
  }

  base::Result<LoadResult> world(const std::string& text, const fs::path& folder, const std::string& name);
  base::Result<LoadedModel> model(std::string_view what, const std::string& instance_name, const std::optional<Eigen::Isometry3d>& pose);
  // What was done last.
  const std::string& busy_with() const { return busy_with_; }

 private:
  void collect(pugi::xml_node world, const fs::path& folder);
  void collect_population(pugi::xml_node population);
  void collect_include(pugi::xml_node world, pugi::xml_node include, const fs::path& folder);
  void add_instance(std::size_t distinct, pugi::xml_node named, pugi::xml_node pose_node, std::string name);
  std::size_t distinct_for(const std::string& key, pugi::xml_node node);
  bool is_too_large() const { return elements_ > max_elements_of_world; }
  static bool has_world_frames(pugi::xml_node world);
  void repair_world_references(pugi::xml_node world);
  bool resolve_whole_world(pugi::xml_node world);
  void resolve_models();
  void resolve_batch(const std::vector<std::pair<std::string, std::size_t>>& batch);
  void build_instances(WorldDef& world);

  ModelPath model_path_;
  Complaints complaints_;
  SdfLibrary library_;
  ModelFiles files_;
  Materials materials_;
  SavedState saved_;
  pugi::xml_document holder_;
  pugi::xml_node copies_;
  std::vector<std::unique_ptr<pugi::xml_document>> documents_;
  std::vector<DistinctModel> distinct_;
  std::map<std::string, std::size_t> distinct_by_key_;
  std::vector<Instance> instances_;
  std::size_t elements_ = 0;  // of all instances
  TakenNames names_;
  std::string busy_with_ = "the world";            // for when memory runs out
  std::map<std::string, ResolvedModel> resolved_;  // by skeleton
  std::optional<ResolvedWorld> whole_;             // when the world's own frames had to be resolved
};

std::size_t Loader::distinct_for(const std::string& key, pugi::xml_node node) {
  const auto [found, is_new] = distinct_by_key_.emplace(key, distinct_.size());
  if (!is_new) return found->second;
  DistinctModel& model = distinct_.emplace_back();
  model.node = node;
  model.is_usable = repair_model(node, complaints_);
  model.elements = element_count(node);
  if (model.is_usable && frames_of(node) > max_frames) {
    complaints_.drop(node, describe(node) + " has more than " + std::to_string(max_frames) +
                               " links, joints, frames and nested models in all and is left out");
    model.is_usable = false;
  }
  return found->second;
}

void Loader::add_instance(std::size_t distinct, pugi::xml_node named, pugi::xml_node pose_node, std::string name) {
  if (!distinct_[distinct].is_usable || is_too_large()) return;
  elements_ += distinct_[distinct].elements;
  std::string legal = name.empty() ? "model" : name;
  for (std::size_t at; (at = legal.find("::")) != std::string::npos;) legal.replace(at, 2, "_");
  legal = without_slashes(legal);
  if (legal == "world" || (legal.starts_with("__") && legal.ends_with("__"))) legal = "model_" + legal;
  legal = names_.free(legal);
  if (legal != name)
    complaints_.warn(named,
                     "model " + base::in_quotes(name) + " has a name that is taken or not allowed and is called " + base::in_quotes(legal));
  names_.insert(legal);
  instances_.push_back(
      {distinct, legal, parse_pose(pose_node).value_or(Eigen::Isometry3d::Identity()), pose_node, complaints_.place_of(named)});
}

void Loader::collect_include(pugi::xml_node world, pugi::xml_node include, const fs::path& folder) {
  const pugi::xml_node found = files_.included(include, folder);
  if (!found) return;
  const auto copy_to = [&](pugi::xml_node parent) {
    pugi::xml_node copy = parent.append_copy(found);
    copy.remove_attribute(file_mark);
    copy.append_attribute(file_mark) = complaints_.add_file(complaints_.place_of(found).file);
    ModelFiles::apply_include(include, copy);
    return copy;
  };
  if (std::string_view(found.name()) != "model") {
    copy_to(world);  // a light or an actor
    return;
  }
  const std::string key = "include " + std::to_string(found.hash_value()) + key_of(include, {"name", "pose", "uri"});
  const auto known = distinct_by_key_.find(key);
  const std::size_t distinct = known != distinct_by_key_.end() ? known->second : distinct_for(key, copy_to(copies_));
  const std::string name = text_of(include.child("name"));
  add_instance(distinct, include, include.child("pose") ? include.child("pose") : found.child("pose"),
               name.empty() ? std::string(found.attribute("name").value()) : name);
}

void Loader::collect(pugi::xml_node world, const fs::path& folder) {
  for (pugi::xml_node child = world.first_child(), next; child; child = next) {
    next = child.next_sibling();
    const std::string_view kind = child.name();
    if (kind == "model") {
      add_instance(distinct_for(key_of(child, {"pose"}), child), child, child.child("pose"), child.attribute("name").value());
    } else if (kind == "include") {
      collect_include(world, child, folder);
    } else if (kind == "road") {
      if (!child.child("point")) {
        complaints_.drop(child, describe(child) + " has no <point> and is left out");
        continue;
      }
      pugi::xml_node model = model_of_road(child, copies_);
      model.append_copy(child.attribute(line_mark));
      model.append_attribute(file_mark) = complaints_.add_file(complaints_.place_of(child).file);
      add_instance(distinct_for(key_of(model, {}), model), child, {}, child.attribute("name").value());
    } else if (kind == "population") {
      collect_population(child);
    }
  }
}

void Loader::collect_population(pugi::xml_node population) {
  const pugi::xml_node model = population.child("model");
  if (!model) return complaints_.drop(population, describe(population) + " has no <model> and is left out");
  if (is_too_large()) return;
  const std::vector<Eigen::Isometry3d> places = places_of(population, complaints_);
  if (places.empty()) return;
  const Eigen::Isometry3d own = pose_at(model, "pose"), around = pose_at(population, "pose");
  const pugi::xml_attribute relative = population.child("pose").attribute("relative_to");
  const std::size_t distinct = distinct_for(key_of(model, {"pose"}), model);
  const std::string name = model.attribute("name").value();
  for (std::size_t i = 0; i < places.size(); ++i) {
    // The frame graph reads poses from elements.
    pugi::xml_node pose = copies_.append_child("place").append_child("pose");
    pose.text() = pose_text(around * places[i] * own).c_str();
    if (relative) pose.append_copy(relative);
    add_instance(distinct, population, pose, places.size() == 1 ? name : name + "_" + std::to_string(i));
  }
}

bool Loader::has_world_frames(pugi::xml_node world) {
  if (world.child("frame")) return true;
  for (pugi::xml_node child : world.children()) {
    if (has_relative_pose(child) && std::string_view(child.child("pose").attribute("relative_to").value()) != "world") return true;
  }
  return false;
}

void Loader::repair_world_references(pugi::xml_node world) {
  std::vector<NamedPlace> places;
  for (pugi::xml_node frame : world.children("frame")) places.push_back({frame.attribute("name").value(), frame, frame.child("pose"), {}});
  for (const Instance& instance : instances_) places.push_back({instance.name, {}, instance.pose_node, {}});
  for (const char* kind : {"light", "actor"}) {
    for (pugi::xml_node thing : world.children(kind)) places.push_back({{}, {}, thing.child("pose"), {}});
  }
  repair_missing_references(places, complaints_);
  repair_circular_references(places, complaints_);
}

// Models that stand relative to each other or to frames of the world are resolved in one go.
bool Loader::resolve_whole_world(pugi::xml_node world) {
  std::size_t count = static_cast<std::size_t>(std::distance(world.children("frame").begin(), world.children("frame").end()));
  for (const Instance& instance : instances_) count += 1 + frames_of(distinct_[instance.distinct].node);
  if (count > max_frames_of_world) {
    complaints_.drop(world, "frames of the world, and of models in it, are more than " + std::to_string(max_frames_of_world) +
                                "; poses are taken relative to the world");
    return false;
  }
  repair_world_references(world);
  pugi::xml_document document;
  pugi::xml_node sdf = document.append_child("sdf");
  sdf.append_attribute("version") = current_sdf_version;
  pugi::xml_node out = sdf.append_child("world");
  out.append_attribute("name") = "w";
  for (pugi::xml_node frame : world.children("frame")) append_frame(frame, out);
  int frames = 0;
  for (const char* kind : {"light", "actor"}) {
    for (pugi::xml_node thing : world.children(kind)) append_frame_of_pose(thing, out, {}, "_pose_of_" + std::to_string(frames++));
  }
  for (const Instance& instance : instances_) {
    append_skeleton(distinct_[instance.distinct].node, out, instance.name, false);
    if (instance.pose_node) append_pose(instance.pose_node.parent(), out.last_child());
  }
  base::Result<ResolvedWorld> resolved = library_.resolve(sdf);
  if (!resolved) {
    complaints_.warn(world,
                     "frames of the world cannot be resolved (" + resolved.error().message + "); poses are taken relative to the world");
    return false;
  }
  whole_ = std::move(*resolved);
  return true;
}

void Loader::resolve_batch(const std::vector<std::pair<std::string, std::size_t>>& batch) {
  pugi::xml_document document;
  pugi::xml_node sdf = document.append_child("sdf");
  sdf.append_attribute("version") = current_sdf_version;
  pugi::xml_node out = sdf.append_child("world");
  out.append_attribute("name") = "w";
  for (std::size_t i = 0; i < batch.size(); ++i) append_skeleton(distinct_[batch[i].second].node, out, "m" + std::to_string(i), false);
  base::Result<ResolvedWorld> resolved = library_.resolve(sdf);
  if (resolved) {
    for (std::size_t i = 0; i < batch.size(); ++i) resolved_[batch[i].first] = std::move(resolved->models["m" + std::to_string(i)]);
    return;
  }
  if (batch.size() == 1) {
    const pugi::xml_node node = distinct_[batch.front().second].node;
    complaints_.drop(node, describe(node) + " is left out: " + resolved.error().message);
    return;
  }
  // One bad model spoils all that are read with it: halve until it is alone.
  const auto middle = batch.begin() + static_cast<std::ptrdiff_t>(batch.size() / 2);
  resolve_batch({batch.begin(), middle});
  resolve_batch({middle, batch.end()});
}

void Loader::resolve_models() {
  std::vector<std::pair<std::string, std::size_t>> batch;
  std::set<std::string> seen;
  std::size_t text = 0;
  for (std::size_t i = 0; i < distinct_.size(); ++i) {
    if (!distinct_[i].is_usable) continue;
    pugi::xml_document document;
    append_skeleton(distinct_[i].node, document, "m", false);
    distinct_[i].skeleton = to_xml(document.first_child(), false);
    if (!seen.insert(distinct_[i].skeleton).second) continue;
    text += distinct_[i].skeleton.size();
    batch.emplace_back(distinct_[i].skeleton, i);
    if (text < batch_text) continue;
    resolve_batch(batch);
    batch.clear();
    text = 0;
  }
  if (!batch.empty()) resolve_batch(batch);
}

void Loader::build_instances(WorldDef& world) {
  BuildContext context{complaints_, materials_};
  for (const Instance& instance : instances_) {
    DistinctModel& distinct = distinct_[instance.distinct];
    busy_with_ = "model " + base::in_quotes(instance.name);
    if (!distinct.built) {
      const auto resolved = resolved_.find(distinct.skeleton);
      if (resolved == resolved_.end()) continue;
      distinct.built = build_model(distinct.node, resolved->second, context);
    }
    ModelDef model = *distinct.built;
    model.name = instance.name;
    model.pose = instance.pose * distinct.built->pose;
    model.source = instance.place.text();
    if (whole_) {
      const auto placed = whole_->models.find(instance.name);
      if (placed != whole_->models.end()) model.pose = placed->second.pose;
    }
    saved_.move(model);
    world.models.push_back(std::move(model));
  }
}

namespace {

// The world in which a file that holds a model alone is opened: a floor, and a sun unless the file has lights. The elements keep their
// places in the file.
pugi::xml_node world_around(pugi::xml_node sdf) {
  pugi::xml_node world = sdf.append_child("world");
  world.append_attribute("name") = sdf.child("model").attribute("name").value();
  const bool has_light = sdf.child("light");
  for (pugi::xml_node child = sdf.first_child(), next; child; child = next) {
    next = child.next_sibling();
    const std::string_view kind = child.name();
    if (kind == "model" || kind == "light" || kind == "actor") world.append_move(child);
  }
  static constexpr std::string_view floor =
      "<model name='floor'><static>true</static><link name='link'>"
      "<collision name='collision'><geometry><plane><normal>0 0 1</normal><size>100 100</size></plane></geometry></collision>"
      "<visual name='visual'><cast_shadows>false</cast_shadows><geometry><plane><normal>0 0 1</normal><size>100 100</size></plane>"
      "</geometry><material><diffuse>0.8 0.81 0.78 1</diffuse></material></visual></link></model>";
  static constexpr std::string_view sun =
      "<light name='sun' type='directional'><cast_shadows>true</cast_shadows><pose>0 0 10 0 0 0</pose><diffuse>0.8 0.8 0.8 1</diffuse>"
      "<specular>0.2 0.2 0.2 1</specular><direction>-0.5 0.3 -0.9</direction></light>";
  world.append_buffer(floor.data(), floor.size());
  if (!has_light) world.append_buffer(sun.data(), sun.size());
  return world;
}

// Robots often have their origin in the middle: what would be in the floor is raised out of it.
void lift_onto_floor(std::vector<ModelDef>& models) {
  for (ModelDef& model : models) {
    if (model.is_static) continue;
    const Eigen::AlignedBox3d box = box_of(model, model.pose);
    if (!box.isEmpty() && box.min().z() < 0) model.pose.translation().z() -= box.min().z();
  }
}

}  // namespace

base::Result<LoadResult> Loader::world(const std::string& text, const fs::path& folder, const std::string& name) {
  base::Result<pugi::xml_document> document = files_.open_text(text, name);
  if (!document) return document.error();
  const pugi::xml_node sdf = document->child("sdf");
  pugi::xml_node world = sdf.child("world");
  const bool is_model = !world && sdf.child("model");
  if (is_model) world = world_around(sdf);
  if (!world) {
    // What the limits took out explains why there is none.
    for (const Finding& finding : complaints_.take()) {
      if (finding.severity == Finding::Severity::dropped) return base::Error{finding.text()};
    }
    return base::Error{name + ": a <world> or a <model> is expected in it"};
  }
  if (world.next_sibling("world")) complaints_.drop(world.next_sibling("world"), "only the first <world> of a file is loaded");
  saved_.apply(world);
  if (!files_.complete(world, folder)) return base::Error{name + ": the world is not fit to be used"};
  collect(world, folder);
  if (is_too_large())
    return base::Error{name + ": the world has more than " + std::to_string(max_elements_of_world) + " elements with all it includes"};
  if (has_world_frames(world)) resolve_whole_world(world);
  busy_with_ = "the tree of its frames";
  resolve_models();
  LoadResult result;
  BuildContext context{complaints_, materials_};
  result.world = build_world(world, whole_ ? *whole_ : ResolvedWorld{}, context);
  build_instances(result.world);
  for (ModelDef& model : result.world.models) add_plugin_gains(model_path_, model, complaints_);
  if (is_model) lift_onto_floor(result.world.models);
  result.world.model_path = model_path_;
  tell_of_unseen_models(result.world, complaints_);
  result.dropped = complaints_.dropped();
  result.findings = complaints_.take();
  result.found = files_.found();
  result.world.missing_parts = static_cast<std::size_t>(std::count_if(
      result.findings.begin(), result.findings.end(), [](const Finding& f) { return f.severity == Finding::Severity::dropped; }));
  return result;
}

base::Result<LoadedModel> Loader::model(std::string_view what, const std::string& instance_name,
                                        const std::optional<Eigen::Isometry3d>& pose) {
  if (pose && !pose->matrix().allFinite()) return base::Error{"pose of the model must be finite"};
  pugi::xml_node found;
  const std::string_view trimmed = base::trim(what);
  if (trimmed.starts_with('<')) {
    base::Result<pugi::xml_document> document = files_.open_text(std::string(trimmed), "text");
    if (!document) return document.error();
    documents_.push_back(std::make_unique<pugi::xml_document>(std::move(*document)));
    found = documents_.back()->child("sdf").child("model");
    if (found && !files_.complete(found, fs::current_path())) found = {};
  } else {
    const std::optional<fs::path> path = model_path_.find(trimmed, fs::current_path());
    if (!path)
      return base::Error{"model " + base::in_quotes(trimmed) + " is not found; text, a file, a folder or model://name is expected" +
                         model_path_.suggestion_for(trimmed)};
    base::Result<pugi::xml_node> entity = files_.entity(*path);
    if (!entity) return entity.error();
    found = *entity;
    if (const auto line = model_path_.other_version(trimmed, *path); !line.empty())
      complaints_.warn(found, "model " + base::in_quotes(trimmed) + ": " + line);
  }
  if (std::string_view(found.name()) != "model") {
    for (const Finding& finding : complaints_.take()) {
      if (finding.severity == Finding::Severity::dropped) return base::Error{finding.text()};
    }
    return base::Error{"a <model> is expected in " + base::in_quotes(trimmed.substr(0, 80))};
  }
  LoadedModel result;
  BuildContext context{complaints_, materials_};
  for (pugi::xml_node light : found.parent().children("light")) {
    if (std::optional<LightDef> built = build_light(light, context)) result.lights.push_back(std::move(*built));
  }
  const std::string name = instance_name.empty() ? std::string(found.attribute("name").value()) : instance_name;
  add_instance(distinct_for("model", found), found, found.child("pose"), name);
  resolve_models();
  WorldDef world;
  build_instances(world);
  for (ModelDef& built : world.models) add_plugin_gains(model_path_, built, complaints_);
  result.dropped = complaints_.dropped();
  result.findings = complaints_.take();
  result.found = files_.found();
  result.found[{"", std::string(trimmed)}] = complaints_.place_of(found).file;
  if (world.models.empty()) {
    return base::Error{result.findings.empty() ? "no model found in " + base::in_quotes(trimmed.substr(0, 80))
                                               : result.findings.back().text()};
  }
  result.model = std::move(world.models.front());
  if (pose) result.model.pose = *pose;
  return result;
}

// What `load` makes of a new loader; errors for what is thrown on the way.
template <class Load>
auto loaded(const ModelPath& path, const std::string& name, const Load& load) -> std::invoke_result_t<Load, Loader&> {
  std::optional<Loader> loader;
  try {
    return load(loader.emplace(path));
  } catch (const std::bad_alloc&) {
    return base::Error{name + ": cannot be loaded: " + (loader ? loader->busy_with() : name) + " needs more memory than there is"};
  } catch (const std::exception& problem) {
    return base::Error{name + ": cannot be loaded: " + problem.what()};
  } catch (...) {
    return base::Error{name + ": cannot be loaded: a library gives no reason"};
  }
}

}  // namespace

base::Result<LoadResult> load_world_text(std::string_view text, const fs::path& folder, const std::string& name,
                                         const ModelPath& model_path) {
  if (const auto foreign = foreign_file(text)) return base::Error{name + ": " + *foreign};
  ModelPath path = model_path;
  if (!folder.empty()) path.add_first(folder);
  return loaded(path, name, [&](Loader& loader) { return loader.world(std::string(text), folder, name); });
}

base::Result<LoadResult> load_world(const fs::path& file, const ModelPath& model_path) {
  base::Result<std::string> text = read_file(file);
  if (!text) return text.error();
  std::error_code problem;
  const fs::path absolute = fs::absolute(file, problem);
  return load_world_text(*text, absolute.parent_path(), file.string(), model_path);
}

base::Result<LoadedModel> load_model(std::string_view what, const std::string& instance_name, const std::optional<Eigen::Isometry3d>& pose,
                                     const ModelPath& model_path) {
  return loaded(model_path, "the model", [&](Loader& loader) { return loader.model(what, instance_name, pose); });
}

}  // namespace sim
