#include "lock_step_participant.h"

#include <utility>

#include "base/log.h"

namespace ros2 {
namespace {
constexpr std::chrono::milliseconds participant_look_period{100};
}

bool LockStepParticipant::join() {
  if (participant_) return true;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_look_) return false;
  next_look_ = now + participant_look_period;
  auto joined = shm::Participant::join(server_id_, {.name = "ros2-gateway", .phase = 1, .period = period_});
  if (!joined) return false;
  participant_ = std::make_shared<shm::Participant>(std::move(*joined));
  *sleeper_.lock() = participant_;
  return true;
}

std::optional<shm::Tick> LockStepParticipant::sleep(std::chrono::nanoseconds time) {
  shm::Tick tick;
  switch (participant_->wait(tick, time)) {
    case shm::Participant::State::tick:
      return tick;
    case shm::Participant::State::timed_out:
      return std::nullopt;
    case shm::Participant::State::dropped:
      base::log(base::Level::warn, "ros2-gateway", "the simulator dropped the gateway from the lock step; it joins again");
      break;
    case shm::Participant::State::closed:
      break;
  }
  leave();
  return std::nullopt;
}

void LockStepParticipant::finish() {
  if (participant_) participant_->finish();
}

void LockStepParticipant::interrupt() {
  if (const auto sleeper = sleeper_.snapshot()) sleeper->interrupt();
}

void LockStepParticipant::leave() {
  sleeper_.lock()->reset();
  participant_.reset();
}

}  // namespace ros2
