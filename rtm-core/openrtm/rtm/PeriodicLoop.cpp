#include "rtm/PeriodicLoop.h"

#include "rtm/ExecutionContextBase.h"

namespace RTC::detail {

std::size_t LoopMembers::size() {
  members_.clear();
  for (const auto& component : context_.getComponents()) {
    members_.push_back({RTC::LightweightRTObject::_duplicate(component), members_.empty() ? &context_ : nullptr});
  }
  return members_.size();
}

LoopMembers::iterator LoopMembers::begin() {
  size();
  return {this, 0};
}

}  // namespace RTC::detail
