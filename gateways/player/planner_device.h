// planner: drives a robot to poses in the world, around static obstacles. One thread at a time.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drive_devices.h"
#include "shm/map_path.h"
#include "shm/pose_control.h"

namespace gateway {

// The iface is the drive, the companion the true pose of the robot, which is what it goes by. A goal makes the map, in the thread of the
// long async_requests, and a way over it (shm/map_path.h); then each sample of the drive gives the next velocity (shm/pose_control.h). What
// moves is not on the map. A way ends like the ways of a Position2d: with any other command, when the client that gave the goal lets go,
// and when the world is reset. Cars, which can't turn on the spot, have no way.
class Planner final : public Drive {
 public:
  Planner(const player::Address& address, std::uint32_t robot, Services services) : Drive(address, robot, services) {}
  static constexpr std::array shows{shm::IfaceType::position2d};
  static constexpr std::array table = std::to_array<Served>({
      {player::Type::data, 1, "whether there is a way, and whether it is done; pose, goal and next way point in the world"},
      {player::Type::request, 1, "way points"},
      {player::Type::request, 2, "start and stop"},
      {player::Type::command, 1, "goal in the world"},
  });

 private:
  struct Wish {
    shm::PlanarPose goal;
    std::uint64_t number = 0;  // of the goals, so that a way to an earlier one is known
    bool is_asked = false;     // a way
  };

  ServedTable served() const override { return table; }
  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
  void obey(Client& client, std::uint8_t subtype, const std::string& payload) override;
  void forget(Client& client) override;
  void on_attach() override { end(); }

  // Of the robot in the world; nothing before the first sample.
  std::optional<shm::PlanarPose> pose() const;
  void plan();
  void take(std::uint64_t number, const base::Result<std::vector<shm::MapPlace>>& way);
  void go_on(const shm::Position2dSample& sample, const shm::PlanarPose& now);
  shm::PlanarPose waypoint(std::size_t index) const;
  void stop();
  // There is no goal any more.
  void end();
  double radius() const;

  Client* pursuer_ = nullptr;  // who gave the goal
  std::optional<Wish> wish_;
  std::uint64_t goals_ = 0;
  bool is_enabled_ = true, is_done_ = false, is_driving_ = false;
  std::vector<shm::MapPlace> way_;
  std::size_t next_ = 0;
  std::optional<shm::PoseControl> leg_;
  std::optional<std::uint32_t> resets_;
  std::shared_ptr<Planner*> self_ = std::make_shared<Planner*>(this);  // for ways that come after the device has gone
};

}  // namespace gateway
