// Elements of a document that mean something to a person but not in SDFormat 1.9, put the way SDFormat has them: what was copied from URDF,
// left over from xacro, or comes from newer versions. Before the document is translated to the current version. One thread at a time.
#pragma once

#include <pugixml.hpp>

#include "world/complaints.h"

namespace sim {

void repair_document(pugi::xml_node sdf, Complaints& complaints);

// Whether something is called like "a::b": how versions before 1.8 write what stands in nested models.
bool has_flattened_names(pugi::xml_node sdf);
// Version 1.7 only: what such things say of the model's axes they say of those of their own nested model, which are the same in files that
// were older. Axes of joints are written that way before version 1.5, and by use_parent_model_frame.
void keep_axes_in_nested_models(pugi::xml_node sdf);
// Whether something called like "a::b", from which the translation of versions before 1.8 makes a nested model, refers to what will lie
// outside of it: the reference would be lost.
bool has_torn_names(pugi::xml_node sdf);
// Writes "a_b" for such names and in what refers to them. False when there is none.
bool flatten_names(pugi::xml_node sdf, Complaints& complaints);

// A <road> of a world as a static <model> in `parent`: strips along its points, round at the corners.
pugi::xml_node model_of_road(pugi::xml_node road, pugi::xml_node parent);

// An attribute of an axis: the inertia of its motor's rotor as the joint feels it.
inline constexpr const char* rotor_mark = "_rotor";

// Attributes that carry <inertial auto="true"> and its densities past the checks of version 1.9.
inline constexpr const char* automatic_mark = "_auto";
inline constexpr const char* density_mark = "_density";
inline constexpr const char* added_mass_mark = "_added_mass";

// The same for <initial_position> of an axis, which version 1.9 does not have any more.
inline constexpr const char* initial_mark = "_initial";

// The same for <mimic> of an axis, of version 1.11: the leader, and three numbers.
inline constexpr const char* mimic_mark = "_mimic";
inline constexpr const char* mimic_numbers_mark = "_mimic_numbers";
// Of a <mimic> in any spelling; `otherwise`, with a finding, for what is no number that can be simulated. `joint`: as it is named there.
double number_of_mimic(pugi::xml_node node, const std::string& joint, const char* key, const std::string& text, double otherwise,
                       Complaints& complaints);
// Sets these attributes of an axis.
void mark_mimic(pugi::xml_node axis, const std::string& leader, double multiplier, double offset, double reference);

}  // namespace sim
