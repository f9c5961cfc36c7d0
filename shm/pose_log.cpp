#include "shm/pose_log.h"

#include <cstring>
#include <utility>

namespace shm {
namespace {

enum Kind : std::uint32_t { is_model = 1, is_pose = 2, is_contact = 3, is_still = 4, is_joint = 5, is_joint_name = 6 };

struct Head {
  std::uint32_t size = 0;  // of what follows [bytes]
  std::uint32_t kind = 0, id = 0, other = 0;
  double time = 0;  // [s]
};
static_assert(sizeof(Head) == 24);
static_assert(sizeof(Pose) == 7 * sizeof(double));

constexpr std::uint32_t longest_entry = 4096;

void append(std::string& bytes, const Head& head, const void* data) {
  bytes.append(reinterpret_cast<const char*>(&head), sizeof head);
  bytes.append(static_cast<const char*>(data), head.size);
}

}  // namespace

void PoseLogWriter::name(std::uint32_t id, std::string_view name) {
  auto& known = names_[id];
  if (known == name) return;
  known = name.substr(0, longest_entry);
  append(bytes_, {static_cast<std::uint32_t>(known.size()), is_model, id, 0, 0}, known.data());
}

void PoseLogWriter::pose(double time, std::uint32_t id, std::string_view model, const Pose& pose) {
  name(id, model);
  append(bytes_, {sizeof pose, is_pose, id, 0, time}, &pose);
}

void PoseLogWriter::contact(double time, std::uint32_t id, std::string_view model, std::uint32_t other, std::string_view other_model) {
  name(id, model);
  name(other, other_model);
  append(bytes_, {0, is_contact, id, other, time}, "");
}

void PoseLogWriter::joint(double time, std::uint32_t id, std::string_view model, std::uint32_t joint, std::string_view joint_name,
                          double position) {
  name(id, model);
  auto& known = joint_names_[{id, joint}];
  if (known != joint_name) {
    known = joint_name.substr(0, longest_entry);
    append(bytes_, {static_cast<std::uint32_t>(known.size()), is_joint_name, id, joint, 0}, known.data());
  }
  append(bytes_, {sizeof position, is_joint, id, joint, time}, &position);
}

void PoseLogWriter::still(double time) { append(bytes_, {0, is_still, 0, 0, time}, ""); }

base::Result<std::string> PoseLogWriter::take(std::int64_t from) {
  if (from < begin_ || from > end())
    return base::Error{"the log holds bytes " + std::to_string(begin_) + " to " + std::to_string(end()) + ", asked for " +
                       std::to_string(from)};
  bytes_.erase(0, static_cast<std::size_t>(from - begin_));
  begin_ = from;
  return bytes_.substr(0, pose_log_piece);
}

struct PoseLogReader::Entry {
  const Head& head;
  std::string_view data;
};

// False: no entry of a pose log.
bool PoseLogReader::take(const Entry& entry, PoseLogSink& sink) {
  const auto& [head, data] = entry;
  if (head.kind == is_model) {
    names_[head.id] = data;
    return true;
  }
  if (head.kind == is_joint_name) {
    joint_names_[{head.id, head.other}] = data;
    return true;
  }
  if (head.kind == is_still) {
    sink.still(head.time);
    return true;
  }
  const auto model = names_.find(head.id), other = names_.find(head.other);
  const auto joint = joint_names_.find({head.id, head.other});
  if (model == names_.end()) return false;
  if (head.kind == is_pose && head.size == sizeof(Pose)) {
    Pose pose;
    std::memcpy(&pose, data.data(), sizeof pose);
    sink.pose(head.time, model->second, pose);
  } else if (head.kind == is_contact && other != names_.end()) {
    sink.contact(head.time, model->second, other->second);
  } else if (head.kind == is_joint && joint != joint_names_.end() && head.size == sizeof(double)) {
    double position = 0;
    std::memcpy(&position, data.data(), sizeof position);
    sink.joint(head.time, model->second, joint->second, position);
  } else {
    return false;
  }
  return true;
}

base::Result<void> PoseLogReader::read(std::string_view piece, PoseLogSink& sink) {
  rest_.append(piece);
  const base::Error wrong{"pose log: cannot be read"};
  std::string_view left = rest_;
  Head head;
  for (; left.size() >= sizeof head; left.remove_prefix(sizeof head + head.size)) {
    std::memcpy(&head, left.data(), sizeof head);
    if (head.size > longest_entry) return wrong;
    if (left.size() < sizeof head + head.size) break;
    if (!take({head, left.substr(sizeof head, head.size)}, sink)) return wrong;
  }
  rest_.erase(0, rest_.size() - left.size());
  return {};
}

}  // namespace shm
