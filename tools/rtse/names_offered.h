// Completion candidates from the running system: components, ports, parameters, managers. One thread at a time.
#pragma once

#include "base/completion.h"

namespace tools {

// Asks the name server of the words (or the default one), half a second at most for a call; nothing when it does not answer.
std::optional<std::vector<base::Offer>> names_offered(const std::string& value, const std::vector<std::string>& before,
                                                      const std::string& current);

}  // namespace tools
