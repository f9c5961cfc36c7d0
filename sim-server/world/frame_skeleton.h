// The bare frames of models: all that libsdformat has to see of them. One thread at a time.
#pragma once

#include <pugixml.hpp>
#include <string>

namespace sim {

// Appends to `parent` (a <world> or <model>) the model with nothing but its links, joints, frames and nested models. A pose of a collision,
// visual, sensor or light that is relative to a named frame becomes a frame of its own, whose name is marked on the source
// (frame_of_pose_mark).
void append_skeleton(pugi::xml_node model, pugi::xml_node parent, const std::string& name, bool keep_pose);

// A <frame> of a model or world.
void append_frame(pugi::xml_node frame, pugi::xml_node parent);

// The pose of something as a frame (lights and actors of a world, too); marks the source when its pose is relative to something.
void append_frame_of_pose(pugi::xml_node thing, pugi::xml_node parent, const std::string& attached_to, const std::string& frame_name);

// The <pose> of the element.
void append_pose(pugi::xml_node thing, pugi::xml_node parent);

// Whether the <pose> of the element is relative to a named frame.
bool has_relative_pose(pugi::xml_node thing);

// Links, joints, frames and nested models of the model and of those in it.
std::size_t frames_of(pugi::xml_node model);

}  // namespace sim
