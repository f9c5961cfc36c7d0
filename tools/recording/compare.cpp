#include "recording/compare.h"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "base/text.h"
#include "recording/mcap/mcap.h"
#include "recording/sample_text.h"
#include "recording/selection.h"

namespace recorder {
namespace {

// The messages of one recording, channel by channel of its topic.
class Side {
 public:
  Side(mcap::Reader reader, const Selection& selection) : reader_(std::move(reader)), selection_(selection), values_(reader_) {}
  base::Result<void> begin() {
    auto query = query_of(reader_, selection_);
    if (!query) return query.error();
    for (const auto& [id, channel] : reader_.channels()) {
      const auto wish = channel.metadata.find("compare");
      const bool is_meant = selection_.topics.empty() ? wish == channel.metadata.end() || wish->second != "no"
                                                      : std::ranges::find(query->channels, id) != query->channels.end();
      if (is_meant) chosen_.emplace(channel.topic, channel.metadata.contains("late") || channel.topic == "/hashes");
    }
    others_ = others_of(reader_);
    return {};
  }
  // The samples of a topic have stamps of their sender's own clock.
  bool has_own_stamps(const std::string& topic) const {
    return std::ranges::any_of(reader_.channels(), [&](const auto& one) {
      const auto component = one.second.metadata.find("component");
      return one.second.topic == topic && component != one.second.metadata.end() && std::ranges::count(others_, component->second) > 0;
    });
  }
  // Those that count, and whether they are about the run rather than of it: a hash log is there or not.
  const std::map<std::string, bool>& chosen() const { return chosen_; }
  void leave_out(const std::string& topic) { chosen_.erase(topic); }
  void seek() {
    reader_.leave_out_broken_chunks();
    mcap::Query query{.channels = {0}};  // none but these
    for (const auto& [id, channel] : reader_.channels()) {
      if (chosen_.contains(channel.topic)) query.channels.push_back(id);
    }
    reader_.seek(std::move(query));
  }
  base::Result<std::optional<mcap::Message>> next() { return reader_.next(); }
  const mcap::Reader& reader() const { return reader_; }
  SampleValues& values() { return values_; }
  const std::string& topic(const mcap::Message& message) const { return reader_.channels().at(message.channel).topic; }

 private:
  mcap::Reader reader_;
  Selection selection_;
  SampleValues values_;
  std::map<std::string, bool> chosen_;
  std::vector<std::string> others_;
};

struct Entry {
  mcap::Time time{0};
  std::string topic;
  std::string octets;
};

bool is_in(const std::vector<mcap::Reader::BrokenChunk>& chunks, mcap::Time time) {
  return std::ranges::any_of(chunks, [&](const auto& chunk) { return time >= chunk.first && time <= chunk.last; });
}

// All messages of one moment, in the order of topics: within a moment the order of arrival says nothing.
class Moments {
 public:
  explicit Moments(Side& side) : side_(side) {}
  const std::vector<Entry>& now() const { return now_; }
  bool is_at_end() const { return now_.empty(); }
  base::Result<void> go_on() {
    auto moment = read();
    if (!moment) return moment.error();
    now_ = std::move(*moment);
    return {};
  }
  // Whether one of both recordings has this moment in a chunk that cannot be read.
  bool is_unread(const Side& other) const {
    return !is_at_end() && (is_in(side_.reader().broken_chunks(), now_[0].time) || is_in(other.reader().broken_chunks(), now_[0].time));
  }

 private:
  base::Result<std::vector<Entry>> read() {
    std::vector<Entry> moment;
    if (ahead_) moment.push_back(std::move(*std::exchange(ahead_, std::nullopt)));
    for (;;) {
      const auto message = side_.next();
      if (!message) return message.error();
      if (!message->has_value()) break;
      Entry entry{(*message)->log_time, side_.topic(**message), std::string((*message)->data)};
      if (!moment.empty() && entry.time != moment.front().time) {
        ahead_ = std::move(entry);
        break;
      }
      moment.push_back(std::move(entry));
    }
    std::stable_sort(moment.begin(), moment.end(), [](const Entry& a, const Entry& b) { return a.topic < b.topic; });
    return moment;
  }

