#include "core/publisher.h"

#include <algorithm>
#include <condition_variable>
#include <thread>
#include <utility>

#include "base/guarded.h"
#include "base/log.h"
#include "base/tick.h"
#include "core/send_queue.h"

namespace rt {
namespace {

using Point = SteadyTime::Point;
using Duration = Point::duration;

// Between two attempts to hand a sample to a receiver whose buffer is full.
constexpr auto first_retry = std::chrono::milliseconds(1);
constexpr auto longest_retry = std::chrono::milliseconds(128);
// Not time_point::max(), which overflows inside some condition variables.
constexpr Duration far = std::chrono::hours(24 * 365);

}  // namespace

struct Publisher::Work : std::enable_shared_from_this<Publisher::Work> {
  struct State {
    SendQueue queue;
    bool is_stopped = false;
    bool is_lost = false;
    bool is_in_hooks = false;
    bool belongs_to_ticks = false;       // what is in the queue: the thread leaves it alone
    std::weak_ptr<void> announcement{};  // alive while a tick is going to call send_in
    std::chrono::nanoseconds due{-1};    // periodic: simulated time of the next sending; negative: not known

    bool has_own_work() const { return !belongs_to_ticks && !queue.is_empty(); }
  };
  enum class Next { go_on, retry, end };

  Work(Subscription s, const PublisherSettings& p, const BufferSettings& b, Hooks h, const SteadyTime& t)
      : subscription(s), period(p.period), buffer(b), hooks(std::move(h)), time(t), state(State{SendQueue(b.length, p)}) {}

  // Time has jumped.
  void look_again() {
    { const auto seen = state.lock(); }  // see SteadyTime::on_jump
    changed.notify_all();
    room.notify_all();
  }

  void run() {
    try {
      if (subscription == Subscription::periodic) {
        run_periodically();
      } else {
        run_on_writes();
      }
    } catch (const std::exception& e) {
      base::log(base::Level::error, "publisher", "stopped: {}", e.what());
    } catch (...) {
      base::log(base::Level::error, "publisher", "stopped by an exception that is no std::exception");
    }
  }

  void run_on_writes() {
    Duration retry{};  // 0: the last sample got through
    for (;;) {
      std::vector<Sample> batch;
      {
        auto locked = state.lock();
        // While the receiver is full, only the time-out or the end wakes us.
        const auto deadline = time.now() + (retry.count() ? retry : far);
        while (!locked->is_stopped && (retry.count() || !locked->has_own_work()) && time.now() < deadline) {
          locked.wait_until(changed, time.look_again(deadline),
                            [&] { return locked->is_stopped || (!retry.count() && locked->has_own_work()) || time.now() >= deadline; });
        }
        if (locked->is_stopped) return;
        if (!locked->has_own_work()) {
          retry = {};
          continue;
        }
        batch = locked->queue.next_batch();
      }
      room.notify_all();
      switch (send(std::move(batch))) {
        case Next::go_on:
          retry = {};
          break;
        case Next::retry:
          retry = retry.count() ? std::min<Duration>(retry * 2, longest_retry) : first_retry;
          break;
        case Next::end:
          return;
      }
    }
  }

  void run_periodically() {
    auto deadline = made + period;
    for (;;) {
      std::vector<Sample> batch;
      {
        auto locked = state.lock();
        while (!locked->is_stopped && time.now() < deadline)
          locked.wait_until(changed, time.look_again(deadline), [&] { return locked->is_stopped || time.now() >= deadline; });
        if (locked->is_stopped) return;
        if (locked->belongs_to_ticks) {
          deadline = time.now() + period;
          continue;
        }
        batch = locked->queue.next_batch();
      }
      room.notify_all();
      if (batch.empty() && hooks.starved) {
        if (!enter_hooks()) return;
        hooks.starved();
        state.lock()->is_in_hooks = false;
      }
      if (send(std::move(batch)) == Next::end) return;
      deadline = std::max<Point>(deadline + period, time.now());
    }
  }

  // At the end of a tick.
  void send_in(base::Tick& tick) {
    state.lock()->announcement.reset();
    if (subscription == Subscription::periodic) {
      for (auto times = times_due(tick.time()); times > 0; --times) {
        std::vector<Sample> batch = state.lock()->queue.next_batch();
        if (batch.empty() && hooks.starved) {
          if (!enter_hooks()) return;
          hooks.starved();
          state.lock()->is_in_hooks = false;
        }
        if (send(std::move(batch)) != Next::go_on) break;
      }
    } else {
      drain();
    }
    const bool is_over = [&] {
      auto locked = state.lock();
      return locked->is_stopped || !locked->belongs_to_ticks || (subscription != Subscription::periodic && locked->queue.is_empty());
    }();
    if (!is_over) announce(tick);
  }

  // Sends what the policy lets through. False when the receiver is full or nothing is sent any more.
  bool drain() {
    while (true) {
      std::vector<Sample> batch;
      {
        auto locked = state.lock();
        if (locked->is_stopped || locked->queue.is_empty()) return !locked->is_stopped;
        batch = locked->queue.next_batch();
      }
      room.notify_all();
      if (send(std::move(batch)) != Next::go_on) return false;
    }
  }

  void announce(base::Tick& tick);

  // How many multiples of the period have come up to `now`; time that has jumped counts once.
  std::int64_t times_due(std::chrono::nanoseconds now) {
    constexpr std::int64_t most = 1000;
    if (period <= std::chrono::nanoseconds(0)) return 1;
    auto locked = state.lock();
    auto& due = locked->due;
    const auto next = [&](std::chrono::nanoseconds time) { return (time / period + (time % period == Duration::zero() ? 0 : 1)) * period; };
    if (due < std::chrono::nanoseconds(0) || now + period < due) due = next(now);  // the first time, or after a reset
    if (now < due) return 0;
    const auto times = (now - due) / period + 1;
    due += times * period;
    return times > most ? 1 : times;
  }

