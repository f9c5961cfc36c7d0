#include "world/model_files.h"

#include <algorithm>
#include <functional>
#include <vector>

#include "base/text.h"
#include "world/checks.h"
#include "world/floor_plan.h"
#include "world/materials.h"
#include "world/repairs.h"
#include "world/ros_joints.h"
#include "world/urdf.h"
#include "world/xml_file.h"
#include "world/xml_values.h"

namespace sim {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t max_elements_of_a_model = 100000;
constexpr std::size_t max_nested_files = 16;

// "1.9" -> 109, "1.10" -> 110; 0 for what is no version.
int version_number(std::string_view text) {
  const std::size_t dot = text.find('.');
  const std::optional<std::int64_t> major = base::parse_integer(text.substr(0, dot));
  const std::optional<std::int64_t> minor = dot == std::string_view::npos ? 0 : base::parse_integer(text.substr(dot + 1));
  if (!major || !minor || *major < 1 || *major > 20 || *minor < 0 || *minor > 99) return 0;
  return static_cast<int>(*major * 100 + *minor);
}

constexpr int newest_known = 109;
constexpr int first_with_frames = 107;
constexpr int first_with_nested_names = 108;

bool is_entity(pugi::xml_node node) {
  const std::string_view name = node.name();
  return name == "model" || name == "actor" || name == "light";
}

// What stands at the top of the document besides <sdf>, in words that help.
base::Error wrong_root(pugi::xml_node root, const std::string& file_name) {
  const std::string name = root.name();
  if (name == "gazebo" || name.starts_with("gazebo:") || name.find(':') != std::string::npos) {
    return {file_name + ": is a file of Gazebo before SDFormat (<" + name + ">); SDFormat 1.2 or newer (<sdf version=...>) is expected"};
  }
  if (name.empty()) return {file_name + ": holds no element; <sdf> is expected at the top"};
  if (name == "COLLADA") return {file_name + ": is a mesh (COLLADA), not SDFormat"};
  return {file_name + ": an <sdf> element is expected at the top, got <" + name.substr(0, 60) + ">"};
}

pugi::xml_node first_element(pugi::xml_node node) {
  for (pugi::xml_node child : node.children()) {
    if (child.type() == pugi::node_element) return child;
  }
  return {};
}

}  // namespace

std::size_t element_count(pugi::xml_node node) {
  std::size_t count = std::string_view(node.name()) == "model" ? 50 : 1;
  for (pugi::xml_node child : node.children()) count += child.type() == pugi::node_element ? element_count(child) : 0;
  return count;
}

ModelFiles::ModelFiles(const ModelPath& model_path, SdfLibrary& library, Complaints& complaints)
    : model_path_(model_path), library_(library), complaints_(complaints) {}

base::Result<pugi::xml_document> ModelFiles::open_text(const std::string& text, const std::string& file_name) {
  base::Result<pugi::xml_document> parsed = parse_xml(text, file_name, complaints_);
  if (!parsed) return parsed;
  pugi::xml_node sdf = parsed->child("sdf");
  if (!sdf && parsed->child("robot")) {
    pugi::xml_node written = parsed->child("robot");
    written.append_attribute(file_mark) = complaints_.add_file(file_name);
    base::Result<pugi::xml_document> robot = library_.translate_urdf(urdf_for_library(written, complaints_));
    if (!robot) {
      const auto fault = fault_of_urdf(written);
      return base::Error{file_name + ": " + (fault ? "the URDF robot cannot be read: " + *fault : robot.error().message)};
    }
    robot->child("sdf").append_attribute(file_mark) = complaints_.add_file(file_name);
    carry_mimics(written, robot->child("sdf"), complaints_);
    carry_initial_positions(written, robot->child("sdf").child("model"), complaints_);
    carry_mimic_plugins(robot->child("sdf").child("model"), complaints_);
    carry_rotors(written, robot->child("sdf").child("model"), complaints_);
    return robot;
  }
  if (!sdf) return wrong_root(first_element(*parsed), file_name);
  check_name_lengths(sdf, complaints_);
  repair_document(sdf, complaints_);
  const std::string version = sdf.attribute("version").value();
  const int number = version_number(version);
  if (number == 0 || number > newest_known) {
    const std::string written = version.empty() ? "names no version" : "is of version " + base::in_quotes(version);
    const std::string finding = "the file " + written + "; it is read as SDFormat " + current_sdf_version;
    number == 0 ? complaints_.warn(sdf, finding) : complaints_.note(sdf, finding);
    sdf.remove_attribute("version");
    sdf.append_attribute("version") = current_sdf_version;
    return parsed;
  }
  if (number == newest_known) return parsed;
  if (number < first_with_frames && has_flattened_names(sdf)) {
    if (base::Result<pugi::xml_document> newer = library_.translate(sdf, "1.7")) {
      parsed = std::move(newer);
      sdf = parsed->child("sdf");
      sdf.append_attribute(file_mark) = complaints_.add_file(file_name);
      keep_axes_in_nested_models(sdf);
    }
  }
  if (number < first_with_nested_names && has_torn_names(sdf)) flatten_names(sdf, complaints_);
  base::Result<pugi::xml_document> translated = library_.translate(sdf);
  if (!translated && flatten_names(sdf, complaints_)) translated = library_.translate(sdf);
  if (!translated) return base::Error{complaints_.place_of(sdf).text() + ": " + translated.error().message};
  pugi::xml_node root = translated->child("sdf");
  root.remove_attribute(file_mark);
  root.append_attribute(file_mark) = complaints_.add_file(file_name);
  return translated;
}

