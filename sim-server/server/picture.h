// Pictures of a running world for `screenshot`; fans, trails and names are laid over when asked for. Planned in the stepping thread; a plan
// never changes and any thread may draw it.
#pragma once

#include <optional>

#include "base/result.h"
#include "render/image.h"
#include "render/renderer.h"
#include "server/simulation.h"
#include "shm/requests.h"

namespace sim {

// The view that a request asks for. Fails when the model to follow or the camera does not exist.
base::Result<View> view_of(Simulation& simulation, const Snapshot& world, const shm::ScreenshotRequest& request);

// Scans, trails and names of everything that moves and measures. The first scanner is blue, the second green.
Overlay overlay_of(Simulation& simulation, const Snapshot& world);

// Everything that a picture of one moment needs.
struct PicturePlan {
  Snapshot world;
  View view;
  std::optional<Overlay> overlay;
};
base::Result<PicturePlan> plan_picture(Simulation& simulation, const shm::ScreenshotRequest& request);

base::Result<Image> draw_picture(Renderer& renderer, const PicturePlan& plan);

}  // namespace sim
