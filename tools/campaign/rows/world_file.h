// A world file in which single values can be changed by a path. Only values that a plan can vary are understood
// here; the simulator interprets the world. Included models are changed in copies. One thread at a time; reading is
// const.
//
//   model/NAME/pose          x y z roll pitch yaw; also .../pose/x, y, z, roll, pitch, yaw   [m, rad]
//   model/NAME/mass          of all links together [kg]; the inertia goes with it
//   model/NAME/friction      of all that collides (mu, mu2)
//   model/NAME/sensor/SENSOR/noise   standard deviation, in the sensor's unit
//   model/NAME/sensor/SENSOR/rate    [Hz]
//   light/NAME/intensity, light/NAME/diffuse, light/NAME/direction
//   world/gravity, world/step
#pragma once

#include <memory>
#include <string>

#include "base/result.h"
#include "campaign/rows/world_survey.h"

namespace campaign {

using base::Error;
using base::Result;

class WorldFile {
 public:
  // `survey`: of the same file; must live as long.
  static Result<WorldFile> read(const std::string& file, const WorldSurvey& survey);
  WorldFile(WorldFile&&) noexcept;
  WorldFile& operator=(WorldFile&&) noexcept;
  ~WorldFile();

  // An error when the world has no such value, or it cannot be this.
  Result<void> set(const std::string& path, const std::string& value);
  // Writes what has been set as FOLDER/world.sdf, with changed models in FOLDER/models. Other files stay where they were found.
  Result<void> write(const std::string& folder) const;
  // The folder of the world itself, in which the simulator must look for models of a changed one.
  std::string folder() const;

 private:
  struct State;
  explicit WorldFile(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

// Whether a parameter path of a plan is about the world.
bool is_world_path(const std::string& path);

}  // namespace campaign