bool ModelFiles::complete(pugi::xml_node entity, const fs::path& folder) {
  insert_floor_plans(entity, folder, model_path_, complaints_);
  if (!check_numbers(entity, complaints_)) return false;
  library_.check(entity, complaints_);
  resolve_uris(entity, folder);
  const std::function<void(pugi::xml_node)> expand = [&](pugi::xml_node node) {
    for (const char* kind : {"model", "population"}) {
      for (pugi::xml_node child : node.children(kind)) expand(child);
    }
    if (std::string_view(node.name()) == "model") expand_includes(node, folder);
  };
  expand(entity);
  return true;
}

void ModelFiles::resolve_uris(pugi::xml_node entity, const fs::path& folder) {
  std::vector<pugi::xml_node> lost;
  const std::function<void(pugi::xml_node)> walk = [&](pugi::xml_node node) {
    const std::string_view name = node.name();
    const std::string_view parent = node.parent().name();
    if ((name == "plugin" && parent != "visual") || name == "include") return;
    const bool is_shape = name == "uri" && (parent == "mesh" || parent == "heightmap");
    const bool is_script = name == "uri" && parent == "script";
    const bool is_image =
        name.ends_with("_map") || name == "heat_signature" || (parent == "texture" && (name == "diffuse" || name == "normal"));
    const bool is_figure = name == "filename" && (parent == "skin" || parent == "animation");
    if (!is_shape && !is_script && !is_image && !is_figure) {
      for (pugi::xml_node child : node.children()) walk(child);
      return;
    }
    const std::string uri = text_of(node);
    if (uri.empty() && !is_shape) return;
    if (uri == "__default__" && !is_shape) {  // so Gazebo saves what was never said
      lost.push_back(node);
      return;
    }
    const std::optional<fs::path> found = model_path_.find(uri, folder);
    if (found && !is_lfs_pointer_file(*found)) {
      if (const auto line = model_path_.other_version(uri, *found); !line.empty())
        complaints_.warn(node, "file " + base::in_quotes(uri) + ": " + line);
      node.text() = found->string().c_str();
      found_files_[{folder.string(), uri}] = found->string();
      return;
    }
    if (const std::string color = color_of_media(uri); !found && is_image && !color.empty()) {
      const bool is_colored = name == "albedo_map" || name == "diffuse";
      if (is_colored) node.text() = color.c_str();
      if (!is_colored) lost.push_back(node);  // bumps and the like are nothing that is missed
      return;
    }
    const std::string fault(found ? lfs_pointer_fault : "is not found");
    if (is_shape) {
      const pugi::xml_node owner = node.parent().parent().parent();
      const bool is_seen = std::string_view(owner.name()) == "visual";
      const bool is_ground = parent == "heightmap";
      complaints_.drop(node, std::string(parent) + " file " + base::in_quotes(uri) + " of " + describe_in_context(owner) + " " + fault +
                                 "; " +
                                 (is_ground ? "a flat ground is taken"
                                  : is_seen ? "a stand-in is drawn"
                                            : std::string("the ") + owner.name() + " is left out"));
      if (is_seen || is_ground)
        node.text() = missing_file;
      else
        lost.push_back(owner);
    } else if (is_script) {
      // The materials of Gazebo itself are built in.
      if (uri.find("gazebo.material") == std::string::npos) complaints_.warn(node, "material script " + base::in_quotes(uri) + " " + fault);
      lost.push_back(node);
    } else if (name == "albedo_map" || name == "diffuse") {
      complaints_.warn(node, "texture " + base::in_quotes(uri) + " " + fault + "; a chequer stands in");
      node.text() = missing_file;
    } else {
      complaints_.warn(node, (is_figure ? "animation or skin " : "texture ") + base::in_quotes(uri) + " " + fault);
      lost.push_back(node);
    }
  };
  walk(entity);
  for (pugi::xml_node node : lost) {
    if (node.parent()) node.parent().remove_child(node);
  }
}

