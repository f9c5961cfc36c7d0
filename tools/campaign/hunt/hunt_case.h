// One case of a hunt: a row of the plan with faults and events; how cases are created, changed and written. Values; one thread at a
// time.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "base/random.h"
#include "campaign/run/action_runner.h"
#include "campaign/run/campaign.h"

namespace campaign {

struct HuntCase {
  Row row;
  std::vector<Event> events;  // each at a time
  std::vector<Fault> faults;
  double duration_s = 0;

  // An activation that follows a deactivation of its component is one action with it.
  std::size_t actions() const;
};

class CaseMaker {
 public:
  // Of the plan's events and these faults, see hunt_targets(). The campaign must live as long.
  CaseMaker(const Campaign& campaign, const std::vector<HuntTarget>& targets);

  HuntCase fresh(base::Random& random);
  // A case that differs a little.
  HuntCase changed(const HuntCase& from, base::Random& random);
  bool has_actions() const { return !choices_.empty(); }

 private:
  // One thing that can be done.
  struct Choice {
    const Event* event = nullptr;  // of the plan; null: a fault
    const Event* again = nullptr;  // of a deactivation: the activation of the same component, which follows it
    Fault::Object object = Fault::Object::component;
    Fault::Kind kind = Fault::Kind::error;
    std::string target;
  };
  // All are tried in a random order before one is tried again: what is rare among many must not be a matter of luck.
  const Choice& draw(base::Random& random);
  void add_action(HuntCase& to, base::Random& random);
  void add_consequence(HuntCase& to, base::Random& random) const;
  void add_event(HuntCase& to, const Event& wanted, double from_s, base::Random& random) const;
  void add_restarts(HuntCase& to, const Choice& choice, base::Random& random) const;
  double time(base::Random& random, double duration_s) const;
  const Campaign& campaign_;
  std::vector<Choice> choices_;
  std::vector<std::size_t> deck_;  // of choices_, those that are not drawn yet
};

// All of a case, with what the plan always does.
Actions actions_of(const Campaign& campaign, const HuntCase& tried);
// A plan whose only row is the case.
std::string plan_text(const Campaign& campaign, const HuntCase& tried);
// The faults and events in one line.
std::string text_of(const HuntCase& tried);

}  // namespace campaign
