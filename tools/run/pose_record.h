// Poses and contacts of the models during a run, and positions of joints. Values; any thread.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

namespace tools {

struct RecordedPose {
  double time, x, y, z;                   // [s, m]
  double qw = 1, qx = 0, qy = 0, qz = 0;  // unit quaternion, world frame
};
struct RecordedContact {
  double time;
  std::string model, other;
};
struct RecordedJoint {
  double time, position;  // [s], [rad or m]
};

class PoseRecord {
 public:
  std::map<std::string, std::vector<RecordedPose>> poses;    // by model
  std::map<std::string, std::vector<RecordedJoint>> joints;  // by MODEL::JOINT; only those wanted
  std::set<std::string> wanted_joints;                       // MODEL::JOINT; set before the first step
  std::vector<RecordedContact> contacts;
  double last = 0;  // [s], of the last pose, or of the last moment in which nothing moved

  // Nothing after this time [s] is recorded. A reset of the world, which sets the time back, ends the record.
  void set_end(double end) { end_ = end; }

  void add_pose(const std::string& model, const RecordedPose& pose);
  void add_joint(const std::string& name, const RecordedJoint& joint);
  void add_contact(const RecordedContact& contact);
  // A moment in which nothing moved.
  void add_still(double time);

 private:
  bool take(double time);
  double end_ = 1e12;
  bool is_over_ = false;
};

// [m]
double path_length(const std::vector<RecordedPose>& poses);

}  // namespace tools
