#include "server/recorder.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <iomanip>
#include <sstream>

#include "base/log.h"

namespace sim {
namespace {

// Names with blanks, quotes or backslashes stand in double quotes, with a backslash before quotes and backslashes.
std::string as_word(const std::string& name) {
  if (!name.empty() && name.find_first_of(" \t\r\n\"\\") == std::string::npos) return name;
  std::ostringstream quoted;
  quoted << std::quoted(name);
  return quoted.str();
}

}  // namespace

base::Result<Recorder> Recorder::open(const std::string& path, const std::string& world) {
  std::ofstream file(path);
  if (!file) return base::Error{fmt::format("record {}: {}", path, std::strerror(errno))};
  file << "# rtm-sim record 1, world " << world << "\n# time model x y z qw qx qy qz\n";
  return Recorder(path, std::move(file));
}

void Recorder::record_contacts(double seconds, const Physics& physics) {
  std::set<std::pair<ModelId, ModelId>> now;
  for (ModelId id = 0; id < physics.model_slots(); ++id) {
    if (!physics.exists(id) || physics.is_static(id)) continue;
    for (const Contact& contact : physics.contacts(id)) {
      const ModelId other = contact.link.model == id ? contact.other.model : contact.link.model;
      if (other == id || !physics.exists(other)) continue;
      const auto pair = std::minmax(id, other);
      if (!now.insert(pair).second || touching_.contains(pair)) continue;
      file_ << fmt::format("contact {:.3f} {} {}\n", seconds, as_word(physics.def(id).name), as_word(physics.def(other).name));
    }
  }
  touching_ = std::move(now);
}

void Recorder::record(std::chrono::nanoseconds time, const Physics& physics) {
  if (!file_) return;
  const double seconds = static_cast<double>(time.count()) * 1e-9;
  record_contacts(seconds, physics);
  if (!schedule_.is_due(time)) return;
  schedule_.done(time);
  bool is_empty = true;
  for (ModelId id = 0; id < physics.model_slots(); ++id) {
    if (!physics.exists(id) || physics.is_static(id)) continue;
    is_empty = false;
    const Eigen::Isometry3d pose = physics.model_pose(id);
    const Eigen::Vector3d p = pose.translation();
    const Eigen::Quaterniond q(pose.linear());
    file_ << fmt::format("{:.3f} {} {} {} {} {} {} {} {}\n", seconds, as_word(physics.def(id).name), p.x(), p.y(), p.z(), q.w(), q.x(),
                         q.y(), q.z());
  }
  if (is_empty) file_ << fmt::format("# {:.3f} nothing moves\n", seconds);
  file_.flush();  // who reads along, or after a kill, finds whole lines
  if (!file_) base::log(base::Level::error, "sim-server", "record {}: {}; recording stops", path_, std::strerror(errno));
}

bool Recorder::finish() {
  const bool was_good = static_cast<bool>(file_);
  file_.close();
  if (was_good && !file_) base::log(base::Level::error, "sim-server", "record {}: {}; its end is missing", path_, std::strerror(errno));
  return static_cast<bool>(file_);
}

}  // namespace sim
