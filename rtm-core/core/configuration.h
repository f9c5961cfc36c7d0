// The configuration sets of a component: named lists of parameters, one of them active, and the variables bound to the active one. Any
// thread; variables are assigned without a lock on the thread that calls bind() or update().
//
// In lock step a change that comes from outside while time passes takes effect at the next edge between two ticks, the same for every
// component: a tick at time t, in any phase, uses what came before t. A change by a thread that itself runs a tick, and one while time
// stands still, take effect at once.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/guarded.h"

namespace rt {

class Configuration {
 public:
  // In the order in which they were set.
  using Values = std::vector<std::pair<std::string, std::string>>;
  struct Set {
    std::string id;
    Values values;
  };
  // False when the text cannot be converted; the variable stays as it was.
  using Assign = std::function<bool(const char* text)>;
  // What update() has written.
  struct Update {
    std::string set;
    std::vector<std::string> parameters;
    std::vector<std::string> refused;  // a line for each value that could not be converted; its parameter has the default instead
  };

  // There is always a set "default", and it is the first active one.
  Configuration();

  // The variable takes the active set's value at once, the default when there is none or it cannot be converted. False when the name is
  // taken.
  bool bind(const std::string& name, const std::string& default_value, Assign assign);
  bool unbind(std::string_view name);
  bool is_bound(std::string_view name) const;
  std::vector<std::string> bound_names() const;

  // If something has changed since the last time and a set is active, assigns the parameters whose text has changed. Variables that the set
  // does not name keep their values. In a tick in lock step: what came before it.
  std::optional<Update> update();
  // Assigns all parameters of that set, or the named one, whatever is active. Nothing when there is no such set or parameter.
  std::optional<Update> update_from(const std::string& set, const std::optional<std::string>& parameter = std::nullopt);

  std::string active_id() const;
  // False from a change of any set until activate().
  bool is_active() const;
  bool has_changed() const;
  bool has(std::string_view id) const;
  std::vector<Set> sets() const;
  std::optional<Set> set(std::string_view id) const;

  // Merges, or makes the set; changes neither which set is active nor whether.
  void load(const Set& set);
  // Merges, or makes the set. False when it would be one of too many, or all of them too long (core/key_limits.h).
  bool set_values(const Set& set);
  // False when there is one of that id, the id is empty, or there is no room, as above.
  bool add(const Set& set);
  // Only sets that add() made and that are not active.
  bool remove(std::string_view id);
  // False for unknown sets and those whose id starts with an underscore: they describe the others.
  bool activate(std::string_view id);

 private:
  struct Parameter {
    std::string name;
    std::string default_value;
    std::shared_ptr<const Assign> assign;
    std::optional<std::string> assigned{};  // the text that the variable was assigned last
  };
  struct State {
    std::vector<Set> sets{};
    std::vector<std::string> added{};
    std::string active = "default";
    bool is_active = true;
    bool changed = true;
  };
  // Simulated time: of a tick, or at which something came from outside.
  struct EpochTime {
    std::uint64_t epoch = 0;
    std::chrono::nanoseconds time{0};
    bool operator==(const EpochTime&) const = default;
  };
  struct Data {
    State state{};
    std::vector<Parameter> parameters{};
    // What came last from outside, and everything as it was before that: for ticks at the same time.
    std::optional<EpochTime> arrival{};
    std::optional<State> before{};
  };
  struct Assignment {
    std::string name;
    std::shared_ptr<const Assign> assign;
    std::string value;
    std::string default_value;
  };

  static bool has_room(const State& state, const Set& further);
  static Set* find(State& state, std::string_view id);
  static const Set* find(const State& state, std::string_view id);
  // Those of this thread; to be asked without the lock.
  static std::optional<EpochTime> arrival_now();
  static std::optional<EpochTime> tick_now();
  static State& state_at(const std::optional<EpochTime>& tick, Data& data);
  // Calls bool change(State&).
  template <class Change>
  bool change(Change change);
  static void merge(Set& to, const Set& from);
  static std::vector<Assignment> assignments(Data& data, const Set& set, const std::optional<std::string>& only, bool changed_only);
  static std::optional<Update> run(const std::string& set, const std::vector<Assignment>& assignments);

  base::Guarded<Data, base::Rank::component> shared_;
};

}  // namespace rt
