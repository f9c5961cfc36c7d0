// Completion candidates from this machine: simulators, their ifaces and models. Any thread.
#pragma once

#include "base/completion.h"

namespace simctl {

std::optional<std::vector<base::Offer>> offers(const std::string& value, const std::vector<std::string>& before,
                                               const std::string& current);

}  // namespace simctl
