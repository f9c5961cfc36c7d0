// A recording for viewers: each has a playhead, requests times (request "look") and gets the values in the events and frames of a live run.
// Changes are rejected. The loop's thread only; workers read the file and post to the loop.
#pragma once

#include <boost/asio/io_context.hpp>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "studio/client_message.h"
#include "studio/playhead.h"
#include "studio/recorded_series.h"
#include "studio/web.h"
#include "studio/workers.h"

namespace studio {

class RecordedStudio {
 public:
  // An error when the file is no recording.
  static base::Result<std::unique_ptr<RecordedStudio>> open(boost::asio::io_context& loop, const std::string& file);

  static std::unique_ptr<RecordedStudio> of(boost::asio::io_context& loop, std::shared_ptr<const RecordingFacts> facts);

  // For the web server; used as long as the object lives.
  WebHandlers handlers();
  // No work comes back to it: it may end.
  bool is_idle() const { return jobs_ == 0; }

 private:
  struct ClientSession {
    std::shared_ptr<Viewer> viewer;
    std::shared_ptr<Playhead> playhead;  // of the reading thread
    std::size_t open_requests = 0;
  };
  using Scene = std::shared_ptr<const RecordedScene>;
  using Work = std::function<base::Result<Json>(Playhead&, Playhead::News&)>;

  RecordedStudio(boost::asio::io_context& loop, std::shared_ptr<const RecordingFacts> facts);
  void join(std::shared_ptr<Viewer> viewer);
  void greet(ClientSession& session);
  void leave(Viewer& viewer);
  void hear(Viewer& viewer, std::string_view text);
  void handle(ClientSession& session, const Request& request);
  base::Result<Work> work_for(const Request& request) const;
  base::Result<SeriesOrder> series_of(const Json& args) const;
  void start(ClientSession& session, std::int64_t id, Work work);
  void start_series(ClientSession& session, std::int64_t id, SeriesOrder order);
  void finish(std::uint64_t viewer, std::int64_t id, const base::Result<Json>& result, const Playhead::News& news);
  void make_scene();
  void has_scene(const base::Result<Scene>& scene);
  bool fetch(const std::string& path, const std::string& query, const Answer& answer);
  std::string world_event() const;

  boost::asio::io_context& loop_;
  const std::shared_ptr<const RecordingFacts> facts_;
  const std::string session_;
  std::map<std::uint64_t, ClientSession> sessions_;
  std::size_t jobs_ = 0;  // given to workers, and not back yet
  Scene scene_;
  std::string scene_problem_;                     // why there is none; empty while it is made
  std::vector<std::pair<bool, Answer>> waiting_;  // for the scene; true: with collisions
  std::unique_ptr<Workers> makers_;               // of the scene and of plots
  std::unique_ptr<Workers> reading_;              // one thread: all playheads are its
};

}  // namespace studio
