#include "tick_group.h"

#include <base/guarded.h>

#include <algorithm>
#include <condition_variable>
#include <map>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

namespace iface {
namespace {

using std::chrono::nanoseconds;
using namespace std::chrono_literals;

constexpr std::chrono::milliseconds longest_wait_of_group = 100ms;  // for a tick, before all participants are looked at
constexpr std::chrono::milliseconds longest_alone = 20ms;           // of a call, before another thread goes on
constexpr nanoseconds worth_sharing = 500us;                        // calls of a tick
constexpr int quiet_looks = 50;                                     // of a thread that helps, before it sleeps until it is called
constexpr std::size_t max_group_threads = 64;

}  // namespace

// All but the first two belong to the group's lock.
struct TickGroup::Place::Node {
  Node(std::shared_ptr<shm::Participant> with, Ticked& called) : participant(std::move(with)), ticked(called) {}

  const std::shared_ptr<shm::Participant> participant;
  Ticked& ticked;
  std::condition_variable changed;  // of what wait() and the end of the place wait for
  shm::Tick tick{};
  bool has_requests = true, is_called = false, is_removed = false, is_leaving = false;
  bool owes_finish = false;  // it is alone, and its tick ends when the next one is awaited: the thread may linger then
  shm::Participant::State end = shm::Participant::State::tick;  // dropped or closed: it is over

  bool is_over() const { return end != shm::Participant::State::tick; }
  bool is_free() const { return !is_called && !is_removed && !is_over(); }
};

struct TickGroup::Impl {
  using Node = Place::Node;
  using State = shm::Participant::State;

  struct Call {
    std::shared_ptr<Node> node;
    bool is_tick = true;  // else for requests
  };
  struct Data {
    std::vector<std::shared_ptr<Node>> nodes;
    std::vector<Call> due;  // of this round
    std::size_t next = 0;   // in due
    std::shared_ptr<Node> awaited;
    bool is_woken = false, is_ending = false;
    std::uint64_t calls = 0;  // begun
    nanoseconds took{0};      // calls of this round
    std::size_t busy = 0;     // threads in a call
    std::size_t wanted = 0;   // threads that are called to help
    bool is_watched = true;   // false: a thread that sleeps is to look from time to time
    std::size_t taken_over = 0;
    std::size_t resting = 0, asleep = 0;  // threads without a call: those that look from time to time, and those that do not
    std::vector<std::thread> threads;
  };
  using Shared = base::Guarded<Data, base::Rank::tasks>;

  // What a thread is to do: a call, wait for the next tick, or end.
  struct Job {
    Call call{};
    std::shared_ptr<Node> awaits{};
  };

  Shared shared;
  std::condition_variable work;