base::Result<fs::path> ModelFiles::file_in_folder(const fs::path& folder) {
  std::error_code problem;
  for (const char* name : {"model.config", "manifest.xml"}) {
    const fs::path config = folder / name;
    if (!fs::exists(config, problem)) continue;
    base::Result<std::string> text = read_file(config);
    if (!text) return text.error();
    base::Result<pugi::xml_document> parsed = parse_xml(*text, config.string(), complaints_);
    if (!parsed) return parsed.error();
    fs::path best, newest;
    int best_version = -1, newest_version = -1;
    for (pugi::xml_node sdf : first_element(*parsed).children("sdf")) {
      const int version = version_number(sdf.attribute("version").value());
      const fs::path file = folder / text_of(sdf);
      if (!fs::is_regular_file(file, problem)) continue;
      if (version <= newest_known && version > best_version) best_version = version, best = file;
      if (version > newest_version) newest_version = version, newest = file;
    }
    if (!best.empty()) return best;
    if (!newest.empty()) return newest;
  }
  if (fs::exists(folder / "model.sdf", problem)) return folder / "model.sdf";
  return base::Error{folder.string() + ": neither a model.config that names an SDF file nor a model.sdf is there"};
}

base::Result<pugi::xml_node> ModelFiles::entity(const fs::path& path) {
  std::error_code problem;
  if (!fs::is_directory(path, problem)) return load(path);
  base::Result<fs::path> file = file_in_folder(path);
  if (!file) return file.error();
  return load(*file);
}

base::Result<pugi::xml_node> ModelFiles::load(const fs::path& file) {
  const std::string key = file.lexically_normal().string();
  const auto find_entity = [](pugi::xml_node sdf) {
    for (pugi::xml_node child : sdf.children()) {
      if (is_entity(child)) return child;
    }
    return pugi::xml_node();
  };
  if (const auto known = documents_.find(key); known != documents_.end()) return find_entity(known->second.child("sdf"));
  if (const auto known = failures_.find(key); known != failures_.end()) return base::Error{known->second};
  const auto failed = [&](const std::string& message) {
    failures_[key] = message;
    return base::Error{message};
  };
  if (being_loaded_.contains(key)) return base::Error{key + ": includes itself"};
  if (being_loaded_.size() >= max_nested_files)
    return failed(key + ": files are included in each other more than " + std::to_string(max_nested_files) + " deep");
  base::Result<std::string> text = read_file(file);
  if (!text) return failed(text.error().message);
  base::Result<pugi::xml_document> document = open_text(*text, key);
  if (!document) return failed(document.error().message);
  const pugi::xml_node found = find_entity(document->child("sdf"));
  if (!found) return failed(key + ": a <model>, <actor> or <light> is expected in it");
  being_loaded_.insert(key);
  const bool is_fit = complete(found, file.parent_path());
  being_loaded_.erase(key);
  if (!is_fit) return failed(key + ": the " + found.name() + " is not fit to be used");
  if (element_count(found) > max_elements_of_a_model) {
    return failed(key + ": the model has more than " + std::to_string(max_elements_of_a_model) + " elements with all it includes");
  }
  return find_entity(documents_.emplace(key, std::move(*document)).first->second.child("sdf"));
}

pugi::xml_node ModelFiles::included(pugi::xml_node include, const fs::path& folder) {
  const std::string uri = text_of(include.child("uri"));
  if (uri.empty()) {
    complaints_.drop(include, "<include> has no <uri> and is left out");
    return {};
  }
  const auto [known, is_new] = found_.try_emplace(uri + "\n" + folder.string());
  if (is_new) known->second = model_path_.find(uri, folder);
  const std::optional<fs::path>& path = known->second;
  if (const auto line = is_new && path ? model_path_.other_version(uri, *path) : ""; !line.empty())
    complaints_.warn(include, "model " + base::in_quotes(uri) + ": " + line);
  if (!path) {
    complaints_.drop(include, "model " + base::in_quotes(uri) + " is not found and is left out" + model_path_.suggestion_for(uri));
    return {};
  }
  base::Result<pugi::xml_node> found = entity(*path);
  if (!found) {
    complaints_.drop(include, "model " + base::in_quotes(uri) + " is left out: " + found.error().message);
    return {};
  }
  if (is_new) found_files_[{folder.string(), uri}] = complaints_.place_of(*found).file;
  return *found;
}

