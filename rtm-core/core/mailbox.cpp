#include "core/mailbox.h"

#include <algorithm>
#include <utility>

#include "base/tick.h"

namespace rt {
namespace {

// Of two samples that wait in channels of these names, whether this one is read first.
bool is_before(const Sample& a, const std::string& from_a, const Sample& b, const std::string& from_b) {
  if (a.phase_counter != b.phase_counter && a.phase_counter != 0 && b.phase_counter != 0) return a.phase_counter < b.phase_counter;
  if (a.phase_counter == b.phase_counter && base::is_in_phase(a.phase_counter) && from_a != from_b) return from_a < from_b;
  return a.arrival < b.arrival;
}

}  // namespace

void Mailbox::Entry::settle(std::uint64_t now) {
  while (!aside.empty() && (!base::is_in_phase(now) || aside.front().phase_counter < now)) {
    ring.push(std::move(aside.front()));
    aside.pop_front();
  }
  if (!base::is_in_phase(now) || now <= phase_counter) return;
  phase_counter = now;
  size_at_start = ring.size();
}

bool Mailbox::Entry::is_full(std::uint64_t now) const {
  const bool is_aside = base::is_in_phase(now) && now == phase_counter && !is_rendezvous;
  return (is_aside ? size_at_start + aside.size() : ring.size()) >= ring.length();
}

bool Mailbox::Entry::put(Sample sample) {
  if (!base::is_in_phase(sample.phase_counter) || sample.phase_counter != phase_counter || is_rendezvous)
    return ring.push(std::move(sample));
  const bool loses = is_full(phase_counter);
  if (aside.size() == ring.length()) aside.pop_front();
  aside.push_back(std::move(sample));
  return loses;
}

std::size_t Mailbox::Entry::readable(std::uint64_t now) const {
  const auto is_readable = [&](const Sample& sample) { return !base::is_in_phase(now) || sample.phase_counter < now; };
  return std::min(ring.length(), ring.size() + static_cast<std::size_t>(std::ranges::count_if(aside, is_readable)));
}

std::size_t Mailbox::Entry::octets() const {
  std::size_t sum = ring.octets();
  for (const Sample& sample : aside) sum += octets_of(sample);
  return sum;
}

Sample Mailbox::Entry::drop_oldest() {
  if (!ring.is_empty()) return ring.pop();
  Sample dropped = std::move(aside.front());
  aside.pop_front();
  return dropped;
}

std::size_t Mailbox::State::unread_octets() const {
  std::size_t sum = 0;
  for (const auto& entry : entries) sum += entry.octets();
  return sum;
}

std::size_t Mailbox::State::all_octets() const {
  std::size_t sum = unread_octets();
  for (const auto& entry : entries) sum += octets_of(entry.last);
  return sum;
}

Mailbox::Entry* Mailbox::State::find(Channel channel) {
  const auto it = std::ranges::find(entries, channel, &Entry::channel);
  return it == entries.end() ? nullptr : &*it;
}

Mailbox::Entry* Mailbox::State::find_writable(Channel channel) {
  Entry* entry = find(channel);
  return entry && !entry->is_finished ? entry : nullptr;
}

void Mailbox::State::erase(const Entry& entry) { entries.erase(entries.begin() + (&entry - entries.data())); }

Mailbox::Entry* Mailbox::State::oldest(Channel channel) {
  Entry* found = nullptr;
  for (auto& entry : entries) {
    if (channel != Channel::any && entry.channel != channel) continue;
    if (entry.ring.is_empty()) continue;
    if (!found || is_before(entry.ring.front(), entry.name, found->ring.front(), found->name)) found = &entry;
  }
  return found;
}

Mailbox::Entry* Mailbox::State::last_read(Channel channel) {
  Entry* found = nullptr;
  for (auto& entry : entries) {
    if (channel != Channel::any && entry.channel != channel) continue;
    if (!entry.last) continue;
    if (!found || is_before(found->last, found->name, entry.last, entry.name)) found = &entry;
  }
  return found;
}

ReadResult Mailbox::State::take(Entry& entry) {
  entry.last = entry.ring.pop();
  ++entry.read_count;
  return {PortStatus::ok, entry.last, true, entry.channel};
}

std::optional<std::chrono::nanoseconds> Mailbox::State::longest_wait(Channel channel) {
  std::optional<std::chrono::nanoseconds> longest;
  const Entry* last = last_read(channel);
  for (const auto& entry : entries) {
    if (channel != Channel::any && entry.channel != channel) continue;
    if (entry.is_finished) continue;
    if (last && &entry != last) continue;
    if (entry.settings.empty != EmptyPolicy::block && !entry.is_rendezvous) continue;
    if (!longest || entry.settings.read_timeout > *longest) longest = entry.settings.read_timeout;
  }
  return longest;
}

Channel Mailbox::open(const BufferSettings& settings, const std::string& name) {
  auto state = state_.lock();
  const Channel channel{++state->last_channel};
  state->entries.push_back({channel, name, settings, Ring(settings.length), {}});
  return channel;
}

void Mailbox::close(Channel channel) {
  Entry closed{channel, {}, {}, Ring(1), {}};  // destroyed without the lock: samples may be large
  {
    auto state = state_.lock();
    Entry* entry = state->find(channel);
    if (!entry) return;
    closed = std::move(*entry);
    state->erase(*entry);
  }
  arrived_.notify_all();
  freed_.notify_all();
}

void Mailbox::finish(Channel channel) {
  Entry closed{channel, {}, {}, Ring(1), {}};  // as in close
  {
    auto state = state_.lock();
    Entry* entry = state->find(channel);
    if (!entry) return;
    entry->is_finished = true;
    if (entry->is_empty()) {
      closed = std::move(*entry);
      state->erase(*entry);
    }
  }
  arrived_.notify_all();
  freed_.notify_all();
}

WriteResult Mailbox::write(Channel channel, Sample sample, std::chrono::nanoseconds most) {
  WriteResult result;
  std::vector<Sample> lost;  // let go without the lock
  {
    auto state = state_.lock();
    Entry* entry = state->find_writable(channel);
    if (!entry) return {PortStatus::precondition_not_met};
    entry->settle(sample.phase_counter);
    const std::size_t octets = octets_of(sample);
    const auto is_crowded = [&] { return !entry->is_empty() && state->unread_octets() + octets > max_octets_; };
    const auto is_full = [&] { return entry->is_full(sample.phase_counter) || is_crowded(); };
    if (entry->settings.full == FullPolicy::do_nothing && is_full()) return {PortStatus::buffer_full};
    if (entry->settings.full == FullPolicy::block && is_full()) {
      const bool has_room = state.wait_for(freed_, std::min(entry->settings.write_timeout, most), [&] {
        entry = state->find_writable(channel);
        return !entry || !is_full();
      });
      if (!entry) return {PortStatus::precondition_not_met};
      if (!has_room) return {PortStatus::buffer_timeout};
    }
    while (is_crowded()) lost.push_back(entry->drop_oldest());
    if (!lost.empty()) freed_.notify_all();
    if (state->all_octets() + octets > 2 * max_octets_) return {PortStatus::buffer_full};
    sample.arrival = ++state->arrivals;
    if (entry->is_full(sample.phase_counter) && !entry->ring.is_empty()) lost.push_back(entry->ring.front());
    result.overwrote = entry->put(std::move(sample)) || !lost.empty();
    if (!entry->is_rendezvous) {
      arrived_.notify_all();
      return result;
    }
    arrived_.notify_all();
    const auto reads = entry->read_count;
    const bool is_read = state.wait_for(freed_, std::min(entry->settings.write_timeout, most), [&] {
      entry = state->find_writable(channel);
      return !entry || entry->read_count != reads;
    });
    if (!entry) return {PortStatus::precondition_not_met};
    if (!is_read) result.status = PortStatus::buffer_timeout;
  }
  return result;
}

ReadResult Mailbox::read(Channel channel, std::uint64_t phase_counter, std::chrono::nanoseconds most) {
  ReadResult result;
  {
    auto state = state_.lock();
    if (channel == Channel::any ? state->entries.empty() : !state->find(channel))
      return {PortStatus::precondition_not_met, {}, false, channel};
    for (auto& each : state->entries) each.settle(phase_counter);
    Entry* entry = state->oldest(channel);
    if (!entry) {
      if (const auto longest = state->longest_wait(channel)) {
        // Nobody brings anything for this phase any more.
        if (base::is_in_phase(phase_counter) && std::ranges::none_of(state->entries, &Entry::is_rendezvous))
          return {PortStatus::buffer_timeout, {}, false, channel};
        state.wait_for(arrived_, std::min(*longest, most), [&] {
          for (auto& each : state->entries) each.settle(phase_counter);
          entry = state->oldest(channel);
          return entry || (channel == Channel::any ? state->entries.empty() : !state->find(channel));
        });
        if (!entry) return {PortStatus::buffer_timeout, {}, false, channel};
      } else {
        Entry* last = state->last_read(channel);
        if (!last || last->settings.empty != EmptyPolicy::readback) return {PortStatus::buffer_empty, {}, false, channel};
        return {PortStatus::ok, last->last, false, last->channel};
      }
    }
    result = state->take(*entry);
    if (entry->is_finished && entry->is_empty()) state->erase(*entry);
  }
  freed_.notify_all();
  return result;
}

std::size_t Mailbox::unread(Channel channel, std::uint64_t phase_counter) const {
  auto state = state_.lock();
  std::size_t count = 0;
  for (const auto& entry : state->entries) {
    if (channel == Channel::any || entry.channel == channel) count += entry.readable(phase_counter);
  }
  return count;
}

bool Mailbox::wait_unread(std::chrono::nanoseconds most) {
  auto state = state_.lock();
  return state.wait_for(arrived_, most,
                        [&] { return std::ranges::any_of(state->entries, [](const Entry& entry) { return entry.readable(0) > 0; }); });
}

void Mailbox::drop_unread(Channel channel) {
  std::vector<Sample> dropped;  // destroyed without the lock, as in close
  {
    auto state = state_.lock();
    Entry* entry = state->find(channel);
    if (!entry) return;
    entry->settle(0);
    while (!entry->ring.is_empty()) dropped.push_back(entry->ring.pop());
    dropped.push_back(std::exchange(entry->last, {}));
    if (entry->is_finished) state->erase(*entry);
  }
  freed_.notify_all();
}

void Mailbox::drop_other_epochs(std::uint64_t epoch) {
  std::vector<Sample> dropped;  // destroyed without the lock, as in close
  {
    auto state = state_.lock();
    for (auto& entry : state->entries) {
      if (std::exchange(entry.epoch, epoch) != epoch) entry.phase_counter = 0;  // the phase counter may have restarted
      while (!entry.ring.is_empty() && entry.ring.front().epoch != epoch) dropped.push_back(entry.ring.pop());
      while (!entry.aside.empty() && entry.aside.front().epoch != epoch) {
        dropped.push_back(std::move(entry.aside.front()));
        entry.aside.pop_front();
      }
      if (entry.last && entry.last.epoch != epoch) dropped.push_back(std::exchange(entry.last, {}));
    }
    std::erase_if(state->entries, [](const Entry& entry) { return entry.is_finished && entry.is_empty(); });
  }
  if (!dropped.empty()) freed_.notify_all();
}

void Mailbox::forget_last(Channel channel) {
  auto state = state_.lock();
  if (Entry* entry = state->find(channel)) entry->last = {};
}

void Mailbox::set_rendezvous(Channel channel, bool is_rendezvous) {
  auto state = state_.lock();
  if (Entry* entry = state->find(channel)) entry->is_rendezvous = is_rendezvous;
}

}  // namespace rt
