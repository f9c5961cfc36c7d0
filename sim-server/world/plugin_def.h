// A <plugin> of a model or sensor, as it is written: name, file and its free-form parameters. Values: any thread may read a shared one.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sim {

// One node of the free-form parameters of a plugin: an element with its attributes, text and children, in the order of the file.
struct ParameterNode {
  std::string name;
  std::string text;  // trimmed
  std::vector<std::pair<std::string, std::string>> attributes;
  std::vector<ParameterNode> children;

  // The first child of that name, or null.
  const ParameterNode* child(std::string_view child_name) const;
  // The text of the first child that exists, tried in order of the spellings given ("left_joint", "leftJoint").
  std::optional<std::string> text_of(std::initializer_list<std::string_view> spellings) const;
  // As text_of; empty also when the text is no finite number (or no yes/no word).
  std::optional<double> number_of(std::initializer_list<std::string_view> spellings) const;
  std::optional<bool> bool_of(std::initializer_list<std::string_view> spellings) const;
  std::string attribute(std::string_view attribute_name) const;  // empty when absent
};

// A <plugin>. What it does is decided by the devices; the loader only reads it.
struct PluginDef {
  std::string name;
  std::string filename;  // as written: "libDiffDrivePlugin.so", "gz-sim-diff-drive-system", ...
  std::string
      scope;  // nested model it stands in, relative to its ModelDef ("" or "arm::hand"); joints and links it names are relative to it
  std::string iface;  // of drives, as in SensorDef
  ParameterNode parameters;
  std::string source;  // "file:line" for messages
};

}  // namespace sim
