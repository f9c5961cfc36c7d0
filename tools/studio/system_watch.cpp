#include "studio/system_watch.h"

#include <omnithread.h>

#include <algorithm>
#include <utility>

#include "studio/system_json.h"
#include "system/component_view.h"

namespace studio {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto shortest_pause = 500ms;
constexpr int share = 4;  // it spends at most this fraction, 1/N, of its time on queries: large systems are asked less often

Json nothing(const std::string& problem) {
  return {{"op", "system"},           {"revision", 0}, {"problem", problem}, {"components", Json::array()}, {"connections", Json::array()},
          {"managers", Json::array()}};
}

// Takes what changes often out of the picture.
Json take_states(Json& system) {
  Json states = Json::object(), rates = Json::object();
  for (auto& component : system["components"]) {
    const auto path = component["path"].get<std::string>();
    states[path] = std::exchange(component["state"], Json());
    Json& contexts = component["contexts"];
    if (!contexts.empty()) rates[path] = {contexts[0]["rate"], contexts[0]["running"]};
    for (auto& context : contexts) context["state"] = context["rate"] = context["running"] = Json();
  }
  return {{"op", "states"}, {"revision", 0}, {"states", std::move(states)}, {"rates", std::move(rates)}};
}

}  // namespace

SystemWatch::SystemWatch(CORBA::ORB_ptr orb, std::string server, std::chrono::milliseconds limit, Tell tell)
    : orb_(CORBA::ORB::_duplicate(orb)), server_(std::move(server)), limit_(limit), tell_(std::move(tell)), thread_([this] { run(); }) {}

SystemWatch::~SystemWatch() {
  data_.lock()->is_ending = true;
  changed_.notify_all();
  thread_.join();
}

void SystemWatch::set_watched(bool is_watched) {
  data_.lock()->is_watched = is_watched;
  changed_.notify_all();
}

void SystemWatch::look_now() {
  data_.lock()->is_hurried = true;
  changed_.notify_all();
}

void SystemWatch::run() {
  const omni_thread::ensure_self known_to_the_orb;  // time-outs per thread need it
  auto next = Clock::now();
  for (;;) {
    {
      auto data = data_.lock();
      data.wait(changed_, [&] { return data->is_ending || data->is_watched || data->is_hurried; });
      data.wait_until(changed_, next, [&] { return data->is_ending || data->is_hurried; });
      if (data->is_ending) return;
      data->is_hurried = false;
    }
    const auto start = Clock::now();
    tell_changes(look());
    next = Clock::now() + std::max<Clock::duration>(shortest_pause, (Clock::now() - start) * share);
  }
}

Json SystemWatch::look() const {
  const auto tree = tools::NamingTree::read(orb_, server_, limit_);
  if (!tree) return nothing(tree.error().message);
  const auto components = tools::read_components(*tree, {.contexts = true, .connectors = true, .members = true}, limit_);
  auto system = nothing("");
  system["components"] = components_json(components);
  system["connections"] = connections_json(components);
  system["managers"] = managers_json(*tree);
  return system;
}

void SystemWatch::tell_changes(Json now) {
  Json bare = now;
  Json states = take_states(bare);
  auto structure_text = to_text(bare), states_text = to_text(states);
  SystemNews news;
  if (structure_text != structure_) {
    now["revision"] = ++revision_;
    news.structure = to_text(now);
  } else if (states_text != states_) {
    states["revision"] = ++revision_;
    news.states = to_text(states);
  } else {
    return;
  }
  structure_ = std::move(structure_text);
  states_ = std::move(states_text);
  tell_(std::move(news));
}

}  // namespace studio
