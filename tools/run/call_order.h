// Who is called after whom within a phase of a run with components of others. Any thread.
//
// What a component writes in a phase can be read in later phases only. Our own put aside what comes meanwhile (base/tick.h); one of others
// holds what it gets at once, and answers at once who fetches from it. So where two of one phase are connected, the one that reads gets an
// earlier turn (shm/lockstep.h) when it is of others, or when it fetches from one of others; and those who send to one InPort of others
// have turns of their own, in the order of their names. All others are called at the same time.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "system/profile/rts_profile.h"

namespace editor {

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

}  // namespace editor
