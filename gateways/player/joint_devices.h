// actarray, gripper and ptz, and the base of limb (limb_device.h): joints of a joints iface. Each device commands through its own handle,
// so devices of one iface do not withdraw each other's commands. Joints brake when the client that commanded them last releases the device
// or disconnects. Player's commands have no reply, so a command that cannot be executed is logged, each line once. One thread at a time.
#pragma once

#include <array>
#include <deque>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "device.h"
#include "shm/joint_part.h"

namespace gateway {

class JointDevice : public Device {
 public:
  using Device::Device;
  static constexpr std::array shows{shm::IfaceType::joints};
  void choose(const JointGroup& group) override;

 protected:
  const JointGroup& group() const { return group_; }
  shm::JointPart& part() { return part_; }
  const shm::JointPart& part() const { return part_; }
  // Describes the joints as they are now.
  virtual void show(const shm::Stamp& stamp) = 0;
  virtual void do_command(std::uint8_t subtype, const std::string& payload) = 0;
  // The joints have been chosen, or chosen again.
  virtual void begin() {}
  // For each sample, after part() has read it.
  virtual void step() {}
  // Who commanded it is gone: the joints brake.
  virtual void let_go() {}
  void note(const base::Result<void>& done);
  // Of one, or with -1 of all. Fails for a joint that there is not.
  base::Result<void> for_joint(std::int32_t joint, const std::function<base::Result<void>(std::size_t)>& work);
  void brake();
  // Those that brake hold where they are, as soon as that is known.
  void release();
  void send();
  // Where a joint is, in the frame of the joint or model that carries it.
  const shm::Pose& place(std::size_t i) const { return part_.joint(i).pose; }

 private:
  void show_sample() final;
  void obey(Client& client, std::uint8_t subtype, const std::string& payload) final;
  void forget(Client& client) override;
  void on_attach() override;
  void on_unused() override;

  struct Waiting {
    Client* client;
    std::uint8_t subtype;
    std::string payload;
  };
  JointGroup group_;
  shm::JointPart part_;
  std::optional<shm::Iface> commands_;
  Client* commanding_client_ = nullptr;
  bool has_state_ = false;       // since somebody uses the device
  bool is_release_due_ = false;  // with the first sample
  std::deque<Waiting> waiting_;  // commands that came before the first sample
  std::int64_t shown_ns_ = -1;
  std::set<std::string> logged_;
};

class ActArray final : public JointDevice {
 public:
  using JointDevice::JointDevice;
  static constexpr std::array table = std::to_array<Served>({
      {player::Type::data, 1, "position, speed, acceleration, effort in place of current, state"},
      {player::Type::request, 1, "power"},
      {player::Type::request, 2, "brakes"},
      {player::Type::request, 3, "geometry"},
      {player::Type::request, 4, "speed and acceleration of the next positions"},
      {player::Type::request, 5, ""},
      {player::Type::command, 1, "position, speed or effort of one joint or of all"},
      {player::Type::command, 2, ""},
      {player::Type::command, 3, ""},
      {player::Type::command, 4, ""},
      {player::Type::command, 6, ""},
      {player::Type::command, 7, ""},
      {player::Type::command, 5, "home"},
  });

 private:
  ServedTable served() const override { return table; }
  void show(const shm::Stamp& stamp) override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
  void do_command(std::uint8_t subtype, const std::string& payload) override;
  void begin() override;
  std::string geometry() const;
  base::Result<void> command_one(std::uint8_t subtype, std::size_t joint, double value);
  base::Result<void> may_move() const;

  bool is_powered_ = true, has_brakes_on_ = false;
  std::vector<double> speeds_, last_speeds_;  // highest, for the geometry; of the last sample
  std::int64_t last_ns_ = 0;
};

// The upper limits of its joints are open, the lower ones closed.
class Gripper final : public JointDevice {
 public:
  using JointDevice::JointDevice;
  static constexpr std::array table = std::to_array<Served>({
      {player::Type::data, 1, "open, closed (also when it holds something), moving"},
      {player::Type::request, 1, "geometry"},
      {player::Type::command, 1, "open, close, stop"},
      {player::Type::command, 2, ""},
      {player::Type::command, 3, ""},
  });

 private:
  ServedTable served() const override { return table; }
  void show(const shm::Stamp& stamp) override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
  void do_command(std::uint8_t subtype, const std::string& payload) override;
  std::uint8_t state() const;
};

// A pan and a tilt joint. Position control until a client asks for velocity control. Only data of subtype 1 may be sent: clients take any.
class Ptz final : public JointDevice {
 public:
  using JointDevice::JointDevice;
  static constexpr std::array table = std::to_array<Served>({
      {player::Type::data, 1, "pan, tilt and their speeds; zoom is the field of view"},
      {player::Type::request, 2, "position and velocity control"},
      {player::Type::request, 4, "geometry"},
      {player::Type::request, 5, "status"},
      {player::Type::command, 1, "pan and tilt, or their speeds"},
  });

 private:
  ServedTable served() const override { return table; }
  void show(const shm::Stamp& stamp) override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
  void do_command(std::uint8_t subtype, const std::string& payload) override;
  void begin() override { has_velocities_ = false; }

  bool has_velocities_ = false;
};

}  // namespace gateway
