#include "server/recorder.h"

#include <cerrno>
#include <cstring>

#include "base/log.h"

namespace sim {

base::Result<Recorder> Recorder::open(const std::string& path, const std::string& world) {
  std::ofstream file(path);
  if (!file) return base::Error{fmt::format("record {}: {}", path, std::strerror(errno))};
  file << "# rtm-sim record 1, world " << world << "\n# time model x y z qw qx qy qz\n";
  return Recorder(path, std::move(file));
}

void Recorder::record(std::chrono::nanoseconds time, const Physics& physics) {
  if (!file_ || !schedule_.is_due(time)) return;
  schedule_.done(time);
  const double seconds = static_cast<double>(time.count()) * 1e-9;
  for (ModelId id = 0; id < physics.model_slots(); ++id) {
    if (!physics.exists(id) || physics.is_static(id)) continue;
    const Eigen::Isometry3d pose = physics.model_pose(id);
    const Eigen::Vector3d p = pose.translation();
    const Eigen::Quaterniond q(pose.linear());
    file_ << fmt::format("{:.3f} {} {} {} {} {} {} {} {}\n", seconds, physics.def(id).name, p.x(), p.y(), p.z(), q.w(), q.x(), q.y(),
                         q.z());
  }
  if (!file_) base::log(base::Level::error, "sim-server", "record {}: {}; recording stops", path_, std::strerror(errno));
}

}  // namespace sim
