// Names of the files that the loader found. A value; any thread.
#pragma once

#include <map>
#include <string>
#include <utility>

namespace sim {

// Absolute names of files, by the folder of the file that names them and the URI in it. Of an include: the SDFormat file.
using FoundFiles = std::map<std::pair<std::string, std::string>, std::string>;

}  // namespace sim
