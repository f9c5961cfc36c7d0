// graphics2d and graphics3d: drawings of clients, as a model without collision shapes, so that only images and the studio show it. One
// thread at a time.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "device.h"

namespace gateway {

// Lengths m, in the frame of the robot at the time when it is drawn (of `world`: of the world). Each change draws all again: the new model
// is added before the old one is deleted. At most 1000 parts (points, lines and faces); more are ignored, with a line in the log. All is
// deleted when the last client lets go.
class Graphics : public Device {
 public:
  Graphics(const player::Address& address, std::uint32_t robot, Services services) : Device(address, robot, services) {}
  static constexpr std::array shows{shm::IfaceType::simulation, shm::IfaceType::position2d, shm::IfaceType::position3d};

 protected:
  bool has_data() const override { return false; }
  std::optional<Answer> answer(std::uint8_t, const std::string&, const Later&) override { return nack(); }
  void on_attach() override;
  void on_unused() override;

  using Points = std::vector<Eigen::Vector3d>;
  void add_points(const Points& points, const player::Color& color);
  void add_lines(const Points& points, bool is_closed, const player::Color& color);
  // Convex and flat; any other is drawn as if it were.
  void add_face(const Points& points, const player::Color& color);
  void clear();
  // After the last change by a command.
  void draw();

 private:
  bool has_room();
  void add(const Eigen::Isometry3d& pose, const std::string& geometry, const player::Color& color);
  void spawn(const std::optional<shm::Pose>& pose);
  void erase(const std::string& model);
  void end_drawing();
  template <class Act>
  auto later(Act act);  // with the reply, if the device is still there

  std::vector<std::string> parts_;  // SDF
  bool is_drawing_ = false, is_changed_ = false, has_complained_ = false;
  std::string drawn_;  // name of the model; empty: none
  int number_ = 0;     // of drawings
  std::shared_ptr<Graphics*> self_ = std::make_shared<Graphics*>(this);
};

class Graphics2d final : public Graphics {
 public:
  using Graphics::Graphics;
  static constexpr std::array table = std::to_array<Served>({
      {player::Type::command, 1, "clear"},
      {player::Type::command, 2, "points"},
      {player::Type::command, 3, "polyline"},
      {player::Type::command, 4, "polygon"},
      {player::Type::command, 5, "lines"},
  });

 private:
  ServedTable served() const override { return table; }
  void obey(Client& client, std::uint8_t subtype, const std::string& payload) override;
};

class Graphics3d final : public Graphics {
 public:
  using Graphics::Graphics;
  static constexpr std::array table = std::to_array<Served>({
      {player::Type::command, 1, "clear"},
      {player::Type::command, 2, "points, lines, triangles, quads, polygon"},
      {player::Type::command, 3, "translate"},
      {player::Type::command, 4, "rotate"},
      {player::Type::command, 5, "push"},
      {player::Type::command, 6, "pop"},
  });

 private:
  ServedTable served() const override { return table; }
  void obey(Client& client, std::uint8_t subtype, const std::string& payload) override;
  void draw(const player::Drawing& drawing);

  Eigen::Isometry3d frame_ = Eigen::Isometry3d::Identity();
  std::vector<Eigen::Isometry3d> frames_;
};

}  // namespace gateway
