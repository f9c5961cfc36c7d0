#include "simulation.h"

#include <regex.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "names.h"
#include "ros/from_iface.h"
#include "shm/layout.h"

namespace ros2 {
namespace {

using ros::SimulationResult;
constexpr std::size_t max_pattern = 200;
constexpr std::uint64_t max_steps = 1'000'000'000;
constexpr std::chrono::minutes step_timeout{10};

// What simulation_interfaces calls the abilities of this simulator.
enum Feature : std::uint16_t {
  spawning = 0,
  deleting = 1,
  spawning_resource_string = 9,
  spawnables = 14,
  entity_state_getting = 10,
  entity_state_setting = 11,
  simulation_reset = 20,
  simulation_reset_state = 22,
  simulation_state_getting = 24,
  simulation_state_setting = 25,
  simulation_state_pause = 26,
  step_single = 31,
  step_multiple = 32,
  world_info_getting = 44,
};
// Results that a service has for itself.
constexpr std::uint8_t already_in_state = 101, transition_error = 102, incorrect_transition = 103, name_not_unique = 101,
                       name_invalid = 102, unsupported_format = 103, no_resource = 104, namespace_invalid = 105, resource_parse_error = 106,
                       invalid_pose = 109, state_invalid_pose = 101, no_world = 101;

SimulationResult good() { return {SimulationResult::ok, ""}; }
// Without the end of a text that repeats a huge value of the client.
SimulationResult bad(std::uint8_t code, std::string why) {
  constexpr std::size_t most = 500;
  if (why.size() > most) {
    std::size_t end = most;
    while (end > 0 && (static_cast<unsigned char>(why[end]) & 0xc0) == 0x80) --end;  // within a character
    why.resize(end);
    why += "...";
  }
  return {code, std::move(why)};
}

// The C library unrolls repetitions, one in another too: three characters of a client would fill the memory. It also looks for back
// references, which ERE has not, in a time that grows with each one.
bool is_cheap(const std::string& pattern) {
  constexpr double most = 1000;
  double copies = 1;
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    if (pattern[i] == '\\' && i + 1 < pattern.size() && std::isdigit(static_cast<unsigned char>(pattern[i + 1])) != 0) return false;
    if (pattern[i] != '{') continue;
    const char* at = pattern.c_str() + i + 1;
    char* end = nullptr;
    double count = std::strtod(at, &end);
    if (*end == ',') count = std::max(count, std::strtod(end + 1, &end));
    copies *= std::max(count, 1.0);
  }
  return copies <= most;
}

// A POSIX extended regular expression; one of clients, so its length and its repetitions are limited.
class Pattern {
 public:
  explicit Pattern(const std::string& text) : is_everything_(text.empty()) {
    is_good_ = is_everything_ ||
               (text.size() <= max_pattern && is_cheap(text) && ::regcomp(&compiled_, text.c_str(), REG_EXTENDED | REG_NOSUB) == 0);
  }
  ~Pattern() {
    if (is_good_ && !is_everything_) ::regfree(&compiled_);
  }
  Pattern(const Pattern&) = delete;
  Pattern& operator=(const Pattern&) = delete;
  bool is_good() const { return is_good_; }
  bool fits(const std::string& name) const { return is_everything_ || ::regexec(&compiled_, name.c_str(), 0, nullptr, 0) == 0; }

