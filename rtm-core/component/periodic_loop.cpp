#include "rtm/PeriodicLoop.h"

#include <algorithm>

#include "base/waiting.h"

namespace RTC::detail {

void LoopState::worker() const {
  if (!m_sm.machine) return;
  m_sm.machine->workerPreDo();
  m_sm.machine->workerDo();
  m_sm.machine->workerPostDo();
}

void LoopMember::run() const {
  if (is_first) {
    list->cycle_start_ = std::chrono::steady_clock::now();
    list->waited_before_ = base::time_waited();
  }
  _sm.worker();
  if (!is_last) return;
  const std::chrono::nanoseconds took = std::chrono::steady_clock::now() - list->cycle_start_.load();
  const auto waited = std::clamp(base::time_waited() - list->waited_before_.load(), std::chrono::nanoseconds(0), took);
  list->worker_.countCycle(took - waited, waited);
}

LoopMembers::Snapshot LoopMembers::refresh() {
  auto members = std::make_shared<std::vector<LoopMember>>();
  for (auto& machine : worker_.members()) {
    const RTC::LightweightRTObject_var component = machine->getRTObject();
    members->push_back({._ref = component, ._sm = LoopState(std::move(machine)), .list = this, .is_first = members->empty()});
  }
  if (!members->empty()) members->back().is_last = true;
  const std::lock_guard lock(mutex_);
  members_ = std::move(members);
  return members_;
}

LoopMember LoopMembers::operator[](std::size_t at) const {
  const std::lock_guard lock(mutex_);
  return at < members_->size() ? (*members_)[at] : LoopMember();
}

}  // namespace RTC::detail
