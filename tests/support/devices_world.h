// worlds/devices.sdf, which has a device of each type.
#pragma once

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <utility>

#include "support/paths.h"
#include "world/world_loader.h"

namespace sim::test {

inline WorldDef devices_world() {
  const std::string worlds = std::string(paths::source_dir) + "/worlds";
  auto loaded = load_world(worlds + "/devices.sdf", ModelPath::from_environment({}, worlds));
  if (!loaded) throw std::runtime_error(loaded.error().message);
  EXPECT_TRUE(loaded->findings.empty()) << loaded->findings.front().text();
  return std::move(loaded->world);
}

}  // namespace sim::test