 private:
  const bool is_everything_;
  bool is_good_ = false;
  regex_t compiled_{};
};

std::vector<std::string> models_in(const std::string& tree) {
  std::vector<std::string> names;
  const auto json = nlohmann::json::parse(tree, nullptr, false);
  if (!json.is_object() || !json.contains("models")) return names;
  for (const auto& model : json["models"]) names.push_back(model.value("name", ""));
  return names;
}

std::optional<shm::Pose> shm_pose(const ros::Pose& pose) {
  const auto& q = pose.orientation;
  const auto& p = pose.position;
  constexpr double most = 1e12;  // of the simulator
  const double length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  if (!std::isfinite(length) || !(std::abs(p.x) < most && std::abs(p.y) < most && std::abs(p.z) < most)) return std::nullopt;
  if (length < 1e-9) return shm::Pose{p.x, p.y, p.z, 1, 0, 0, 0};  // all zero: not said
  return shm::Pose{p.x, p.y, p.z, q.w / length, q.x / length, q.y / length, q.z / length};
}

// Why a model cannot have this name; nothing when it can. The simulator gives another name in place of the last ones, if it may.
std::optional<std::string> problem_of_model_name(const std::string& name, bool may_rename) {
  if (name.size() > shm::max_name_length) return "name must have at most " + std::to_string(shm::max_name_length) + " bytes";
  if (std::ranges::any_of(name, [](unsigned char c) { return c < ' ' || c == 127; })) return "name has a control character";
  if (may_rename) return std::nullopt;
  if (name.empty()) return "name is empty and allow_renaming is false";
  if (name.find("::") != std::string::npos || name.find('/') != std::string::npos) return "name \"" + name + "\" has :: or /";
  if (name == "world" || (name.starts_with("__") && name.ends_with("__"))) return "name \"" + name + "\" is reserved";
  return std::nullopt;
}

// "<mujoco ...>" and other formats. A text that is no XML at all is one that cannot be parsed.
bool is_other_format(const std::string& text) {
  const auto root = base::trim(text);
  if (!root.starts_with('<') || root.starts_with("<?") || root.starts_with("<!")) return false;
  return !root.starts_with("<sdf") && !root.starts_with("<robot") && root.find('>') != std::string_view::npos;
}

// "robot1" is "/robot1".
std::string full_namespace(const std::string& typed) { return typed.empty() || typed.front() == '/' ? typed : "/" + typed; }

bool is_world(const std::string& frame) { return frame.empty() || frame == "world" || frame == "map"; }

}  // namespace

SimulationServices::SimulationServices(Node& node, World& world, Errands& errands, Errands& steps, std::string prefix,
                                       Namespaces namespaces)
    : node_(node), world_(world), errands_(errands), steps_(steps), prefix_(std::move(prefix)), namespaces_(std::move(namespaces)) {
  serve_time();
  serve_entities();
  serve_spawnables();
  serve_entity_states();
}

ros::SimulationState SimulationServices::state() const {
  const auto& clock = world_.clock();
  if (!clock || !clock->iface().read()) return {ros::SimulationState::quitting};
  const auto& sample = clock->iface().sample<shm::SimulationSample>();
  if (sample.paused == 0) return {ros::SimulationState::playing};
  return {sample.steps == 0 ? ros::SimulationState::stopped : ros::SimulationState::paused};
}

void SimulationServices::ask(shm::Request request, std::function<void(const Result&)> done) {
  errands_.post(std::move(request), [done = std::move(done)](const base::Result<shm::Reply>& reply) {
    done(reply ? good() : bad(SimulationResult::failed, reply.error().message));
  });
}

// ---- time ----

