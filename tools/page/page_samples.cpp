#include "page/page_samples.h"

#include <cmath>
#include <utility>

#include "base/base64.h"
#include "base/text.h"
#include "studio/client_message.h"
#include "studio/shown_picture.h"

namespace page {
namespace {

using base::Error;
using base::Result;
using std::chrono::nanoseconds;
using namespace std::chrono_literals;

constexpr nanoseconds sample_interval = 20ms;        // of a signal, at least
constexpr nanoseconds bulk_interval = 100ms;         // of one with many numbers
constexpr std::size_t bulk = 64;                     // numbers of a sample; arrays of as many are rounded
constexpr std::size_t max_numbers = 20000;           // of a sample
constexpr std::size_t max_bytes = 20 * max_numbers;  // of a sample; as text a number has up to 20
constexpr double resolution = 1000;                  // of rounded numbers: 1/1000 of their unit
constexpr std::size_t max_sonars = 64;               // of a ring

// Rounds arrays of many numbers; returns how many numbers the value has.
std::size_t rounded(Json& value, bool& is_rounded) {
  if (value.is_number()) return 1;
  if (!value.is_structured()) return 0;
  std::size_t count = 0;
  const bool is_bulk = value.is_array() && value.size() >= bulk;
  for (auto& one : value) {
    count += rounded(one, is_rounded);
    if (!is_bulk || !one.is_number_float() || !std::isfinite(one.get<double>())) continue;
    one = std::round(one.get<double>() * resolution) / resolution;
    is_rounded = true;
  }
  return count;
}

void add(std::string& samples, const std::string& sample) {
  if (!samples.empty()) samples += ',';
  samples += sample;
}

}  // namespace

std::string PagePart::text() const {
  const auto rest = studio::to_text(members);
  std::string text = "{\"samples\":[";
  text.reserve(samples.size() + rest.size() + second.size() + 32);
  text += samples;
  text += rest.size() > 2 ? "]," : "]";  // "{}"
  text.append(rest, 1, rest.size() - 2);
  if (!second.empty()) text.append(",\"other\":").append(second);
  return text += '}';
}

Result<std::unique_ptr<PageSamples>> PageSamples::open(std::shared_ptr<const studio::RecordingFacts> facts, double camera_rate) {
  auto reader = mcap::Reader::open(facts->file);
  if (!reader) return reader.error();
  std::unique_ptr<PageSamples> samples(new PageSamples(std::move(facts), camera_rate, std::move(*reader)));
  samples->find_channels(samples->facts_->from);
  return samples;
}

Result<void> PageSamples::resume(std::shared_ptr<const studio::RecordingFacts> facts, nanoseconds from) {
  auto reader = mcap::Reader::open(facts->file);
  if (!reader) return reader.error();
  facts_ = std::move(facts);
  reader_ = std::move(*reader);
  ahead_.reset();
  find_channels(from);
  return {};
}

PageSamples::PageSamples(std::shared_ptr<const studio::RecordingFacts> facts, double camera_rate, mcap::Reader reader)
    : facts_(std::move(facts)), camera_rate_(camera_rate), reader_(std::move(reader)) {}

void PageSamples::find_channels(nanoseconds from) {
  std::map<std::string, Channel> topics;
  for (const auto& [id, channel] : reader_.channels()) topics[channel.topic] = id;
  mcap::Query query;
  const auto add = [&](Channel channel, Signal signal) {
    signals_.emplace(channel, std::move(signal));  // one that is known stays as it is
    query.channels.push_back(channel);
  };
  for (const auto& signal : facts_->signals) {
    const auto topic = signal.value("topic", "");
    if (signal.value("kind", "") == "image") {
      if (const auto found = topics.find(topic + "/image"); found != topics.end() && camera_rate_ > 0)
        add(found->second, {.topic = topic, .is_image = true});
    } else if (const auto found = topics.find(topic); found != topics.end()) {
      add(found->second, {.topic = topic});
    } else {
      std::size_t count = 0;
      while (count < max_sonars && topics.contains(topic + "/" + std::to_string(count))) ++count;
      for (std::size_t i = 0; i < count; ++i)
        add(topics.at(topic + "/" + std::to_string(i)), {.topic = topic, .of_ring = count, .number = i});
      if (count > 0 && !rings_.contains(topic)) rings_[topic] = Json{{"ranges", std::vector<double>(count, 0.0)}};
    }
  }
  reader_.leave_out_broken_chunks();
  is_at_end_ = query.channels.empty();  // a query without channels would be one for all
  query.from = studio::to_mcap_time(from);
  reader_.seek(query);
}

Result<PagePart> PageSamples::part_until(nanoseconds to) {
  PagePart part{.samples = {}, .members = {{"images", Json::object()}}, .second = {}};
  for (const auto& [topic, sample] : newest_) add(part.samples, sample);
  for (const auto& [topic, image] : images_) part.members["images"][topic] = Json::array({Json::array({image.first, image.second})});
  if (ahead_ && studio::to_nanoseconds(ahead_->first.log_time) < to) {
    auto [message, data] = std::move(*ahead_);
    ahead_.reset();
    message.data = data;
    if (const auto taken = add_message(message, part); !taken) return taken.error();
  }
  while (!ahead_ && !is_at_end_) {
    const auto message = reader_.next();
    if (!message) return message.error();
    if (!message->has_value()) {
      is_at_end_ = true;
    } else if (studio::to_nanoseconds((*message)->log_time) >= to) {
      ahead_ = std::make_unique<std::pair<mcap::Message, std::string>>(**message, std::string((*message)->data));
    } else if (const auto taken = add_message(**message, part); !taken) {
      return taken.error();
    }
  }
  return part;
}

Result<void> PageSamples::add_message(const mcap::Message& message, PagePart& part) {
  Signal& signal = signals_.at(message.channel);
  const auto time = studio::to_nanoseconds(message.log_time);
  const bool ends_ring = signal.number + 1 >= signal.of_ring;  // true without a ring
  if (time < signal.next) {
    if (ends_ring) ++thinned_[signal.topic];
    return {};
  }
  if (signal.is_image) return add_image(message, signal, part);
  if (message.data.size() > max_bytes) {  // its values alone would take many times as much memory
    signal.next = time + bulk_interval - 1ms;
    ++too_large_[signal.topic];
    return {};
  }
  auto value = values_.of(message);
  if (!value) return value.error();
  if (signal.of_ring > 0) {
    auto& ring = rings_.at(signal.topic);
    ring["ranges"][signal.number] = value->value("range", 0.0);
    if (ends_ring) add_sample(signal.topic, facts_->seconds(time), ring, part);
    return {};
  }
  bool is_rounded = false;
  const std::size_t numbers = rounded(*value, is_rounded);
  if (is_rounded) rounded_.insert(signal.topic);
  signal.next = time + (numbers >= bulk ? bulk_interval : sample_interval) - 1ms;  // what comes at this rate is kept
  if (numbers > max_numbers) {
    ++too_large_[signal.topic];
  } else {
    add_sample(signal.topic, facts_->seconds(time), std::move(*value), part);
  }
  return {};
}

Result<void> PageSamples::add_image(const mcap::Message& message, Signal& signal, PagePart& part) {
  const auto schema = reader_.schemas().find(reader_.channels().at(message.channel).schema);
  const auto jpeg = studio::jpeg_in_message(schema == reader_.schemas().end() ? "" : schema->second.name, message.data);
  if (!jpeg) return Error{signal.topic + ": " + jpeg.error().message};
  const auto time = studio::to_nanoseconds(message.log_time);
  signal.next = time + nanoseconds(static_cast<std::int64_t>(1e9 / camera_rate_)) - 1ms;
  const auto& image = images_[signal.topic] = {facts_->seconds(time), base::to_base64(*jpeg)};
  part.members["images"][signal.topic].push_back(Json::array({image.first, image.second}));
  return {};
}

void PageSamples::add_sample(const std::string& topic, double time, Json value, PagePart& part) {
  auto& sample = newest_[topic];
  sample = studio::to_text(Json::array({topic, time, std::move(value)}));
  add(part.samples, sample);
}

std::vector<std::string> PageSamples::left_out() const {
  std::vector<std::string> lines;
  for (const auto& [topic, count] : thinned_)
    lines.push_back(topic + ": " + std::to_string(count) + " samples between those that are shown");
  for (const auto& [topic, count] : too_large_)
    lines.push_back(topic + ": " + std::to_string(count) + " samples with more than " + std::to_string(max_numbers) + " numbers");
  for (const auto& topic : rounded_) lines.push_back(topic + ": arrays are rounded to 0.001");
  return lines;
}

}  // namespace page
