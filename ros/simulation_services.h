// Services that control a simulator (simulation_interfaces 1.x; `...2` are those that 2.x changes). Values.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "ros/command_messages.h"
#include "ros/messages.h"

namespace ros {

struct SimulationResult {
  static constexpr std::string_view name = "simulation_interfaces/msg/Result";
  static constexpr std::uint8_t unsupported = 0, ok = 1, not_found = 2, incorrect_state = 3, failed = 4;
  std::uint8_t result = 0;
  std::string error_message{};
  static void fields(auto& m, auto& visit) {
    visit("result", m.result);
    visit("error_message", m.error_message);
  }
};
struct Resource {
  static constexpr std::string_view name = "simulation_interfaces/msg/Resource";
  std::string uri{};
  std::string resource_string{};
  static void fields(auto& m, auto& visit) {
    visit("uri", m.uri);
    visit("resource_string", m.resource_string);
  }
};
struct Bounds {
  static constexpr std::string_view name = "simulation_interfaces/msg/Bounds";
  static constexpr std::uint8_t empty = 0, box = 1, sphere = 3;
  std::uint8_t type = empty;
  std::vector<Vector3> points{};
  static void fields(auto& m, auto& visit) {
    visit("type", m.type);
    visit("points", m.points);
  }
};
struct EntityCategory {
  static constexpr std::string_view name = "simulation_interfaces/msg/EntityCategory";
  static constexpr std::uint8_t robot = 1, dynamic_object = 4, static_object = 5;
  std::uint8_t category = 0;
  static void fields(auto& m, auto& visit) { visit("category", m.category); }
};
struct TagsFilter {
  static constexpr std::string_view name = "simulation_interfaces/msg/TagsFilter";
  std::vector<std::string> tags{};
  std::uint8_t filter_mode = 0;
  static void fields(auto& m, auto& visit) {
    visit("tags", m.tags);
    visit("filter_mode", m.filter_mode);
  }
};
struct EntityFilters {
  static constexpr std::string_view name = "simulation_interfaces/msg/EntityFilters";
  std::string filter{};
  std::vector<EntityCategory> categories{};
  TagsFilter tags{};
  Bounds bounds{};
  static void fields(auto& m, auto& visit) {
    visit("filter", m.filter);
    visit("categories", m.categories);
    visit("tags", m.tags);
    visit("bounds", m.bounds);
  }
};
struct EntityInfo {
  static constexpr std::string_view name = "simulation_interfaces/msg/EntityInfo";
  EntityCategory category{};
  std::string description{};
  std::vector<std::string> tags{};
  static void fields(auto& m, auto& visit) {
    visit("category", m.category);
    visit("description", m.description);
    visit("tags", m.tags);
  }
};
struct EntityState {
  static constexpr std::string_view name = "simulation_interfaces/msg/EntityState";
  Header header{};
  Pose pose{};
  Twist twist{};
  Accel acceleration{};
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("pose", m.pose);
    visit("twist", m.twist);
    visit("acceleration", m.acceleration);
  }
};
struct SimulationState {
  static constexpr std::string_view name = "simulation_interfaces/msg/SimulationState";
  static constexpr std::uint8_t stopped = 0, playing = 1, paused = 2, quitting = 3;
  std::uint8_t state = 0;
  static void fields(auto& m, auto& visit) { visit("state", m.state); }
};
struct SimulatorFeatures {
  static constexpr std::string_view name = "simulation_interfaces/msg/SimulatorFeatures";
  std::vector<std::uint16_t> features{};
  std::vector<std::string> spawn_formats{};
  std::string custom_info{};
  static void fields(auto& m, auto& visit) {
    visit("features", m.features);
    visit("spawn_formats", m.spawn_formats);
    visit("custom_info", m.custom_info);
  }
};
struct WorldResource {
  static constexpr std::string_view name = "simulation_interfaces/msg/WorldResource";
  std::string label{};
  Resource world_resource{};
  std::string description{};
  std::vector<std::string> tags{};
  static void fields(auto& m, auto& visit) {
    visit("name", m.label);
    visit("world_resource", m.world_resource);
    visit("description", m.description);
    visit("tags", m.tags);
  }
};
struct Spawnable {
  static constexpr std::string_view name = "simulation_interfaces/msg/Spawnable";
  std::string uri{};
  std::string description{};
  Bounds spawn_bounds{};
  static void fields(auto& m, auto& visit) {
    visit("uri", m.uri);
    visit("description", m.description);
    visit("spawn_bounds", m.spawn_bounds);
  }
};
struct Spawnable2 {
  static constexpr std::string_view name = "simulation_interfaces/msg/Spawnable";
  Resource entity_resource{};
  std::string description{};
  Bounds spawn_bounds{};
  static void fields(auto& m, auto& visit) {
    visit("entity_resource", m.entity_resource);
    visit("description", m.description);
    visit("spawn_bounds", m.spawn_bounds);
  }
};

