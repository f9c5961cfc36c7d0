#include "joint_component.h"

#include <base/tick.h>

#include <chrono>
#include <utility>

namespace iface {

JointComponent::JointComponent(RTC::Manager* manager, const Specification& specification)
    : IfaceComponent(manager, specification, shm::IfaceType::joints, true) {}

void JointComponent::bindJoints() {
  bindDevice();
  bind("joints", names_);
}

void JointComponent::attached(const Device&) {
  refusals_.clear();
  choose(false);
  shared_.lock()->is_active = true;
}

void JointComponent::detaching() {
  auto shared = shared_.lock();
  shared->is_active = false;
  shared->works.clear();
}

void JointComponent::choose(bool has_sample) {
  chosen_attachment_ = link().attachments();
  chosen_names_ = all_names(names_);
  auto* iface = link().live();
  if (iface == nullptr) return;
  const auto done = part_.choose(*iface, chosen_names_);
  if (!done) part_.clear();
  note(done);
  // Services can command before the next sample comes. A simulator that waits for participants publishes the first one soon; whether it is
  // there already must not matter, so it is waited for and gives places alone, no time. In a tick none can come: the simulator waits for
  // it.
  constexpr auto first_limit = std::chrono::milliseconds(500);
  if (!has_sample && done && iface->sequence() == 0 && base::tick_in_lock_step() == nullptr) static_cast<void>(iface->wait(0, first_limit));
  if (done && (has_sample || iface->read()) && iface->sample<shm::Stamp>().valid != 0) part_.read(*iface);
  if (!has_sample) part_.start_anew();
  std::vector<shm::Joint> joints;
  for (std::size_t i = 0; i < part_.size(); ++i) joints.push_back(part_.joint(i));
  shared_.lock()->joints = std::move(joints);
  chosen();
}

void JointComponent::note(const base::Result<void>& done) {
  constexpr std::int64_t quiet_ns = 1'000'000'000;
  constexpr std::size_t most = 256;
  if (done) return;
  const std::string& message = done.error().message;
  const std::string about = message.substr(0, message.find(", got "));
  if (refusals_.size() >= most) refusals_.clear();
  const auto [found, is_new] = refusals_.try_emplace(about, now_ns_);
  const std::int64_t since = now_ns_ - std::exchange(found->second, now_ns_);
  if (is_new || since < 0 || since > quiet_ns) RTC_WARN(("%s", message.c_str()));
}

bool JointComponent::post(const std::string& what, std::function<void()> work) {
  constexpr std::size_t most = 1000;  // that wait while time stands still
  {
    auto shared = shared_.lock();
    if (shared->is_active && shared->works.size() < most) {
      shared->works.push_back(std::move(work));
      return true;
    }
  }
  RTC_WARN(("%s is ignored: the component is not active, or 1000 calls wait", what.c_str()));
  return false;
}

std::vector<shm::Joint> JointComponent::described() const { return shared_.lock()->joints; }

RTC::ReturnCode_t JointComponent::onExecute(RTC::UniqueId) {
  if (!follow_configuration()) return RTC::RTC_ERROR;
  auto* iface = link().fresh(wait_limit());
  if (iface == nullptr) return RTC::RTC_OK;
  if (chosen_attachment_ != link().attachments() || chosen_names_ != all_names(names_)) choose(true);
  part_.read(*iface);
  now_ns_ = iface->sample<shm::Stamp>().sim_time_ns;
  const auto works = std::exchange(shared_.lock()->works, {});
  for (const auto& work : works) work();
  read_ports();
  step();
  note(part_.send(*iface));
  if (const auto& stamp = iface->sample<shm::Stamp>(); stamp.valid != 0) publish(stamp);
  return RTC::RTC_OK;
}

}  // namespace iface
