#include "page/run_page.h"

#include <libdeflate.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>

#include "base/base64.h"
#include "base/text.h"
#include "page/failure_marks.h"
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

// Parts are as long as their text has about this size, which bounds the memory: as JSON a part takes ten times of it.
constexpr std::size_t part_size = 3U << 19U;
constexpr nanoseconds shortest_part = 200ms, longest_part = 10s;
constexpr nanoseconds pose_step(static_cast<std::int64_t>(studio::recorded_step_s * 1e9));
constexpr int growth = 4;                          // of the length from one part to the next, at most
constexpr std::string_view marker = "<!--run-->";  // in the viewer: the place of the data
constexpr int compression_level = 9;
constexpr std::size_t most_changes = 1000;  // of the parameters of one component

Result<std::string> file_text(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(in)), {});
  if (!in) return Error{path + ": cannot be read; the page of rtm-studio is needed (built with node and npm)"};
  return text;
}

// The page while it is written: a file beside it, which takes its name at the end.
class PageFile {
 public:
  PageFile(std::string path, std::uint64_t limit)
      : path_(std::move(path)),
        part_path_(path_ + "." + std::to_string(::getpid()) + ".part"),
        out_(part_path_, std::ios::binary),
        limit_(limit) {}
  PageFile(const PageFile&) = delete;
  PageFile& operator=(const PageFile&) = delete;
  ~PageFile() {
    std::error_code ignored;
    if (!is_done_) std::filesystem::remove(part_path_, ignored);
  }

  void put(std::string_view text) {
    out_ << text;
    size_ += text.size();
  }
  // Zlib data in base64, in an element with this id. False: the page would exceed its limit, and nothing was written.
  bool put_data(const std::string& id, std::string_view bytes, bool is_needed = false) {
    const std::string text = "<script type=\"text/plain\" id=\"run-" + id + "\">" + base::to_base64(packed(bytes)) + "</script>\n";
    if (!is_needed && size_ + text.size() > limit_) return false;
    put(text);
    return true;
  }
  std::uint64_t size() const { return size_; }
  Result<void> finish() {
    out_.close();
    if (!out_) return Error{path_ + ": cannot be written"};
    std::error_code problem;
    std::filesystem::rename(part_path_, path_, problem);
    if (problem) return Error{path_ + ": " + problem.message()};
    is_done_ = true;
    return {};
  }

 private:
  static std::string packed(std::string_view bytes) {
    const std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> compressor(
        libdeflate_alloc_compressor(compression_level), libdeflate_free_compressor);
    std::string result(libdeflate_zlib_compress_bound(compressor.get(), bytes.size()), '\0');
    result.resize(libdeflate_zlib_compress(compressor.get(), bytes.data(), bytes.size(), result.data(), result.size()));
    return result;
  }

  const std::string path_, part_path_;
  std::ofstream out_;
  const std::uint64_t limit_;
  std::uint64_t size_ = 0;
  bool is_done_ = false;
};

class RunPage {
 public:
  using Facts = std::shared_ptr<const studio::RecordingFacts>;
  // `other`: of the second recording; null: there is none.
  RunPage(const PageOptions& options, Facts facts, Facts other)
      : options_(options), facts_(std::move(facts)), other_(std::move(other)), file_(options.file, options.limit) {
    to_ = facts_->to;
    if (other_) to_ = std::max(to_, facts_->zero + (other_->to - other_->zero));
  }

  Result<PageReport> write() {
    const auto viewer = file_text(options_.viewer);
    if (!viewer) return viewer.error();
    const auto at = viewer->find(marker);
    if (at == std::string::npos) return Error{options_.viewer + ": has no place for data"};
    file_.put(std::string_view(*viewer).substr(0, at));
    if (const auto done = put_scene(); !done) return done.error();
    if (const auto done = put_parts(); !done) return done.error();
    if (const auto done = put_parameters(); !done) return done.error();
    put_index();
    file_.put(std::string_view(*viewer).substr(at + marker.size()));
    if (const auto done = file_.finish(); !done) return done.error();
    return PageReport{file_.size(), left_out_};
  }

 private:
  // A recording without a world has a page, too.
  Result<void> put_scene() {
    auto playhead = studio::Playhead::open(facts_);
    if (!playhead) return playhead.error();
    playhead_ = std::move(*playhead);
    auto scene = studio::RecordedScene::make(facts_->file);
    if (!scene) {
      scene_problem_ = scene.error().message;
      return {};
    }
    scene_ = *scene;
    playhead_->set_scene(scene_);
    if (!file_.put_data("world", *scene_->glb.octets)) {
      scene_problem_ = "the world is larger than the limit of the page";
      left_out_.push_back(scene_problem_);
      scene_ = nullptr;
      return {};
    }
    (void)file_.put_data("collisions", *scene_->glb_with_collisions.octets);
    return {};
  }

  Result<void> put_parts() {
    const auto samples = PageSamples::open(facts_, options_.camera_rate);
    if (!samples) return samples.error();
    if (const auto opened = open_other(); !opened) return opened;
    auto length = shortest_part;
    for (auto from = facts_->from; from <= to_;) {
      const auto to = std::min(from + length, to_ + 1ns);
      auto part = (*samples)->part_until(to);
      if (!part) return part.error();
      if (const auto posed = add_poses(*part, *facts_, *playhead_, from, to); !posed) return posed.error();
      if (const auto added = add_other(*part, from, to); !added) return added.error();
      const auto size = put_part(*part);
      if (!size) {
        left_out_.push_back("everything after " + std::to_string(facts_->seconds(from)) + " s: the page has reached its limit");
        until_ = from;
        break;
      }
      parts_.push_back(Json::array({facts_->seconds(from), facts_->seconds(to)}));
      length = std::clamp(length * static_cast<std::int64_t>(part_size) / static_cast<std::int64_t>(*size),
                          std::max(shortest_part, length / growth), std::min(longest_part, length * growth));
      length -= length % pose_step;  // the poses of all parts are at the times of those of the first
      from = to;
    }
    if (are_images_left_out_) left_out_.emplace_back("images: the page has reached its limit");
    for (auto& line : (*samples)->left_out()) left_out_.push_back(std::move(line));
    return {};
  }

