// The session that viewers see: the system that the program was started for, or a recording that a viewer opened. All viewers see the same;
// every viewer with write access can change it. Only recordings in or below the start folder are opened. The loop's thread only.
#pragma once

#include <boost/asio/io_context.hpp>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "studio/client_message.h"
#include "studio/recorded_studio.h"
#include "studio/web.h"
#include "studio/workers.h"

namespace studio {

struct HallOptions {
  std::filesystem::path folder;  // of recordings
  bool is_read_only = false;     // nothing is opened
};

// Recordings in a folder and three levels below it, the newest first, at most 200: [{file, size, time [s since 1970]}], names relative to
// it.
Json recordings_in(const std::filesystem::path& folder);
// The file of this name in the folder, or below it. An error for all others, whatever is there.
base::Result<std::filesystem::path> recording_in(const std::filesystem::path& folder, const std::string& name);

class Hall {
 public:
  // `first`: what is shown as long as nobody opens anything; its owner outlives the hall.
  Hall(boost::asio::io_context& loop, WebHandlers first, HallOptions options);

  // For the web server; used as long as the hall lives.
  WebHandlers handlers();

 private:
  using Facts = std::shared_ptr<const RecordingFacts>;
  void hear(Viewer& viewer, std::string_view text);
  bool takes(Viewer& viewer, const Request& request);
  void list(const Viewer& viewer, std::int64_t id);
  void open(const Viewer& viewer, const Request& request);
  void close(const Viewer& viewer, std::int64_t id);
  void has_read(std::uint64_t viewer, std::int64_t id, const std::string& name, const base::Result<Facts>& facts);
  void show(WebHandlers handlers);
  void answer(std::uint64_t viewer, std::int64_t id, const base::Result<Json>& result, const std::string& command = "");
  void clear_away();

  boost::asio::io_context& loop_;
  const HallOptions options_;
  const WebHandlers first_;
  WebHandlers now_;
  std::string opened_;  // name of the recording; empty: the first show
  std::map<std::uint64_t, std::shared_ptr<Viewer>> viewers_;
  std::unique_ptr<RecordedStudio> recording_;
  std::vector<std::unique_ptr<RecordedStudio>> ended_;  // those that work for them may still come back to
  std::unique_ptr<Workers> reading_;                    // last: ends before what it posts to
};

}  // namespace studio
