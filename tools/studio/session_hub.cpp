#include "studio/session_hub.h"

#include <algorithm>
#include <boost/asio/post.hpp>
#include <chrono>

#include "base/shell_word.h"
#include "base/text.h"
#include "studio/acts.h"
#include "studio/campaigns.h"

namespace studio {
namespace {

namespace fs = std::filesystem;
using base::Error;
using base::Result;

constexpr std::size_t max_recordings = 200;
constexpr int max_entries = 20000;  // of folders that are looked through
constexpr int deepest_folder = 3;

double seconds_of(fs::file_time_type time) {
  const auto system = std::chrono::file_clock::to_sys(time);
  return std::chrono::duration<double>(system.time_since_epoch()).count();
}

}  // namespace

Json files_in(const fs::path& folder, const std::string& extension) {
  struct Found {
    std::string name;
    std::uintmax_t size;
    double time;
  };
  std::vector<Found> found;
  std::error_code problem;
  int looked_at = 0;
  for (fs::recursive_directory_iterator at(folder, fs::directory_options::skip_permission_denied, problem), end; !problem && at != end;
       at.increment(problem)) {
    if (++looked_at > max_entries) break;
    if (at.depth() >= deepest_folder || at->path().filename().string().starts_with('.')) at.disable_recursion_pending();
    std::error_code ignored;  // it was deleted meanwhile
    if (at->path().extension() != extension || !at->is_regular_file(ignored)) continue;
    const auto size = at->file_size(ignored);
    const auto time = at->last_write_time(ignored);
    if (!ignored) found.push_back({at->path().lexically_relative(folder).string(), size, seconds_of(time)});
  }
  std::ranges::sort(found, std::greater(), &Found::time);
  if (found.size() > max_recordings) found.resize(max_recordings);
  Json list = Json::array();
  for (const auto& [name, size, time] : found) list.push_back({{"file", name}, {"size", size}, {"time", time}});
  return list;
}

Result<fs::path> file_in(const fs::path& folder, const std::string& what, const std::string& name) {
  const Error refused{what + " " + base::in_quotes(name) + ": expected a file in the folder that rtm-studio was started in, or below it"};
  if (name.find('\0') != std::string::npos) return refused;
  std::error_code problem;
  const auto root = fs::canonical(folder, problem);
  if (problem) return refused;
  const auto file = fs::canonical(root / name, problem);
  if (problem || std::mismatch(root.begin(), root.end(), file.begin(), file.end()).first != root.end()) return refused;
  if (!fs::is_regular_file(file, problem)) return refused;
  return file;
}

SessionHub::SessionHub(boost::asio::io_context& loop, WebHandlers first, SessionHubOptions options)
    : loop_(loop),
      options_(std::move(options)),
      first_(std::move(first)),
      now_(first_),
      reading_(std::make_unique<Workers>(1)),
      replaying_(std::make_unique<Workers>(1)) {}

WebHandlers SessionHub::handlers() {
  return {[this](std::shared_ptr<Viewer> viewer) {
            viewers_[viewer->id()] = viewer;
            now_.joined(std::move(viewer));
          },
          [this](Viewer& viewer, std::string_view text) { hear(viewer, text); },
          [this](Viewer& viewer, std::string_view octets) { now_.sent(viewer, octets); },
          [this](Viewer& viewer) {
            now_.left(viewer);
            viewers_.erase(viewer.id());
            clear_away();
          },
          [this](const std::string& path, const std::string& query, const Answer& answer) { return now_.fetch(path, query, answer); }};
}

void SessionHub::hear(Viewer& viewer, std::string_view text) {
  // Most of what is said is for the show, and is read there.
  const auto names = [&](std::string_view word) { return text.find(word) != std::string_view::npos; };
  if (viewer.speaks_studio() && (names("recording") || names("campaign") || names("replay"))) {
    const auto message = parse_message(text);
    const auto* request = message ? std::get_if<Request>(&*message) : nullptr;
    if (request != nullptr && takes(viewer, *request)) return;
  }
  now_.said(viewer, text);
}

bool SessionHub::takes(Viewer& viewer, const Request& request) {
  if (request.name == "recordings") {
    list(viewer, request.id, ".mcap");
  } else if (request.name == "campaigns") {
    list(viewer, request.id, ".db");
  } else if (request.name == "campaign") {
    show_campaign(viewer, request);
  } else if (request.name == "replay") {
    replay(viewer, request);
  } else if (request.name == "open_recording") {
    open(viewer, request);
  } else if (request.name == "close_recording") {
    close(viewer, request.id);
  } else {
    return false;
  }
  return true;
}

void SessionHub::read(const Viewer& viewer, std::int64_t id, Workers& workers, Work work, const std::string& command) {
  const auto job = [this, to = viewer.id(), id, work = std::move(work), command] {
    Result<Json> result = Error{"internal error (unexpected exception)"};
    try {
      result = work();
    } catch (const std::exception& e) {
      result = Error{e.what()};
    }
    boost::asio::post(loop_, [this, to, id, result = std::move(result), command] { answer(to, id, result, command); });
  };
  if (!workers.give(job)) answer(viewer.id(), id, Error{"too much is being done already; try again"}, command);
}

void SessionHub::list(const Viewer& viewer, std::int64_t id, const std::string& extension) {
  read(viewer, id, *reading_, [folder = options_.folder, opened = opened_, may_open = !options_.is_read_only, extension]() -> Result<Json> {
    return Json{{"folder", folder.string()}, {"open", opened}, {"may_open", may_open}, {"files", files_in(folder, extension)}};
  });
}

void SessionHub::show_campaign(const Viewer& viewer, const Request& request) {
  const auto name = text_of(request.args, "file");
  if (!name) return answer(viewer.id(), request.id, name.error());
  std::vector<std::string> words = base::command_words({"rtse", "results"}, {*name});
  read(
      viewer, request.id, *reading_,
      [folder = options_.folder, name = *name]() -> Result<Json> {
        const auto file = file_in(folder, "campaign", name);
        if (!file) return file.error();
        return campaign_results(fs::canonical(folder), *file);
      },
      base::shell_line(words));
}

// Of the recording that is shown.
void SessionHub::replay(const Viewer& viewer, const Request& request) {
  const auto instance = text_of(request.args, "component");
  if (!instance) return answer(viewer.id(), request.id, instance.error());
  const std::string file = recording_ ? (options_.folder / opened_).string() : options_.recording;
  if (file.empty()) return answer(viewer.id(), request.id, Error{"replay: no recording is shown"});
  const auto command = replay_line(recording_ ? opened_ : file, *instance);
  if (request.is_dry) return answer(viewer.id(), request.id, Json::object(), command);
  if (options_.is_read_only) return answer(viewer.id(), request.id, Error{"this studio is read-only"}, command);
  read(
      viewer, request.id, *replaying_, [file, instance = *instance] { return replay_component(file, instance); }, command);
}

void SessionHub::open(const Viewer& viewer, const Request& request) {
  const auto name = text_of(request.args, "file");
  if (!name) return answer(viewer.id(), request.id, name.error());
  const auto command = base::shell_line(base::command_words({"rtm-studio"}, {*name}));
  if (request.is_dry) return answer(viewer.id(), request.id, Json::object(), command);
  if (options_.is_read_only) return answer(viewer.id(), request.id, Error{"this studio is read-only"}, command);
  const auto file = file_in(options_.folder, "recording", *name);
  if (!file) return answer(viewer.id(), request.id, file.error(), command);
  const auto work = [this, to = viewer.id(), id = request.id, name = *name, file = file->string()] {
    Result<Facts> facts = Error{"internal error (unexpected exception)"};
    try {
      auto read = RecordingFacts::read(file);
      facts = read ? Result<Facts>(std::make_shared<const RecordingFacts>(std::move(*read))) : Result<Facts>(read.error());
    } catch (const std::exception& e) {
      facts = Error{base::in_quotes(name) + ": " + e.what()};
    }
    boost::asio::post(loop_, [this, to, id, name, facts] { has_read(to, id, name, facts); });
  };
  if (!reading_->give(work)) answer(viewer.id(), request.id, Error{"too much is being done already; try again"}, command);
}

// The answer comes before the news, so that the client that asked can tell them apart.
void SessionHub::has_read(std::uint64_t viewer, std::int64_t id, const std::string& name, const Result<Facts>& facts) {
  const auto command = base::shell_line(base::command_words({"rtm-studio"}, {name}));
  if (!facts) return answer(viewer, id, facts.error(), command);
  answer(viewer, id, Json::object(), command);
  auto recording = RecordedStudio::of(loop_, *facts);
  show(recording->handlers());
  opened_ = name;
  if (recording_) ended_.push_back(std::move(recording_));
  recording_ = std::move(recording);
  clear_away();
}

void SessionHub::close(const Viewer& viewer, std::int64_t id) {
  if (options_.is_read_only) return answer(viewer.id(), id, Error{"this studio is read-only"});
  answer(viewer.id(), id, Json::object());
  if (!recording_) return;
  show(first_);
  opened_.clear();
  ended_.push_back(std::move(recording_));
  clear_away();
}

void SessionHub::show(WebHandlers handlers) {
  for (const auto& [id, viewer] : viewers_) now_.left(*viewer);
  now_ = std::move(handlers);
  for (const auto& [id, viewer] : viewers_) now_.joined(viewer);
}

void SessionHub::answer(std::uint64_t viewer, std::int64_t id, const Result<Json>& result, const std::string& command) {
  const auto found = viewers_.find(viewer);
  if (found == viewers_.end()) return;
  found->second->send(text_frame(reply_text(id, result, command)));
}

void SessionHub::clear_away() {
  std::erase_if(ended_, [](const auto& one) { return one->is_idle(); });
}

}  // namespace studio
