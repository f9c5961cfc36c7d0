#include "page/run_page.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <thread>

#include "base/base64.h"
#include "base/text.h"
#include "page/failure_marks.h"
#include "page/page_file.h"
#include "page/page_samples.h"
#include "studio/playhead.h"
#include "studio/recorded_details.h"
#include "studio/recorded_scene.h"

namespace page {
namespace {

using base::Error;
using base::Result;
using std::chrono::nanoseconds;
using namespace std::chrono_literals;

// Approximate size of the text of a part, which limits the memory.
constexpr std::size_t part_size = 3U << 19U;
constexpr nanoseconds shortest_part = 200ms, longest_part = 10s;
constexpr nanoseconds pose_step(static_cast<std::int64_t>(studio::recorded_step_s * 1e9));
constexpr int growth = 4;                           // of the length from one part to the next, at most
constexpr std::string_view marker = "<!--run-->";   // in the viewer: the place of the data
constexpr nanoseconds unsettled = 2s;               // at the end of a recording that grows: samples of these times may still come
constexpr std::uintmax_t first_growth = 4U << 20U;  // [bytes] of a recording, until it is looked at
constexpr std::chrono::milliseconds look_interval{100};
constexpr double growth_share = 1.25;      // and looked at again: all looks together read a few times what there is
constexpr std::size_t max_changes = 1000;  // of the parameters of one component

Result<std::string> file_text(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(in)), {});
  if (!in) return Error{"the viewer is missing: " + path + "; it is in the package rtm-studio, and is built if there are node and npm"};
  return text;
}

std::string in_mib(std::uint64_t bytes) { return base::format_number(static_cast<double>(bytes) / (1U << 20U)) + " MiB"; }

class RunPage {
 public:
  explicit RunPage(const PageOptions& options) : options_(options), summary_(options.summary), file_(options.file, options.limit) {}

  Result<PageReport> write() {
    const auto viewer = file_text(options_.viewer);
    if (!viewer) return viewer.error();
    const auto at = viewer->find(marker);
    if (at == std::string::npos) return Error{options_.viewer + ": has no place for data"};
    if (const auto opened = file_.open(); !opened) return opened.error();
    const auto end = std::string_view(*viewer).substr(at + marker.size());
    file_.put(std::string_view(*viewer).substr(0, at));
    file_.reserve(end.size());
    if (const auto done = follow(); !done) return done.error();
    if (const auto done = put_all(); !done) return done.error();
    file_.put(end);
    if (const auto done = file_.finish(); !done) return done.error();
    return PageReport{file_.size(), left_out()};
  }

 private:
  using Facts = std::shared_ptr<const studio::RecordingFacts>;

  static Result<Facts> read(const std::string& file) {
    auto facts = studio::RecordingFacts::read(file);
    if (!facts) return facts.error();
    return std::make_shared<const studio::RecordingFacts>(std::move(*facts));
  }

  // Writes what is settled while the recording grows.
  Result<void> follow() {
    auto wanted = first_growth;
    while (is_growing()) {
      std::error_code not_there;
      const auto size = std::filesystem::file_size(options_.recording, not_there);
      if (not_there || size < wanted) {
        std::this_thread::sleep_for(look_interval);  // nobody tells of a file that grows
        continue;
      }
      wanted = static_cast<std::uintmax_t>(static_cast<double>(size) * growth_share);
      if (const auto done = put_settled(); !done) return done;
    }
    return recorded_ == RecordingState::abandoned ? Error{"the run ended without a result"} : Result<void>();
  }

  // Waits until there is time for more work.
  bool is_growing() {
    if (recorded_ == RecordingState::growing) recorded_ = options_.follow ? options_.follow(summary_) : RecordingState::complete;
    return recorded_ == RecordingState::growing;
  }

