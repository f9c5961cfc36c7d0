#include "world/frame_references.h"

#include <algorithm>
#include <map>
#include <set>
#include <string_view>

#include "base/text.h"
#include "world/xml_file.h"

namespace sim {
namespace {

enum class Relation { attached, relative };

pugi::xml_attribute reference_of(const NamedPlace& place, Relation relation) {
  return relation == Relation::attached ? place.frame.attribute("attached_to") : place.pose.attribute("relative_to");
}

std::string head_of(std::string_view reference) { return std::string(reference.substr(0, reference.find("::"))); }

void take_out(const NamedPlace& place, Relation relation, const std::string& why, Complaints& complaints) {
  const bool is_attached = relation == Relation::attached;
  pugi::xml_node holder = is_attached ? place.frame : place.pose;
  const pugi::xml_attribute reference = reference_of(place, relation);
  const pugi::xml_node thing = place.frame ? place.frame : place.pose.parent();
  complaints.warn(thing, describe_in_context(thing) + (is_attached ? " is attached to " : " stands relative to ") +
                             base::in_quotes(reference.value()) + ", " + why + "; it is ignored");
  holder.remove_attribute(reference);
}

// Whom a place follows in one of the graphs, and whether an attribute says so.
struct Step {
  std::string to;
  Relation relation = Relation::attached;
  bool is_said = false;
};

// A frame without a pose of its own stands where it is attached.
Step step_from(const NamedPlace& place, bool is_of_poses) {
  Relation relation = Relation::attached;
  if (is_of_poses && (!place.frame || !std::string_view(place.pose.attribute("relative_to").value()).empty()))
    relation = Relation::relative;
  const std::string said = head_of(reference_of(place, relation).value());
  return said.empty() && is_of_poses ? Step{head_of(place.implied), relation, false} : Step{said, relation, !said.empty()};
}

}  // namespace

void repair_missing_references(const std::vector<NamedPlace>& places, Complaints& complaints) {
  std::set<std::string> names{"world"};
  for (const NamedPlace& place : places) names.insert(place.name);
  names.erase("");
  for (const NamedPlace& place : places) {
    for (const Relation relation : {Relation::attached, Relation::relative}) {
      const pugi::xml_attribute reference = reference_of(place, relation);
      if (std::string_view(reference.value()).empty() || names.contains(head_of(reference.value()))) continue;
      take_out(place, relation, "which does not exist", complaints);
    }
  }
}

void repair_circular_references(const std::vector<NamedPlace>& places, Complaints& complaints) {
  std::map<std::string, const NamedPlace*> by_name;
  for (const NamedPlace& place : places) {
    if (!place.name.empty()) by_name.emplace(place.name, &place);
  }
  // What is attached, and what stands relative to what, are two graphs; neither may have a circle.
  for (const bool is_of_poses : {false, true}) {
    std::set<const NamedPlace*> sound;
    for (const NamedPlace& start : places) {
      std::vector<const NamedPlace*> way;
      for (const NamedPlace* at = &start; at != nullptr && !sound.contains(at);) {
        way.push_back(at);
        const auto next = by_name.find(step_from(*at, is_of_poses).to);
        at = next == by_name.end() ? nullptr : next->second;
        const auto circle = std::find(way.begin(), way.end(), at);
        if (circle == way.end()) continue;
        const auto said = std::find_if(circle, way.end(), [&](const NamedPlace* place) { return step_from(*place, is_of_poses).is_said; });
        if (said != way.end()) take_out(**said, step_from(**said, is_of_poses).relation, "which leads back to it", complaints);
        break;
      }
      sound.insert(way.begin(), way.end());
    }
  }
}

void repair_circular_references(pugi::xml_node model, Complaints& complaints) {
  std::vector<NamedPlace> places;
  for (const char* kind : {"link", "model", "frame", "joint"}) {
    const bool is_frame = std::string_view(kind) == "frame", is_joint = std::string_view(kind) == "joint";
    for (pugi::xml_node node : model.children(kind)) {
      places.push_back({node.attribute("name").value(), is_frame ? node : pugi::xml_node(), node.child("pose"),
                        is_joint ? text_of(node.child("child")) : ""});
    }
  }
  repair_circular_references(places, complaints);
}

}  // namespace sim
