#include "studio/recorded_studio.h"

#include <algorithm>
#include <boost/asio/post.hpp>
#include <cmath>
#include <filesystem>

#include "base/id.h"
#include "base/text.h"
#include "studio/foxglove.h"
#include "studio/recorded_details.h"
#include "studio/scene.h"

namespace studio {
namespace {

using base::Error;
using base::Result;

constexpr std::size_t maker_threads = 2;
constexpr std::size_t max_points = 20000;  // of a line of a plot

}  // namespace

Result<std::unique_ptr<RecordedStudio>> RecordedStudio::open(boost::asio::io_context& loop, const std::string& file) {
  auto facts = RecordingFacts::read(file);
  if (!facts) return facts.error();
  return of(loop, std::make_shared<const RecordingFacts>(std::move(*facts)));
}

std::unique_ptr<RecordedStudio> RecordedStudio::of(boost::asio::io_context& loop, std::shared_ptr<const RecordingFacts> facts) {
  return std::unique_ptr<RecordedStudio>(new RecordedStudio(loop, std::move(facts)));
}

RecordedStudio::RecordedStudio(boost::asio::io_context& loop, std::shared_ptr<const RecordingFacts> facts)
    : loop_(loop),
      facts_(std::move(facts)),
      session_(base::make_uuid()),
      makers_(std::make_unique<Workers>(maker_threads)),
      reading_(std::make_unique<Workers>(1)) {
  make_scene();
}

WebHandlers RecordedStudio::handlers() {
  return {
      [this](std::shared_ptr<Viewer> viewer) { join(std::move(viewer)); },
      [this](Viewer& viewer, std::string_view text) { hear(viewer, text); },
      [](Viewer& viewer, std::string_view) { viewer.send(text_frame(status(2, "a recording is open here: binary frames are rejected"))); },
      [this](Viewer& viewer) { leave(viewer); },
      [this](const std::string& path, const std::string& query, const Answer& answer) { return fetch(path, query, answer); }};
}

// ---- the scene ----

void RecordedStudio::make_scene() {
  const auto work = [this, file = facts_->file] {
    Result<Scene> scene = Error{"the world cannot be built: internal error (unexpected exception)"};
    try {
      scene = RecordedScene::make(file);
    } catch (const std::exception& e) {
      scene = Error{e.what()};
    }
    boost::asio::post(loop_, [this, scene] { has_scene(scene); });
  };
  if (makers_->give(work)) ++jobs_;  // the first work of all: there is room
}

void RecordedStudio::has_scene(const Result<Scene>& scene) {
  --jobs_;
  if (scene) {
    scene_ = *scene;
  } else {
    scene_problem_ = scene.error().message;
  }
  for (const auto& [with_collisions, answer] : waiting_)
    answer(!scene_ ? refusal(scene_problem_) : with_collisions ? scene_->glb_with_collisions : scene_->glb);
  waiting_.clear();
  const Frame frame = text_frame(world_event());
  for (auto& [id, session] : sessions_) {
    if (scene_) (void)reading_->give([playhead = session.playhead, scene = scene_] { playhead->set_scene(scene); });
    session.viewer->send_newest("world", frame);
  }
}

std::string RecordedStudio::world_event() const { return to_text(recorded_world(*facts_, scene_.get(), scene_problem_)); }

bool RecordedStudio::fetch(const std::string& path, const std::string& query, const Answer& answer) {
  if (path != "/world.glb") return false;
  const bool with_collisions = query_value(query, "collisions") == "1";
  if (!scene_ && scene_problem_.empty()) {
    waiting_.emplace_back(with_collisions, answer);
  } else {
    answer(!scene_ ? refusal(scene_problem_) : with_collisions ? scene_->glb_with_collisions : scene_->glb);
  }
  return true;
}

// ---- viewers ----

void RecordedStudio::join(std::shared_ptr<Viewer> viewer) {
  viewer->send(text_frame(server_info(session_, Offer::nothing)));
  if (!viewer->speaks_studio()) {
    return viewer->send(
        text_frame(status(2, "a recording is open here, and no system runs: open " + base::in_quotes(facts_->file) + " itself")));
  }
  auto playhead = Playhead::open(facts_);
  if (!playhead) return viewer->send(text_frame(status(2, playhead.error().message)));
  if (scene_) (*playhead)->set_scene(scene_);
  ClientSession& session = sessions_.try_emplace(viewer->id()).first->second;
  session.viewer = std::move(viewer);
  session.playhead = std::move(*playhead);
  greet(session);
}

void RecordedStudio::greet(ClientSession& session) {
  const auto say = [&](const Json& event) { session.viewer->send(text_frame(to_text(event))); };
  say(recorded_hello(*facts_));
  say(recorded_system(*facts_));
  say({{"op", "signals"}, {"signals", facts_->signals}});
  session.viewer->send_newest("world", text_frame(world_event()));
}

void RecordedStudio::leave(Viewer& viewer) { sessions_.erase(viewer.id()); }

void RecordedStudio::hear(Viewer& viewer, std::string_view text) {
  const auto message = parse_message(text);
  if (!message) return viewer.send(text_frame(status(2, message.error().message)));
  const auto* request = std::get_if<Request>(&*message);
  const auto found = sessions_.find(viewer.id());
  if (request != nullptr && found != sessions_.end()) return handle(found->second, *request);
  viewer.send(text_frame(status(2, "a recording is open here: its channels accept no data")));
}

void RecordedStudio::handle(ClientSession& session, const Request& request) {
  const auto viewer = session.viewer->id();
  if (++session.open_requests > max_open_requests) return finish(viewer, request.id, Error{"32 requests are not answered yet"}, {});
  if (request.name == "series") {
    auto order = series_of(request.args);
    return order ? start_series(session, request.id, std::move(*order)) : finish(viewer, request.id, order.error(), {});
  }
  auto work = work_for(request);
  work ? start(session, request.id, std::move(*work)) : finish(viewer, request.id, work.error(), {});
}

Result<RecordedStudio::Work> RecordedStudio::work_for(const Request& request) const {
  const Json& args = request.args;
  const auto done = [](Result<Playhead::News> shown, Playhead::News& news) -> Result<Json> {
    if (!shown) return shown.error();
    news = std::move(*shown);
    return Json::object();
  };
  if (request.name == "look") {
    const auto time = number_of(args, "time");
    if (!time) return time.error();
    return Work([done, at = facts_->time_of(*time), is_whole = flag_of(args, "whole")](Playhead& playhead, Playhead::News& news) {
      return done(playhead.look(at, is_whole), news);
    });
  }
  if (request.name == "component") {
    const auto path = text_of(args, "path");
    if (!path) return path.error();
    return Work([facts = facts_, path = *path](Playhead& playhead, Playhead::News&) { return recorded_details(*facts, path, playhead); });
  }
  if (request.name != "watch" && request.name != "watch_image" && request.name != "unwatch")
    return Error{"a recording shows what was: " + base::in_quotes(request.name) + " cannot be done to it"};
  const auto watch = whole_number_of(args, "watch");
  if (!watch) return watch.error();
  if (request.name == "unwatch") {
    return Work([watch = *watch](Playhead& playhead, Playhead::News&) -> Result<Json> {
      playhead.unwatch(watch);
      return Json::object();
    });
  }
  if (request.name == "watch_image") {
    const auto iface = text_of(args, "iface");
    if (!iface) return iface.error();
    return Work([done, watch = *watch, iface = *iface](Playhead& playhead, Playhead::News& news) {
      return done(playhead.watch_picture(watch, iface), news);
    });
  }
  const auto topic = text_of(args, "topic");
  if (!topic) return topic.error();
  WatchOrder order{*topic, {}, 0};
  if (args.contains("members")) {
    auto members = texts_of(args, "members", 0, max_members);
    if (!members) return members.error();
    order.members = std::move(*members);
  }
  return Work([done, watch = *watch, order](Playhead& playhead, Playhead::News& news) { return done(playhead.watch(watch, order), news); });
}

Result<SeriesOrder> RecordedStudio::series_of(const Json& args) const {
  const auto topic = text_of(args, "topic");
  if (!topic) return topic.error();
  auto members = texts_of(args, "members", 1, max_members);
  if (!members) return members.error();
  const auto points = std::clamp(number_or(args, "points", 4000), 10.0, static_cast<double>(max_points));
  SeriesOrder order{*topic, std::move(*members), facts_->time_of(number_or(args, "from", -HUGE_VAL)),
                    facts_->time_of(number_or(args, "to", HUGE_VAL)), static_cast<std::size_t>(points)};
  if (order.to < order.from) return Error{"to: expected a time that is not before `from`"};
  return order;
}

// ---- work ----

void RecordedStudio::start(ClientSession& session, std::int64_t id, Work work) {
  const auto job = [this, viewer = session.viewer->id(), id, playhead = session.playhead, work = std::move(work)] {
    Playhead::News news;
    Result<Json> result = Error{"internal error (unexpected exception)"};
    try {
      result = work(*playhead, news);
    } catch (const std::exception& e) {
      result = Error{base::in_quotes(facts_->file) + ": " + e.what()};
    }
    boost::asio::post(loop_, [this, viewer, id, result, news = std::move(news)] {
      --jobs_;
      finish(viewer, id, result, news);
    });
  };
  if (!reading_->give(job)) return finish(session.viewer->id(), id, Error{"too much is being done already; try again"}, {});
  ++jobs_;
}

void RecordedStudio::start_series(ClientSession& session, std::int64_t id, SeriesOrder order) {
  const auto job = [this, viewer = session.viewer->id(), id, facts = facts_, order = std::move(order)] {
    Result<Json> result = Error{"internal error (unexpected exception)"};
    try {
      result = recorded_series(*facts, order);
    } catch (const std::exception& e) {
      result = Error{base::in_quotes(facts->file) + ": " + e.what()};
    }
    boost::asio::post(loop_, [this, viewer, id, result] {
      --jobs_;
      finish(viewer, id, result, {});
    });
  };
  if (!makers_->give(job)) return finish(session.viewer->id(), id, Error{"too much is being done already; try again"}, {});
  ++jobs_;
}

// What is shown comes before the reply, so that a page that asks again has seen it.
void RecordedStudio::finish(std::uint64_t viewer, std::int64_t id, const Result<Json>& result, const Playhead::News& news) {
  const auto found = sessions_.find(viewer);
  if (found == sessions_.end()) return;
  ClientSession& session = found->second;
  if (session.open_requests > 0) --session.open_requests;
  for (const auto& [key, frame] : news) session.viewer->send_newest(key, frame);
  session.viewer->send(text_frame(reply_text(id, result)));
}

}  // namespace studio