  Result<void> put_settled() {
    auto facts = read(options_.recording);
    if (!facts) return {};  // not enough of it yet
    facts_ = std::move(*facts);
    if (const auto opened = open_playhead(); !opened) return opened;
    if (!is_scene_tried_) put_scene();
    return scene_ ? put_parts(facts_->to - unsettled, false) : Result<void>();
  }

  Result<void> put_all() {
    auto facts = read(options_.recording);
    if (!facts) return facts.error();
    facts_ = std::move(*facts);
    if (!options_.second.empty()) {
      auto second = read(options_.second);
      if (!second) return second.error();
      second_ = std::move(*second);
    }
    to_ = second_ ? std::max(facts_->to, facts_->zero + (second_->to - second_->zero)) : facts_->to;
    if (const auto opened = open_playhead(); !opened) return opened;
    if (!scene_ && !has_written_scene_) put_scene();
    if (const auto opened = open_second(); !opened) return opened;
    if (const auto done = put_parts(to_, true); !done) return done;
    if (are_images_left_out_) left_out_.emplace_back("images: the page has reached its limit");
    for (auto& line : samples_->left_out()) left_out_.push_back(std::move(line));
    auto reader = mcap::Reader::open(facts_->file);
    if (!reader) return reader.error();
    reader->leave_out_broken_chunks();
    if (!facts_->damage.empty()) note_damage(facts_->damage);
    if (second_ && !second_->damage.empty()) note_damage(second_->damage);
    note_broken(samples_->broken_chunks(), *facts_);
    note_broken(playhead_->broken_chunks(), *facts_);
    if (second_) note_broken(second_samples_->broken_chunks(), *second_);
    if (second_) note_broken(second_playhead_->broken_chunks(), *second_);
    return put_rest(*reader);
  }

  void note_damage(const std::string& what) {
    if (damage_.find(what) != std::string::npos) return;
    left_out_.push_back("what is damaged in the recording: " + what);
    damage_ += (damage_.empty() ? "" : "; ") + what;
  }

  void note_broken(const std::vector<mcap::Reader::BrokenChunk>& chunks, const studio::RecordingFacts& facts) {
    for (const auto& chunk : chunks) note_damage(facts.text_of(chunk));
  }

  // Parameters and index. The last parts make room for them, but for the first, which a viewer needs.
  Result<void> put_rest(mcap::Reader& reader) {
    const auto parameters = parameters_text(reader);
    if (!parameters) return parameters.error();
    while (parts_.empty() || !file_.put_data({{"parameters", *parameters}, {"index", index_text()}})) {
      if (parts_.size() < 2) return Error{"the page needs more than its limit of " + in_mib(options_.limit) + " (--page-limit)"};
      until_ = written_.back().from;
      if (const auto done = file_.cut(written_.back().begin); !done) return done;
      written_.pop_back();
      parts_.erase(parts_.size() - 1);
    }
    return {};
  }

  Result<void> open_playhead() {
    auto playhead = studio::Playhead::open(facts_);
    if (!playhead) return playhead.error();
    playhead_ = std::move(*playhead);
    if (scene_) playhead_->set_scene(scene_);
    return {};
  }

  // A recording without a world has a page, too.
  void put_scene() {
    is_scene_tried_ = true;
    scene_problem_.clear();
    auto scene = studio::RecordedScene::make(facts_->file);
    if (!scene) {
      scene_problem_ = scene.error().message;
      return;
    }
    has_written_scene_ = true;
    if (!file_.put_data({{"world", *(*scene)->glb.octets}})) {
      scene_problem_ = "the world is larger than the limit of the page";
      left_out_.push_back(scene_problem_);
      return;
    }
    scene_ = *scene;
    playhead_->set_scene(scene_);
    (void)file_.put_data({{"collisions", *scene_->glb_with_collisions.octets}});
  }

