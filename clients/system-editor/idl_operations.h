// The operations of an IDL interface as C++ declarations, asked from omniidl. Any thread.
#pragma once

#include <string>
#include <vector>

#include "skeleton.h"

namespace editor {

struct Operation {
  std::string declaration;  // "Mod::Pt* q(char*& s)"
  std::string answer;       // a statement that returns something harmless
};

// Those of the interface and of the interfaces that it inherits. Fails when omniidl is missing or refuses the file.
base::Result<std::vector<Operation>> operations_of(const NewService& service);

}  // namespace editor
