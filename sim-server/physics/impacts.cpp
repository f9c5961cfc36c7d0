#include "physics/impacts.h"

#include <algorithm>

namespace sim {
namespace {

constexpr std::size_t largest_heap = 200;  // of a heap the solver knows better

Eigen::Vector3d speed_at(dBodyID body, const Eigen::Vector3d& place) {
  if (body == nullptr) return Eigen::Vector3d::Zero();
  return ode::vector(dBodyGetLinearVel(body)) + ode::vector(dBodyGetAngularVel(body)).cross(place - ode::vector(dBodyGetPosition(body)));
}

}  // namespace

void Impacts::add(dBodyID a, dBodyID b, const dContact& contact) {
  contacts_.push_back(
      {a, b, ode::vector(contact.geom.pos), ode::vector(contact.geom.normal), contact.surface.bounce, contact.surface.bounce_vel});
}

double Impacts::Bouncing::approach() const { return normal.dot(speed_at(b, position) - speed_at(a, position)); }

void Impacts::Bouncing::bounce_off() const {
  const double impulse = (1 + bounce) * approach() / give;
  for (const auto& [body, velocity] : shares) {
    const Eigen::Vector3d v = ode::vector(dBodyGetLinearVel(body)) + impulse * velocity.head<3>();
    const Eigen::Vector3d w = ode::vector(dBodyGetAngularVel(body)) + impulse * velocity.tail<3>();
    dBodySetLinearVel(body, v.x(), v.y(), v.z());
    dBodySetAngularVel(body, w.x(), w.y(), w.z());
  }
}

// One of its bodies bounces off a third one.
bool Impacts::passes_on(const Bouncing& contact) const {
  if (!contact.is_between_bodies()) return false;
  return std::any_of(contacts_.begin(), contacts_.end(), [&](const Bouncing& other) {
    if (!other.is_between_bodies()) return false;
    const bool has_a = other.a == contact.a || other.b == contact.a, has_b = other.a == contact.b || other.b == contact.b;
    return has_a != has_b;
  });
}

const JoinedBodies& Impacts::joined_to(dBodyID body) {
  for (const JoinedBodies& joined : joined_) {
    if (joined.place_of(body) >= 0) return joined;
  }
  return joined_.emplace_back(body);
}

void Impacts::add_shares(Bouncing& contact, const JoinedBodies& joined) const {
  Eigen::VectorXd impulse = Eigen::VectorXd::Zero(6 * static_cast<Eigen::Index>(joined.bodies().size()));
  for (const bool is_a : {true, false}) {
    const int place = joined.place_of(is_a ? contact.a : contact.b);
    if (place < 0) continue;
    const Eigen::Vector3d line = is_a ? contact.normal : -contact.normal;
    impulse.segment<3>(6 * place) = line;
    impulse.segment<3>(6 * place + 3) = (contact.position - ode::vector(dBodyGetPosition(is_a ? contact.a : contact.b))).cross(line);
  }
  const Eigen::VectorXd answer = joined.response(impulse);
  contact.give += impulse.dot(answer);
  for (std::size_t i = 0; i < joined.bodies().size(); ++i)
    contact.shares.push_back({joined.bodies()[i], answer.segment<6>(6 * static_cast<Eigen::Index>(i))});
}

bool Impacts::find_shares(Bouncing& contact) {
  const JoinedBodies &with_a = joined_to(contact.a), &with_b = joined_to(contact.b);
  if (!with_a.are_known() || !with_b.are_known()) return false;
  add_shares(contact, with_a);
  if (&with_b != &with_a) add_shares(contact, with_b);
  return contact.give > 0;
}

void Impacts::settle() {
  const bool goes_on = contacts_.size() >= 2 && contacts_.size() <= largest_heap &&
                       std::any_of(contacts_.begin(), contacts_.end(), [&](const auto& c) { return c.is_hit() && passes_on(c); });
  if (goes_on) {
    std::erase_if(contacts_, [&](Bouncing& contact) { return !contact.is_between_bodies() || !find_shares(contact); });
    bool has_hit = true;
    for (std::size_t round = 0; has_hit && round < 2 * contacts_.size(); ++round) {
      has_hit = false;
      for (const Bouncing& contact : contacts_) {
        if (!contact.is_hit()) continue;
        contact.bounce_off();
        has_hit = true;
      }
    }
  }
  contacts_.clear();
  joined_.clear();
}

}  // namespace sim
