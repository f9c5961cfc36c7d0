#include "world/sdf_library.h"

#include <cmath>
#include <cstdlib>
#include <functional>
#include <set>

#include "base/text.h"
#include "world/sdf_border.h"
#include "world/xml_file.h"
#include "world/xml_values.h"

namespace sim {

namespace {

// libsdformat talks to stderr and opens a log file in the home folder when its console is made. Neither is wanted; the environment is
// changed only while the console is made, before any of our threads is told to load.
void silence_console() {
  const char* home = std::getenv("HOME");
  const std::string kept = home ? home : "";
  setenv("HOME", "/dev/null", 1);
  sdf::Console::Instance()->SetQuiet(true);
  home ? setenv("HOME", kept.c_str(), 1) : unsetenv("HOME");
}

sdf::ParserConfig quiet_config() {
  sdf::ParserConfig config;
  config.SetWarningsPolicy(sdf::EnforcementPolicy::LOG);
  config.SetUnrecognizedElementsPolicy(sdf::EnforcementPolicy::LOG);
  config.SetDeprecatedElementsPolicy(sdf::EnforcementPolicy::LOG);
  config.SetFindCallback([](const std::string&) { return std::string(); });
  return config;
}

// A document without descriptions: whatever is read into it stays as it was written.
sdf::SDFPtr free_form() {
  sdf::SDFPtr document = std::make_shared<sdf::SDF>();
  document->Root()->SetName("sdf");
  document->Root()->SetCopyChildren(true);
  document->Root()->AddAttribute("version", "string", current_sdf_version, true);
  return document;
}

void copy_element(const sdf::ElementPtr& from, pugi::xml_node to) {
  for (const sdf::ParamPtr& attribute : from->GetAttributes()) {
    if (attribute->GetSet()) to.append_attribute(attribute->GetKey().c_str()) = attribute->GetAsString().c_str();
  }
  if (from->GetValue() && !from->GetValue()->GetAsString().empty()) {
    to.append_child(pugi::node_pcdata).set_value(from->GetValue()->GetAsString().c_str());
  }
  for (sdf::ElementPtr child = from->GetFirstElement(); child; child = child->GetNextElement()) {
    copy_element(child, to.append_child(child->GetName().c_str()));
  }
}

pugi::xml_document to_document(const sdf::SDFPtr& source, const std::string& version = current_sdf_version) {
  pugi::xml_document document;
  pugi::xml_node root = document.append_child("sdf");
  copy_element(source->Root(), root);
  root.remove_attribute("version");
  root.prepend_attribute("version") = version.c_str();
  return document;
}

base::Error first_reason(const sdf::Errors& errors) { return reason(errors.empty() ? std::string() : errors.front().Message()); }

sdf::ElementPtr shallow_copy(const sdf::ElementPtr& description) {
  auto copy = std::make_shared<sdf::Element>();
  copy->SetName(description->GetName());
  copy->SetRequired(description->GetRequired());
  copy->SetCopyChildren(description->GetCopyChildren());
  if (const sdf::ParamPtr value = description->GetValue())
    copy->AddValue(value->GetTypeName(), value->GetDefaultAsString(), value->GetRequired(), "");
  for (const sdf::ParamPtr& attribute : description->GetAttributes()) {
    copy->AddAttribute(attribute->GetKey(), attribute->GetTypeName(), attribute->GetDefaultAsString(), attribute->GetRequired(), "");
  }
  return copy;
}

bool is_required(const sdf::ElementPtr& description) { return description->GetRequired() == "1" || description->GetRequired() == "+"; }

// Every element that libsdformat reads gets a copy of all that could stand in it; what no document of ours uses is cut off before.
sdf::ElementPtr prune(const sdf::ElementPtr& description, const sdf::ElementPtr& model, const std::set<std::string>& used, int nested) {
  sdf::ElementPtr copy = shallow_copy(description);
  for (std::size_t i = 0; i < description->GetElementDescriptionCount(); ++i) {
    sdf::ElementPtr child = description->GetElementDescription(i);
    const bool is_leaf = child->GetElementDescriptionCount() == 0 && child->ReferenceSDF().empty();
    if (!is_leaf && !is_required(child) && !used.contains(child->GetName())) continue;
    if (child->ReferenceSDF() == "model") {
      if (nested > 0) copy->AddElementDescription(prune(model, model, used, nested - 1));
      continue;
    }
    copy->AddElementDescription(prune(child, model, used, nested));
  }
  return copy;
}

Eigen::Isometry3d to_eigen(const ignition::math::Pose3d& pose) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.translation() = Eigen::Vector3d(pose.Pos().X(), pose.Pos().Y(), pose.Pos().Z());
  out.linear() = Eigen::Quaterniond(pose.Rot().W(), pose.Rot().X(), pose.Rot().Y(), pose.Rot().Z()).normalized().toRotationMatrix();
  return out;
}

class Resolver {
 public:
  explicit Resolver(sdf::Errors& errors) : errors_(errors) {}

