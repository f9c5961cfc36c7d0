#include "core/steady_time.h"

#include <utility>

namespace rt {
namespace {

class MachineTime final : public SteadyTime {
 public:
  Point now() const override { return std::chrono::steady_clock::now(); }
  Point look_again(Point deadline) const override { return deadline; }
  std::shared_ptr<void> on_jump(std::function<void()>) const override { return nullptr; }
};

}  // namespace

const SteadyTime& machine_time() {
  static const MachineTime time;
  return time;
}

struct ManualTime::Sleepers {
  base::Turn<> turn;  // of what follows: whoever leaves waits until no call to it runs
  std::map<int, std::function<void()>> wakes;
  int last = 0;
};

std::shared_ptr<ManualTime::Sleepers> ManualTime::make_sleepers() { return std::make_shared<Sleepers>(); }

// Nobody tells a sleeper twice; the hour is a bound for tests that fail.
ManualTime::Point ManualTime::look_again(Point deadline) const {
  constexpr std::chrono::hours longest{1};
  return now() >= deadline ? std::chrono::steady_clock::now() : std::chrono::steady_clock::now() + longest;
}

std::shared_ptr<void> ManualTime::on_jump(std::function<void()> wake) const {
  const auto mine = sleepers_->turn.take();
  const int id = ++sleepers_->last;
  sleepers_->wakes.emplace(id, std::move(wake));
  return {nullptr, [sleepers = sleepers_, id](void*) {
            const auto turn = sleepers->turn.take();
            sleepers->wakes.erase(id);
          }};
}

void ManualTime::advance(std::chrono::nanoseconds by) {
  *now_.lock() += std::chrono::duration_cast<Point::duration>(by);
  const auto mine = sleepers_->turn.take();
  for (const auto& [id, wake] : sleepers_->wakes) wake();
}

}  // namespace rt
