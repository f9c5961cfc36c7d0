// The pose log of a simulation: ten times a simulated second the pose of each moving model, and, in the step in which it happens, that two
// models begin to touch. The simulator keeps it from the first RTMSIM_REQUEST_POSE_LOG on; a client reads it piece by piece, and the
// simulator deletes what the client has read. `PoseLogWriter` and `PoseLogReader` are the two sides of its bytes. Values; one thread at a
// time each.
//
// The log is a sequence of entries: a head, then as many bytes as it says.
//
//   model    the model of number `id` is called ... (the bytes); sent before its first pose or contact, and again when a number is reused
//   pose     of `id` at `time`: seven doubles, x y z [m], qw qx qy qz
//   contact  `id` and `other` begin to touch at `time`
//   still    no model moves at `time`
//   joint    the position [rad or m] of joint `other` of the model `id` at `time`, a double, after the pose of the model; only of joints
//            that a request has named
//   name     the joint of number `other` of the model `id` is called ...; sent before its first position, as with models
//
// Times are those that `sim-server --record` writes: seconds, rounded to milliseconds.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "base/result.h"
#include "shm/layout.h"

namespace shm {

inline constexpr std::size_t pose_log_piece = std::size_t{8} << 20;  // of a reply [bytes]

class PoseLogWriter {
 public:
  void pose(double time, std::uint32_t id, std::string_view name, const Pose& pose);
  void contact(double time, std::uint32_t id, std::string_view name, std::uint32_t other, std::string_view other_name);
  void still(double time);
  void joint(double time, std::uint32_t id, std::string_view name, std::uint32_t joint, std::string_view joint_name, double position);
  // Of everything that was ever written [bytes].
  std::int64_t end() const { return begin_ + static_cast<std::int64_t>(bytes_.size()); }
  // The bytes from there on, at most pose_log_piece; those before are forgotten. An Error when they are already, or are still to come.
  base::Result<std::string> take(std::int64_t from);

 private:
  void name(std::uint32_t id, std::string_view name);
  std::string bytes_;
  std::int64_t begin_ = 0;  // of bytes_
  std::map<std::uint32_t, std::string> names_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::string> joint_names_;  // by model and joint
};

class PoseLogSink {
 public:
  virtual ~PoseLogSink() = default;
  virtual void pose(double time, const std::string& model, const Pose& pose) = 0;
  virtual void contact(double time, const std::string& model, const std::string& other) = 0;
  virtual void still(double time) = 0;
  virtual void joint(double /*time*/, const std::string& /*model*/, const std::string& /*joint*/, double /*position*/) {}
};

class PoseLogReader {
 public:
  // Pieces may end anywhere. An Error: these are no bytes of a pose log.
  base::Result<void> read(std::string_view piece, PoseLogSink& sink);

 private:
  struct Entry;
  bool take(const Entry& entry, PoseLogSink& sink);
  std::string rest_;
  std::map<std::uint32_t, std::string> names_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::string> joint_names_;
};

}  // namespace shm
