#include "studio/playhead.h"

#include <algorithm>

#include "base/text.h"
#include "studio/foxglove.h"
#include "studio/shown_picture.h"

namespace studio {
namespace {

using base::Error;
using base::Result;
using std::chrono::nanoseconds;
using namespace std::chrono_literals;

constexpr nanoseconds longest_stride = 2s;  // what is farther is jumped to
constexpr nanoseconds first_span = 1s;      // before a moment in which its samples are looked for at first
constexpr int span_growth = 8;
constexpr std::size_t max_sonars = 64;  // of a ring
constexpr char recorded_picture_octet = static_cast<char>(0x83);

Frame event(std::uint32_t watch, Json more) {
  Json event{{"op", "values"}, {"watch", watch}};
  event.update(more);
  return text_frame(to_text(event));
}

}  // namespace

Result<std::unique_ptr<Playhead>> Playhead::open(std::shared_ptr<const RecordingFacts> facts) {
  auto reader = mcap::Reader::open(facts->file);
  if (!reader) return reader.error();
  return std::unique_ptr<Playhead>(new Playhead(std::move(facts), std::move(*reader)));
}

Playhead::Playhead(std::shared_ptr<const RecordingFacts> facts, mcap::Reader reader)
    : facts_(std::move(facts)), reader_(std::move(reader)) {
  reader_.leave_out_broken_chunks();
  for (const auto& [id, channel] : reader_.channels()) topics_[channel.topic] = id;
  tf_ = channel_of("/tf");
  tf_static_ = channel_of("/tf_static");
  // One message says what the scene has: nothing came or went.
  const auto shapes = channel_of("/sim/shapes");
  const auto& counts = reader_.statistics().messages_of;
  if (const auto count = shapes ? counts.find(*shapes) : counts.end(); count != counts.end() && count->second > 1) shapes_ = shapes;
}

std::optional<Playhead::Channel> Playhead::channel_of(const std::string& topic) const {
  const auto found = topics_.find(topic);
  return found == topics_.end() ? std::nullopt : std::optional(found->second);
}

void Playhead::set_scene(std::shared_ptr<const RecordedScene> scene) {
  scene_ = std::move(scene);
  shown_tf_ = shown_static_ = 0;
  shown_shapes_.reset();
}

// ---- reading ----

std::vector<Playhead::Channel> Playhead::wanted() const {
  std::set<Channel> all;
  for (const auto& channel : {tf_, tf_static_, shapes_}) {
    if (channel) all.insert(*channel);
  }
  for (const auto& [number, watch] : watches_) all.insert(watch.channels.begin(), watch.channels.end());
  return {all.begin(), all.end()};
}

void Playhead::take(const mcap::Message& message) {
  auto& newest = newest_[message.channel];
  newest.time = to_nanoseconds(message.log_time);
  newest.number = ++taken_;
  newest.octets.assign(message.data);
}

const Playhead::Newest* Playhead::newest(Channel channel) const {
  const auto found = newest_.find(channel);
  return found == newest_.end() ? nullptr : &found->second;
}

// The last sample of each of these channels up to a time: near it first, and then farther and farther before.
Result<void> Playhead::find(std::vector<Channel> channels, nanoseconds time) {
  for (const Channel channel : channels) newest_.erase(channel);
  nanoseconds to = time, span = first_span;
  while (!channels.empty()) {
    const nanoseconds from = std::max(facts_->from, to - span);
    reader_.seek({channels, to_mcap_time(from), to_mcap_time(to)});
    for (;;) {
      const auto message = reader_.next();
      if (!message) return message.error();
      if (!message->has_value()) break;
      take(**message);
    }
    if (from <= facts_->from) break;
    std::erase_if(channels, [&](Channel channel) { return newest_.contains(channel); });
    to = from - 1ns;
    span *= span_growth;
  }
  is_reading_on_ = false;
  return {};
}

Result<void> Playhead::move(nanoseconds time) {
  if (time < now_ || now_ < 0ns || time - now_ > longest_stride) {
    now_ = time;
    return find(wanted(), time);
  }
  if (!is_reading_on_) {
    reader_.seek({wanted(), to_mcap_time(now_ + 1ns)});
    ahead_.reset();
    is_reading_on_ = true;
  }
  now_ = time;
  if (ahead_ && ahead_->second.time <= time) {
    ahead_->second.number = ++taken_;
    newest_[ahead_->first] = std::move(ahead_->second);
    ahead_.reset();
  }
  while (!ahead_) {
    const auto message = reader_.next();
    if (!message) return message.error();
    if (!message->has_value()) return {};
    const mcap::Message& next = **message;
    if (to_nanoseconds(next.log_time) > time) {
      ahead_ = {next.channel, {to_nanoseconds(next.log_time), 0, std::string(next.data)}};
    } else {
      take(next);
    }
  }
  return {};
}

Result<Json> Playhead::value_of(Channel channel) {
  const Newest* sample = newest(channel);
  if (sample == nullptr) return Json();
  return values_.of({channel, 0, to_mcap_time(sample->time), to_mcap_time(sample->time), sample->octets});
}

// ---- showing ----

Result<Playhead::News> Playhead::look(nanoseconds time, bool is_whole) {
  if (const auto moved = move(time); !moved) return moved.error();
  if (is_whole) {
    shown_tf_ = shown_static_ = seen_poses_ = 0;
    shown_shapes_.reset();
    for (auto& [number, watch] : watches_) watch.shown = UINT64_MAX;
  }
  News news;
  if (const auto shown = show_poses(news); !shown) return shown.error();
  for (auto& [number, watch] : watches_) {
    if (const auto shown = show(number, watch, news); !shown) return shown.error();
  }
  return news;
}

Result<void> Playhead::read_first_shapes() {
  if (std::exchange(has_first_shapes_, true)) return {};
  reader_.seek({{*shapes_}});
  is_reading_on_ = false;
  const auto message = reader_.next();
  if (!message) return message.error();
  if (!message->has_value()) return {};
  const auto value = values_.of(**message);
  if (!value) return value.error();
  late_.begin(*value);
  return {};
}

// True when other models are there than a moment ago.
Result<bool> Playhead::show_late(News& news) {
  const Newest* sample = shapes_ ? newest(*shapes_) : nullptr;
  if (sample == nullptr || sample->time == shown_shapes_) return false;
  if (const auto read = read_first_shapes(); !read) return read.error();
  const auto value = value_of(*shapes_);
  if (!value) return value.error();
  late_.take(*value, *scene_);
  shown_shapes_ = sample->time;
  news.push_back({"late", text_frame(to_text(late_.event(*scene_)))});
  return true;
}

Result<void> Playhead::show_poses(News& news) {
  if (!scene_) return {};
  const auto has_others = show_late(news);
  if (!has_others) return has_others.error();
  bool is_other = *has_others;
  for (const auto& [channel, shown] : {std::pair(tf_static_, &shown_static_), std::pair(tf_, &shown_tf_)}) {
    const Newest* sample = channel ? newest(*channel) : nullptr;
    if (sample == nullptr || sample->number == *shown) continue;
    const auto value = value_of(*channel);
    if (!value) return value.error();
    places_.take(*value);
    *shown = sample->number;
    is_other = true;
  }
  if (!is_other) return {};
  board_.update(scene_->version, now_ - facts_->zero, places_.of(*scene_, late_.frames()));
  if (auto frame = board_.frame_since(seen_poses_)) news.push_back({"poses", binary_frame(std::move(*frame))});
  return {};
}

Result<void> Playhead::show(std::uint32_t number, Watch& watch, News& news) {
  std::uint64_t latest = 0;
  nanoseconds time{0};
  for (const Channel channel : watch.channels) {
    const Newest* sample = newest(channel);
    if (sample == nullptr || sample->number <= latest) continue;
    latest = sample->number;
    time = sample->time;
  }
  if (latest == watch.shown) return {};
  watch.shown = latest;
  if (latest == 0) {
    news.push_back({values_key(number), event(number, {{"error", "no data up to this time"}})});
    return {};
  }
  if (watch.is_picture) {
    auto frame = picture(number, watch.channels[0]);
    news.push_back({values_key(number), frame ? binary_frame(std::move(*frame)) : event(number, {{"error", frame.error().message}})});
    return {};
  }
  Json value;
  if (watch.channels.size() == 1) {
    auto one = value_of(watch.channels[0]);
    if (!one) return one.error();
    value = std::move(*one);
  } else {  // a ring of sonars, as one
    value = {{"ranges", Json::array()}};
    for (const Channel channel : watch.channels) {
      const auto one = value_of(channel);
      if (!one) return one.error();
      value["ranges"].push_back(member_at(*one, "range"));
    }
  }
  Json times = Json::array({facts_->seconds(time)});
  if (watch.members.empty()) {
    news.push_back({values_key(number), event(number, {{"t", std::move(times)}, {"value", std::move(value)}})});
    return {};
  }
  Json row = Json::array();
  for (const auto& member : watch.members) row.push_back(member_at(value, member));
  news.push_back({values_key(number), event(number, {{"t", std::move(times)}, {"v", Json::array({std::move(row)})}})});
  return {};
}

Result<std::string> Playhead::picture(std::uint32_t number, Channel channel) {
  const Newest& sample = *newest(channel);
  const auto& schema = reader_.channels().at(channel).schema;
  const auto found = reader_.schemas().find(schema);
  const auto jpeg = jpeg_in_message(found == reader_.schemas().end() ? "" : found->second.name, sample.octets);
  if (!jpeg) return jpeg.error();
  std::string frame{recorded_picture_octet, 0, 0, 0};
  put_u32(frame, number);
  put_u64(frame, static_cast<std::uint64_t>(std::max<std::int64_t>((sample.time - facts_->zero).count(), 0)));
  return frame.append(*jpeg);
}

// ---- wishes ----

Result<Playhead::News> Playhead::begin(std::uint32_t number, Watch watch) {
  if (watches_.size() >= max_watches && !watches_.contains(number)) return Error{"watch: 512 signals are watched already"};
  auto& kept = watches_[number] = std::move(watch);
  kept.shown = UINT64_MAX;  // whatever it is, it was not shown
  if (const auto found = find(kept.channels, std::max(now_, facts_->from)); !found) return found.error();
  News news;
  if (const auto shown = show(number, kept, news); !shown) return shown.error();
  return news;
}

Result<Playhead::News> Playhead::watch(std::uint32_t number, const WatchOrder& order) {
  Watch watch;
  watch.members = order.members;
  if (const auto channel = channel_of(order.topic)) {
    watch.channels = {*channel};
  } else {
    for (std::size_t i = 0; i < max_sonars; ++i) {
      const auto one = channel_of(order.topic + "/" + std::to_string(i));
      if (!one) break;
      watch.channels.push_back(*one);
    }
  }
  if (watch.channels.empty()) {
    watches_.erase(number);
    return News{{values_key(number), event(number, {{"error", "it was not recorded"}})}};
  }
  return begin(number, std::move(watch));
}

Result<Playhead::News> Playhead::watch_picture(std::uint32_t number, const std::string& iface) {
  const auto camera = camera_name(iface);
  for (const auto& type : camera.types) {
    const auto channel = channel_of(iface_topic(type, camera.iface) + "/image");
    if (!channel) continue;
    Watch watch;
    watch.channels = {*channel};
    watch.is_picture = true;
    return begin(number, std::move(watch));
  }
  watches_.erase(number);
  return News{{values_key(number), event(number, {{"error", "camera " + iface + ": its pictures were not recorded"}})}};
}

void Playhead::unwatch(std::uint32_t number) { watches_.erase(number); }

Result<std::map<std::string, std::string>> Playhead::parameters(const std::string& instance) {
  std::map<std::string, std::string> found;
  const auto channel = channel_of("/rtc/" + instance + "/configuration");
  if (!channel) return found;
  reader_.seek({{*channel}, to_mcap_time(facts_->from), to_mcap_time(std::max(now_, facts_->from))});
  is_reading_on_ = false;
  for (;;) {
    const auto message = reader_.next();
    if (!message) return message.error();
    if (!message->has_value()) return found;
    const auto value = values_.of(**message);
    if (!value) return value.error();
    for (const auto& [name, text] : value->at("values").items()) found[name] = text.get<std::string>();
  }
}

}  // namespace studio
