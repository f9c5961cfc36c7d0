// The names of all signals, as recordings name them: "/sim/laser/robot/laser" for the iface robot::laser, "/Component0/out" for an OutPort;
// the whole path if two components have one name. One thread at a time.
#pragma once

#include <map>
#include <string>

#include "studio/client_message.h"

namespace studio {

class SignalBook {
 public:
  // The events "world" and "system". True when the list has changed.
  bool take_world(const Json& world);
  bool take_system(const Json& system);

  // The event "signals".
  Json event() const;
  // What Signals calls it: "TYPE:IFACE" or "PATH:PORT"; what is not in the book may be such a name itself.
  std::string source_of(const std::string& topic) const;

 private:
  struct Signal {
    Json shown;
    std::string source;
    bool operator==(const Signal&) const = default;
  };
  using Signals = std::map<std::string, Signal>;  // by topic
  Signals ifaces_, ports_;
};

}  // namespace studio