  template <class Thing>
  Eigen::Isometry3d pose_of(const Thing& thing, const std::string& in) {
    ignition::math::Pose3d pose;
    sdf::Errors problems = thing.SemanticPose().Resolve(pose, in);
    if (!problems.empty()) {
      keep(problems);
      pose = thing.RawPose();
    }
    return to_eigen(pose);
  }

  ResolvedModel model(const sdf::Model& source, const std::string& in) {
    ResolvedModel out;
    out.pose = pose_of(source, in);
    out.canonical_link = source.CanonicalLinkAndRelativeName().second;
    for (std::size_t i = 0; i < source.LinkCount(); ++i)
      out.links[source.LinkByIndex(i)->Name()] = pose_of(*source.LinkByIndex(i), "__model__");
    for (std::size_t i = 0; i < source.FrameCount(); ++i)
      out.frames[source.FrameByIndex(i)->Name()] = pose_of(*source.FrameByIndex(i), "__model__");
    for (std::size_t i = 0; i < source.JointCount(); ++i) out.joints[source.JointByIndex(i)->Name()] = joint(*source.JointByIndex(i));
    for (std::size_t i = 0; i < source.ModelCount(); ++i)
      out.models[source.ModelByIndex(i)->Name()] = model(*source.ModelByIndex(i), "__model__");
    return out;
  }

 private:
  void keep(const sdf::Errors& problems) { errors_.insert(errors_.end(), problems.begin(), problems.end()); }

  ResolvedJoint joint(const sdf::Joint& source) {
    ResolvedJoint out;
    keep(source.ResolveParentLink(out.parent));
    keep(source.ResolveChildLink(out.child));
    if (out.parent == "world") out.parent.clear();
    if (out.child == "world") out.child.clear();
    out.pose = pose_of(source, "__model__");
    for (unsigned i = 0; i < 2; ++i) {
      const sdf::JointAxis* axis = source.Axis(i);
      if (!axis) break;
      ignition::math::Vector3d xyz = axis->Xyz();
      keep(axis->ResolveXyz(xyz));
      const Eigen::Vector3d direction(xyz.X(), xyz.Y(), xyz.Z());
      out.axes.push_back(direction.norm() > 0 ? Eigen::Vector3d(direction.normalized()) : Eigen::Vector3d::UnitZ());
    }
    return out;
  }

