#include "campaign/run/action_script.h"

namespace campaign {

Result<std::unique_ptr<ActionScript>> ActionScript::read(const std::string& file) {
  const auto plan = read_plan(file);
  if (!plan) return plan.error();
  return std::make_unique<ActionScript>(*plan);
}

}  // namespace campaign
