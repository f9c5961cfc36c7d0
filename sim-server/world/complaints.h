// Warnings and errors of the loader about the files of one world, with their positions: every element of a document being loaded carries
// its line (and its file where that changes) as attributes, so that the place survives conversions and includes. One thread at a time.
#pragma once

#include <pugixml.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "world/world_def.h"

namespace sim {

inline constexpr const char* line_mark = "_line";
inline constexpr const char* file_mark = "_file";
// On a model that was to include another which is not there and has had its line.
inline constexpr const char* lost_include_mark = "lost_include";

struct Place {
  std::string file;
  int line = 0;
  std::string text() const;  // "file:line"
};

class Complaints {
 public:
  // The number by which documents refer to this file.
  int add_file(const std::string& name);
  Place place_of(pugi::xml_node node) const;

  void add(Finding::Severity severity, const Place& place, std::string message);
  void note(pugi::xml_node at, std::string message) { add(Finding::Severity::note, place_of(at), std::move(message)); }
  void warn(pugi::xml_node at, std::string message) { add(Finding::Severity::warning, place_of(at), std::move(message)); }
  void drop(pugi::xml_node at, std::string message) { add(Finding::Severity::dropped, place_of(at), std::move(message)); }

  bool dropped() const { return dropped_; }
  // In the order they were made; the same line twice is kept once, and a flood is cut with a last line that says so.
  std::vector<Finding> take();

 private:
  std::vector<std::string> files_;
  std::vector<Finding> findings_;
  std::set<std::string> seen_;
  std::size_t cut_ = 0;
  bool dropped_ = false;
};

// "model 'box'" or "<size>": how messages call an element.
std::string describe(pugi::xml_node node);
// As describe, with the model and link around it: "collision 'c' of link 'l' of model 'm'".
std::string describe_in_context(pugi::xml_node node);

}  // namespace sim
