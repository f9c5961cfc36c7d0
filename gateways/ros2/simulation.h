// The services of simulation_interfaces for one simulator: state, steps, reset, entities. Each request becomes requests to the simulator;
// the reply is sent when these are done. One thread at a time.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bounds.h"
#include "entities.h"
#include "node.h"
#include "ros/simulation_services.h"
#include "steps_action.h"
#include "world.h"

namespace ros2 {

// Names of robots that are spawned with a namespace.
struct Namespaces {
  std::function<std::string(const std::string& space)> user_of;                        // the robot that has it; empty: none
  std::function<void(const std::string& model, const std::string& space)> on_spawned;  // empty: the usual one
};

class SimulationServices {
 public:
  // `steps`: where steps wait, so that the simulation can be paused meanwhile. `prefix`: "" for the root names, "/sim" for
  // "/sim/get_simulation_state" and so on. All must outlive this object.
  SimulationServices(Node& node, World& world, AsyncRequests& async_requests, AsyncRequests& steps, std::string prefix,
                     Namespaces namespaces);

  // To be called some times a second.
  void update(std::chrono::steady_clock::time_point now) { steps_action_.update(now); }

 private:
  using Result = ros::SimulationResult;
  using OnEntities = std::function<void(const std::vector<Entity>& entities, const Result& result)>;
  using Boxes = std::map<std::string, EntityBox>;
  using OnBoxes = std::function<void(const Boxes& boxes, const Result& result)>;
  using OnSpawned = std::function<void(const ros::SpawnEntityResponse&)>;
  using OnState = std::function<void(const ros::EntityState& state, const Result& result)>;

  void serve_time();
  void serve_entities();
  void serve_spawnables();
  void serve_entity_states();
  void serve_spawning();
  void spawn(const ros::SpawnEntityRequest& request, const OnSpawned& reply);
  void spawn_at(const ros::SpawnEntityRequest& request, const shm::Pose& pose, const OnSpawned& reply);
  struct Batch;
  void spawn_next(const std::shared_ptr<Batch>& batch);
  std::optional<std::string> problem_of_namespace(const std::string& typed) const;
  // 2.x says what is set; 1.x sets pose and twist.
  void set_state(const ros::SetEntityStateRequest2& request, const std::function<void(const ros::SetEntityStateResponse&)>& reply);
  // Asks the simulator for its models; those that the filters name.
  void ask_entities(const ros::EntityFilters& filters, OnEntities done);
  // Of one entity, or of all without a name.
  void ask_boxes(const std::string& entity, OnBoxes done);
  void ask_state(const std::string& entity, OnState done);
  // The simulator's answer as a result.
  void ask(shm::Request request, std::function<void(const Result&)> done);
  ros::SimulationState state() const;
  std::string name(const char* service) const { return prefix_ + "/" + service; }

  Node& node_;
  World& world_;
  AsyncRequests& async_requests_;
  AsyncRequests& steps_;
  const std::string prefix_;
  const Namespaces namespaces_;
  StepsAction steps_action_;
};

}  // namespace ros2
