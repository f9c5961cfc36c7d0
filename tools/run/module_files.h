// The file of a component type: a library TYPE.so, or a source of Python TYPE.py. Any thread.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace tools {

enum class ModuleKind { none, library, python };

// Of the first folder that has one; a library counts before a source in the same folder.
ModuleKind module_kind(const std::string& type, const std::vector<std::string>& folders);
bool is_module(const std::filesystem::path& file);
// "Wall.so or Wall.py"
std::string module_names(const std::string& type);

// For hosts of Python components, so that a run can be repeated: one order of sets and dictionaries, one thread of BLAS, and loops of numpy
// that do not depend on the processor. A value that the user has given stays.
std::map<std::string, std::string> same_python();

}  // namespace tools