  // The parts up to this time; `is_end`: of the recording, else no part that is longer.
  Result<void> put_parts(nanoseconds to, bool is_end) {
    if (const auto opened = open_samples(); !opened) return opened;
    while (at_ <= to && !until_) {
      const auto end = at_ + length_;
      if (!is_end && (end > to || !is_growing())) return {};
      if (const auto done = put_part(at_, is_end ? std::min(end, to + 1ns) : end); !done) return done;
    }
    return {};
  }

  Result<void> open_samples() {
    if (samples_) return samples_->resume(facts_, at_);
    auto samples = PageSamples::open(facts_, options_.camera_rate);
    if (!samples) return samples.error();
    samples_ = std::move(*samples);
    at_ = facts_->from;
    return {};
  }

  Result<void> put_part(nanoseconds from, nanoseconds to) {
    auto part = samples_->part_until(to);
    if (!part) return part.error();
    if (const auto posed = add_poses(part->members, *facts_, *playhead_, from, to); !posed) return posed;
    if (const auto added = add_second(*part, from, to); !added) return added;
    const auto begin = file_.size();
    const auto size = put_text(*part);
    if (!size) {
      until_ = from;
      return {};
    }
    written_.push_back({from, begin});
    parts_.push_back(Json::array({facts_->seconds(from), facts_->seconds(to)}));
    length_ = std::clamp(length_ * static_cast<std::int64_t>(part_size) / static_cast<std::int64_t>(*size),
                         std::max(shortest_part, length_ / growth), std::min(longest_part, length_ * growth));
    length_ -= length_ % pose_step;  // the poses of all parts are at the times of those of the first
    at_ = to;
    return {};
  }

  // The size of its text; nothing: the page has reached its limit.
  std::optional<std::size_t> put_text(PagePart& part) {
    const auto id = std::to_string(parts_.size());
    const auto text = part.text();
    if (file_.put_data({{id, text}})) return text.size();
    part.members.erase("images");
    if (!file_.put_data({{id, part.text()}})) return std::nullopt;
    are_images_left_out_ = true;
    return text.size();
  }

  Result<void> open_second() {
    if (!second_) return {};
    auto samples = PageSamples::open(second_, 0);
    if (!samples) return samples.error();
    second_samples_ = std::move(*samples);
    auto playhead = studio::Playhead::open(second_);
    if (!playhead) return playhead.error();
    second_playhead_ = std::move(*playhead);
    if (scene_) second_playhead_->set_scene(scene_);
    return {};
  }

  // The poses and samples of the second recording, whose frames name the links of the first one's world.
  Result<void> add_second(PagePart& part, nanoseconds from, nanoseconds to) {
    if (!second_) return {};
    const auto there = [&](nanoseconds time) { return second_->zero + (time - facts_->zero); };
    auto second = second_samples_->part_until(there(to));
    if (!second) return second.error();
    if (const auto posed = add_poses(second->members, *second_, *second_playhead_, there(from), there(to)); !posed) return posed.error();
    second->members.erase("images");
    second->members.erase("late");  // models that the first world does not have from its beginning have no ghosts
    part.second = second->text();
    return {};
  }

  // "poses" and "late": the frames and events that a viewer is sent, [s, base64] and [s, event]; the first of a part is complete.
  static Result<void> add_poses(Json& part, const studio::RecordingFacts& facts, studio::Playhead& playhead, nanoseconds from,
                                nanoseconds to) {
    part["poses"] = part["late"] = Json::array();
    for (auto time = from; time < to; time += pose_step) {
      const auto news = playhead.look(time, time == from);
      if (!news) return news.error();
      for (const auto& [key, frame] : *news) {
        if (frame.is_binary)
          part["poses"].push_back(Json::array({facts.seconds(time), base::to_base64(*frame.octets)}));
        else
          part["late"].push_back(Json::array({facts.seconds(time), Json::parse(*frame.octets)}));
      }
    }
    return {};
  }

