#include "simulation.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "names.h"
#include "ros/from_iface.h"
#include "shm/layout.h"

namespace ros2 {
namespace {

using ros::SimulationResult;

// What simulation_interfaces calls the abilities of this simulator.
enum Feature : std::uint16_t {
  spawning = 0,
  deleting = 1,
  entity_bounds = 5,
  entity_bounds_box = 6,
  entity_categories = 8,
  spawning_resource_string = 9,
  entity_state_getting = 10,
  entity_state_setting = 11,
  entity_info_getting = 12,
  spawnables = 14,
  simulation_reset = 20,
  simulation_reset_state = 22,
  simulation_state_getting = 24,
  simulation_state_setting = 25,
  simulation_state_pause = 26,
  step_single = 31,
  step_multiple = 32,
  step_action = 33,
  world_info_getting = 44,
  spawning_entities = 50,
};
// Results that a service has for itself.
constexpr std::uint8_t already_in_state = 101, transition_error = 102, incorrect_transition = 103, name_not_unique = 101,
                       name_invalid = 102, unsupported_format = 103, no_resource = 104, namespace_invalid = 105, resource_parse_error = 106,
                       invalid_pose = 109, state_invalid_pose = 101, no_world = 101, spawn_failed = 150;

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

SimulationResult no_model(const std::string& name) { return bad(SimulationResult::not_found, "the world has no model \"" + name + "\""); }

// The simulator has one status for all: its words tell a uri of nothing from a file that cannot be read.
std::uint8_t code_of_failed_spawn(const std::string& uri, const std::string& message) {
  const auto words = base::in_quotes(std::string(base::trim(uri))) + " is not found";
  return !uri.empty() && message.find(words) != std::string::npos ? SimulationResult::not_found : resource_parse_error;
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

SimulationServices::SimulationServices(Node& node, World& world, AsyncRequests& async_requests, AsyncRequests& steps, std::string prefix,
                                       Namespaces namespaces)
    : node_(node),
      world_(world),
      async_requests_(async_requests),
      steps_(steps),
      prefix_(std::move(prefix)),
      namespaces_(std::move(namespaces)),
      steps_action_(node, world, async_requests, steps, name("simulate_steps")) {
  serve_time();
  serve_entities();
  serve_spawning();
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
  async_requests_.post(std::move(request), [done = std::move(done)](const base::Result<shm::Reply>& reply) {
    done(reply ? good() : bad(SimulationResult::failed, reply.error().message));
  });
}

// ---- time ----

void SimulationServices::serve_time() {
  node_.serve<ros::GetSimulatorFeaturesRequest, ros::GetSimulatorFeaturesResponse>(
      name("get_simulator_features"), [](const auto&, const auto& reply) {
        reply(ros::GetSimulatorFeaturesResponse{{{spawning,
                                                  deleting,
                                                  entity_bounds,
                                                  entity_bounds_box,
                                                  entity_categories,
                                                  spawning_resource_string,
                                                  entity_state_getting,
                                                  entity_state_setting,
                                                  entity_info_getting,
                                                  spawnables,
                                                  simulation_reset,
                                                  simulation_reset_state,
                                                  simulation_state_getting,
                                                  simulation_state_setting,
                                                  simulation_state_pause,
                                                  step_single,
                                                  step_multiple,
                                                  step_action,
                                                  world_info_getting,
                                                  spawning_entities},
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
        if (const auto problem = problem_of_steps(world_, request.steps)) return answer(bad(SimulationResult::failed, *problem));
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

void SimulationServices::ask_entities(const ros::EntityFilters& filters, OnEntities done) {
  if (const auto problem = problem_of(filters)) return done({}, bad(problem->result, problem->error_message));
  async_requests_.post(shm::ListRequest{}, [this, filters, done = std::move(done)](const base::Result<shm::Reply>& reply) {
    if (!reply) return done({}, bad(SimulationResult::failed, reply.error().message));
    auto entities = filtered(entities_in(reply->text), filters);
    if (filters.bounds.type == ros::Bounds::empty) return done(entities, good());
    ask_boxes("", [entities = std::move(entities), bounds = filters.bounds, done](const Boxes& boxes, const Result& result) mutable {
      std::erase_if(entities, [&](const Entity& one) { return !boxes.contains(one.name) || !overlaps(boxes.at(one.name), bounds); });
      done(entities, result);
    });
  });
}

void SimulationServices::ask_boxes(const std::string& entity, OnBoxes done) {
  async_requests_.post(shm::TreeRequest{entity, true}, [done = std::move(done)](const base::Result<shm::Reply>& tree) {
    if (!tree) return done({}, bad(SimulationResult::failed, tree.error().message));
    done(boxes_in(tree->text), good());
  });
}

void SimulationServices::serve_entities() {
  node_.serve<ros::GetEntitiesRequest, ros::GetEntitiesResponse>(name("get_entities"), [this](const auto& request, const auto& reply) {
    ask_entities(request.filters, [reply](const std::vector<Entity>& entities, const Result& result) {
      ros::GetEntitiesResponse response{result, {}};
      for (const auto& entity : entities) response.entities.push_back(entity.name);
      reply(response);
    });
  });
  node_.serve<ros::GetEntityInfoRequest, ros::GetEntityInfoResponse>(
      name("get_entity_info"), [this](const auto& request, const auto& reply) {
        ask_entities({}, [reply, wanted = request.entity](const std::vector<Entity>& entities, const Result& result) {
          if (result.result != SimulationResult::ok) return reply(ros::GetEntityInfoResponse{result, {}});
          const auto found = std::ranges::find(entities, wanted, &Entity::name);
          if (found == entities.end()) return reply(ros::GetEntityInfoResponse{no_model(wanted), {}});
          reply(ros::GetEntityInfoResponse{good(), {{found->category}, "", {}}});
        });
      });
  node_.serve<ros::GetEntityBoundsRequest, ros::GetEntityBoundsResponse>(
      name("get_entity_bounds"), [this](const auto& request, const auto& reply) {
        ask_entities({}, [this, reply, wanted = request.entity](const std::vector<Entity>& entities, const Result& listed) {
          if (listed.result != SimulationResult::ok) return reply(ros::GetEntityBoundsResponse{listed, {}});
          if (std::ranges::find(entities, wanted, &Entity::name) == entities.end())
            return reply(ros::GetEntityBoundsResponse{no_model(wanted), {}});
          ask_boxes(wanted, [reply, wanted](const Boxes& boxes, const Result& result) {
            if (result.result != SimulationResult::ok) return reply(ros::GetEntityBoundsResponse{result, {}});
            if (!boxes.contains(wanted)) return reply(ros::GetEntityBoundsResponse{no_model(wanted), {}});
            reply(ros::GetEntityBoundsResponse{good(), bounds_of(boxes.at(wanted))});
          });
        });
      });
  node_.serve<ros::DeleteEntityRequest, ros::DeleteEntityResponse>(name("delete_entity"), [this](const auto& request, const auto& reply) {
    ask_entities({}, [this, reply, wanted = request.entity](const std::vector<Entity>& entities, const Result& result) {
      const auto answer = [reply](const Result& done) { reply(ros::DeleteEntityResponse{done}); };
      if (result.result != SimulationResult::ok) return answer(result);
      if (std::ranges::find(entities, wanted, &Entity::name) == entities.end()) return answer(no_model(wanted));
      ask(shm::DeleteRequest{wanted}, answer);
    });
  });
}

// ---- new entities ----

// Entities that are spawned one after the other.
struct SimulationServices::Batch {
  std::vector<ros::SpawnEntity> requests;
  std::function<void(const ros::SpawnEntitiesResponse&)> reply;
  ros::SpawnEntitiesResponse response{good(), {}};
};

void SimulationServices::serve_spawning() {
  node_.serve_both<ros::SpawnEntityRequest, ros::SpawnEntityRequest2, ros::SpawnEntityResponse>(
      name("spawn_entity"), [this](const auto& request, const auto& reply) { spawn(request, reply); },
      [this](const auto& newer, const auto& reply) {
        const auto& [uri, text] = newer.entity_resource;
        spawn({newer.label, newer.allow_renaming, uri, text, newer.entity_namespace, newer.initial_pose}, reply);
      });
  node_.serve<ros::SpawnEntitiesRequest, ros::SpawnEntitiesResponse>(
      name("spawn_entities"), [this](const auto& request, const auto& reply) {
        constexpr std::size_t most = 500;
        const std::size_t count = request.spawn_requests.size();
        const auto wrong = [&] { return "spawn_requests must be at most " + std::to_string(most) + ", got " + std::to_string(count); };
        if (count > most) return reply(ros::SpawnEntitiesResponse{bad(SimulationResult::failed, wrong()), {}});
        spawn_next(std::make_shared<Batch>(Batch{request.spawn_requests, reply}));
      });
}

void SimulationServices::spawn_next(const std::shared_ptr<Batch>& batch) {
  auto& response = batch->response;
  const std::size_t done = response.results.size();
  if (done == batch->requests.size()) return batch->reply(response);
  const auto& one = batch->requests[done];
  const auto& [uri, text] = one.entity_resource;
  spawn({one.label, one.allow_renaming, uri, text, one.entity_namespace, one.initial_pose},
        [this, batch](const ros::SpawnEntityResponse& spawned) {
          auto& all = batch->response;
          all.results.push_back({spawned.result, spawned.entity_name});
          if (spawned.result.result != SimulationResult::ok && all.result.result == SimulationResult::ok)
            all.result =
                bad(spawn_failed, "spawn_requests[" + std::to_string(all.results.size() - 1) + "]: " + spawned.result.error_message);
          spawn_next(batch);
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
        async_requests_.post(shm::ModelsRequest{}, [reply](const base::Result<shm::Reply>& models) {
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

void SimulationServices::spawn(const ros::SpawnEntityRequest& request, const OnSpawned& reply) {
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
  async_requests_.post(shm::GetPoseRequest{frame}, [this, request, reply, frame, pose = *pose](const base::Result<shm::Reply>& entity) {
    if (!entity)
      return reply({bad(invalid_pose, "initial_pose must be in the frame world or in that of an entity, got \"" + frame + "\""), ""});
    const double* p = entity->values;
    spawn_at(request, ros::product({p[0], p[1], p[2], p[3], p[4], p[5], p[6]}, pose), reply);
  });
}

void SimulationServices::spawn_at(const ros::SpawnEntityRequest& request, const shm::Pose& pose, const OnSpawned& reply) {
  ask_entities({}, [this, request, reply, pose](const std::vector<Entity>& entities, const Result& result) {
    if (result.result != SimulationResult::ok) return reply(ros::SpawnEntityResponse{result, ""});
    std::string wanted = request.label;
    for (int i = 1; !wanted.empty() && std::ranges::find(entities, wanted, &Entity::name) != entities.end(); ++i) {
      if (!request.allow_renaming)
        return reply(ros::SpawnEntityResponse{bad(name_not_unique, "the world has a model \"" + wanted + "\" already"), ""});
      wanted = request.label + "_" + std::to_string(i);
    }
    const bool is_path = !request.uri.empty();  // the text is ignored then
    // For clients that may not read all that the simulator may.
    shm::SpawnRequest spawn{is_path ? request.uri : request.resource_string, is_path, wanted, true, pose, true};
    async_requests_.post(std::move(spawn), [this, reply, uri = request.uri,
                                            space = full_namespace(request.entity_namespace)](const base::Result<shm::Reply>& done) {
      if (!done) return reply(ros::SpawnEntityResponse{bad(code_of_failed_spawn(uri, done.error().message), done.error().message), ""});
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
  async_requests_.post(shm::GetPoseRequest{entity}, [this, entity, done = std::move(done)](const base::Result<shm::Reply>& pose) {
    if (!pose) return done({}, bad(SimulationResult::not_found, pose.error().message));
    async_requests_.post(shm::GetVelocityRequest{entity}, [done, place = *pose](const base::Result<shm::Reply>& velocity) {
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
        ask_entities(request.filters, [this, reply](const std::vector<Entity>& entities, const Result& result) {
          const auto response = std::make_shared<ros::GetEntitiesStatesResponse>(ros::GetEntitiesStatesResponse{result, {}, {}});
          if (entities.empty()) return reply(*response);
          const auto left = std::make_shared<std::size_t>(entities.size());
          for (const auto& entity : entities) {
            // One that was deleted meanwhile is left out.
            ask_state(entity.name, [reply, response, left, model = entity.name](const ros::EntityState& state, const Result& one) {
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