struct GetSimulatorFeaturesRequest {
  static constexpr std::string_view name = "simulation_interfaces/srv/GetSimulatorFeatures_Request";
  std::uint8_t structure_needs_at_least_one_member = 0;
  static void fields(auto& m, auto& visit) { visit("structure_needs_at_least_one_member", m.structure_needs_at_least_one_member); }
};
struct GetSimulatorFeaturesResponse {
  static constexpr std::string_view name = "simulation_interfaces/srv/GetSimulatorFeatures_Response";
  SimulatorFeatures features{};
  static void fields(auto& m, auto& visit) { visit("features", m.features); }
};
struct GetSimulationStateRequest {
  static constexpr std::string_view name = "simulation_interfaces/srv/GetSimulationState_Request";
  std::uint8_t structure_needs_at_least_one_member = 0;
  static void fields(auto& m, auto& visit) { visit("structure_needs_at_least_one_member", m.structure_needs_at_least_one_member); }
};
struct GetSimulationStateResponse {
  static constexpr std::string_view name = "simulation_interfaces/srv/GetSimulationState_Response";
  SimulationState state{};
  SimulationResult result{};
  static void fields(auto& m, auto& visit) {
    visit("state", m.state);
    visit("result", m.result);
  }
};
struct SetSimulationStateRequest {
  static constexpr std::string_view name = "simulation_interfaces/srv/SetSimulationState_Request";
  SimulationState state{};
  static void fields(auto& m, auto& visit) { visit("state", m.state); }
};
struct SetSimulationStateResponse {
  static constexpr std::string_view name = "simulation_interfaces/srv/SetSimulationState_Response";
  SimulationResult result{};
  static void fields(auto& m, auto& visit) { visit("result", m.result); }
};
struct ResetSimulationRequest {
  static constexpr std::string_view name = "simulation_interfaces/srv/ResetSimulation_Request";
  static constexpr std::uint8_t time = 1, state = 2, spawned = 4, all = 255;
  std::uint8_t scope = 0;
  static void fields(auto& m, auto& visit) { visit("scope", m.scope); }
};
struct ResetSimulationResponse {
  static constexpr std::string_view name = "simulation_interfaces/srv/ResetSimulation_Response";
  SimulationResult result{};
  static void fields(auto& m, auto& visit) { visit("result", m.result); }
};
struct StepSimulationRequest {
  static constexpr std::string_view name = "simulation_interfaces/srv/StepSimulation_Request";
  std::uint64_t steps = 0;
  static void fields(auto& m, auto& visit) { visit("steps", m.steps); }
};
struct StepSimulationResponse {
  static constexpr std::string_view name = "simulation_interfaces/srv/StepSimulation_Response";
  SimulationResult result{};
  static void fields(auto& m, auto& visit) { visit("result", m.result); }
};
struct SpawnEntityRequest {
  static constexpr std::string_view name = "simulation_interfaces/srv/SpawnEntity_Request";
  std::string label{};
  bool allow_renaming = false;
  std::string uri{};
  std::string resource_string{};
  std::string entity_namespace{};
  PoseStamped initial_pose{};
  static void fields(auto& m, auto& visit) {
    visit("name", m.label);
    visit("allow_renaming", m.allow_renaming);
    visit("uri", m.uri);
    visit("resource_string", m.resource_string);
    visit("entity_namespace", m.entity_namespace);
    visit("initial_pose", m.initial_pose);
  }
};
struct SpawnEntityRequest2 {
  static constexpr std::string_view name = "simulation_interfaces/srv/SpawnEntity_Request";
  std::string label{};
  bool allow_renaming = false;
  Resource entity_resource{};
  std::string entity_namespace{};
  PoseStamped initial_pose{};
  static void fields(auto& m, auto& visit) {
    visit("name", m.label);
    visit("allow_renaming", m.allow_renaming);
    visit("entity_resource", m.entity_resource);
    visit("entity_namespace", m.entity_namespace);
    visit("initial_pose", m.initial_pose);
  }
};
struct SpawnEntityResponse {
  static constexpr std::string_view name = "simulation_interfaces/srv/SpawnEntity_Response";
  SimulationResult result{};
  std::string entity_name{};
  static void fields(auto& m, auto& visit) {
    visit("result", m.result);
    visit("entity_name", m.entity_name);
  }
};
// One of SpawnEntitiesRequest.
struct SpawnEntity {
  static constexpr std::string_view name = "simulation_interfaces/msg/SpawnEntity";
  std::string label{};
  bool allow_renaming = false;
  Resource entity_resource{};
  std::string entity_namespace{};
  PoseStamped initial_pose{};
  static void fields(auto& m, auto& visit) { SpawnEntityRequest2::fields(m, visit); }
};
struct SpawnResult {
  static constexpr std::string_view name = "simulation_interfaces/msg/SpawnResult";
  SimulationResult result{};
  std::string entity_name{};
  static void fields(auto& m, auto& visit) {
    visit("result", m.result);
    visit("entity_name", m.entity_name);
  }
};
struct SpawnEntitiesRequest {
  static constexpr std::string_view name = "simulation_interfaces/srv/SpawnEntities_Request";
  std::vector<SpawnEntity> spawn_requests{};
  static void fields(auto& m, auto& visit) { visit("spawn_requests", m.spawn_requests); }
};
struct SpawnEntitiesResponse {
  static constexpr std::string_view name = "simulation_interfaces/srv/SpawnEntities_Response";
  SimulationResult result{};
  std::vector<SpawnResult> results{};
  static void fields(auto& m, auto& visit) {
    visit("result", m.result);
    visit("results", m.results);
  }
};
struct DeleteEntityRequest {
  static constexpr std::string_view name = "simulation_interfaces/srv/DeleteEntity_Request";
  std::string entity{};
  static void fields(auto& m, auto& visit) { visit("entity", m.entity); }
};
struct DeleteEntityResponse {
  static constexpr std::string_view name = "simulation_interfaces/srv/DeleteEntity_Response";
  SimulationResult result{};
  static void fields(auto& m, auto& visit) { visit("result", m.result); }
};
struct GetEntitiesRequest {
  static constexpr std::string_view name = "simulation_interfaces/srv/GetEntities_Request";
  EntityFilters filters{};
  static void fields(auto& m, auto& visit) { visit("filters", m.filters); }
};
struct GetEntitiesResponse {
  static constexpr std::string_view name = "simulation_interfaces/srv/GetEntities_Response";
  SimulationResult result{};
  std::vector<std::string> entities{};
  static void fields(auto& m, auto& visit) {
    visit("result", m.result);
    visit("entities", m.entities);
  }
};
struct GetEntityInfoRequest {
  static constexpr std::string_view name = "simulation_interfaces/srv/GetEntityInfo_Request";
  std::string entity{};
  static void fields(auto& m, auto& visit) { visit("entity", m.entity); }
};
struct GetEntityInfoResponse {
  static constexpr std::string_view name = "simulation_interfaces/srv/GetEntityInfo_Response";
  SimulationResult result{};
  EntityInfo info{};
  static void fields(auto& m, auto& visit) {
    visit("result", m.result);
    visit("info", m.info);
  }
};
struct GetEntityBoundsRequest {
  static constexpr std::string_view name = "simulation_interfaces/srv/GetEntityBounds_Request";
  std::string entity{};
  static void fields(auto& m, auto& visit) { visit("entity", m.entity); }
};
struct GetEntityBoundsResponse {
  static constexpr std::string_view name = "simulation_interfaces/srv/GetEntityBounds_Response";
  SimulationResult result{};
  Bounds bounds{};
  static void fields(auto& m, auto& visit) {
    visit("result", m.result);
    visit("bounds", m.bounds);
  }
};
struct GetEntityStateRequest {
  static constexpr std::string_view name = "simulation_interfaces/srv/GetEntityState_Request";
  std::string entity{};
  static void fields(auto& m, auto& visit) { visit("entity", m.entity); }
};
struct GetEntityStateResponse {
  static constexpr std::string_view name = "simulation_interfaces/srv/GetEntityState_Response";
  SimulationResult result{};
  EntityState state{};
  static void fields(auto& m, auto& visit) {
    visit("result", m.result);
    visit("state", m.state);
  }
};
struct GetEntitiesStatesRequest {
  static constexpr std::string_view name = "simulation_interfaces/srv/GetEntitiesStates_Request";
  EntityFilters filters{};
  static void fields(auto& m, auto& visit) { visit("filters", m.filters); }
};
struct GetEntitiesStatesResponse {
  static constexpr std::string_view name = "simulation_interfaces/srv/GetEntitiesStates_Response";
  SimulationResult result{};
  std::vector<std::string> entities{};
  std::vector<EntityState> states{};
  static void fields(auto& m, auto& visit) {
    visit("result", m.result);
    visit("entities", m.entities);
    visit("states", m.states);
  }
};
struct SetEntityStateRequest {
  static constexpr std::string_view name = "simulation_interfaces/srv/SetEntityState_Request";
  std::string entity{};
  EntityState state{};
  static void fields(auto& m, auto& visit) {
    visit("entity", m.entity);
    visit("state", m.state);
  }
};
struct SetEntityStateRequest2 {
  static constexpr std::string_view name = "simulation_interfaces/srv/SetEntityState_Request";
  std::string entity{};
  EntityState state{};
  bool set_pose = false;
  bool set_twist = false;
  bool set_acceleration = false;
  static void fields(auto& m, auto& visit) {
    visit("entity", m.entity);
    visit("state", m.state);
    visit("set_pose", m.set_pose);
    visit("set_twist", m.set_twist);
    visit("set_acceleration", m.set_acceleration);
  }
};
struct SetEntityStateResponse {
  static constexpr std::string_view name = "simulation_interfaces/srv/SetEntityState_Response";
  SimulationResult result{};
  static void fields(auto& m, auto& visit) { visit("result", m.result); }
};
struct GetSpawnablesRequest {
  static constexpr std::string_view name = "simulation_interfaces/srv/GetSpawnables_Request";
  std::vector<std::string> sources{};
  static void fields(auto& m, auto& visit) { visit("sources", m.sources); }
};
struct GetSpawnablesResponse {
  static constexpr std::string_view name = "simulation_interfaces/srv/GetSpawnables_Response";
  SimulationResult result{};
  std::vector<Spawnable> spawnables{};
  static void fields(auto& m, auto& visit) {
    visit("result", m.result);
    visit("spawnables", m.spawnables);
  }
};
struct GetSpawnablesResponse2 {
  static constexpr std::string_view name = "simulation_interfaces/srv/GetSpawnables_Response";
  SimulationResult result{};
  std::vector<Spawnable2> spawnables{};
  static void fields(auto& m, auto& visit) {
    visit("result", m.result);
    visit("spawnables", m.spawnables);
  }
};
struct GetCurrentWorldRequest {
  static constexpr std::string_view name = "simulation_interfaces/srv/GetCurrentWorld_Request";
  std::uint8_t structure_needs_at_least_one_member = 0;
  static void fields(auto& m, auto& visit) { visit("structure_needs_at_least_one_member", m.structure_needs_at_least_one_member); }
};
struct GetCurrentWorldResponse {
  static constexpr std::string_view name = "simulation_interfaces/srv/GetCurrentWorld_Response";
  SimulationResult result{};
  WorldResource world{};
  static void fields(auto& m, auto& visit) {
    visit("result", m.result);
    visit("world", m.world);
  }
};

}  // namespace ros
