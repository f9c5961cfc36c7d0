// Impacts that propagate through several bodies, as in Newton's cradle. ODE's solvers decide all contacts of a step at once: of five equal
// balls in a row four leave together. Here the impacts of one step happen one after the other, before the step, each between two bodies and
// those that joints hold to them. No impact adds energy. Friction acts in the step, after them.
//
// Private to physics/; the stepping thread of the shard.
#pragma once

#include <list>
#include <vector>

#include "physics/joined_bodies.h"

namespace sim {

class Impacts {
 public:
  // A contact that bounces. Either body may be null.
  void add(dBodyID a, dBodyID b, const dContact& contact);
  // Before the step, after all were added, which are gone then. Contacts that no impact reaches through a third body stay the solver's.
  void settle();

 private:
  struct Bouncing {
    dBodyID a = nullptr, b = nullptr;
    Eigen::Vector3d position, normal;  // the normal points to a
    double bounce = 0, threshold = 0;  // [m/s] the latter
    double give = 0;                   // [1/kg]
    struct Share {
      dBodyID body = nullptr;
      JoinedBodies::Vector6 velocity;  // by an impulse of 1 N s
    };
    std::vector<Share> shares{};
    bool is_between_bodies() const { return is_pushable(a) && is_pushable(b); }
    double approach() const;  // [m/s]
    bool is_hit() const { return approach() > threshold; }
    void bounce_off() const;
  };
  bool passes_on(const Bouncing& contact) const;
  bool find_shares(Bouncing& contact);  // false: joints that are not known
  void add_shares(Bouncing& contact, const JoinedBodies& joined) const;
  const JoinedBodies& joined_to(dBodyID body);

  std::vector<Bouncing> contacts_;
  std::list<JoinedBodies> joined_;
};

}  // namespace sim