  Side& side_;
  std::vector<Entry> now_;
  std::optional<Entry> ahead_;
};

// ", tick 571" of a port in lock step, whose channel says how long a tick is.
std::string tick_text(Side& side, const std::string& topic, mcap::Time time) {
  for (const auto& [id, channel] : side.reader().channels()) {
    const auto period = channel.topic == topic ? channel.metadata.find("period_ns") : channel.metadata.end();
    if (period == channel.metadata.end()) continue;
    const auto ns = base::parse_integer(period->second).value_or(0);
    if (ns > 0) return ", tick " + std::to_string(time.count() / static_cast<std::uint64_t>(ns));
  }
  return "";
}

base::Result<Json> value_of(Side& side, const Entry& entry) {
  for (const auto& [id, channel] : side.reader().channels()) {
    if (channel.topic == entry.topic) return side.values().of({id, 0, entry.time, entry.time, entry.octets});
  }
  return base::Error{"channel " + entry.topic + " is not there"};
}

std::optional<std::string> difference(const DifferenceOptions& options, Side& first, Side& second, const Entry& a, const Entry& b) {
  if (a.octets == b.octets) return std::nullopt;
  const auto left = value_of(first, a);
  const auto right = value_of(second, b);
  if (!left || !right) return "bytes differ";
  auto tolerated = options;
  if (first.has_own_stamps(a.topic) && second.has_own_stamps(b.topic)) tolerated.ignored.emplace_back("tm");
  return difference(tolerated, *left, *right);
}

// Channels that only one of them has; those of hash logs are noted and left out.
std::vector<std::string> lonely_channels(const CompareOptions& options, Side& first, Side& second, tools::Reporter& reporter) {
  std::vector<std::string> differences;
  for (const auto& [one, other, file] : {std::tuple(&first, &second, &options.first), std::tuple(&second, &first, &options.second)}) {
    const auto chosen = one->chosen();
    for (const auto& [topic, is_late] : chosen) {
      if (other->chosen().contains(topic)) continue;
      const std::string what = "channel " + base::printable(topic) + " is in " + *file + " only";
      if (!is_late) {
        differences.push_back(what);
        continue;
      }
      reporter.warn(what + ", and is left out");
      one->leave_out(topic);
    }
  }
  return differences;
}

// Both go on to their next moments, behind what cannot be read.
base::Result<void> go_on(Moments& first, Moments& second, const Side& first_side, const Side& second_side) {
  for (Moments* moments : {&first, &second}) {
    if (const auto done = moments->go_on(); !done) return done;
  }
  while (first.is_unread(second_side) || second.is_unread(first_side)) {
    if (const auto done = (first.is_unread(second_side) ? first : second).go_on(); !done) return done;
  }
  return {};
}

void note_unread(const Side& side, Comparison& comparison) {
  for (const auto& [from, to, problem] : side.reader().broken_chunks())
    comparison.not_compared.push_back("not compared from " + base::format_number(seconds(from)) + " to " +
                                      base::format_number(seconds(to)) + " s: " + problem);
}

}  // namespace

base::Result<Comparison> compare(const CompareOptions& options, tools::Reporter& reporter) {
  std::vector<std::unique_ptr<Side>> sides;
  for (const std::string& file : {options.first, options.second}) {
    auto reader = open(file, reporter);
    if (!reader) return reader.error();
    sides.push_back(std::make_unique<Side>(std::move(*reader), Selection{.file = file, .topics = options.topics}));
    if (const auto begun = sides.back()->begin(); !begun) return begun.error();
  }
  Comparison result;
  result.lonely_channels = lonely_channels(options, *sides[0], *sides[1], reporter);
  if (!result.lonely_channels.empty()) return result;
  for (const auto& side : sides) side->seek();
  Moments first(*sides[0]);
  Moments second(*sides[1]);
  const auto differ = [&](mcap::Time time, const std::string& topic, const std::string& how) {
    for (const auto& side : sides) note_unread(*side, result);
    result.first = {time, tick_text(*sides[0], topic, time), base::printable(topic) + " " + base::printable(how)};
    return result;
  };
  const auto &a = first.now(), &b = second.now();
  for (;;) {
    if (const auto done = go_on(first, second, *sides[0], *sides[1]); !done) return done.error();
    if (a.empty() && b.empty()) {
      for (const auto& side : sides) note_unread(*side, result);
      return result;
    }
    for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i) {
      const bool in_first = i < a.size() && (i >= b.size() || std::pair(a[i].time, a[i].topic) <= std::pair(b[i].time, b[i].topic));
      const bool in_second = i < b.size() && (i >= a.size() || std::pair(b[i].time, b[i].topic) <= std::pair(a[i].time, a[i].topic));
      if (!in_first || !in_second) {
        const Entry& entry = in_first ? a[i] : b[i];
        return differ(entry.time, entry.topic, "has a sample in " + (in_first ? options.first : options.second) + " only");
      }
      ++result.samples;
      if (const auto what = difference(options.tolerated, *sides[0], *sides[1], a[i], b[i])) return differ(a[i].time, a[i].topic, *what);
    }
  }
}

}  // namespace recorder
