// Orders calls to third-party components inside one phase, so that input sent in a tick is read in the next one. Any thread.
//
// What a component writes in a phase can be read in later phases only. Our components hide input until then (base/tick.h). A third-party
// component sees its input immediately, and a fetch from it returns immediately. So where two components of one phase are connected, the
// reader gets an earlier turn (shm/lockstep.h) if it is a third-party component, or if it fetches from one. The senders to one InPort of a
// third-party component have turns of their own, in the order of their names. All other components are called at the same time.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "system/profile/rts_profile.h"

namespace tools {

struct CallOrder {
  std::map<std::string, int> turns;  // by instance; 0 where nothing stands
  // Links that close a circle, "A.out to B.in": what goes there is read in the tick in which it is sent, as in any order one of the circle
  // comes before the others.
  std::vector<std::string> in_a_circle;

  int turn_of(const std::string& instance) const;
};

struct CalledComponent {
  bool is_foreign = false;
  std::optional<int> phase;  // nothing: its own choice, which is not known yet
};

CallOrder call_order(const SavedSystem& system, const std::function<CalledComponent(const std::string& instance)>& about);

}  // namespace tools
