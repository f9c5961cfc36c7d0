// The actions that a viewer can request by name: one row each. A row reads the arguments and makes a plan, which has the equivalent command
// line and executes the action. Plans run on workers, several at a time; each uses only objects that it creates.
#pragma once

#include <omniORB4/CORBA.h>

#include <array>
#include <chrono>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "shm/layout.h"
#include "studio/client_message.h"

namespace studio {

// Values that hold as long as the program runs.
struct ActContext {
  CORBA::ORB_ptr orb = CORBA::ORB::_nil();
  std::string name_server{};
  std::uint32_t server_id = 0;
  std::chrono::milliseconds call_limit{1000};
};

struct Plan {
  std::string command;                      // empty: nothing can be typed for it
  std::function<base::Result<Json>()> run;  // the result of the reply
  enum class Touches { nothing, system, world } touches = Touches::nothing;
};

struct Act {
  std::string_view name;
  bool is_reading;  // also in a studio that only shows
  base::Result<Plan> (*plan)(const ActContext& context, const Json& args);
};

// nullptr: there is none of this name.
const Act* find_act(std::string_view name);

// The component or model that an act changes. What is done to the same one is done in the order in which it was asked for: values are read,
// changed and written back. Empty: none.
std::string subject_of(const Act& act, const Json& args);

// What a studio that only shows answers to acts.
base::Error read_only();

// The first words of a line for this simulator.
std::vector<std::string> simctl_words(std::uint32_t server_id);

// Roll, pitch and yaw [rad], as simctl takes them.
std::array<double, 3> angles_of(const shm::Pose& pose);

// The rows, by what they are about.
std::vector<Act> system_acts();
std::vector<Act> manager_acts();
std::vector<Act> world_acts();
std::vector<Act> look_acts();

}  // namespace studio
