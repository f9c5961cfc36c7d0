// Applies the faults of the property fault.on_execute to the ticks of a component; see core/fault.h. The thread that runs the component
// only.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "core/fault.h"

namespace rt {

class ExecuteFaults {
 public:
  // Null without faults.
  static base::Result<std::unique_ptr<ExecuteFaults>> parse(const std::string& text);
  // Before onExecute. True: the tick has failed, and onExecute is not called. Throws what the fault is to throw; may take long, or for
  // ever.
  bool strike();

 private:
  explicit ExecuteFaults(std::vector<Fault> faults) : faults_(std::move(faults)), has_struck_(faults_.size()) {}
  std::vector<Fault> faults_;
  std::vector<bool> has_struck_;
  std::uint64_t epoch_ = 0;
};

}  // namespace rt
