// The session that viewers see: the system that the program was started for, or a recording that a viewer opened. All viewers see the same;
// every viewer with write access can change it. Only recordings in or below the start folder are opened. The loop's thread only.
#pragma once

#include <boost/asio/io_context.hpp>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "studio/client_message.h"
#include "studio/recorded_studio.h"
#include "studio/web.h"
#include "studio/workers.h"

namespace studio {

struct SessionHubOptions {
  std::filesystem::path folder;  // of recordings
  bool is_read_only = false;     // nothing is opened
  std::string recording{};       // that the program was started for, if it was
};

// Files with this extension in a folder and three levels below it, the newest first, at most 200: [{file, size, time [s since 1970]}],
// names relative to it.
Json files_in(const std::filesystem::path& folder, const std::string& extension);
// The file of this name in the folder, or below it. An error for all others, whatever is there. `what`: for the error.
base::Result<std::filesystem::path> file_in(const std::filesystem::path& folder, const std::string& what, const std::string& name);

class SessionHub {
 public:
  // `first`: what is shown as long as nobody opens anything; its owner outlives the hub.
  SessionHub(boost::asio::io_context& loop, WebHandlers first, SessionHubOptions options);

  // For the web server; used as long as the hub lives.
  WebHandlers handlers();

 private:
  using Facts = std::shared_ptr<const RecordingFacts>;
  void hear(Viewer& viewer, std::string_view text);
  bool takes(Viewer& viewer, const Request& request);
  using Work = std::function<base::Result<Json>()>;
  // On a worker; the answer comes from there.
  void read(const Viewer& viewer, std::int64_t id, Workers& workers, Work work, const std::string& command = "");
  void list(const Viewer& viewer, std::int64_t id, const std::string& extension);
  void show_campaign(const Viewer& viewer, const Request& request);
  void replay(const Viewer& viewer, const Request& request);
  void open(const Viewer& viewer, const Request& request);
  void close(const Viewer& viewer, std::int64_t id);
  void has_read(std::uint64_t viewer, std::int64_t id, const std::string& name, const base::Result<Facts>& facts);
  void show(WebHandlers handlers);
  void answer(std::uint64_t viewer, std::int64_t id, const base::Result<Json>& result, const std::string& command = "");
  void clear_away();

  boost::asio::io_context& loop_;
  const SessionHubOptions options_;
  const WebHandlers first_;
  WebHandlers now_;
  std::string opened_;  // name of the recording; empty: the first show
  std::map<std::uint64_t, std::shared_ptr<Viewer>> viewers_;
  std::unique_ptr<RecordedStudio> recording_;
  std::vector<std::unique_ptr<RecordedStudio>> ended_;  // those that work for them may still come back to
  std::unique_ptr<Workers> reading_, replaying_;        // last: they end before what they post to
};

}  // namespace studio
