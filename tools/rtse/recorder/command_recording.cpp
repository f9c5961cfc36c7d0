// recording info, ls, cat, export, compare, repair.
#include <algorithm>
#include <filesystem>
#include <functional>
#include <iostream>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "base/command_line.h"
#include "base/descriptors.h"
#include "base/output_name.h"
#include "base/text.h"
#include "base/valid_file.h"
#include "recording/compare.h"
#include "recording/mcap/mcap.h"
#include "recording/ring.h"
#include "recording/sample_export.h"
#include "recording/sample_text.h"
#include "recording/selection.h"
#include "rtse/command.h"
#include "rtse/output.h"
#include "rtse/recorder/recorder_commands.h"
#include "run/run_page.h"

namespace recorder {

namespace {

using tools::Console;
using tools::Session;

// ---- info, ls ----

constexpr std::uint64_t max_read = 2ull << 30;  // [bytes] of all samples; of more than that the indexes have to do

// Numbers of the samples of a channel, in any order: files hold samples in an order of their own, and are read in that of their times.
class SeenNumbers {
 public:
  void add(std::uint32_t sequence) {
    if (!is_counted_) return;
    // Numbers go on at 0 after the highest.
    last_ = ranges_.empty() ? std::int64_t{sequence} : last_ + static_cast<std::int32_t>(sequence - static_cast<std::uint32_t>(last_));
    auto after = ranges_.upper_bound(last_);
    const auto before = after == ranges_.begin() ? ranges_.end() : std::prev(after);
    if (before != ranges_.end() && last_ <= before->second) return;
    const bool joins_after = after != ranges_.end() && after->first == last_ + 1;
    const std::int64_t end = joins_after ? after->second : last_;
    if (joins_after) ranges_.erase(after);
    if (before != ranges_.end() && before->second == last_ - 1) {
      before->second = end;
    } else {
      ranges_[last_] = end;
    }
    is_counted_ = ranges_.size() <= max_ranges;
  }
  // Between the lowest and the highest; nothing when there were too many gaps to remember.
  std::optional<std::uint64_t> missing() const {
    if (!is_counted_) return std::nullopt;
    std::uint64_t count = 0;
    for (auto range = ranges_.begin(); range != ranges_.end() && std::next(range) != ranges_.end(); ++range)
      count += static_cast<std::uint64_t>(std::next(range)->first - range->second - 1);
    return count;
  }