  sdf::Errors& errors_;
};

// Whether the text can be a value of the type that the specification names.
bool fits_type(const std::string& type, const std::string& text) {
  if (type == "bool") return base::parse_bool(text).has_value();
  if (type == "int" || type == "unsigned int" || type == "uint64_t") {
    const std::optional<std::vector<double>> numbers = parse_numbers(text);
    const bool is_hex = text.starts_with("0x");
    return is_hex || (numbers && numbers->size() == 1 && std::abs(numbers->front()) < 1e19 && (type == "int" || numbers->front() >= 0));
  }
  std::size_t least = 0, most = 0;
  if (type == "double" || type == "float") {
    least = most = 1;
  } else if (type == "vector2d" || type == "vector2i") {
    least = most = 2;
  } else if (type == "vector3" || type == "color") {
    least = 3;
    most = type == "color" ? 4 : 3;
  } else if (type == "quaternion") {
    least = most = 4;
  } else if (type == "pose") {
    least = 6;
    most = 7;
  } else {
    return true;
  }
  const std::optional<std::vector<double>> numbers = parse_numbers(text);
  if (!numbers || numbers->size() < least || numbers->size() > most) return false;
  for (double number : *numbers) {
    if (std::isnan(number)) return false;
  }
  return true;
}

// "alwaysOn" -> "always_on".
std::string snake_case(const std::string& name) {
  std::string out;
  for (char c : name) {
    if (c >= 'A' && c <= 'Z' && !out.empty()) out += '_';
    out += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return out;
}

// Elements that newer versions or ROS know: names of topics and frames of messages, and controllers outside of the simulator.
bool means_nothing_here(std::string_view name) {
  for (std::string_view known : {"gz_frame_id", "ignition_frame_id", "optical_frame_id", "camera_info_topic", "trigger_topic",
                                 "enable_metrics", "robotNamespace", "topicName", "frameName", "ros2_control"}) {
    if (name == known) return true;
  }
  return false;
}

// What sensors have that this library does not know: the element of a type of ours or of a newer version (a type that nobody knows gets a
// line of its own), and our <rolling> of a lidar.
bool is_taken_over(pugi::xml_node node, std::string_view name) {
  const std::string_view parent = node.name();
  return (parent == "sensor" && name == node.attribute("type").value()) || (name == "rolling" && (parent == "lidar" || parent == "ray"));
}

std::string expectation(const std::string& type) {
  if (type == "bool") return "true or false";
  if (type == "int") return "a whole number";
  if (type == "unsigned int" || type == "uint64_t") return "a whole number that is not negative";
  if (type == "vector3") return "three numbers";
  if (type == "vector2d" || type == "vector2i") return "two numbers";
  if (type == "color") return "three or four numbers";
  if (type == "pose") return "six numbers";
  return "a number";
}

}  // namespace

namespace {

// What elements there are. Reading it takes longer than loading a usual world, so that it is made once and never changed; a spawned model
// need not wait.
const sdf::ElementPtr& specification() {
  static const sdf::ElementPtr root = [] {
    silence_console();
    const sdf::SDFPtr document = std::make_shared<sdf::SDF>();
    sdf::init(document);
    return document->Root();
  }();
  return root;
}

}  // namespace

struct SdfLibrary::State {
  sdf::ParserConfig config = quiet_config();
  sdf::ElementPtr model = specification()->GetElementDescription("model");
  Complaints* complaints = nullptr;

