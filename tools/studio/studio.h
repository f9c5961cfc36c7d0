// Caches the latest state of the system, sends it to new viewers, and executes their requests. The loop's thread only; its watches and
// workers post to the loop.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "studio/acts.h"
#include "studio/channel_book.h"
#include "studio/client_message.h"
#include "studio/drives.h"
#include "studio/log_book.h"
#include "studio/parameters.h"
#include "studio/pictures.h"
#include "studio/pose_board.h"
#include "studio/publications.h"
#include "studio/signal_book.h"
#include "studio/signals.h"
#include "studio/system_watch.h"
#include "studio/web.h"
#include "studio/workers.h"
#include "studio/world_watch.h"

namespace studio {

struct StudioOptions {
  std::string name_server = "localhost:2809";
  std::uint32_t server_id = 0;
  std::chrono::milliseconds call_limit{1000};
  bool is_read_only = false;
};

class Studio {
 public:
  Studio(boost::asio::io_context& loop, CORBA::ORB_ptr orb, const StudioOptions& options);
  ~Studio();

  // For the web server; used as long as the studio lives.
  WebHandlers handlers();

 private:
  struct ClientSession {
    std::shared_ptr<Viewer> viewer;
    std::uint64_t seen_poses = 0, seen_lines = 0;
    std::size_t open_requests = 0;
    std::map<std::uint32_t, channels::ChannelId> subscriptions;
    bool sees_graph = false;
    bool sees_parameters = false;
    std::set<std::string> parameters;  // none: all
    Parameters seen_parameters;        // that were sent last
  };
  void join(std::shared_ptr<Viewer> viewer);
  void leave(Viewer& viewer);
  void hear(Viewer& viewer, std::string_view text);
  void handle(ClientSession& session, const Request& request);
  void handle_here(ClientSession& session, const Request& request);
  void handle_drive(ClientSession& session, const Request& request);
  void handle_joints(ClientSession& session, const Request& request);
  void handle_release(ClientSession& session, const Request& request);
  base::Result<Json> start_watch(const ClientSession& session, const Json& args);
  base::Result<Json> start_pictures(const ClientSession& session, const Json& args);
  base::Result<Json> end_watch(const ClientSession& session, const Json& args);
  void start_act(ClientSession& session, const Request& request, const Act& act);
  using Finish = std::function<void(ClientSession&, const base::Result<Json>&)>;
  // Runs the plan on a worker; `finish` on the loop, unless the viewer has left. Fails at once when too much is under way.
  base::Result<void> carry_out(ClientSession& session, const std::string& subject, Plan plan, Finish finish);
  bool give(const std::string& subject, std::function<void()> work);
  void give_next(const std::string& subject);
  void finish_act(const std::string& subject, std::uint64_t session, Plan::Touches touches, const Finish& finish,
                  const base::Result<Json>& result);
  void answer(ClientSession& session, std::int64_t id, const base::Result<Json>& result, const std::string& command = "");
  bool fetch(const std::string& path, const std::string& query, const Answer& answer);

  void tell(const std::string& key, std::string text);  // to all who speak our protocol, and keeps it for those who come
  void tell_world(std::string text);
  void tell_time(std::string text);
  void tell_system(SystemNews news);
  void tell_poses(std::shared_ptr<const Poses> poses);
  void greet_foxglove(ClientSession& session);
  void hear_foxglove(ClientSession& session, const ClientMessage& message);
  void take_frame(Viewer& viewer, std::string_view octets);
  void advertise(ClientSession& session, const Advertise& message);
  void unadvertise(ClientSession& session, const Unadvertise& message);
  void get_parameters(ClientSession& session, const GetParameters& message);
  void set_parameters(ClientSession& session, const SetParameters& message);
  void see_parameters(ClientSession& session, const ParameterWish& message);
  void look_at_parameters();
  void tell_parameters(const Parameters& now);
  void call_service(ClientSession& session, const ServiceCall& call);
  void warn(ClientSession& session, const std::string& line);
  void subscribe(ClientSession& session, const Subscribe& message);
  void unsubscribe(ClientSession& session, const Unsubscribe& message);
  void see_graph(ClientSession& session, bool is_wanted);
  void tell_graph();
  void want_channels(const std::map<std::uint32_t, channels::ChannelId>& changed);
  void tell_channel(channels::ChannelId id, const channels::Channel& channel);
  void tell_no_channel(channels::ChannelId id);
  void tell_sample(const channels::Sample& sample);
  void tell_picture(const WatchKey& key, std::string frame);
  void tell_values(const WatchKey& key, std::string event);
  void tell_clock(std::chrono::nanoseconds time);
  void send_poses(ClientSession& session);
  void send_lines(ClientSession& session);
  void tend();

  boost::asio::io_context& loop_;
  const StudioOptions options_;
  const ActContext context_;
  std::string session_;
  std::map<std::uint64_t, ClientSession> sessions_;
  std::map<std::string, Frame> newest_;  // events by key
  Json system_event_, graph_;            // of the newest structure
  PoseBoard board_;
  SignalBook book_;
  Drives drives_;
  unsigned tended_ = 0;
  std::map<std::string, std::deque<std::function<void()>>> lines_;  // by what acts are about: one is under way, these wait for it
  std::vector<std::string> stalled_;                                // of lines_: the workers had too much for their next
  boost::asio::steady_timer timer_;
  std::unique_ptr<SystemWatch> system_;
  std::unique_ptr<WorldWatch> world_;
  std::unique_ptr<Workers> workers_;  // what they do uses the rest
  std::unique_ptr<Signals> signals_;
  std::unique_ptr<Pictures> pictures_;
  std::unique_ptr<ChannelBook> channels_;
  std::unique_ptr<LogBook> logs_;
  std::unique_ptr<Publications> publications_;
  bool looks_at_parameters_ = false;  // a worker reads them
};

}  // namespace studio
