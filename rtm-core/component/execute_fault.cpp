#include "component/execute_fault.h"

#include <chrono>
#include <stdexcept>
#include <thread>

#include "base/clock.h"

namespace rt {

base::Result<std::unique_ptr<ExecuteFaults>> ExecuteFaults::parse(const std::string& text) {
  auto faults = parse_faults(text);
  if (!faults) return faults.error();
  for (const Fault& fault : *faults) {
    if (fault.kind > Fault::Kind::hang) return base::Error{"fault.on_execute " + text + ": expected error, exception, slow or hang"};
  }
  if (faults->empty()) return std::unique_ptr<ExecuteFaults>();
  return std::unique_ptr<ExecuteFaults>(new ExecuteFaults(std::move(*faults)));
}

bool ExecuteFaults::strike() {
  const auto& clock = base::current_clock();
  if (const auto epoch = clock.epoch(); epoch != epoch_) {
    epoch_ = epoch;
    has_struck_.assign(faults_.size(), false);
  }
  const auto now = clock.now();
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    const Fault& fault = faults_[i];
    if (!fault.is_at(now)) continue;
    const bool is_endless = fault.until == std::chrono::nanoseconds::max();
    const bool is_once = is_endless && fault.kind <= Fault::Kind::exception;  // else it could never be reset
    if (is_once && has_struck_[i]) continue;
    has_struck_[i] = true;
    switch (fault.kind) {
      case Fault::Kind::error:
        return true;
      case Fault::Kind::exception:
        throw std::runtime_error("a fault that was asked for");
      case Fault::Kind::hang:
        for (;;) std::this_thread::sleep_for(std::chrono::hours(1));  // this is what was asked for
      default:
        std::this_thread::sleep_for(std::chrono::duration<double>(fault.amount));
        break;
    }
  }
  return false;
}

}  // namespace rt
