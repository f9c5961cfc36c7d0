// The world as glTF, by the simulator. Any thread; waits for the simulator, at most a minute.
#pragma once

#include <cstdint>
#include <string>

#include "studio/web.h"

namespace studio {

Content export_scene(std::uint32_t server_id, bool with_collisions);
// 503 and a line.
Content refusal(const std::string& why);

}  // namespace studio