  void check(pugi::xml_node node, const sdf::ElementPtr& description);
  void check_attributes(pugi::xml_node node, const sdf::ElementPtr& description);
  bool has_all_attributes(pugi::xml_node node, const sdf::ElementPtr& description);
};

SdfLibrary::SdfLibrary() : state_(std::make_unique<State>()) {}

SdfLibrary::~SdfLibrary() = default;

base::Result<pugi::xml_document> SdfLibrary::translate(pugi::xml_node sdf, const std::string& version) {
  const std::string text = to_xml(sdf, true);
  auto done = ask_library([&]() -> std::optional<pugi::xml_document> {
    const sdf::SDFPtr document = free_form();
    if (!sdf::convertString(text, version, state_->config, document)) return std::nullopt;
    return to_document(document, version);
  });
  const std::string refusal = "cannot be translated from SDFormat " + base::in_quotes(sdf.attribute("version").value()) + " to " + version;
  if (!done) return base::Error{refusal + ": " + done.error().message};
  if (!*done) return base::Error{refusal};
  return std::move(**done);
}

base::Result<pugi::xml_document> SdfLibrary::translate_urdf(const std::string& text) {
  auto done = ask_library([&]() -> base::Result<pugi::xml_document> {
    const sdf::SDFPtr document = free_form();
    sdf::Errors errors;
    if (!sdf::readString(text, state_->config, document, errors)) return first_reason(errors);
    return to_document(document);
  });
  const std::string refusal = "the URDF robot cannot be read: ";
  if (!done) return base::Error{refusal + done.error().message};
  if (!*done) return base::Error{refusal + (*done).error().message};
  return std::move(**done);
}

void SdfLibrary::check(pugi::xml_node entity, Complaints& complaints) {
  state_->complaints = &complaints;
  const auto done = ask_library([&] {
    const sdf::ElementPtr description = specification()->GetElementDescription(entity.name());
    if (description) state_->check(entity, description);
    return true;
  });
  if (!done) complaints.warn(entity, describe(entity) + " cannot be checked: " + done.error().message);
  state_->complaints = nullptr;
}

void SdfLibrary::State::check_attributes(pugi::xml_node node, const sdf::ElementPtr& description) {
  for (pugi::xml_attribute attribute = node.first_attribute(), next; attribute; attribute = next) {
    next = attribute.next_attribute();
    const std::string name = attribute.name();
    if (name.starts_with('_') || name.find(':') != std::string::npos || name == "xmlns") continue;
    // In some sensors the type is an element, in others an attribute; people mix them up and both are understood.
    if (name == "type" && std::string_view(node.name()) == "noise") continue;
    const sdf::ParamPtr param = description->GetAttribute(name);
    if (!param) {
      complaints->warn(node, "unknown attribute " + base::in_quotes(name) + " of " + describe_in_context(node) + " is ignored");
    } else if (!fits_type(param->GetTypeName(), attribute.value())) {
      complaints->warn(node, "attribute " + base::in_quotes(name) + " of " + describe_in_context(node) + " must be " +
                                 expectation(param->GetTypeName()) + ", got " + base::in_quotes(attribute.value()) + "; it is ignored");
    } else {
      continue;
    }
    node.remove_attribute(attribute);
  }
}

// Missing names are given; false when another attribute is missing without which the element means nothing.
bool SdfLibrary::State::has_all_attributes(pugi::xml_node node, const sdf::ElementPtr& description) {
  for (const sdf::ParamPtr& param : description->GetAttributes()) {
    if (!param->GetRequired()) continue;
    const std::string& key = param->GetKey();
    const pugi::xml_attribute attribute = node.attribute(key.c_str());
    if (attribute && !(key == "name" && base::trim(attribute.value()).empty())) continue;
    if (key == "name") {
      if (!attribute) node.append_attribute("name");
      node.attribute("name") = (std::string(node.name()) + "_without_name").c_str();
      complaints->warn(node,
                       "<" + std::string(node.name()) + "> has no name and is called " + base::in_quotes(node.attribute("name").value()));
    } else if (!(std::string_view(node.name()) == "physics" || std::string_view(node.name()) == "plugin" ||
                 std::string_view(node.name()) == "noise" || std::string_view(node.name()) == "light")) {
      complaints->drop(node, describe_in_context(node) + " has no attribute " + base::in_quotes(key) + " and is left out");
      return false;
    }
  }
  return true;
}

void SdfLibrary::State::check(pugi::xml_node node, const sdf::ElementPtr& description) {
  check_attributes(node, description);
  if (description->GetCopyChildren()) return;
  for (pugi::xml_node child = node.first_child(), next; child; child = next) {
    next = child.next_sibling();
    if (child.type() != pugi::node_element) continue;
    std::string name = child.name();
    if (name.find(':') != std::string::npos || name.starts_with('_')) continue;
    sdf::ElementPtr known = description->GetElementDescription(name);
    for (const std::string& meant : {base::to_lower(name), snake_case(name)}) {
      if (known || meant == name || !description->GetElementDescription(meant)) continue;
      complaints->warn(child, "<" + name.substr(0, 60) + "> in " + describe_in_context(node) + " is taken as <" + meant + ">");
      child.set_name(meant.c_str());
      known = description->GetElementDescription(meant);
      name = meant;
    }
    // Newer than this library, with the elements of a cylinder.
    if (!known && name == "cone") known = description->GetElementDescription("cylinder");
    // Newer than this library; taken over as it is.
    if (!known && name == "shininess" && std::string_view(node.name()) == "material") {
      if (!fits_type("double", text_of(child))) {
        complaints->warn(child, "<shininess> of " + describe_in_context(node) + " must be " + expectation("double") + ", got " +
                                    base::in_quotes(text_of(child)) + "; it is ignored");
        node.remove_child(child);
      }
      continue;
    }
    if (!known && is_taken_over(node, name)) continue;
    if (!known) {
      if (!means_nothing_here(name))
        complaints->warn(child, "unknown element <" + base::in_quotes(name).substr(1, base::in_quotes(name).size() - 2) + "> in " +
                                    describe_in_context(node) + " is ignored");
      node.remove_child(child);
      continue;
    }
    const sdf::ElementPtr& inner = known->ReferenceSDF() == "model" ? model : known;
    if (!has_all_attributes(child, inner)) {
      node.remove_child(child);
      continue;
    }
    const std::string text = text_of(child);
    const sdf::ParamPtr value = inner->GetValue();
    if (value && !text.empty() && inner->GetElementDescriptionCount() == 0 && !fits_type(value->GetTypeName(), text)) {
      complaints->warn(child, "<" + name + "> of " + describe_in_context(node) + " must be " + expectation(value->GetTypeName()) +
                                  ", got " + base::in_quotes(text) + "; it is ignored");
      node.remove_child(child);
      continue;
    }
    check(child, inner);
  }
}

namespace {

base::Result<ResolvedWorld> resolve_text(const std::string& text, const sdf::ElementPtr& descriptions, const sdf::ParserConfig& config) {
  const sdf::SDFPtr document = std::make_shared<sdf::SDF>();
  document->Root(descriptions);
  sdf::Errors errors;
  if (!sdf::readString(text, config, document, errors)) return first_reason(errors);
  sdf::Root root;
  const sdf::Errors problems = root.Load(document, config);
  errors.insert(errors.end(), problems.begin(), problems.end());
  if (!errors.empty() || root.WorldCount() == 0) return first_reason(errors);
  const sdf::World& world = *root.WorldByIndex(0);
  Resolver resolver(errors);
  ResolvedWorld out;
  for (std::size_t i = 0; i < world.FrameCount(); ++i)
    out.frames[world.FrameByIndex(i)->Name()] = resolver.pose_of(*world.FrameByIndex(i), "world");
  for (std::size_t i = 0; i < world.ModelCount(); ++i)
    out.models[world.ModelByIndex(i)->Name()] = resolver.model(*world.ModelByIndex(i), "world");
  if (!errors.empty()) return first_reason(errors);
  return out;
}

}  // namespace

base::Result<ResolvedWorld> SdfLibrary::resolve(pugi::xml_node sdf) {
  std::set<std::string> used;
  int nested = 0;
  const std::function<void(pugi::xml_node, int)> look = [&](pugi::xml_node node, int models) {
    if (node.type() != pugi::node_element) return;
    used.insert(node.name());
    if (std::string_view(node.name()) == "model") nested = std::max(nested, models++);
    for (const pugi::xml_node& child : node.children()) look(child, models);
  };
  look(sdf, 0);
  const std::string text = to_xml(sdf, false);
  auto done = ask_library([&] { return resolve_text(text, prune(specification(), state_->model, used, nested), state_->config); });
  return done ? std::move(*done) : done.error();
}

}  // namespace sim
