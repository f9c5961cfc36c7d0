#include "studio/recorded_series.h"

#include "base/text.h"
#include "recording/sample_text.h"
#include "studio/signals.h"

namespace studio {
namespace {

constexpr std::chrono::seconds longest_work{10};

}  // namespace

base::Result<Json> recorded_series(const RecordingFacts& facts, const SeriesOrder& order) {
  auto reader = mcap::Reader::open(facts.file);
  if (!reader) return reader.error();
  mcap::Query query{.channels = {}, .from = to_mcap_time(order.from), .to = to_mcap_time(order.to)};
  for (const auto& [id, channel] : reader->channels()) {
    if (channel.topic == order.topic) query.channels = {id};
  }
  if (query.channels.empty()) return base::Error{"topic " + base::in_quotes(order.topic) + ": was not recorded"};
  // All of them when there are not too many; else those that begin an interval.
  const auto& counts = reader->statistics().messages_of;
  const auto count = counts.find(query.channels[0]);
  const bool takes_all = count != counts.end() && count->second <= order.points;
  const auto interval = std::chrono::nanoseconds((order.to - order.from).count() / static_cast<std::int64_t>(order.points));
  recorder::SampleValues values(*reader);
  Json times = Json::array(), rows = Json::array();
  std::uint64_t left_out = 0;
  auto next = order.from, until = order.to;
  const auto deadline = std::chrono::steady_clock::now() + longest_work;
  reader->leave_out_broken_chunks();
  reader->seek(query);
  for (;;) {
    const auto message = reader->next();
    if (!message) return message.error();
    if (!message->has_value()) break;
    const auto time = to_nanoseconds((*message)->log_time);
    if (std::chrono::steady_clock::now() > deadline) {
      until = time;
      break;
    }
    if (!takes_all && time < next) {
      ++left_out;
      continue;
    }
    while (next <= time && interval.count() > 0) next += std::max(interval, (time - next) / interval * interval);
    const auto value = values.of(**message);
    if (!value) return value.error();
    Json row = Json::array();
    for (const auto& member : order.members) row.push_back(member_at(*value, member));
    times.push_back(facts.seconds(time));
    rows.push_back(std::move(row));
  }
  return Json{{"t", std::move(times)}, {"v", std::move(rows)}, {"until", facts.seconds(until)}, {"left_out", left_out}};
}

}  // namespace studio
