// The base of devices that follow commands as a whole, into which faults can be injected. See device.h for the thread rule.
#pragma once

namespace sim {

class Drive {
 public:
  virtual ~Drive() = default;
  // From the next step on: the fraction of what is asked for that it follows, and whether it goes on as it was told last, whatever it is
  // told.
  virtual void set_fault(double strength, bool is_halted) = 0;
};

}  // namespace sim
