#include "world/frame_skeleton.h"

#include <string_view>

#include "world/model_builder.h"
#include "world/xml_file.h"

namespace sim {

namespace {

void copy_child(pugi::xml_node from, pugi::xml_node to, const char* name) {
  if (const pugi::xml_node child = from.child(name)) to.append_copy(child);
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
  frame.append_copy(thing.child("pose"));
  thing.append_attribute(frame_of_pose_mark) = frame_name.c_str();
}

void append_skeleton(pugi::xml_node model, pugi::xml_node parent, const std::string& name, bool keep_pose) {
  pugi::xml_node out = parent.append_child("model");
  out.append_attribute("name") = name.c_str();
  for (const char* key : {"canonical_link", "placement_frame"}) copy_attribute(model, out, key);
  if (keep_pose) copy_child(model, out, "pose");
  int frames = 0;
  for (pugi::xml_node link : model.children("link")) {
    const std::string link_name = link.attribute("name").value();
    pugi::xml_node bare = out.append_child("link");
    bare.append_attribute("name") = link_name.c_str();
    copy_child(link, bare, "pose");
    for (const char* kind : {"collision", "visual", "sensor", "light"}) {
      for (pugi::xml_node thing : link.children(kind)) append_frame_of_pose(thing, out, link_name, "_pose_of_" + std::to_string(frames++));
    }
  }
  for (pugi::xml_node frame : model.children("frame")) out.append_copy(frame);
  for (pugi::xml_node joint : model.children("joint")) {
    pugi::xml_node bare = out.append_child("joint");
    for (const char* key : {"name", "type"}) copy_attribute(joint, bare, key);
    for (const char* key : {"pose", "parent", "child"}) copy_child(joint, bare, key);
    for (const char* key : {"axis", "axis2"}) {
      if (const pugi::xml_node axis = joint.child(key)) copy_child(axis, bare.append_child(key), "xyz");
    }
  }
  for (pugi::xml_node nested : model.children("model")) append_skeleton(nested, out, nested.attribute("name").value(), true);
}

}  // namespace sim
