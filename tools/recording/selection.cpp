#include "recording/selection.h"

#include <fnmatch.h>

#include <cmath>

#include "base/text.h"
#include "recording/ring.h"

namespace recorder {

namespace {

constexpr std::size_t max_shown = 5;  // broken chunks

mcap::Time to_time(double seconds) { return mcap::Time(static_cast<std::uint64_t>(std::llround(seconds * 1e9))); }

}  // namespace

base::Result<mcap::Query> query_of(const mcap::Reader& reader, const Selection& selection) {
  if (selection.to_s > 0 && selection.to_s < selection.from_s)
    return base::Error{"--to " + base::format_number(selection.to_s) + ": expected a time behind --from " +
                       base::format_number(selection.from_s)};
  mcap::Query query;
  query.from = to_time(selection.from_s);
  if (selection.to_s > 0) query.to = to_time(selection.to_s);
  for (const std::string& pattern : selection.topics) {
    const auto before = query.channels.size();
    for (const auto& [id, channel] : reader.channels()) {
      const bool fits = ::fnmatch(pattern.c_str(), channel.topic.c_str(), 0) == 0 ||
                        channel.topic == "/" + pattern.substr(0, pattern.find(':')) + "/" + pattern.substr(pattern.find(':') + 1);
      if (fits) query.channels.push_back(id);
    }
    if (query.channels.size() != before) continue;
    std::vector<std::string> topics;
    for (const auto& [id, channel] : reader.channels()) topics.push_back(base::printable(channel.topic));
    return base::Error{base::in_quotes(selection.file) + ": has no channel " + base::in_quotes(pattern) +
                       "; channels: " + base::join(topics, ", ")};
  }
  return query;
}

base::Result<mcap::Reader> open(const std::string& file, tools::Reporter& reporter) {
  auto reader = open_recording(file);
  if (reader && reader->damage()) reporter.warn(*reader->damage());
  return reader;
}

std::vector<std::string> others_of(mcap::Reader& reader) {
  const auto metadata = reader.metadata();
  for (const auto& one : metadata ? *metadata : std::vector<mcap::Metadata>()) {
    const auto names = one.name == "run" ? one.texts.find("others") : one.texts.end();
    if (names != one.texts.end()) return base::split_list(names->second, '\n');
  }
  return {};
}

std::vector<base::Error> for_each(mcap::Reader& reader, const Selection& selection, const std::function<bool(const mcap::Message&)>& take) {
  auto query = query_of(reader, selection);
  if (!query) return {query.error()};
  std::vector<base::Error> errors;
  reader.seek(std::move(*query));
  std::size_t broken = 0;  // chunks
  for (int n = 0; selection.count <= 0 || n < selection.count;) {
    const auto message = reader.next();
    if (!message) {
      if (++broken <= max_shown) errors.push_back(message.error());
      continue;
    }
    if (!message->has_value() || !take(**message)) break;
    ++n;
  }
  if (broken > max_shown) errors.push_back({base::in_quotes(selection.file) + ": ... and " + std::to_string(broken - max_shown) + " more"});
  return errors;
}

}  // namespace recorder
