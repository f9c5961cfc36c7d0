// The extent of a driven body, as drives describe it. Pure; any thread.
#pragma once

#include "shm/iface_types.h"
#include "world/world_def.h"

namespace sim {

// The middle of the body in the frame of the model, unturned, and its length, width and height [m]; zeros for a body without shapes.
void describe_body(const ModelDef& model, shm::Pose& middle, double (&size)[3]);

}  // namespace sim
