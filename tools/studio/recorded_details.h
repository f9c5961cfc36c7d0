// Events and replies that describe a recording (docs/develop/studio-protocol.md). One thread at a time.
#pragma once

#include <string>

#include "base/result.h"
#include "studio/playhead.h"
#include "studio/recorded_scene.h"
#include "studio/recording_facts.h"

namespace studio {

inline constexpr double recorded_step_s = 0.02;  // in which poses are recorded

// The events "hello", "system" and "world". Without a scene, `problem` says why; if it is empty, the scene is being made.
Json recorded_hello(const RecordingFacts& facts);
Json recorded_system(const RecordingFacts& facts);
Json recorded_world(const RecordingFacts& facts, const RecordedScene* scene, const std::string& problem);

// The reply to "component": the component as the profile describes it, with the parameters at the time of the playhead. An error if the
// recording has no such path.
base::Result<Json> recorded_details(const RecordingFacts& facts, const std::string& path, Playhead& playhead);

}  // namespace studio
