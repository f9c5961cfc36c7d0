#include "limb_device.h"

#include <algorithm>
#include <array>
#include <utility>

#include "protocol/payloads.h"

namespace gateway {
namespace {

constexpr double usual_speed = 0.25;  // [m/s]

player::Point3d to_point(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }
Eigen::Vector3d to_vector(const player::Point3d& point) { return {point.x, point.y, point.z}; }

}  // namespace

void LimbDevice::begin() {
  if (part().size() > 0 && !limb_.begin(part(), 0, usual_speed))
    note(base::Error{"the joints are no chain from base to tip; commands are ignored"});
}

void LimbDevice::show(const shm::Stamp& stamp) {
  if (!limb_.is_there()) return;
  using Status = arms::Limb::Status;
  constexpr std::array<std::pair<Status, std::uint8_t>, 5> states{
      {{Status::idle, 1}, {Status::braked, 2}, {Status::moving, 3}, {Status::out_of_reach, 4}, {Status::collision, 5}}};
  const auto found = std::ranges::find(states, limb_.status(), &std::pair<Status, std::uint8_t>::first);
  const Eigen::Isometry3d tip = limb_.pose();
  publish(1,
          player::encode(player::LimbState{{to_point(tip.translation()), to_point(tip.linear().col(2)), to_point(tip.linear().col(1))},
                                           found->second}),
          stamp);
}

std::optional<Answer> LimbDevice::answer(std::uint8_t subtype, const std::string& payload, const Later&) {
  constexpr std::uint8_t power = 1, brakes = 2, get_geometry = 3;
  if (part().size() == 0) return nack();
  if (subtype == get_geometry) return ack(player::encode(player::Point3d{place(0).x, place(0).y, place(0).z}));
  if (subtype == power || subtype == brakes) {
    const auto is_on = player::decode_byte(payload);
    if (!is_on || !limb_.is_there()) return nack();
    limb_.measure(part());
    subtype == power ? limb_.set_power(*is_on != 0) : limb_.set_brakes(*is_on != 0);
    note(arms::command(limb_.advance(0), part()));
    send();
    return ack();
  }
  const auto speed = player::decode_float(payload);
  const arms::Reply done = speed ? limb_.set_speed(*speed) : arms::wrong_value("a speed is one number");
  if (!done.is_ok()) note(base::Error{done.comment});
  return done.is_ok() ? ack() : nack();
}

arms::Reply LimbDevice::command(std::uint8_t subtype, const std::string& payload) {
  constexpr std::uint8_t home = 1, stop = 2, pose = 3, position = 4;
  if (subtype == home) return limb_.go_home();
  if (subtype == stop) return limb_.stop(), arms::Reply{};
  if (subtype == pose) {
    const auto goal = player::decode_limb_pose(payload);
    if (!goal) return {};
    Eigen::Isometry3d wanted = Eigen::Isometry3d::Identity();
    wanted.translation() = to_vector(goal->position);
    const Eigen::Vector3d approach = to_vector(goal->approach), orientation = to_vector(goal->orientation);
    wanted.linear() << orientation.cross(approach), orientation, approach;
    return limb_.go(wanted);
  }
  if (subtype == position) {
    const auto goal = player::decode_point(payload);
    return goal ? limb_.go_to_place(to_vector(*goal)) : arms::Reply{};
  }
  const auto way = player::decode_vector_move(payload);
  return way ? limb_.go_along(to_vector(way->direction), way->length) : arms::Reply{};
}

void LimbDevice::do_command(std::uint8_t subtype, const std::string& payload) {
  limb_.measure(part());
  const arms::Reply done = command(subtype, payload);
  if (!done.is_ok()) note(base::Error{done.comment + "; the command is ignored"});
}

}  // namespace gateway