  // The size of its text; nothing: the page has reached its limit.
  std::optional<std::size_t> put_part(Json& part) {
    const auto id = std::to_string(parts_.size());
    const auto text = studio::to_text(part);
    if (file_.put_data(id, text)) return text.size();
    part.erase("images");
    if (!file_.put_data(id, studio::to_text(part))) return std::nullopt;
    are_images_left_out_ = true;
    return text.size();
  }

  Result<void> open_other() {
    if (!other_) return {};
    auto samples = PageSamples::open(other_, 0);
    if (!samples) return samples.error();
    other_samples_ = std::move(*samples);
    auto playhead = studio::Playhead::open(other_);
    if (!playhead) return playhead.error();
    other_playhead_ = std::move(*playhead);
    if (scene_) other_playhead_->set_scene(scene_);
    return {};
  }

  // "other": the poses and samples of the second recording, whose frames name the links of the first one's world.
  Result<void> add_other(Json& part, nanoseconds from, nanoseconds to) {
    if (!other_) return {};
    const auto there = [&](nanoseconds time) { return other_->zero + (time - facts_->zero); };
    auto other = other_samples_->part_until(there(to));
    if (!other) return other.error();
    if (const auto posed = add_poses(*other, *other_, *other_playhead_, there(from), there(to)); !posed) return posed.error();
    other->erase("images");
    other->erase("late");  // models that the first world does not have from its beginning have no ghosts
    part["other"] = std::move(*other);
    return {};
  }

  // "poses" and "late": the frames and events that a viewer is sent, [s, base64] and [s, event]; the first of a part is whole.
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
  Result<void> put_parameters() {
    auto reader = mcap::Reader::open(facts_->file);
    if (!reader) return reader.error();
    Json all = Json::object();
    for (const auto& component : facts_->components) {
      const auto path = component.value("path", "");
      Json& changes = all[path] = Json::array();
      for (const auto time : times_of_changes(*reader, component.value("instance", ""))) {
        if (const auto looked = playhead_->look(time); !looked) return looked.error();
        auto details = studio::recorded_details(*facts_, path, *playhead_);
        if (!details) return details.error();
        if (changes.empty() || changes.back()[1] != *details) changes.push_back(Json::array({facts_->seconds(time), std::move(*details)}));
      }
    }
    (void)file_.put_data("parameters", studio::to_text(all), true);
    return {};
  }

  std::vector<nanoseconds> times_of_changes(mcap::Reader& reader, const std::string& instance) const {
    std::vector<nanoseconds> times{facts_->from};
    for (const auto& [id, channel] : reader.channels()) {
      if (channel.topic != "/rtc/" + instance + "/configuration") continue;
      reader.seek({.channels = {id}});
      while (times.size() < most_changes) {
        const auto message = reader.next();
        if (!message || !message->has_value()) break;
        times.push_back(studio::to_nanoseconds((*message)->log_time));
      }
    }
    return times;
  }

  void put_index() {
    Json hello = studio::recorded_hello(*facts_);
    hello["recording"]["to"] = facts_->seconds(until_.value_or(to_));
    Json summary = options_.summary;
    mark_failures(summary, *facts_, scene_ ? scene_->models : Json::array());
    if (other_) summary["other"] = std::filesystem::path(other_->file).filename().string();
    summary["left_out"] = left_out_;
    hello["page"] = std::move(summary);
    const Json index{{"hello", std::move(hello)},
                     {"system", studio::recorded_system(*facts_)},
                     {"signals", {{"op", "signals"}, {"signals", facts_->signals}}},
                     {"world", studio::recorded_world(*facts_, scene_.get(), scene_ ? "" : scene_problem_)},
                     {"parts", parts_}};
    (void)file_.put_data("index", studio::to_text(index), true);
  }

  const PageOptions& options_;
  const Facts facts_, other_;
  nanoseconds to_{0};  // the end of the longer recording, in times of the first
  PageFile file_;
  std::unique_ptr<PageSamples> other_samples_;
  std::unique_ptr<studio::Playhead> other_playhead_;
  std::unique_ptr<studio::Playhead> playhead_;
  std::shared_ptr<const studio::RecordedScene> scene_;
  std::string scene_problem_;
  Json parts_ = Json::array();
  std::optional<nanoseconds> until_;
  bool are_images_left_out_ = false;
  std::vector<std::string> left_out_;
};

}  // namespace

Result<PageReport> write_run_page(const PageOptions& options) {
  const auto read = [](const std::string& file) -> Result<RunPage::Facts> {
    if (file.empty()) return RunPage::Facts();
    auto facts = studio::RecordingFacts::read(file);
    if (!facts) return facts.error();
    return RunPage::Facts(std::make_shared<const studio::RecordingFacts>(std::move(*facts)));
  };
  const auto facts = read(options.recording), other = read(options.other);
  if (!facts || !other) return (facts ? other : facts).error();
  try {
    return RunPage(options, *facts, *other).write();
  } catch (const Json::exception& e) {
    return Error{base::in_quotes(options.recording) +
                 ": a sample has not the members that its channel has in recordings of rtse: " + e.what()};
  }
}

}  // namespace page
