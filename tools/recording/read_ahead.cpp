#include "recording/read_ahead.h"

#include <chrono>
#include <utility>

namespace recorder {

namespace {

constexpr std::size_t max_ahead = 8 << 20;      // that wait
constexpr std::size_t piece_octets = 64 << 10;  // that are handed over together
constexpr std::chrono::seconds wait_period{1};  // of who waits; whoever has something says so at once

}  // namespace

ReadAhead::ReadAhead(mcap::Reader reader, mcap::Query query) : reader_(std::move(reader)) {
  reader_.seek(std::move(query));
  thread_ = std::thread([this] { run(); });
}

ReadAhead::~ReadAhead() {
  data_.lock()->is_ending = true;
  changed_.notify_all();
  thread_.join();
}

// False when nobody wants more.
bool ReadAhead::hand_over(std::deque<Sample>& samples, std::size_t octets) {
  auto data = data_.lock();
  while (!data->is_ending && data->octets > max_ahead)
    data.wait_for(changed_, wait_period, [&] { return data->is_ending || data->octets <= max_ahead; });
  for (Sample& sample : samples) data->samples.push_back(std::move(sample));
  data->octets += octets;
  samples.clear();
  changed_.notify_all();
  return !data->is_ending;
}

void ReadAhead::end(std::optional<base::Error> failure) {
  auto data = data_.lock();
  data->failure = std::move(failure);
  data->is_over = true;
  changed_.notify_all();
}

void ReadAhead::run() {
  std::deque<Sample> samples;
  std::size_t octets = 0;
  for (;;) {
    const auto message = reader_.next();
    const bool is_over = !message || !message->has_value();
    if (!is_over) {
      samples.push_back({(*message)->channel, (*message)->log_time, std::string((*message)->data)});
      octets += (*message)->data.size() + sizeof(Sample);
    }
    if ((is_over || octets >= piece_octets) && !hand_over(samples, std::exchange(octets, 0))) return;
    if (is_over) return end(message ? std::nullopt : std::optional(message.error()));
  }
}

base::Result<std::optional<ReadAhead::Sample>> ReadAhead::next() {
  if (ready_.empty()) {
    auto data = data_.lock();
    while (data->samples.empty() && !data->is_over)
      data.wait_for(changed_, wait_period, [&] { return !data->samples.empty() || data->is_over; });
    if (data->samples.empty()) return data->failure ? base::Result<std::optional<Sample>>(*data->failure) : std::optional<Sample>();
    std::swap(ready_, data->samples);
    data->octets = 0;
    changed_.notify_all();
  }
  std::optional<Sample> sample(std::move(ready_.front()));
  ready_.pop_front();
  return sample;
}

}  // namespace recorder
