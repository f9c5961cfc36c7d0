// Pictures of a running world for `screenshot`, drawn by the renderer; fans, trails and names are laid over when asked for. The stepping
// thread only.
#pragma once

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

base::Result<Image> draw_picture(Simulation& simulation, const shm::ScreenshotRequest& request);

}  // namespace sim