void SimulationServices::serve_time() {
  node_.serve<ros::GetSimulatorFeaturesRequest, ros::GetSimulatorFeaturesResponse>(
      name("get_simulator_features"), [](const auto&, const auto& reply) {
        reply(ros::GetSimulatorFeaturesResponse{
            {{spawning, deleting, spawning_resource_string, spawnables, entity_state_getting, entity_state_setting, simulation_reset,
              simulation_reset_state, simulation_state_getting, simulation_state_setting, simulation_state_pause, step_single,
              step_multiple, world_info_getting},
             {"sdf", "urdf"},
             "rtm-sim"}});
      });
  node_.serve<ros::GetSimulationStateRequest, ros::GetSimulationStateResponse>(
      name("get_simulation_state"), [this](const auto&, const auto& reply) {
        reply(ros::GetSimulationStateResponse{state(), world_.is_there() ? good() : bad(SimulationResult::failed, "no simulator runs")});
      });
  node_.serve<ros::SetSimulationStateRequest, ros::SetSimulationStateResponse>(name("set_simulation_state"), [this](const auto& request,
                                                                                                                    const auto& reply) {
    const auto answer = [reply](Result result) {
      if (result.result == SimulationResult::failed) result.result = transition_error;
      reply(ros::SetSimulationStateResponse{std::move(result)});
    };
    const std::uint8_t wanted = request.state.state, now = state().state;
    if (wanted == now) return answer(bad(already_in_state, "the simulation is in this state already"));
    if (wanted == ros::SimulationState::playing) return ask(shm::RunRequest{}, answer);
    if (wanted == ros::SimulationState::paused && now == ros::SimulationState::stopped)
      return answer(bad(incorrect_transition, "the simulation is stopped; it can be paused when it has run"));
    if (wanted == ros::SimulationState::paused) return ask(shm::PauseRequest{}, answer);
    if (wanted != ros::SimulationState::stopped)
      return answer(bad(SimulationResult::unsupported, "expected 0 (stopped), 1 (playing) or 2 (paused), got " + std::to_string(wanted)));
    ask(shm::PauseRequest{}, [this, answer](const Result& paused) {
      if (paused.result != SimulationResult::ok) return answer(paused);
      ask(shm::ResetRequest{}, answer);
    });
  });
  node_.serve<ros::ResetSimulationRequest, ros::ResetSimulationResponse>(name("reset_simulation"), [this](const auto& request,
                                                                                                          const auto& reply) {
    using Scope = ros::ResetSimulationRequest;
    const auto answer = [reply](const Result& result) { reply(ros::ResetSimulationResponse{result}); };
    const std::uint8_t scope = request.scope == 0 ? Scope::all : request.scope;
    constexpr std::uint8_t whole = Scope::time | Scope::state | Scope::spawned;
    if ((scope & whole) == whole) return ask(shm::ResetRequest{}, answer);
    if (scope == Scope::state) return ask(shm::ResetRequest{.poses_only = true}, answer);
    answer(bad(SimulationResult::unsupported,
               "scope " + std::to_string(scope) + " is not supported; use 0, 7 or 255 (time, state and spawned entities) or 2 (state)"));
  });
  node_.serve<ros::StepSimulationRequest, ros::StepSimulationResponse>(
      name("step_simulation"), [this](const auto& request, const auto& reply) {
        const auto answer = [reply](const Result& result) { reply(ros::StepSimulationResponse{result}); };
        if (state().state == ros::SimulationState::playing)
          return answer(bad(SimulationResult::failed, "the simulation runs; pause it first"));
        if (request.steps < 1 || request.steps > max_steps)
          return answer(bad(SimulationResult::failed, "steps must be from 1 to 1000000000, got " + std::to_string(request.steps)));
        steps_.post(
            shm::StepRequest{.steps = static_cast<std::int64_t>(request.steps)},
            [answer](const base::Result<shm::Reply>& done) { answer(done ? good() : bad(SimulationResult::failed, done.error().message)); },
            step_timeout);
      });
  node_.serve<ros::GetCurrentWorldRequest, ros::GetCurrentWorldResponse>(name("get_current_world"), [this](const auto&, const auto& reply) {
    if (!world_.is_there()) return reply(ros::GetCurrentWorldResponse{bad(no_world, "no simulator runs"), {}});
    const auto& info = world_.clock()->iface().template info<shm::SimulationInfo>();
    reply(ros::GetCurrentWorldResponse{good(), {ros::text_of(info.world), {ros::text_of(info.file), ""}, "", {}}});
  });
}

// ---- entities ----

void SimulationServices::ask_models(const ros::EntityFilters& filters, OnModels done) {
  if (!filters.categories.empty() || !filters.tags.tags.empty() || filters.bounds.type != 0)
    return done({}, bad(SimulationResult::unsupported, "only the filter by name is supported: categories, tags and bounds must be empty"));
  const auto pattern = std::make_shared<Pattern>(filters.filter);
  if (!pattern->is_good())
    return done({}, bad(SimulationResult::failed,
                        "filter must be a POSIX extended regular expression of at most 200 characters, with {N} of at "
                        "most 1000 copies in all; got \"" +
                            filters.filter + "\""));
  errands_.post(shm::TreeRequest{}, [pattern, done = std::move(done)](const base::Result<shm::Reply>& reply) {
    if (!reply) return done({}, bad(SimulationResult::failed, reply.error().message));
    auto models = models_in(reply->text);
    std::erase_if(models, [&](const std::string& model) { return !pattern->fits(model); });
    done(models, good());
  });
}

void SimulationServices::serve_entities() {
  node_.serve<ros::GetEntitiesRequest, ros::GetEntitiesResponse>(name("get_entities"), [this](const auto& request, const auto& reply) {
    ask_models(request.filters, [reply](const std::vector<std::string>& models, const Result& result) {
      reply(ros::GetEntitiesResponse{result, models});
    });
  });
  node_.serve<ros::DeleteEntityRequest, ros::DeleteEntityResponse>(name("delete_entity"), [this](const auto& request, const auto& reply) {
    ask_models({}, [this, reply, entity = request.entity](const std::vector<std::string>& models, const Result& result) {
      const auto answer = [reply](const Result& done) { reply(ros::DeleteEntityResponse{done}); };
      if (result.result != SimulationResult::ok) return answer(result);
      if (std::ranges::find(models, entity) == models.end())
        return answer(bad(SimulationResult::not_found, "the world has no model \"" + entity + "\""));
      ask(shm::DeleteRequest{entity}, answer);
    });
  });
  node_.serve_both<ros::SpawnEntityRequest, ros::SpawnEntityRequest2, ros::SpawnEntityResponse>(
      name("spawn_entity"), [this](const auto& request, const auto& reply) { spawn(request, reply); },
      [this](const auto& newer, const auto& reply) {
        const auto& [uri, text] = newer.entity_resource;
        spawn({newer.label, newer.allow_renaming, uri, text, newer.entity_namespace, newer.initial_pose}, reply);
      });
}

