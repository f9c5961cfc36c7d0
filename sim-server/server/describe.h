// Describes the content and the statistics of a simulation, as JSON for clients. The stepping thread only.
#pragma once

#include <string>
#include <vector>

#include "server/simulation.h"
#include "shm/lockstep.h"
#include "world/world_loader.h"

namespace sim {

// What the loop knows besides.
struct LoopState {
  bool is_paused = false;
  std::uint32_t waiting_for = 0;  // participants that must join before time starts
  double rtf_wanted = 1, rtf_reached = 0, load = 0;
  std::vector<shm::ParticipantRecord> participants;
  const PartTimes* times = nullptr;
};

// {"world", "models": [{"name", "static", "pose"}], "ifaces": [{"type", "name", "model", "subscribed"}]}
std::string list_text(Simulation& simulation);
// {"models": [{"name", "static", "pose", "links": [...], "joints": [...], "plugins": [...]}]}; links have "collisions":
// [{"name", "shape", "pose": in the link, "size"}], size being the three of a box, the radius, or radius and length [m]. Of one model, or
// of all when `model` is empty. With bounds, models have "bounds": the lowest x, y and z of the shapes that collide, and the highest ones,
// in the model's frame [m]; null: no end; []: nothing collides.
std::string tree_text(const Simulation& simulation, const std::string& model, bool with_bounds = false);
// The same with {"found": [{"folder", "uri", "file"}], "spawned": [{"model", "files" or "error"}]}: what the URIs in the files of the world
// mean, and all files of each model of `spawned`, as it would be spawned from
// this path.
std::string check_text(const Simulation& simulation, const FoundFiles& found, const std::vector<std::string>& spawned,
                       const ModelPath& model_path);
// {"models": [{"name"}]}: those of the model path.
std::string models_text(const ModelPath& path);
std::string stats_text(Simulation& simulation, const LoopState& loop);
// {"model", "total", "contacts": [{"link", "other", "position", "normal", "depth"}]}: those of the last step.
std::string contacts_text(const Simulation& simulation, ModelId model);
// {"time", "faults": [{"iface", "kind", "amount", "from", "until", "on"}]}: those that have not ended, of one iface, or of all when `iface`
// is empty. Seconds; no amount and no end are null.
std::string faults_text(const Simulation& simulation, const std::string& iface);

// Pages in use by this process [bytes].
std::size_t resident_memory();

}  // namespace sim
