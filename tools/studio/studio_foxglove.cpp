// What the studio sends to viewers that speak foxglove.websocket.v1.
#include <algorithm>
#include <boost/asio/post.hpp>
#include <variant>

#include "base/log.h"
#include "base/text.h"
#include "studio/connection_graph.h"
#include "studio/foxglove.h"
#include "studio/services.h"
#include "studio/studio.h"
#include "system/remote.h"

namespace studio {
namespace {

using base::Error;
using base::Result;

std::string channel_key(std::uint32_t subscription) { return "channel." + std::to_string(subscription); }

std::string advertisement(channels::ChannelId id, const channels::Channel& channel) {
  return to_text({{"op", "advertise"},
                  {"channels", Json::array({{{"id", id},
                                             {"topic", channel.topic},
                                             {"encoding", channel.encoding},
                                             {"schemaName", channel.schema.name},
                                             {"schema", channel.schema.text},
                                             {"schemaEncoding", channel.schema.encoding}}})}});
}

template <class... Works>
struct Overloaded : Works... {
  using Works::operator()...;
};
template <class... Works>
Overloaded(Works...) -> Overloaded<Works...>;

}  // namespace

void Studio::greet_foxglove(ClientSession& session) {
  for (const auto& [id, channel] : channels_->open_channels()) session.viewer->send(text_frame(advertisement(id, channel)));
  session.viewer->send(text_frame(advertise_services(!options_.is_read_only)));
  channels_->tend();
}

void Studio::warn(ClientSession& session, const std::string& line) { session.viewer->send(text_frame(status(2, line))); }

void Studio::hear_foxglove(ClientSession& session, const ClientMessage& message) {
  std::visit(Overloaded{
                 [&](const Subscribe& one) { subscribe(session, one); },
                 [&](const Unsubscribe& one) { unsubscribe(session, one); },
                 [&](const GraphWish& one) { see_graph(session, one.is_wanted); },
                 [&](const Advertise& one) { advertise(session, one); },
                 [&](const Unadvertise& one) { unadvertise(session, one); },
                 [&](const GetParameters& one) { get_parameters(session, one); },
                 [&](const SetParameters& one) { set_parameters(session, one); },
                 [&](const ParameterWish& one) { see_parameters(session, one); },
                 [&](const Request&) { warn(session, "requests need the subprotocol rtmsim.studio.v1"); },
                 [&](const Unused& one) {
                   session.viewer->send(text_frame(status(1, "op " + base::in_quotes(one.op) + ": is not offered by this server")));
                 },
             },
             message);
}

void Studio::take_frame(Viewer& viewer, std::string_view octets) {
  const auto found = sessions_.find(viewer.id());
  if (found == sessions_.end()) return;
  const auto frame = parse_frame(octets);
  if (!frame) return warn(found->second, frame.error().message);
  if (const auto* call = std::get_if<ServiceCall>(&*frame)) return call_service(found->second, *call);
  const auto& data = std::get<PublishedData>(*frame);
  if (const auto done = publications_->publish(viewer.id(), data.channel, data.payload); !done) warn(found->second, done.error().message);
}

// ---- what viewers publish

void Studio::advertise(ClientSession& session, const Advertise& message) {
  for (const Publication& channel : message.channels) {
    const auto done = options_.is_read_only ? Result<void>(read_only()) : publications_->open(session.viewer->id(), channel, system_event_);
    if (!done) warn(session, done.error().message);
  }
}

void Studio::unadvertise(ClientSession& session, const Unadvertise& message) {
  for (const auto id : message.ids) {
    if (const auto done = publications_->close(session.viewer->id(), id); !done) warn(session, done.error().message);
  }
}

// ---- parameters

// The answer has what could be read. Workers pass it on in JSON, as they do all results.
void Studio::get_parameters(ClientSession& session, const GetParameters& message) {
  Plan plan{"", [context = context_, system = system_event_, names = message.names]() -> Result<Json> {
              return Json(read_parameters(context, system, names));
            }};
  const auto started = carry_out(session, "", std::move(plan), [this, id = message.id](ClientSession& one, const Result<Json>& result) {
    if (!result) return warn(one, result.error().message);
    one.viewer->send(text_frame(parameter_values(result->get<Parameters>(), id)));
  });
  if (!started) warn(session, started.error().message);
}

void Studio::set_parameters(ClientSession& session, const SetParameters& message) {
  if (options_.is_read_only) return warn(session, read_only().message);
  std::vector<std::string> names;
  for (const auto& [name, value] : message.values) names.push_back(name);
  Plan plan{"",
            [context = context_, system = system_event_, values = message.values, names]() -> Result<Json> {
              const auto done = write_parameters(context, system, values);
              return Json{{"problem", done ? "" : done.error().message}, {"now", read_parameters(context, system, names)}};
            },
            Plan::Touches::system};
  const auto started =
      carry_out(session, "parameters", std::move(plan), [this, id = message.id](ClientSession& one, const Result<Json>& result) {
        if (!result) return warn(one, result.error().message);
        if (const auto problem = result->value("problem", ""); !problem.empty()) warn(one, problem);
        const auto now = result->at("now").get<Parameters>();
        if (id) one.viewer->send(text_frame(parameter_values(now, id)));
        tell_parameters(now);
      });
  if (!started) warn(session, started.error().message);
}

void Studio::see_parameters(ClientSession& session, const ParameterWish& message) {
  if (!message.is_wanted && (message.names.empty() || session.parameters.empty())) {
    session.sees_parameters = false;
    session.parameters.clear();
  } else if (!message.is_wanted) {
    for (const auto& name : message.names) session.parameters.erase(name);
    session.sees_parameters = !session.parameters.empty();
  } else {
    const bool sees_all = message.names.empty() || (session.sees_parameters && session.parameters.empty());
    session.sees_parameters = true;
    if (sees_all) session.parameters.clear();
    if (!sees_all) session.parameters.insert(message.names.begin(), message.names.end());
    look_at_parameters();
  }
  if (!session.sees_parameters) session.seen_parameters.clear();
}

// Components send no notice of most changes, so they are read while somebody wants to know.
void Studio::look_at_parameters() {
  bool is_wanted = false, is_all_wanted = false;
  std::set<std::string> names;
  for (const auto& [id, session] : sessions_) {
    is_wanted = is_wanted || session.sees_parameters;
    is_all_wanted = is_all_wanted || (session.sees_parameters && session.parameters.empty());
    names.insert(session.parameters.begin(), session.parameters.end());
  }
  if (!is_wanted || looks_at_parameters_) return;
  if (is_all_wanted) names.clear();
  looks_at_parameters_ =
      workers_->give([this, context = context_, system = system_event_, names = std::vector(names.begin(), names.end())] {
        Parameters now;
        try {
          now = read_parameters(context, system, names);
        } catch (const CORBA::Exception& e) {
          base::log(base::Level::warn, "studio", "parameters: {}", tools::describe(e));
        } catch (const std::exception& e) {
          base::log(base::Level::warn, "studio", "parameters: {}", e.what());
        }
        boost::asio::post(loop_, [this, now = std::move(now)] {
          looks_at_parameters_ = false;
          tell_parameters(now);
        });
      });
}

// Those that are new to a viewer, or have another value.
void Studio::tell_parameters(const Parameters& now) {
  for (auto& [id, session] : sessions_) {
    if (!session.sees_parameters) continue;
    Parameters news;
    for (const auto& [name, value] : now) {
      if (!session.parameters.empty() && !session.parameters.contains(name)) continue;
      const auto [seen, is_new] = session.seen_parameters.try_emplace(name, value);
      if (!is_new && seen->second == value) continue;
      news[name] = seen->second = value;
    }
    if (!news.empty()) session.viewer->send(text_frame(parameter_values(news, std::nullopt)));
  }
}

// ---- services

void Studio::call_service(ClientSession& session, const ServiceCall& call) {
  const auto fail = [service = call.service, id = call.call](ClientSession& one, const std::string& why) {
    one.viewer->send(text_frame(service_failure(service, id, why)));
  };
  const auto service = find_service(call.service);
  if (!service || service->act == nullptr) return fail(session, "service " + std::to_string(call.service) + ": does not exist");
  if (options_.is_read_only && !service->act->is_reading) return fail(session, read_only().message);
  const auto args = arguments_of(call);
  if (!args) return fail(session, args.error().message);
  auto plan = service->act->plan(context_, *args);
  if (!plan) return fail(session, plan.error().message);
  const auto started = carry_out(session, subject_of(*service->act, *args), std::move(*plan),
                                 [fail, number = call.service, id = call.call](ClientSession& one, const Result<Json>& result) {
                                   if (!result) return fail(one, result.error().message);
                                   one.viewer->send(binary_frame(service_answer(number, id, "json", to_text(*result))));
                                 });
  if (!started) fail(session, started.error().message);
}

// ---- channels

void Studio::subscribe(ClientSession& session, const Subscribe& message) {
  for (const auto& [id, channel] : message.subscriptions) {
    const auto known = static_cast<channels::ChannelId>(channel);
    if (channel != known || !channels_->open_channels().contains(known)) {
      session.viewer->send(text_frame(status(2, "channel " + std::to_string(channel) + ": is not there")));
    } else if (session.subscriptions.size() >= max_subscriptions) {
      session.viewer->send(text_frame(status(2, "too many subscriptions, at most 1024")));
    } else {
      session.subscriptions[id] = known;
      channels_->want(known, true);
    }
  }
}

void Studio::unsubscribe(ClientSession& session, const Unsubscribe& message) {
  std::map<std::uint32_t, channels::ChannelId> gone;
  for (const auto id : message.ids) {
    if (auto node = session.subscriptions.extract(id)) gone.insert(std::move(node));
    session.viewer->drop(channel_key(id));
  }
  want_channels(gone);
}

void Studio::see_graph(ClientSession& session, bool is_wanted) {
  session.sees_graph = is_wanted;
  if (graph_.is_null()) graph_ = connection_graph({}, {});  // no look at the system has ended yet
  if (is_wanted) session.viewer->send(text_frame(graph_update({}, graph_)));
}

void Studio::tell_graph() {
  Json now = connection_graph(system_event_, book_.event());
  if (now == graph_) return;
  const Frame frame = text_frame(graph_update(graph_, now));
  graph_ = std::move(now);
  for (auto& [id, session] : sessions_) {
    if (session.sees_graph) session.viewer->send(frame);
  }
}

// Those that nobody has subscribed to any more.
void Studio::want_channels(const std::map<std::uint32_t, channels::ChannelId>& changed) {
  for (const auto& [id, channel] : changed) {
    const bool is_wanted = std::any_of(sessions_.begin(), sessions_.end(), [&, channel = channel](const auto& session) {
      const auto& all = session.second.subscriptions;
      return std::any_of(all.begin(), all.end(), [&](const auto& subscription) { return subscription.second == channel; });
    });
    if (!is_wanted) channels_->want(channel, false);
  }
}

void Studio::tell_channel(channels::ChannelId id, const channels::Channel& channel) {
  const Frame frame = text_frame(advertisement(id, channel));
  for (auto& [key, session] : sessions_) {
    if (!session.viewer->speaks_studio()) session.viewer->send(frame);
  }
}

void Studio::tell_no_channel(channels::ChannelId id) {
  const Frame frame = text_frame(to_text({{"op", "unadvertise"}, {"channelIds", Json::array({id})}}));
  for (auto& [key, session] : sessions_) {
    std::erase_if(session.subscriptions, [&](const auto& subscription) { return subscription.second == id; });
    if (!session.viewer->speaks_studio()) session.viewer->send(frame);
  }
}

void Studio::tell_sample(const channels::Sample& sample) {
  for (auto& [key, session] : sessions_) {
    for (const auto& [id, channel] : session.subscriptions) {
      if (channel == sample.channel)
        session.viewer->send_newest(channel_key(id), binary_frame(message_data(id, sample.log_time, sample.octets)));
    }
  }
}

}  // namespace studio