  Next send(std::vector<Sample> batch) {
    for (auto it = batch.begin(); it != batch.end(); ++it) {
      if (!enter_hooks()) return Next::end;
      const PortStatus status = hooks.send(*it);
      state.lock()->is_in_hooks = false;
      switch (status) {
        case PortStatus::send_full:
        case PortStatus::send_timeout:
          state.lock()->queue.put_back({std::make_move_iterator(it), std::make_move_iterator(batch.end())});
          return Next::retry;
        case PortStatus::connection_lost:
          end_lost();
          return Next::end;
        default:
          break;
      }
    }
    return Next::go_on;
  }

  void end_lost() {
    {
      auto locked = state.lock();
      if (std::exchange(locked->is_stopped, true)) return;
      locked->is_lost = true;
      locked->is_in_hooks = true;
    }
    room.notify_all();
    if (hooks.lost) hooks.lost();
  }

  bool enter_hooks() {
    auto locked = state.lock();
    locked->is_in_hooks = !locked->is_stopped;
    return locked->is_in_hooks;
  }

  const Subscription subscription;
  const std::chrono::nanoseconds period;
  const BufferSettings buffer;
  const Hooks hooks;
  const SteadyTime& time;
  const Point made = time.now();
  base::Guarded<State, base::Rank::queue> state;
  std::condition_variable changed;
  std::condition_variable room;
};

void Publisher::Work::announce(base::Tick& tick) {
  const auto announcement = std::make_shared<char>();
  {
    auto locked = state.lock();
    if (!locked->announcement.expired()) return;
    locked->announcement = announcement;
  }
  tick.at_end([announcement, work = weak_from_this()](base::Tick& ending) {
    if (const auto alive = work.lock()) alive->send_in(ending);
  });
}

Publisher::Publisher(Subscription subscription, const PublisherSettings& publisher, const BufferSettings& buffer, Hooks hooks,
                     const SteadyTime& time)
    : work_(std::make_shared<Work>(subscription, publisher, buffer, std::move(hooks), time)),
      jump_(time.on_jump([work = work_] { work->look_again(); })) {
  thread_ = std::thread([work = work_] { work->run(); });
}

Publisher::~Publisher() {
  const bool is_busy = request_stop();
  // Whoever is in a hook may hang there for long, or be the one that destroys us.
  if (is_busy || thread_.get_id() == std::this_thread::get_id()) {
    thread_.detach();
  } else {
    thread_.join();
  }
}

WriteResult Publisher::write_in(base::Tick& tick, Sample sample) {
  const bool is_full = [&] {
    auto state = work_->state.lock();
    state->belongs_to_ticks = true;
    return state->queue.is_full();
  }();
  if (is_full && work_->subscription != Subscription::periodic) work_->drain();
  WriteResult result;
  {
    auto state = work_->state.lock();
    if (state->is_stopped || state->is_lost)
      return WriteResult{state->is_lost ? PortStatus::connection_lost : PortStatus::precondition_not_met};
    if (state->queue.is_full() && work_->buffer.full == FullPolicy::do_nothing) return {PortStatus::buffer_full};
    if (state->queue.is_full() && work_->buffer.full == FullPolicy::block) return {PortStatus::buffer_timeout};
    result.overwrote = state->queue.push(std::move(sample));
  }
  work_->announce(tick);
  return result;
}

WriteResult Publisher::write(Sample sample, base::Tick* tick) {
  if (tick) return write_in(*tick, std::move(sample));
  WriteResult result;
  {
    auto state = work_->state.lock();
    state->belongs_to_ticks = false;
    const auto has_ended = [&] { return state->is_stopped || state->is_lost; };
    const auto ended = [&] { return WriteResult{state->is_lost ? PortStatus::connection_lost : PortStatus::precondition_not_met}; };
    if (has_ended()) return ended();
    if (state->queue.is_full() && work_->buffer.full == FullPolicy::do_nothing) return {PortStatus::buffer_full};
    if (state->queue.is_full() && work_->buffer.full == FullPolicy::block) {
      const auto& time = work_->time;
      const auto deadline = time.now() + work_->buffer.write_timeout;
      while (!has_ended() && state->queue.is_full() && time.now() < deadline)
        state.wait_until(work_->room, time.look_again(deadline),
                         [&] { return has_ended() || !state->queue.is_full() || time.now() >= deadline; });
      const bool is_over = state->queue.is_full();
      if (has_ended()) return ended();
      if (is_over) return {PortStatus::buffer_timeout};
    }
    result.overwrote = state->queue.push(std::move(sample));
  }
  work_->changed.notify_one();
  return result;
}

std::size_t Publisher::waiting() const { return work_->state.lock()->queue.size(); }

void Publisher::drop_waiting() {
  std::vector<Sample> dropped;  // destroyed without the lock: samples may be large
  {
    auto state = work_->state.lock();
    while (!state->queue.is_empty()) dropped.push_back(state->queue.pop());
  }
  work_->room.notify_all();
}

bool Publisher::request_stop() {
  bool is_busy = false;
  {
    auto state = work_->state.lock();
    state->is_stopped = true;
    is_busy = state->is_in_hooks;
  }
  work_->changed.notify_all();
  work_->room.notify_all();
  return is_busy;
}

void Publisher::stop() { request_stop(); }

}  // namespace rt