// What a client may spawn by its uri: the models of the model path that the simulator opens for clients.
void SimulationServices::serve_spawnables() {
  using Response = ros::GetSpawnablesResponse;
  node_.serve_newer_reply<ros::GetSpawnablesRequest, Response, ros::GetSpawnablesResponse2>(
      name("get_spawnables"),
      [this](const auto& request, const auto& reply) {
        if (!request.sources.empty())
          return reply(
              Response{bad(SimulationResult::unsupported, "sources must be empty: the model path of the simulator is listed"), {}});
        errands_.post(shm::ModelsRequest{}, [reply](const base::Result<shm::Reply>& models) {
          if (!models) return reply(Response{bad(SimulationResult::failed, models.error().message), {}});
          Response response{good(), {}};
          for (const auto& model : models_in(models->text)) response.spawnables.push_back({"model://" + model, "", {}});
          reply(response);
        });
      },
      [](const Response& response) {
        ros::GetSpawnablesResponse2 newer{response.result, {}};
        for (const auto& one : response.spawnables) newer.spawnables.push_back({{one.uri, ""}, one.description, one.spawn_bounds});
        return newer;
      });
}

void SimulationServices::spawn(const ros::SpawnEntityRequest& request, const std::function<void(const ros::SpawnEntityResponse&)>& reply) {
  const auto refuse = [&](std::uint8_t code, const std::string& why) { reply(ros::SpawnEntityResponse{bad(code, why), ""}); };
  if (request.uri.empty() && request.resource_string.empty()) return refuse(no_resource, "uri and resource_string are empty");
  if (const auto problem = problem_of_model_name(request.label, request.allow_renaming)) return refuse(name_invalid, *problem);
  if (request.uri.empty() && is_other_format(request.resource_string))
    return refuse(unsupported_format, "resource_string must be sdf or urdf");
  if (const auto problem = problem_of_namespace(request.entity_namespace)) return refuse(namespace_invalid, *problem);
  const auto pose = shm_pose(request.initial_pose.pose);
  const std::string frame = request.initial_pose.header.frame_id;
  if (!pose) return refuse(invalid_pose, "initial_pose must have a finite orientation and a position below 1e12 m");
  if (is_world(frame)) return spawn_at(request, *pose, reply);
  errands_.post(shm::GetPoseRequest{frame}, [this, request, reply, frame, pose = *pose](const base::Result<shm::Reply>& entity) {
    if (!entity)
      return reply({bad(invalid_pose, "initial_pose must be in the frame world or in that of an entity, got \"" + frame + "\""), ""});
    const double* p = entity->values;
    spawn_at(request, ros::product({p[0], p[1], p[2], p[3], p[4], p[5], p[6]}, pose), reply);
  });
}

void SimulationServices::spawn_at(const ros::SpawnEntityRequest& request, const shm::Pose& pose,
                                  const std::function<void(const ros::SpawnEntityResponse&)>& reply) {
  ask_models({}, [this, request, reply, pose](const std::vector<std::string>& models, const Result& result) {
    if (result.result != SimulationResult::ok) return reply(ros::SpawnEntityResponse{result, ""});
    std::string wanted = request.label;
    for (int i = 1; !wanted.empty() && std::ranges::find(models, wanted) != models.end(); ++i) {
      if (!request.allow_renaming)
        return reply(ros::SpawnEntityResponse{bad(name_not_unique, "the world has a model \"" + wanted + "\" already"), ""});
      wanted = request.label + "_" + std::to_string(i);
    }
    const bool is_path = !request.uri.empty();  // the text is ignored then
    // For clients that may not read all that the simulator may.
    shm::SpawnRequest spawn{is_path ? request.uri : request.resource_string, is_path, wanted, true, pose, true};
    errands_.post(std::move(spawn), [this, reply, space = full_namespace(request.entity_namespace)](const base::Result<shm::Reply>& done) {
      if (!done) return reply(ros::SpawnEntityResponse{bad(resource_parse_error, done.error().message), ""});
      namespaces_.on_spawned(done->message, space);
      reply(ros::SpawnEntityResponse{good(), done->message});
    });
  });
}