void ModelFiles::apply_include(pugi::xml_node include, pugi::xml_node copy) {
  if (const std::string name = text_of(include.child("name")); !name.empty()) {
    if (!copy.attribute("name")) copy.append_attribute("name");
    copy.attribute("name") = name.c_str();
  }
  if (const pugi::xml_node pose = include.child("pose")) {
    copy.remove_child("pose");
    copy.prepend_copy(pose);
  }
  if (const std::string frame = text_of(include.child("placement_frame")); !frame.empty()) {
    copy.remove_attribute("placement_frame");
    copy.append_attribute("placement_frame") = frame.c_str();
  }
  if (const pugi::xml_node is_static = include.child("static")) {
    copy.remove_child("static");
    copy.append_copy(is_static);
  }
  for (pugi::xml_node plugin : include.children("plugin")) {
    pugi::xml_node added = copy.append_copy(plugin);
    // Its lines are those of the including file.
    for (pugi::xml_node at = include; at; at = at.parent()) {
      if (!at.attribute(file_mark)) continue;
      added.append_copy(at.attribute(file_mark));
      break;
    }
  }
}

namespace {

// Puts the content of a nested model into the one around it (<include merge="true">): a frame stands for the place where the model would
// be.
void merge_model(pugi::xml_node nested, pugi::xml_node around) {
  const std::string frame = "_merged__" + std::string(nested.attribute("name").value()) + "__model__";
  const auto redirect = [&](pugi::xml_node node, const char* key, bool when_empty) {
    const std::string_view value = node.attribute(key).value();
    if (value != "__model__" && !(when_empty && value.empty())) return;
    node.remove_attribute(key);
    node.append_attribute(key) = frame.c_str();
  };
  pugi::xml_node place = around.append_child("frame");
  place.append_attribute("name") = frame.c_str();
  const pugi::xml_node first_link = nested.child("link");
  const std::string_view canonical = nested.attribute("canonical_link").value();
  place.append_attribute("attached_to") = canonical.empty() ? first_link.attribute("name").value() : canonical.data();
  pugi::xml_node pose = nested.child("pose") ? place.append_copy(nested.child("pose")) : place.append_child("pose");
  if (std::string_view(pose.attribute("relative_to").value()).empty()) {
    pose.remove_attribute("relative_to");
    pose.append_attribute("relative_to") = "__model__";
  }
  for (pugi::xml_node child : nested.children()) {
    const std::string_view kind = child.name();
    if (kind == "pose" || kind == "static" || child.type() != pugi::node_element) continue;
    pugi::xml_node copy = around.append_copy(child);
    copy.remove_attribute(file_mark);
    copy.append_copy(nested.attribute(file_mark));
    if (kind == "link" || kind == "model") {
      pugi::xml_node own = copy.child("pose") ? copy.child("pose") : copy.prepend_child("pose");
      redirect(own, "relative_to", true);
    } else if (kind == "frame") {
      redirect(copy, "attached_to", true);
      redirect(copy.child("pose"), "relative_to", false);
    } else if (kind == "joint") {
      redirect(copy.child("pose"), "relative_to", false);
      for (const char* axis : {"axis", "axis2"}) redirect(child_at(copy, std::string(axis) + "/xyz"), "expressed_in", false);
      for (const char* end : {"parent", "child"}) {
        if (text_of(copy.child(end)) == "__model__") copy.child(end).text() = frame.c_str();
      }
    }
  }
}

}  // namespace

void ModelFiles::expand_includes(pugi::xml_node model, const fs::path& folder) {
  std::size_t elements = element_count(model);
  for (pugi::xml_node include = model.child("include"), next; include; include = next) {
    next = include.next_sibling("include");
    const pugi::xml_node found = included(include, folder);
    if (!found && !model.attribute(lost_include_mark)) model.append_attribute(lost_include_mark) = true;
    if (found && std::string_view(found.name()) != "model") {
      complaints_.drop(
          include, "a model is expected to be included in " + describe_in_context(model) + ", got " + describe(found) + "; it is left out");
    } else if (found && (elements += element_count(found)) > max_elements_of_a_model) {
      complaints_.drop(include, describe_in_context(model) + " has more than " + std::to_string(max_elements_of_a_model) +
                                    " elements with all it includes; " + base::in_quotes(text_of(include.child("uri"))) + " is left out");
    } else if (found) {
      pugi::xml_node copy = model.insert_copy_before(found, include);
      copy.remove_attribute(file_mark);
      copy.append_attribute(file_mark) = complaints_.add_file(complaints_.place_of(found).file);
      apply_include(include, copy);
      const bool is_merged = include.attribute("merge").as_bool();
      if (is_merged && copy.attribute("placement_frame")) {
        complaints_.warn(include, "an include with a placement frame is not merged");
      } else if (is_merged && copy.child("link")) {
        merge_model(copy, model);
        model.remove_child(copy);
      }
    }
    model.remove_child(include);
  }
}

}  // namespace sim
