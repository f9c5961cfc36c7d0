#include "server/memory_log.h"

#include <spdlog/fmt/fmt.h>

#include "base/text.h"

namespace sim {
namespace {

// As the file of --record has it.
double in_milliseconds(double time) { return base::parse_number(fmt::format("{:.3f}", time)).value_or(time); }

}  // namespace

void MemoryLog::contact(double time, ModelId model, ModelId other, const Physics& physics) {
  bytes_.contact(in_milliseconds(time), static_cast<std::uint32_t>(model), physics.def(model).name, static_cast<std::uint32_t>(other),
                 physics.def(other).name);
}

void MemoryLog::pose(double time, ModelId model, const Physics& physics) {
  const Eigen::Isometry3d pose = physics.model_pose(model);
  const Eigen::Vector3d p = pose.translation();
  const Eigen::Quaterniond q(pose.linear());
  bytes_.pose(in_milliseconds(time), static_cast<std::uint32_t>(model), physics.def(model).name,
              {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()});
  if (joints_.empty()) return;
  const ModelDef& def = physics.def(model);
  for (std::uint32_t j = 0; j < def.joints.size(); ++j) {
    if (def.joints[j].axes.empty() || !joints_.contains(def.name + "::" + def.joints[j].name)) continue;
    bytes_.joint(in_milliseconds(time), static_cast<std::uint32_t>(model), def.name, j, def.joints[j].name,
                 physics.joint_state({model, j}).position);
  }
}

void MemoryLog::still(double time) { bytes_.still(in_milliseconds(time)); }

}  // namespace sim
