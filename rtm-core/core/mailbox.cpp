#include "core/mailbox.h"

#include <algorithm>
#include <utility>

namespace rt {

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
    if (!found || entry.ring.front().arrival < found->ring.front().arrival) found = &entry;
  }
  return found;
}

Mailbox::Entry* Mailbox::State::last_read(Channel channel) {
  Entry* found = nullptr;
  for (auto& entry : entries) {
    if (channel != Channel::any && entry.channel != channel) continue;
    if (!entry.last) continue;
    if (!found || entry.last.arrival > found->last.arrival) found = &entry;
  }
  return found;
}

ReadResult Mailbox::State::take(Entry& entry) {
  entry.last = entry.ring.pop();
  ++entry.read_count;
  return {PortStatus::ok, entry.last, true, entry.channel};
}

std::optional<std::chrono::nanoseconds> Mailbox::State::patience(Channel channel) {
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

Channel Mailbox::open(const BufferSettings& settings) {
  auto state = state_.lock();
  const Channel channel{++state->last_channel};
  state->entries.push_back({channel, settings, Ring(settings.length), {}});
  return channel;
}

void Mailbox::close(Channel channel) {
  Entry closed{channel, {}, Ring(1), {}};  // destroyed without the lock: samples may be large
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
  Entry closed{channel, {}, Ring(1), {}};  // as in close
  {
    auto state = state_.lock();
    Entry* entry = state->find(channel);
    if (!entry) return;
    entry->is_finished = true;
    if (entry->ring.is_empty()) {
      closed = std::move(*entry);
      state->erase(*entry);
    }
  }
  arrived_.notify_all();
  freed_.notify_all();
}

WriteResult Mailbox::write(Channel channel, Sample sample) {
  WriteResult result;
  Sample lost;
  {
    auto state = state_.lock();
    Entry* entry = state->find_writable(channel);
    if (!entry) return {PortStatus::precondition_not_met};
    if (entry->ring.is_full() && entry->settings.full == FullPolicy::do_nothing) return {PortStatus::buffer_full};
    if (entry->ring.is_full() && entry->settings.full == FullPolicy::block) {
      const bool has_room = state.wait_for(freed_, entry->settings.write_timeout, [&] {
        entry = state->find_writable(channel);
        return !entry || !entry->ring.is_full();
      });
      if (!entry) return {PortStatus::precondition_not_met};
      if (!has_room) return {PortStatus::buffer_timeout};
    }
    if (entry->ring.is_full()) {
      lost = entry->ring.pop();
      result.overwrote = true;
    }
    sample.arrival = ++state->arrivals;
    entry->ring.push(std::move(sample));
    if (!entry->is_rendezvous) {
      arrived_.notify_all();
      return result;
    }
    arrived_.notify_all();
    const auto reads = entry->read_count;
    const bool is_read = state.wait_for(freed_, entry->settings.write_timeout, [&] {
      entry = state->find_writable(channel);
      return !entry || entry->read_count != reads;
    });
    if (!entry) return {PortStatus::precondition_not_met};
    if (!is_read) result.status = PortStatus::buffer_timeout;
  }
  return result;
}

ReadResult Mailbox::read(Channel channel) {
  ReadResult result;
  {
    auto state = state_.lock();
    if (channel == Channel::any ? state->entries.empty() : !state->find(channel))
      return {PortStatus::precondition_not_met, {}, false, channel};
    Entry* entry = state->oldest(channel);
    if (!entry) {
      if (const auto patience = state->patience(channel)) {
        state.wait_for(arrived_, *patience, [&] {
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
    if (entry->is_finished && entry->ring.is_empty()) state->erase(*entry);
  }
  freed_.notify_all();
  return result;
}

std::size_t Mailbox::unread(Channel channel) const {
  auto state = state_.lock();
  std::size_t count = 0;
  for (const auto& entry : state->entries) {
    if (channel == Channel::any || entry.channel == channel) count += entry.ring.size();
  }
  return count;
}

void Mailbox::drop_unread(Channel channel) {
  std::vector<Sample> dropped;  // destroyed without the lock, as in close
  {
    auto state = state_.lock();
    Entry* entry = state->find(channel);
    if (!entry) return;
    while (!entry->ring.is_empty()) dropped.push_back(entry->ring.pop());
    dropped.push_back(std::exchange(entry->last, {}));
    if (entry->is_finished) state->erase(*entry);
  }
  freed_.notify_all();
}

void Mailbox::drop_other_eras(std::uint64_t era) {
  std::vector<Sample> dropped;  // destroyed without the lock, as in close
  {
    auto state = state_.lock();
    for (auto& entry : state->entries) {
      while (!entry.ring.is_empty() && entry.ring.front().era != era) dropped.push_back(entry.ring.pop());
      if (entry.last && entry.last.era != era) dropped.push_back(std::exchange(entry.last, {}));
    }
    std::erase_if(state->entries, [](const Entry& entry) { return entry.is_finished && entry.ring.is_empty(); });
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
