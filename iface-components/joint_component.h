// Common base of the components of joints: a part of the joints of one iface (parameter `joints`, names separated by commas; empty:
// all), services that are answered at once, also while simulated time stands still, and done in the next onExecute, and the step of all of
// it. When the component is deactivated or its process ends, its joints brake.
#pragma once

#include <base/guarded.h>
#include <shm/joint_part.h>

#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "iface_component.h"

namespace iface {

using shm::JointPart;

class JointComponent : public IfaceComponent {
 public:
  JointComponent(RTC::Manager* manager, const Specification& specification);
  RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id) override;

  // For services; any thread. In the order of the calls. Fails with a log line while the component is not active.
  bool post(const std::string& what, std::function<void()> work);
  // Of the iface as it was attached last; any thread.
  std::vector<shm::Joint> described() const;

 protected:
  // To be called in onInitialize.
  void bindJoints();
  void attached(const Device& device) override;
  void detaching() override;
  JointPart& part() { return part_; }
  const JointPart& part() const { return part_; }
  // A line for the log when something was rejected. What is rejected again and again has no second line, whatever its value, until it has
  // not been rejected for a second of simulated time.
  void note(const base::Result<void>& done);

  // The parameter `joints`, and what a component adds to it.
  virtual std::string all_names(const std::string& joints) const { return joints; }
  virtual void chosen() {}      // after part() has got its joints
  virtual void read_ports() {}  // commands of InPorts
  virtual void step() {}        // after all commands, before they are sent
  virtual void publish(const shm::Stamp& stamp) = 0;

 private:
  void choose(bool has_sample);  // whether the iface has been read

  struct Shared {
    bool is_active = false;
    std::vector<std::function<void()>> works;
    std::vector<shm::Joint> joints;
  };
  std::string names_, chosen_names_;
  JointPart part_;
  std::uint64_t chosen_attachment_ = 0;
  std::int64_t now_ns_ = 0;                                    // of the last sample
  std::map<std::string, std::int64_t, std::less<>> refusals_;  // when they came last
  base::Guarded<Shared, base::Rank::details> shared_;
};

}  // namespace iface