  // {PATH:[[s, reply to "component"]]}, one for each time at which parameters changed.
  Result<std::string> parameters_text(mcap::Reader& reader) {
    Json all = Json::object();
    for (const auto& component : facts_->components) {
      const auto path = component.value("path", "");
      Json& changes = all[path] = Json::array();
      for (const auto time : times_of_changes(reader, component.value("instance", ""))) {
        if (const auto looked = playhead_->look(time); !looked) return looked.error();
        auto details = studio::recorded_details(*facts_, path, *playhead_);
        if (!details) return details.error();
        if (changes.empty() || changes.back()[1] != *details) changes.push_back(Json::array({facts_->seconds(time), std::move(*details)}));
      }
    }
    return studio::to_text(all);
  }

  std::vector<nanoseconds> times_of_changes(mcap::Reader& reader, const std::string& instance) const {
    std::vector<nanoseconds> times{facts_->from};
    for (const auto& [id, channel] : reader.channels()) {
      if (channel.topic != "/rtc/" + instance + "/configuration") continue;
      reader.seek({.channels = {id}});
      while (times.size() < max_changes) {
        const auto message = reader.next();
        if (!message || !message->has_value()) break;
        times.push_back(studio::to_nanoseconds((*message)->log_time));
      }
    }
    return times;
  }

  std::string index_text() {
    Json hello = studio::recorded_hello(*facts_);
    Json world = studio::recorded_world(*facts_, scene_.get(), scene_ ? "" : scene_problem_);
    // A temporary recording is gone when the page is opened.
    const auto name = std::filesystem::path(options_.file).filename().string();
    if (std::filesystem::path(options_.recording).filename().string().starts_with(name + ".")) {
      hello["recording"]["file"] = name;
      world["file"] = "";
    }
    hello["recording"]["damage"] = damage_;
    hello["recording"]["to"] = facts_->seconds(until_.value_or(to_));
    Json summary = summary_;
    mark_failures(summary, *facts_, scene_ ? scene_->models : Json::array());
    if (second_) summary["other"] = std::filesystem::path(second_->file).filename().string();
    summary["left_out"] = left_out();
    hello["page"] = std::move(summary);
    const Json index{{"hello", std::move(hello)},
                     {"system", studio::recorded_system(*facts_)},
                     {"signals", {{"op", "signals"}, {"signals", facts_->signals}}},
                     {"world", std::move(world)},
                     {"parts", parts_}};
    return studio::to_text(index);
  }

  std::vector<std::string> left_out() const {
    auto lines = left_out_;
    if (until_)
      lines.insert(lines.begin(),
                   "everything after " + base::format_number(facts_->seconds(*until_)) + " s: the page has reached its limit");
    return lines;
  }

  const PageOptions& options_;
  Json summary_;
  RecordingState recorded_ = RecordingState::growing;
  PageFile file_;
  Facts facts_, second_;
  nanoseconds to_{0};  // the end of the longer recording, in times of the first
  std::unique_ptr<PageSamples> samples_, second_samples_;
  std::unique_ptr<studio::Playhead> second_playhead_;
  std::unique_ptr<studio::Playhead> playhead_;
  std::shared_ptr<const studio::RecordedScene> scene_;
  std::string scene_problem_;
  bool is_scene_tried_ = false, has_written_scene_ = false;
  struct Written {
    nanoseconds from;
    std::uint64_t begin;  // [bytes] in the page
  };
  Json parts_ = Json::array();
  std::vector<Written> written_;                // the same parts
  nanoseconds at_{0}, length_ = shortest_part;  // of the part that comes next
  std::optional<nanoseconds> until_;
  bool are_images_left_out_ = false;
  std::string damage_;  // of the recordings
  std::vector<std::string> left_out_;
};

}  // namespace

Result<PageReport> write_run_page(const PageOptions& options) {
  try {
    return RunPage(options).write();
  } catch (const Json::exception& e) {
    return Error{base::in_quotes(options.recording) +
                 ": a sample has not the members that its channel has in recordings of rtse: " + e.what()};
  }
}

}  // namespace page
