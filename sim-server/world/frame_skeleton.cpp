#include "world/frame_skeleton.h"

#include <cmath>
#include <string_view>
#include <vector>

#include "base/text.h"
#include "world/model_builder.h"
#include "world/xml_file.h"
#include "world/xml_values.h"

namespace sim {

namespace {

void copy_child(pugi::xml_node from, pugi::xml_node to, const char* name) {
  if (const pugi::xml_node child = from.child(name)) to.append_copy(child);
}

// Numbers in the one spelling that every parser reads: what is smaller than a parser likes is zero, and nothing at all is `empty`.
void copy_numbers(pugi::xml_node from, pugi::xml_node to, const char* name, const char* empty) {
  copy_child(from, to, name);
  pugi::xml_node copy = to.child(name);
  if (!copy) return;
  std::string text;
  for (double number : parse_numbers(text_of(copy)).value_or(std::vector<double>{})) {
    text += (text.empty() ? "" : " ") + base::format_number(std::abs(number) < 1e-300 ? 0 : number);
  }
  copy.text() = text.empty() ? empty : text.c_str();
}

void copy_pose(pugi::xml_node from, pugi::xml_node to) {
  const bool is_quaternion = std::string_view(from.child("pose").attribute("rotation_format").value()) == "quat_xyzw";
  copy_numbers(from, to, "pose", is_quaternion ? "0 0 0 0 0 0 1" : "0 0 0 0 0 0");
}

void copy_attribute(pugi::xml_node from, pugi::xml_node to, const char* name) {
  if (const pugi::xml_attribute attribute = from.attribute(name)) to.append_copy(attribute);
}

}  // namespace

bool has_relative_pose(pugi::xml_node thing) { return !std::string_view(thing.child("pose").attribute("relative_to").value()).empty(); }

void append_frame_of_pose(pugi::xml_node thing, pugi::xml_node parent, const std::string& attached_to, const std::string& frame_name) {
  thing.remove_attribute(frame_of_pose_mark);
  if (!has_relative_pose(thing)) return;
  pugi::xml_node frame = parent.append_child("frame");
  frame.append_attribute("name") = frame_name.c_str();
  if (!attached_to.empty()) frame.append_attribute("attached_to") = attached_to.c_str();
  copy_pose(thing, frame);
  thing.append_attribute(frame_of_pose_mark) = frame_name.c_str();
}

void append_pose(pugi::xml_node thing, pugi::xml_node parent) { copy_pose(thing, parent); }

void append_frame(pugi::xml_node frame, pugi::xml_node parent) {
  pugi::xml_node out = parent.append_child("frame");
  for (const char* key : {"name", "attached_to"}) copy_attribute(frame, out, key);
  copy_pose(frame, out);
}

void append_skeleton(pugi::xml_node model, pugi::xml_node parent, const std::string& name, bool keep_pose) {
  pugi::xml_node out = parent.append_child("model");
  out.append_attribute("name") = name.c_str();
  for (const char* key : {"canonical_link", "placement_frame"}) copy_attribute(model, out, key);
  if (keep_pose) copy_pose(model, out);
  int frames = 0;
  for (pugi::xml_node link : model.children("link")) {
    const std::string link_name = link.attribute("name").value();
    pugi::xml_node bare = out.append_child("link");
    bare.append_attribute("name") = link_name.c_str();
    copy_pose(link, bare);
    for (const char* kind : {"collision", "visual", "sensor", "light"}) {
      for (pugi::xml_node thing : link.children(kind)) append_frame_of_pose(thing, out, link_name, "_pose_of_" + std::to_string(frames++));
    }
  }
  for (pugi::xml_node frame : model.children("frame")) append_frame(frame, out);
  for (pugi::xml_node joint : model.children("joint")) {
    pugi::xml_node bare = out.append_child("joint");
    for (const char* key : {"name", "type"}) copy_attribute(joint, bare, key);
    copy_pose(joint, bare);
    for (const char* key : {"parent", "child"}) copy_child(joint, bare, key);
    for (const char* key : {"axis", "axis2"}) {
      if (const pugi::xml_node axis = joint.child(key)) copy_numbers(axis, bare.append_child(key), "xyz", "0 0 1");
    }
    const std::string child = text_of(joint.child("child"));
    for (pugi::xml_node sensor : joint.children("sensor"))
      append_frame_of_pose(sensor, out, child == "world" ? "" : child, "_pose_of_" + std::to_string(frames++));
  }
  for (pugi::xml_node nested : model.children("model")) append_skeleton(nested, out, nested.attribute("name").value(), true);
}

std::size_t frames_of(pugi::xml_node model) {
  std::size_t count = 0;
  for (pugi::xml_node child : model.children()) {
    const std::string_view kind = child.name();
    if (kind == "link" || kind == "joint" || kind == "frame") ++count;
    if (kind == "model") count += 1 + frames_of(child);
  }
  return count;
}

}  // namespace sim
