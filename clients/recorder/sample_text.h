// Samples of a recording as JSON. An object belongs to one thread at a time.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "base/result.h"
#include "mcap/mcap.h"

namespace recorder {

using Json = nlohmann::ordered_json;

// What a channel's samples say. Types of ports by their IDL, JSON as it is; of others an error that names the encoding.
base::Result<Json> value_of(const mcap::Reader& reader, const mcap::Message& message);

// "data.vx" -> 0.5, "ranges[0]" -> 3.1: the numbers, texts and truths of a value with their places, in its order.
std::vector<std::pair<std::string, Json>> members_of(const Json& value);

// "12.345000000"
std::string seconds_text(mcap::Time time);

}  // namespace recorder
