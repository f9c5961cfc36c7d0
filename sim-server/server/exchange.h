// The world for viewers that draw it themselves: the whole scene once, then only the poses of links. Planned in the stepping thread; a plan
// never changes and any thread may write it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "render/gltf.h"
#include "server/simulation.h"
#include "shm/requests.h"

namespace sim {

// Everything that an export of one moment needs.
struct ExportPlan {
  Snapshot world;
  std::uint64_t version = 0;  // of what is seen, also when shapes that collide are exported: links are the same
  std::vector<GltfSensor> sensors;
  std::optional<Eigen::Isometry3d> camera;
};
ExportPlan plan_export(Simulation& simulation, const shm::ExportRequest& request);

// glTF 2.0 binary, see render/gltf.h.
base::Result<std::string> write_export(const ExportPlan& plan);

// As RTMSIM_REQUEST_POSES says.
shm::Reply poses_reply(Simulation& simulation);

}  // namespace sim