std::optional<std::string> SimulationServices::problem_of_namespace(const std::string& typed) const {
  const std::string space = full_namespace(typed);
  if (space.empty()) return std::nullopt;
  if (space != "/") {
    if (const auto problem = problem_of_name(space)) return "entity_namespace \"" + typed + "\" " + *problem;
  }
  const std::string user = namespaces_.user_of(space);
  if (user.empty()) return std::nullopt;
  return "entity_namespace \"" + typed + "\" is that of the robot " + user;
}

void SimulationServices::ask_state(const std::string& entity, OnState done) {
  errands_.post(shm::GetPoseRequest{entity}, [this, entity, done = std::move(done)](const base::Result<shm::Reply>& pose) {
    if (!pose) return done({}, bad(SimulationResult::not_found, pose.error().message));
    errands_.post(shm::GetVelocityRequest{entity}, [done, place = *pose](const base::Result<shm::Reply>& velocity) {
      if (!velocity) return done({}, bad(SimulationResult::failed, velocity.error().message));
      const double* p = place.values;
      const double* v = velocity->values;
      ros::EntityState state;
      state.header = {ros::to_time(std::chrono::nanoseconds(velocity->sim_time_ns)), "world"};
      state.pose = {{p[0], p[1], p[2]}, {p[4], p[5], p[6], p[3]}};
      state.twist = {ros::vector_of(v), ros::vector_of(v + 3)};
      done(state, good());
    });
  });
}

void SimulationServices::serve_entity_states() {
  node_.serve<ros::GetEntityStateRequest, ros::GetEntityStateResponse>(
      name("get_entity_state"), [this](const auto& request, const auto& reply) {
        ask_state(request.entity, [reply](const ros::EntityState& state, const Result& result) {
          reply(ros::GetEntityStateResponse{result, state});
        });
      });
  node_.serve<ros::GetEntitiesStatesRequest, ros::GetEntitiesStatesResponse>(
      name("get_entities_states"), [this](const auto& request, const auto& reply) {
        ask_models(request.filters, [this, reply](const std::vector<std::string>& models, const Result& result) {
          const auto response = std::make_shared<ros::GetEntitiesStatesResponse>(ros::GetEntitiesStatesResponse{result, {}, {}});
          if (models.empty()) return reply(*response);
          const auto left = std::make_shared<std::size_t>(models.size());
          for (const auto& model : models) {
            // One that was deleted meanwhile is left out.
            ask_state(model, [reply, response, left, model](const ros::EntityState& state, const Result& one) {
              if (one.result == SimulationResult::ok) {
                response->entities.push_back(model);
                response->states.push_back(state);
              }
              if (--*left == 0) reply(*response);
            });
          }
        });
      });
  node_.serve_both<ros::SetEntityStateRequest, ros::SetEntityStateRequest2, ros::SetEntityStateResponse>(
      name("set_entity_state"),
      [this](const auto& request, const auto& reply) {
        set_state({request.entity, request.state, true, true, false}, reply);
      },
      [this](const auto& request, const auto& reply) { set_state(request, reply); });
}

void SimulationServices::set_state(const ros::SetEntityStateRequest2& request,
                                   const std::function<void(const ros::SetEntityStateResponse&)>& reply) {
  const auto answer = [reply](const Result& result) { reply(ros::SetEntityStateResponse{result}); };
  if (request.set_acceleration) return answer(bad(SimulationResult::unsupported, "set_acceleration must be false"));
  const auto pose = shm_pose(request.state.pose);
  if (request.set_pose && (!pose || !is_world(request.state.header.frame_id)))
    return answer(bad(state_invalid_pose, "pose must have a finite orientation, a position below 1e12 m, and be in the frame world"));
  // It says whether there is the entity, and what is to stay.
  ask_state(request.entity, [this, request, pose, answer](const ros::EntityState& before, const Result& found) {
    if (found.result != SimulationResult::ok) return answer(found);
    const auto& twist = request.set_twist ? request.state.twist : before.twist;
    const shm::SetVelocityRequest velocity{
        request.entity, {twist.linear.x, twist.linear.y, twist.linear.z}, {twist.angular.x, twist.angular.y, twist.angular.z}};
    if (!request.set_pose) return request.set_twist ? ask(velocity, answer) : answer(good());
    const auto is_zero = [](double value) { return value == 0; };
    const bool is_at_rest = std::ranges::all_of(velocity.linear, is_zero) && std::ranges::all_of(velocity.angular, is_zero);
    ask(shm::SetPoseRequest{request.entity, *pose}, [this, answer, velocity, is_at_rest](const Result& done) {
      if (done.result != SimulationResult::ok || is_at_rest) return answer(done);  // the pose was set at rest
      ask(velocity, answer);
    });
  });
}

}  // namespace ros2
