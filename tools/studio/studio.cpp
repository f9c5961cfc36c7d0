#include "studio/studio.h"

#include <algorithm>
#include <boost/asio/post.hpp>
#include <utility>

#include "base/id.h"
#include "base/log.h"
#include "base/shell_word.h"
#include "base/text.h"
#include "studio/acts.h"
#include "studio/connection_graph.h"
#include "studio/foxglove.h"
#include "studio/scene.h"
#include "studio/start_hints.h"
#include "system/remote.h"

namespace studio {
namespace {

using base::Error;
using base::Result;

constexpr std::size_t worker_threads = 8;
constexpr std::chrono::milliseconds tend_period{100};
constexpr std::size_t max_queued = 256;  // acts that wait for one about the same component or model
constexpr unsigned tends_per_look = 10;  // for channels, whose simulator may have come back

constexpr const char* poses_key = "poses";
constexpr const char* lines_key = "logs";
constexpr const char* clock_key = "clock";
}  // namespace

Studio::Studio(boost::asio::io_context& loop, CORBA::ORB_ptr orb, const StudioOptions& options)
    : loop_(loop),
      options_(options),
      context_{orb, options.name_server, options.server_id, options.call_limit},
      session_(base::make_uuid()),
      drives_(options.server_id),
      timer_(loop) {
  // Turns a member into something that any thread may call.
  const auto on_loop = [this](auto member) {
    return [this, member](auto... news) {
      boost::asio::post(loop_, [this, member, ... news = std::move(news)]() mutable { (this->*member)(std::move(news)...); });
    };
  };
  const SignalSettings settings{orb, options.name_server, options.server_id, options.call_limit};
  system_ = std::make_unique<SystemWatch>(orb, options.name_server, options.call_limit, on_loop(&Studio::tell_system));
  world_ = std::make_unique<WorldWatch>(options.server_id, WorldCallbacks{on_loop(&Studio::tell_world), on_loop(&Studio::tell_time),
                                                                          on_loop(&Studio::tell_clock), on_loop(&Studio::tell_poses)});
  workers_ = std::make_unique<Workers>(worker_threads);
  signals_ = std::make_unique<Signals>(settings, *workers_, on_loop(&Studio::tell_values));
  pictures_ =
      std::make_unique<Pictures>(options.server_id, Pictures::Tellers{on_loop(&Studio::tell_picture), on_loop(&Studio::tell_values)});
  channels_ = std::make_unique<ChannelBook>(
      loop, settings, *workers_,
      ChannelBook::Tellers{[this](channels::ChannelId id, const channels::Channel& channel) { tell_channel(id, channel); },
                           [this](channels::ChannelId id) { tell_no_channel(id); },
                           [this](const channels::Sample& sample) { tell_sample(sample); }});
  logs_ = std::make_unique<LogBook>(loop, settings, *workers_, [this] {
    for (auto& [id, session] : sessions_) send_lines(session);
  });
  publications_ = std::make_unique<Publications>(loop, settings, *workers_, [this](std::uint64_t viewer, const std::string& line) {
    if (const auto found = sessions_.find(viewer); found != sessions_.end()) warn(found->second, line);
  });
  tend();
}

// Those who give work to the workers end before them.
Studio::~Studio() {
  publications_.reset();
  logs_.reset();
  channels_.reset();
  signals_.reset();
}

WebHandlers Studio::handlers() {
  return {[this](std::shared_ptr<Viewer> viewer) { join(std::move(viewer)); },
          [this](Viewer& viewer, std::string_view text) { hear(viewer, text); },
          [this](Viewer& viewer, std::string_view octets) { take_frame(viewer, octets); }, [this](Viewer& viewer) { leave(viewer); },
          [this](const std::string& path, const std::string& query, const Answer& answer) { return fetch(path, query, answer); }};
}

void Studio::join(std::shared_ptr<Viewer> viewer) {
  ClientSession& session = sessions_.try_emplace(viewer->id()).first->second;
  session.viewer = std::move(viewer);
  session.viewer->send(text_frame(server_info(session_, options_.is_read_only ? Offer::looking : Offer::acting)));
  if (!session.viewer->speaks_studio()) {
    greet_foxglove(session);
  } else {
    const auto [simulator, components] = start_hints(options_.server_id, options_.name_server);
    session.viewer->send(text_frame(to_text({{"op", "hello"},
                                             {"start", {{"simulator", simulator}, {"components", components}}},
                                             {"version", RTMSIM_VERSION},
                                             {"read_only", options_.is_read_only},
                                             {"name_server", options_.name_server},
                                             {"server_id", options_.server_id}})));
    for (const auto& [key, frame] : newest_) session.viewer->send_newest(key, frame);
    send_poses(session);
    send_lines(session);
    logs_->set_watched(true);
  }
  system_->set_watched(true);
  world_->set_watched(true);
}

void Studio::leave(Viewer& viewer) {
  drives_.release_all(viewer.id());
  publications_->close_all(viewer.id());
  signals_->unwatch_all(viewer.id());
  pictures_->unwatch_all(viewer.id());
  const auto session = sessions_.extract(viewer.id());
  if (!session.empty()) want_channels(session.mapped().subscriptions);
  logs_->set_watched(std::any_of(sessions_.begin(), sessions_.end(), [](const auto& one) { return one.second.viewer->speaks_studio(); }));
  system_->set_watched(!sessions_.empty());
  world_->set_watched(!sessions_.empty());
}

void Studio::hear(Viewer& viewer, std::string_view text) {
  const auto found = sessions_.find(viewer.id());
  if (found == sessions_.end()) return;
  const auto message = parse_message(text);
  if (!message) return viewer.send(text_frame(status(2, message.error().message)));
  if (const auto* request = std::get_if<Request>(&*message)) {
    if (viewer.speaks_studio()) return handle(found->second, *request);
    return viewer.send(text_frame(status(2, "requests need the subprotocol rtmsim.studio.v1")));
  }
  hear_foxglove(found->second, *message);
}

void Studio::handle(ClientSession& session, const Request& request) {
  Request asked = request;
  if (request.name == "command_of") {
    asked.name = text_or(request.args, "name", "");
    asked.args = request.args.value("args", Json::object());
    asked.is_dry = true;
    if (!asked.args.is_object()) return answer(session, request.id, Error{"args: expected an object"});
  }
  if (asked.name == "members") asked.args["topic"] = book_.source_of(text_or(asked.args, "topic", ""));
  if (const Act* act = find_act(asked.name)) return start_act(session, asked, *act);
  handle_here(session, asked);
}

// What needs no worker.
void Studio::handle_here(ClientSession& session, const Request& request) {
  if (request.name == "drive") return handle_drive(session, request);
  if (request.name == "move_joints") return handle_joints(session, request);
  if (request.name == "release") return handle_release(session, request);
  if (request.name == "watch") return answer(session, request.id, start_watch(session, request.args));
  if (request.name == "watch_image") return answer(session, request.id, start_pictures(session, request.args));
  if (request.name == "unwatch") return answer(session, request.id, end_watch(session, request.args));
  answer(session, request.id, Error{"request " + base::in_quotes(request.name) + ": is not known"});
}

Result<Json> Studio::start_watch(const ClientSession& session, const Json& args) {
  const auto watch = whole_number_of(args, "watch");
  if (!watch) return watch.error();
  WatchOrder order;
  auto topic = text_of(args, "topic");
  if (!topic) return topic.error();
  order.topic = book_.source_of(*topic);
  if (args.contains("members")) {
    auto members = texts_of(args, "members", 1, max_members);
    if (!members) return members.error();
    order.members = std::move(*members);
  }
  order.hz = std::clamp(number_or(args, "hz", order.hz), 0.1, 60.0);
  const auto done = signals_->watch({session.viewer->id(), *watch}, std::move(order));
  if (!done) return done.error();
  return Json::object();
}

Result<Json> Studio::start_pictures(const ClientSession& session, const Json& args) {
  const auto watch = whole_number_of(args, "watch");
  if (!watch) return watch.error();
  auto iface = text_of(args, "iface");
  if (!iface) return iface.error();
  pictures_->watch({session.viewer->id(), *watch}, {std::move(*iface), std::clamp(number_or(args, "hz", 10), 0.1, 60.0)});
  return Json::object();
}

Result<Json> Studio::end_watch(const ClientSession& session, const Json& args) {
  const auto watch = whole_number_of(args, "watch");
  if (!watch) return watch.error();
  signals_->unwatch({session.viewer->id(), *watch});
  pictures_->unwatch({session.viewer->id(), *watch});
  session.viewer->drop(values_key(*watch));
  return Json::object();
}

void Studio::tell_picture(const WatchKey& key, std::string frame) {
  const auto found = sessions_.find(key.viewer);
  if (found != sessions_.end()) found->second.viewer->send_newest(values_key(key.watch), binary_frame(std::move(frame)));
}

void Studio::tell_values(const WatchKey& key, std::string event) {
  const auto found = sessions_.find(key.viewer);
  if (found != sessions_.end()) found->second.viewer->send_newest(values_key(key.watch), text_frame(std::move(event)));
}

void Studio::start_act(ClientSession& session, const Request& request, const Act& act) {
  auto plan = act.plan(context_, request.args);
  if (!plan) return answer(session, request.id, plan.error());
  const std::string command = plan->command;
  if (request.is_dry) return answer(session, request.id, Json::object(), command);
  if (!act.is_reading && options_.is_read_only) return answer(session, request.id, read_only(), command);
  const auto started =
      carry_out(session, subject_of(act, request.args), std::move(*plan),
                [this, id = request.id, command](ClientSession& one, const Result<Json>& result) { answer(one, id, result, command); });
  if (!started) answer(session, request.id, started.error(), command);
}

Result<void> Studio::carry_out(ClientSession& session, const std::string& subject, Plan plan, Finish finish) {
  if (session.open_requests >= max_open_requests) return Error{"32 requests are not answered yet"};
  const auto work = [this, subject, viewer = session.viewer->id(), plan = std::move(plan), finish = std::move(finish)] {
    Result<Json> result = Error{"internal error (unexpected exception)"};
    try {
      result = plan.run();
    } catch (const CORBA::Exception& e) {
      result = Error{std::string("a component: ") + tools::describe(e)};
    } catch (const std::exception& e) {
      result = Error{e.what()};
    }
    boost::asio::post(loop_, [this, subject, viewer, touches = plan.touches, finish, result = std::move(result)] {
      finish_act(subject, viewer, touches, finish, result);
    });
  };
  if (!give(subject, work)) return Error{"too much is being done already; try again"};
  ++session.open_requests;
  return {};
}

// Behind what is under way about the same subject, which is given to the workers when that is done. False: too much waits.
bool Studio::give(const std::string& subject, std::function<void()> work) {
  if (subject.empty()) return workers_->give(std::move(work));
  if (const auto line = lines_.find(subject); line != lines_.end()) {
    if (line->second.size() >= max_queued) return false;
    line->second.push_back(std::move(work));
    return true;
  }
  if (!workers_->give(std::move(work))) return false;
  lines_.try_emplace(subject);
  return true;
}

// What waits longest about this subject. When the workers have too much, tend() tries again.
void Studio::give_next(const std::string& subject) {
  const auto line = lines_.find(subject);
  if (line == lines_.end()) return;
  if (line->second.empty()) {
    lines_.erase(line);
  } else if (workers_->give(line->second.front())) {
    line->second.pop_front();
  } else {
    stalled_.push_back(subject);
  }
}

void Studio::finish_act(const std::string& subject, std::uint64_t viewer, Plan::Touches touches, const Finish& finish,
                        const Result<Json>& result) {
  give_next(subject);
  if (touches == Plan::Touches::system) system_->look_now();
  if (touches == Plan::Touches::world) world_->look_now();
  const auto found = sessions_.find(viewer);
  if (found == sessions_.end()) return;
  if (found->second.open_requests > 0) --found->second.open_requests;  // 0: it has left and come back
  finish(found->second, result);
}

void Studio::answer(ClientSession& session, std::int64_t id, const Result<Json>& result, const std::string& command) {
  session.viewer->send(text_frame(reply_text(id, result, command)));
}

bool Studio::fetch(const std::string& path, const std::string& query, const Answer& answer) {
  if (path != "/world.glb") return false;
  const bool with_collisions = query_value(query, "collisions") == "1";
  const auto work = [server_id = options_.server_id, with_collisions, answer] { answer(export_scene(server_id, with_collisions)); };
  if (!workers_->give(work)) answer(refusal("too much is being done already; try again"));
  return true;
}

void Studio::tell(const std::string& key, std::string text) {
  const Frame frame = newest_[key] = text_frame(std::move(text));
  for (auto& [id, session] : sessions_) {
    if (session.viewer->speaks_studio()) session.viewer->send_newest(key, frame);
  }
}

void Studio::tell_world(std::string text) {
  const bool has_changed = book_.take_world(Json::parse(text, nullptr, false));
  tell("world", std::move(text));
  if (has_changed) tell("signals", to_text(book_.event()));
}

void Studio::tell_time(std::string text) { tell("time", std::move(text)); }

// A viewer that comes later gets the structure, and then the states as they are now.
void Studio::tell_system(SystemNews news) {
  if (!news.structure.empty()) {
    newest_.erase("system.states");
    for (auto& [id, session] : sessions_) session.viewer->drop("system.states");
    const Json system = Json::parse(news.structure, nullptr, false);
    const bool has_changed = book_.take_system(system);
    channels_->take_system(system);
    logs_->take_system(system);
    tell("system", std::move(news.structure));
    if (has_changed) tell("signals", to_text(book_.event()));
    system_event_ = system;
    tell_graph();
  } else {
    tell("system.states", std::move(news.states));
  }
}

void Studio::tell_poses(std::shared_ptr<const Poses> poses) {
  if (!poses) return board_.clear();
  if (!board_.update(poses->version, poses->time, poses->numbers)) return;
  for (auto& [id, session] : sessions_) send_poses(session);
}

// Made when its turn comes, of what is true then.
void Studio::send_poses(ClientSession& session) {
  if (!session.viewer->speaks_studio() || board_.links() == 0) return;
  session.viewer->send_newest(poses_key, [this, id = session.viewer->id()]() -> std::optional<Frame> {
    const auto found = sessions_.find(id);
    if (found == sessions_.end()) return std::nullopt;
    auto frame = board_.frame_since(found->second.seen_poses);
    if (!frame) return std::nullopt;
    return binary_frame(std::move(*frame));
  });
}

// As poses: all that has come when its turn comes.
void Studio::send_lines(ClientSession& session) {
  if (!session.viewer->speaks_studio()) return;
  session.viewer->send_newest(lines_key, [this, id = session.viewer->id()]() -> std::optional<Frame> {
    const auto found = sessions_.find(id);
    if (found == sessions_.end()) return std::nullopt;
    auto event = logs_->event_since(found->second.seen_lines);
    if (!event) return std::nullopt;
    return text_frame(std::move(*event));
  });
}

void Studio::tell_clock(std::chrono::nanoseconds time) {
  channels_->set_time(time);
  logs_->set_time(time);
  std::optional<Frame> frame;
  for (auto& [id, session] : sessions_) {
    if (session.viewer->speaks_studio()) continue;
    if (!frame) frame = binary_frame(time_data(time));
    session.viewer->send_newest(clock_key, *frame);
  }
}

void Studio::tend() {
  drives_.tend();
  for (const auto& subject : std::exchange(stalled_, {})) give_next(subject);
  if (++tended_ % tends_per_look == 0) {
    const bool is_asked =
        std::any_of(sessions_.begin(), sessions_.end(), [](const auto& session) { return !session.second.viewer->speaks_studio(); });
    is_asked ? channels_->tend() : channels_->rest();
    look_at_parameters();
  }
  timer_.expires_after(tend_period);
  timer_.async_wait([this](boost::system::error_code code) {
    if (!code) tend();
  });
}

}  // namespace studio
