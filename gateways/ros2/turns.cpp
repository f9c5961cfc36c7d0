#include "turns.h"

#include <utility>

#include "base/log.h"

namespace ros2 {
namespace {
constexpr std::chrono::milliseconds wait_slice{100};
}

Turns::Turns(std::uint32_t server_id, std::chrono::nanoseconds period, std::function<void()> on_tick)
    : server_id_(server_id), period_(period), on_tick_(std::move(on_tick)), thread_([this](const std::stop_token& stop) { run(stop); }) {}

Turns::~Turns() {
  thread_.request_stop();
  thread_.join();
}

std::optional<shm::Tick> Turns::tick() { return state_.lock()->tick; }

void Turns::finish() {
  state_.lock()->tick.reset();
  changed_.notify_all();
}

void Turns::hand_over(const shm::Tick& tick, const std::stop_token& stop) {
  state_.lock()->tick = tick;
  on_tick_();
  auto state = state_.lock();
  state.wait(changed_, stop, [&] { return !state->tick; });
}

void Turns::run(const std::stop_token& stop) {
  std::optional<shm::Participant> participant;
  while (!stop.stop_requested()) {
    if (!participant) {
      auto joined = shm::Participant::join(server_id_, {.name = "ros2-gateway", .phase = 1, .period = period_});
      if (!joined) {
        // Nobody says when a simulator starts.
        std::this_thread::sleep_for(wait_slice);
        continue;
      }
      participant.emplace(std::move(*joined));
    }
    shm::Tick tick;
    switch (participant->wait(tick, wait_slice)) {
      case shm::Participant::State::tick:
        hand_over(tick, stop);
        break;
      case shm::Participant::State::timed_out:
        break;
      case shm::Participant::State::dropped:
        base::log(base::Level::warn, "ros2-gateway", "the simulator dropped the gateway from the lock step; it joins again");
        [[fallthrough]];
      case shm::Participant::State::closed:
        participant.reset();
    }
  }
}

}  // namespace ros2