 private:
  static constexpr std::size_t max_ranges = 100'000;
  std::map<std::int64_t, std::int64_t> ranges_;  // first -> last, none beside another
  std::int64_t last_ = 0;
  bool is_counted_ = true;
};

// What a channel has, and its longest silence.
struct ChannelFacts {
  std::uint64_t samples = 0;
  bool is_read = true;  // else octets and missing samples are not known
  std::uint64_t octets = 0;
  mcap::Time first{0};
  mcap::Time last{0};
  mcap::Time longest_gap{0};
  mcap::Time longest_gap_at{0};
  SeenNumbers numbers;
};

void take_in(ChannelFacts& facts, mcap::Time time) {
  if (facts.samples == 0) {
    facts.first = time;
  } else if (const mcap::Time gap = time - facts.last; gap > facts.longest_gap) {
    facts.longest_gap = gap;
    facts.longest_gap_at = facts.last;
  }
  facts.last = time;
  ++facts.samples;
}

void take_in(ChannelFacts& facts, const mcap::Message& message) {
  facts.numbers.add(message.sequence);
  facts.octets += message.data.size();
  take_in(facts, message.log_time);
}

double rate_of(const ChannelFacts& facts) {
  const double duration = seconds(facts.last - facts.first);
  return duration > 0 ? static_cast<double>(facts.samples - 1) / duration : 0;
}

using Facts = std::map<std::uint16_t, ChannelFacts>;

// What the indexes of the messages say, which stand outside of what is compressed; nothing when the file has not all of them, or does not
// have its messages in the order of time.
std::optional<Facts> indexed_facts(mcap::Reader& reader) {
  Facts facts;
  for (const auto& [id, channel] : reader.channels()) facts[id].is_read = false;
  bool is_in_order = true;
  const bool has_all = reader.for_each_time([&](std::uint16_t channel, mcap::Time time) {
    const auto found = facts.find(channel);
    if (found == facts.end()) return;
    is_in_order = is_in_order && (found->second.samples == 0 || time >= found->second.last);
    take_in(found->second, time);
  });
  return has_all && is_in_order ? std::optional(std::move(facts)) : std::nullopt;
}

Facts facts_of(Console& console, mcap::Reader& reader, const std::string& file) {
  if (reader.uncompressed() > max_read) {
    if (auto facts = indexed_facts(reader)) return std::move(*facts);
  }
  Facts facts;
  for (const auto& [id, channel] : reader.channels()) facts[id];
  console.fail(for_each(reader, {.file = file, .topics = {}}, [&](const mcap::Message& message) {
    take_in(facts[message.channel], message);
    return true;
  }));
  return facts;
}

Json channel_json(const mcap::Reader& reader, const mcap::Channel& channel, const ChannelFacts& facts) {
  const auto schema = reader.schemas().find(channel.schema);
  const auto read = [&](std::optional<std::uint64_t> count) { return facts.is_read && count ? Json(*count) : Json(nullptr); };
  return {{"topic", channel.topic},
          {"type", schema == reader.schemas().end() ? "" : schema->second.name},
          {"encoding", channel.encoding},
          {"samples", facts.samples},
          {"octets", read(facts.octets)},
          {"rate", rate_of(facts)},
          {"first", seconds(facts.first)},
          {"last", seconds(facts.last)},
          {"missing", read(facts.numbers.missing())},
          {"longest_gap", seconds(facts.longest_gap)},
          {"longest_gap_at", seconds(facts.longest_gap_at)}};
}

void print_channel(const Json& channel) {
  char line[512];
  std::snprintf(line, sizeof line, "%-40s %-28s %8llu samples  %8.2f Hz", base::printable(channel["topic"].get<std::string>()).c_str(),
                base::printable(channel["type"].get<std::string>()).c_str(), channel["samples"].get<unsigned long long>(),
                channel["rate"].get<double>());
  std::cout << line;
  if (!channel["octets"].is_null()) {
    std::snprintf(line, sizeof line, "  %10llu bytes", channel["octets"].get<unsigned long long>());
    std::cout << line;
    if (!channel["missing"].is_null() && channel["missing"] != 0) std::cout << "  " << channel["missing"] << " missing";
  }
  std::cout << '\n';
}

void list(Console& console, const std::string& file, bool with_run) {
  auto reader = open(file, console);
  if (!reader) return console.fail(reader.error());
  const auto facts = facts_of(console, *reader, file);
  Json all = {{"file", file},
              {"library", reader->library()},
              {"samples", reader->statistics().messages},
              {"first", seconds(reader->statistics().first)},
              {"last", seconds(reader->statistics().last)}};
  all["run"] = Json::object();
  all["metadata"] = Json::array();
  if (const auto metadata = reader->metadata()) {
    for (const auto& one : *metadata) {
      Json texts = Json::object();
      for (const auto& [key, value] : one.texts) (one.name == "run" ? all["run"] : texts)[key] = value;
      if (one.name != "run") all["metadata"].push_back({{"name", one.name}, {"texts", texts}});
    }
  } else {
    console.fail(metadata.error());
  }
  all["attachments"] = Json::array();
  for (const auto& one : reader->attachments()) all["attachments"].push_back({{"name", one.name}, {"octets", one.size}});
  all["channels"] = Json::array();
  for (const auto& [id, channel] : reader->channels()) {
    const auto found = facts.find(id);
    all["channels"].push_back(channel_json(*reader, channel, found == facts.end() ? ChannelFacts{} : found->second));
  }
  if (console.json()) return console.print(with_run ? all : all["channels"]);
  if (std::ranges::any_of(facts, [](const auto& one) { return !one.second.is_read; }))
    console.warn("samples of more than " + std::to_string(max_read >> 30) +
                 " GiB are counted by their indexes: without bytes and missing ones");
  if (with_run) {
    std::cout << "file        " << file << "\nwritten by  " << base::printable(reader->library()) << "\ntime        "
              << seconds_text(reader->statistics().first) << " to " << seconds_text(reader->statistics().last) << " s\nsamples     "
              << reader->statistics().messages << '\n';
    for (const auto& [key, value] : all["run"].items())
      std::cout << "run         " << base::printable(key) << " = " << base::printable(value.get<std::string>()) << '\n';
    for (const auto& one : all["metadata"]) {
      std::cout << "metadata    " << base::printable(one["name"].get<std::string>()) << '\n';
      for (const auto& [key, value] : one["texts"].items())
        std::cout << "              " << base::printable(key) << " = " << base::printable(value.get<std::string>()) << '\n';
    }
    for (const auto& one : all["attachments"])
      std::cout << "attachment  " << base::printable(one["name"].get<std::string>()) << ", " << one["octets"] << " bytes\n";
  }
  for (const auto& channel : all["channels"]) {
    if (with_run) std::cout << "channel     ";
    print_channel(channel);
    if (with_run && channel["longest_gap"] > 0) {
      std::cout << "              longest gap " << base::format_number(channel["longest_gap"]) << " s at "
                << base::format_number(channel["longest_gap_at"]) << " s\n";
    }
  }
}

// ---- cat ----

void cat(Console& console, const Selection& selection) {
  auto reader = open(selection.file, console);
  if (!reader) return console.fail(reader.error());
  std::set<std::uint16_t> unreadable;  // told once
  SampleValues values(*reader);
  console.fail(for_each(*reader, selection, [&](const mcap::Message& message) {
    if (base::output_is_closed()) return false;
    const mcap::Channel& channel = reader->channels().at(message.channel);
    Json line{{"time", seconds(message.log_time)}, {"topic", channel.topic}, {"sequence", message.sequence}};
    if (const auto value = values.of(message)) {
      line["value"] = *value;
    } else {
      if (unreadable.insert(message.channel).second) console.fail(value.error());
      const auto schema = reader->schemas().find(channel.schema);
      line["encoding"] = channel.encoding;
      line["type"] = schema == reader->schemas().end() ? "" : schema->second.name;
      line["octets"] = message.data.size();
    }
    std::cout << json_text(line) << '\n';
    return true;
  }));
}

// ---- export ----

void export_samples(Console& console, const ExportOptions& options) {
  const auto exported = options.png ? export_pictures(options, console) : export_tables(options, console);
  if (!exported) return console.fail(exported.error());
  console.fail(exported->errors);
  if (!console.json()) std::cout << exported->files << (options.png ? " pictures in " : " tables in ") << options.folder << '\n';
}

void export_page(Console& console, const Selection& selection, tools::PageCall page) {
  page.recording = selection.file;
  const auto written = tools::write_run_page(page, nlohmann::ordered_json::object());
  if (!written) return console.fail(written.error());
  if (!console.json()) std::cout << *written;
}

// ---- compare ----

Json to_json(const Comparison& comparison) {
  if (!comparison.lonely_channels.empty()) return {{"equal", false}, {"difference", base::join(comparison.lonely_channels, ", ")}};
  Json json{{"equal", comparison.are_equal()}};
  if (comparison.first)
    json.update({{"time", seconds(comparison.first->time)}, {"difference", comparison.first->what}});
  else
    json["samples"] = comparison.samples;
  if (!comparison.not_compared.empty()) json["not_compared"] = comparison.not_compared;
  return json;
}

void compare_recordings(Console& console, const CompareOptions& options) {
  const auto comparison = compare(options, console);
  if (!comparison) return console.reject(comparison.error());
  if (!comparison->are_equal()) console.set_failed();
  for (const auto& line : comparison->not_compared) console.fail({line});
  if (console.json()) return console.print(to_json(*comparison));
  for (const auto& channel : comparison->lonely_channels) std::cout << channel << '\n';
  if (const auto& first = comparison->first)
    std::cout << "first difference at time " << seconds_text(first->time) << " s" << first->tick << ": " << first->what << '\n';
  if (comparison->lonely_channels.empty() && !comparison->first)
    std::cout << (comparison->are_equal() ? "equal: " : "equal in what can be read: ") << comparison->samples << " samples\n";
}

// ---- repair ----

// Whether there are segments of a ring, and no file that was made of them later.
bool has_newer_segments(const std::string& file, const std::vector<RingSegment>& segments) {
  std::error_code error;  // of a file that is not there: its time is the earliest
  const auto time = std::filesystem::last_write_time(file, error);
  return std::ranges::any_of(segments, [&](const RingSegment& segment) {
    std::error_code gone;
    return error || std::filesystem::last_write_time(segment.path, gone) > time;
  });
}

// The segments of a recorder that was killed.
void merge_segments(Console& console, const std::vector<RingSegment>& segments, const std::string& file, const std::string& output) {
  if (const auto at_rest = check_not_recording(segments); !at_rest) return console.fail(at_rest.error());
  const auto done = merge_ring(segments, file, output.empty() ? file : output);
  if (!done) return console.fail(done.error());
  if (!done->losses.empty())
    console.set_failed();
  else if (output.empty())
    remove_ring_segments(segments);
  if (console.json()) {
    return console.print(Json{{"samples", done->samples},
                              {"pieces", segments.size()},
                              {"samples_lost", done->samples_lost},
                              {"damage", base::join(done->losses, "\n")}});
  }
  std::cout << done->samples << " samples kept of " << segment_names(segments) << '\n';
  for (const auto& line : done->losses) std::cout << line << '\n';
  if (!done->losses.empty()) std::cout << "the segments are kept\n";
}

void repair(Console& console, const std::string& file, const std::string& output) {
  if (const auto segments = ring_segments(file); has_newer_segments(file, segments)) return merge_segments(console, segments, file, output);
  const auto done = mcap::repair(file, output.empty() ? file : output);
  if (!done) return console.fail(done.error());
  if (done->has_losses()) console.set_failed();
  if (console.json()) {
    Json json = {{"samples", done->messages},
                 {"octets_lost", done->octets_lost},
                 {"broken_chunks", done->broken_chunks},
                 {"samples_lost", nullptr},
                 {"attachments_lost", done->attachments_lost},
                 {"metadata_lost", done->metadata_lost},
                 {"damage", done->damage.value_or("")}};
    if (done->messages_lost) json["samples_lost"] = *done->messages_lost;
    return console.print(json);
  }
  std::cout << done->messages << " samples kept, " << done->octets_lost << " bytes lost";
  const std::string samples = done->messages_lost ? std::to_string(*done->messages_lost) + " samples" : "an unknown number of samples";
  if (done->broken_chunks > 0)
    std::cout << ", " << done->broken_chunks << (done->broken_chunks == 1 ? " broken chunk with " : " broken chunks with ") << samples;
  else if (done->messages_lost != 0)
    std::cout << ", " << samples << " lost";
  if (done->attachments_lost > 0) std::cout << ", " << done->attachments_lost << " attachments lost";
  if (done->metadata_lost > 0) std::cout << ", " << done->metadata_lost << " metadata lost";
  std::cout << '\n';
  if (done->damage) std::cout << *done->damage << '\n';
}

void add_selection(base::Command& command, Selection& selection) {
  command.add_option("FILE", selection.file, "Recording")->required()->check(base::valid_file(recording_format_problem));
  command.add_option("CHANNEL", selection.topics, "Topics, COMPONENT:PORT or patterns (default: all)");
  command.add_option("--from", selection.from_s, "Start time [s]")->seconds_between(0.0, 1e10);
  command.add_option("--to", selection.to_s, "End time [s]")->seconds_between(0.0, 1e10);
}

}  // namespace

void add_recording(base::Command& app, tools::Chosen& chosen) {
  auto* recording = app.add_subcommand("recording", "Inspect recordings");
  recording->require_subcommand(1);
  const auto choose = [&chosen](base::Command* command, std::function<void(const Session&, Console&)> work) {
    command->callback([&chosen, work = std::move(work)] {
      chosen.needs_orb = false;
      chosen.work = work;
    });
  };
  for (const bool with_run : {true, false}) {
    auto* command = with_run ? recording->add_subcommand("info", "Show duration, run, attachments, channels and gaps")
                             : recording->add_subcommand("ls", "List the channels");
    auto file = std::make_shared<std::string>();
    command->add_option("FILE", *file, "Recording")->required()->check(base::valid_file(recording_format_problem));
    choose(command, [file, with_run](const Session&, Console& console) { list(console, *file, with_run); });
  }
  auto* cat_command = recording->add_subcommand("cat", "Print samples as JSON, one per line");
  auto selection = std::make_shared<Selection>();
  add_selection(*cat_command, *selection);
  cat_command->add_option("-n,--count", selection->count, "Stop after N samples")->check(base::number_between(0, 1e9));
  choose(cat_command, [selection](const Session&, Console& console) { cat(console, *selection); });

  auto* export_command = recording->add_subcommand("export", "Write a CSV table per channel, the camera images, or one HTML page");
  auto exported = std::make_shared<ExportOptions>();
  add_selection(*export_command, exported->selection);
  auto page = std::make_shared<tools::PageCall>();
  export_command->add_option("-o,--output", exported->folder, "Output folder")->check(base::output_name());
  export_command->add_flag("--png", exported->png, "Write the camera images as PNG files instead of tables");
  export_command->add_option("--html", page->file, "Write the whole recording as this HTML page for any browser")
      ->check(base::output_name());
  tools::add_page_options(*export_command, *page);
  choose(export_command, [exported, page](const Session&, Console& console) {
    if (page->file.empty() == exported->folder.empty()) return console.reject({"export: expected either --output FOLDER or --html FILE"});
    page->file.empty() ? export_samples(console, *exported) : export_page(console, exported->selection, *page);
  });

  auto* compare_command = recording->add_subcommand("compare", "Name the first difference of two recordings");
  auto compared = std::make_shared<CompareOptions>();
  compare_command->add_option("A", compared->first, "Recording")->required()->check(base::valid_file(recording_format_problem));
  compare_command->add_option("B", compared->second, "Recording to compare with")
      ->required()
      ->check(base::valid_file(recording_format_problem));
  compare_command->add_option("--channel", compared->topics, "Compare only these topics, COMPONENT:PORT or patterns");
  compare_command->add_option("--ignore", compared->tolerated.ignored, "Members to ignore, e.g. tm");
  auto tolerances = std::make_shared<std::vector<std::string>>();
  compare_command->add_option("--tolerance", *tolerances, "Absolute tolerance: MEMBER=EPS, or EPS for all members")
      ->allow_extra_args(false)
      ->check([](const std::string& text) {
        const auto parsed = parse_tolerance(text);
        return parsed ? std::string() : parsed.error().message;
      });
  choose(compare_command, [compared, tolerances](const Session&, Console& console) {
    for (const auto& text : *tolerances) compared->tolerated.tolerances.insert(*parse_tolerance(text));
    compare_recordings(console, *compared);
  });

  auto* repair_command =
      recording->add_subcommand("repair", "Rebuild the summary of a truncated file, or merge the segments of a ring recording");
  auto file = std::make_shared<std::string>();
  auto output = std::make_shared<std::string>();
  const auto no_ring_either = [](const std::string& path) {
    return ring_segments(path).empty() ? recording_format_problem(path) : std::string();
  };
  repair_command->add_option("FILE", *file, "Recording")->required()->check(base::valid_file(no_ring_either));
  repair_command->add_option("-o,--output", *output, "Output file (default: FILE)")->check(base::output_name());
  choose(repair_command, [file, output](const Session&, Console& console) { repair(console, *file, *output); });
}

}  // namespace recorder
