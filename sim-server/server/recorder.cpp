#include "server/recorder.h"

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

void Recorder::contact(double time, ModelId model, ModelId other, const Physics& physics) {
  if (file_) file_ << fmt::format("contact {:.3f} {} {}\n", time, as_word(physics.def(model).name), as_word(physics.def(other).name));
}

void Recorder::pose(double time, ModelId model, const Physics& physics) {
  if (!file_) return;
  const Eigen::Isometry3d pose = physics.model_pose(model);
  const Eigen::Vector3d p = pose.translation();
  const Eigen::Quaterniond q(pose.linear());
  file_ << fmt::format("{:.3f} {} {} {} {} {} {} {} {}\n", time, as_word(physics.def(model).name), p.x(), p.y(), p.z(), q.w(), q.x(), q.y(),
                       q.z());
}

void Recorder::still(double time) {
  if (file_) file_ << fmt::format("# {:.3f} nothing moves\n", time);
}

void Recorder::end_of_moment() {
  if (!file_) return;
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
