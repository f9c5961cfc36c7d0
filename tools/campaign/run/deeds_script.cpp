#include "campaign/run/deeds_script.h"

namespace campaign {

Result<std::unique_ptr<DeedsScript>> DeedsScript::read(const std::string& file) {
  const auto plan = read_plan(file);
  if (!plan) return plan.error();
  return std::make_unique<DeedsScript>(*plan);
}

}  // namespace campaign