  void start_thread(Data& data) {
    if (data.threads.size() < max_group_threads && !data.is_ending) data.threads.emplace_back([this] { serve(); });
  }
  static std::shared_ptr<Node> waitable(const Data& data);
  static void finish_others(Data& data, const Node* awaited);
  void gather(Data& data, bool looks_at_all);
  void call_helpers(Data& data, std::size_t ticks, bool was_long);
  std::optional<Job> try_job(Data& data);
  Job next_job(bool rests_first);
  void rest(Shared::Lock& data);
  void call(const Call& call);
  void await(const std::shared_ptr<Node>& node);
  void serve();
};

// A node whose participant can be waited for: the first that is active. Those of one group are due at the same times.
std::shared_ptr<TickGroup::Impl::Node> TickGroup::Impl::waitable(const Data& data) {
  std::shared_ptr<Node> first;
  for (const auto& node : data.nodes) {
    if (!node->is_free()) continue;
    if (node->participant->is_active()) return node;
    if (!first) first = node;
  }
  return first;
}

void TickGroup::Impl::finish_others(Data& data, const Node* awaited) {
  for (const auto& node : data.nodes) {
    if (node.get() != awaited && !node->is_called && std::exchange(node->owes_finish, false)) node->participant->finish();
  }
}

// All that is to be called now. Requests of a context that has a tick are seen to in it.
void TickGroup::Impl::gather(Data& data, bool looks_at_all) {
  data.due.clear();
  data.next = 0;
  const bool was_long = std::exchange(data.took, nanoseconds(0)) > worth_sharing;
  for (const auto& node : data.nodes) {
    if (!node->is_free()) continue;
    const State state = node->participant->look();
    if (state == State::tick) {
      node->tick = node->participant->begin();
      node->has_requests = false;
      data.due.push_back({node, true});
    } else if (state != State::timed_out) {
      node->end = state;
      node->changed.notify_all();
    }
  }
  const std::size_t ticks = data.due.size();
  for (const auto& node : data.nodes) {
    if (ticks > 0 || !node->is_free()) continue;
    if (std::exchange(node->has_requests, false) || looks_at_all) data.due.push_back({node, false});
  }
  if (ticks > 1) call_helpers(data, ticks, was_long);
}

void TickGroup::Impl::call_helpers(Data& data, std::size_t ticks, bool was_long) {
  const std::size_t processors = std::max(std::thread::hardware_concurrency(), 1U);
  const std::size_t helpers = was_long ? std::min({ticks, std::max(processors, data.taken_over + 1), max_group_threads}) - 1 : 0;
  for (auto i = data.threads.size(); i < std::max<std::size_t>(helpers, 1) + 1; ++i) start_thread(data);
  data.wanted = helpers;
  const bool is_watched = helpers > 0 || data.resting > 0 || data.asleep == 0;
  data.is_watched = is_watched;
  if (helpers > 1) work.notify_all();
  if (helpers == 1 || !is_watched) work.notify_one();
}

std::optional<TickGroup::Impl::Job> TickGroup::Impl::try_job(Data& data) {
  while (data.next < data.due.size()) {
    const Call call = data.due[data.next++];
    if (!call.node->is_free()) continue;
    call.node->is_called = true;
    ++data.calls;
    ++data.busy;
    return Job{.call = call};
  }
  if (data.awaited) return std::nullopt;
  auto node = waitable(data);
  if (!node) return std::nullopt;
  finish_others(data, node.get());
  if (std::exchange(data.is_woken, false)) {
    gather(data, false);
    return try_job(data);
  }
  node->owes_finish = false;
  data.awaited = node;
  return Job{.awaits = std::move(node)};
}

TickGroup::Impl::Job TickGroup::Impl::next_job(bool rests_first) {
  auto data = shared.lock();
  while (!data->is_ending) {
    if (!std::exchange(rests_first, false)) {
      if (auto job = try_job(*data)) return std::move(*job);
    }
    rest(data);
    // One thread is there to see that a call lasts.
    if (data->resting == 0 && data->asleep == 0 && data->threads.size() <= data->nodes.size()) start_thread(*data);
  }
  return {};
}

// Until there is something to do for this thread: it is called, nobody is there, or the calls of others last while nobody waits for the
// next tick.
void TickGroup::Impl::rest(Shared::Lock& data) {
  const auto is_deserted = [&] { return data->busy == 0 && !data->awaited && waitable(*data); };
  const auto is_needed = [&] { return data->is_ending || data->wanted > 0 || is_deserted(); };
  int quiet = 0;
  while (true) {
    const auto seen = data->calls;
    ++data->resting;
    const bool is_called = data.wait_for(work, longest_alone, is_needed);
    --data->resting;
    if (is_called) break;
    if (!data->awaited && data->calls == seen && (data->next < data->due.size() || waitable(*data))) {
      ++data->taken_over;
      return;
    }
    quiet = data->calls == seen ? quiet + 1 : 0;
    if (quiet < quiet_looks) continue;
    quiet = 0;
    ++data->asleep;
    data.wait(work, [&] { return is_needed() || !data->is_watched; });
    --data->asleep;
    data->is_watched = true;
  }
  if (data->wanted > 0) --data->wanted;
}

void TickGroup::Impl::call(const Call& call) {
  const auto began = std::chrono::steady_clock::now();
  call.is_tick ? call.node->ticked.run_tick(call.node->tick) : call.node->ticked.run_requests();
  const nanoseconds took = std::chrono::steady_clock::now() - began;
  const bool is_alone = call.is_tick && shared.lock()->nodes.size() == 1;
  if (call.is_tick && !is_alone) call.node->participant->finish();
  auto data = shared.lock();
  data->took += took;
  --data->busy;
  call.node->is_called = false;
  call.node->owes_finish = is_alone;
  if (call.node->is_removed) call.node->changed.notify_all();
}

void TickGroup::Impl::await(const std::shared_ptr<Node>& node) {
  const auto began = std::chrono::steady_clock::now();
  const auto state = node->participant->await(longest_wait_of_group);
  auto data = shared.lock();
  data->awaited.reset();
  data->is_woken = false;
  if (state == State::dropped || state == State::closed) {
    node->end = state;
    node->changed.notify_all();
  }
  // Nothing came, and nobody woke it: requests are not lost, whatever happens.
  gather(*data, state == State::timed_out && std::chrono::steady_clock::now() - began >= longest_wait_of_group);
  if (node->is_removed) node->changed.notify_all();
}

void TickGroup::Impl::serve() {
  for (bool is_new = true;; is_new = false) {
    const Job job = next_job(is_new);
    if (job.call.node) {
      call(job.call);
    } else if (job.awaits) {
      await(job.awaits);
    } else {
      return;
    }
  }
}

TickGroup::TickGroup() : impl_(std::make_unique<Impl>()) {}

// By its last place, so on no thread of its own.
TickGroup::~TickGroup() {
  std::vector<std::thread> threads;
  {
    auto data = impl_->shared.lock();
    data->is_ending = true;
    threads.swap(data->threads);
  }
  impl_->work.notify_all();
  for (auto& thread : threads) thread.join();
}

std::shared_ptr<TickGroup> TickGroup::of(const Key& key) {
  static base::Guarded<std::map<Key, std::weak_ptr<TickGroup>>, base::Rank::objects> groups;
  auto all = groups.lock();
  auto& known = (*all)[key];
  auto group = known.lock();
  if (!group) known = group = std::shared_ptr<TickGroup>(new TickGroup);
  return group;
}

TickGroup::Place::Place(const Key& key, std::shared_ptr<shm::Participant> participant, Ticked& ticked)
    : group_(of(key)), node_(std::make_shared<Node>(std::move(participant), ticked)) {
  auto& impl = *group_->impl_;
  auto data = impl.shared.lock();
  data->nodes.push_back(node_);
  data->is_woken = true;
  if (data->threads.empty()) impl.start_thread(*data);
  if (data->awaited) data->awaited->participant->interrupt();
  impl.work.notify_one();
}

TickGroup::Place::~Place() {
  auto& shared = group_->impl_->shared;
  const auto is_free_within = [&](std::chrono::nanoseconds timeout) {
    auto data = shared.lock();
    return data.wait_for(node_->changed, timeout, [&] { return !node_->is_called && data->awaited != node_; });
  };
  {
    auto data = shared.lock();
    node_->is_removed = true;
    std::erase(data->nodes, node_);
    if (data->awaited == node_) node_->participant->interrupt();
  }
  if (is_free_within(long_wait)) return;
  node_->ticked.report_long_call();
  while (!is_free_within(long_wait)) continue;
}

shm::Participant::State TickGroup::Place::wait() {
  auto data = group_->impl_->shared.lock();
  data.wait(node_->changed, [&] { return node_->is_leaving || node_->is_over(); });
  return node_->is_over() ? node_->end : shm::Participant::State::timed_out;
}

void TickGroup::Place::wake() {
  auto data = group_->impl_->shared.lock();
  node_->has_requests = true;
  data->is_woken = true;
  if (data->awaited) data->awaited->participant->interrupt();
}

void TickGroup::Place::leave() {
  auto data = group_->impl_->shared.lock();
  node_->is_leaving = true;
  node_->changed.notify_all();
}

}  // namespace iface
