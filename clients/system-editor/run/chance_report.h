// What the processes of a run have told that could depend on chance. One thread at a time.
#pragma once

#include <string>
#include <vector>

namespace editor {

// One line for each, without doubles, from these log files.
std::vector<std::string> chances_in(const std::vector<std::string>& logs);

}  // namespace editor
