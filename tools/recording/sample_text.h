// Converts samples of a recording to JSON. An object belongs to one thread at a time.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "base/result.h"
#include "recording/mcap/mcap.h"
#include "recording/ros_text.h"

namespace recorder {

using Json = nlohmann::ordered_json;

// What the samples of a file say: types of ports by their IDL, definitions of ROS 2, JSON as it is; of others an error that names the
// encoding. Keeps what it has learnt of the schemas. A sample of more than max_values values, or of JSON that is nested too deep, is an
// error.
class SampleValues {
 public:
  // The reader must live as long.
  explicit SampleValues(const mcap::Reader& reader) : reader_(reader) {}
  base::Result<Json> of(const mcap::Message& message);

 private:
  base::Result<Json> ros_value(const mcap::Schema& schema, std::string_view octets);
  const mcap::Reader& reader_;
  std::map<std::uint16_t, base::Result<RosDefinition>> definitions_;  // by schema
};

// "data.vx" -> 0.5, "ranges[0]" -> 3.1: the numbers, texts and truths of a value with their places, in its order; not more than `most`.
std::vector<std::pair<std::string, Json>> members_of(const Json& value, std::size_t most = max_values);
// "data" and "vx" -> "data.vx".
std::string place_of(const std::string& outer, const std::string& key);

// In one line. What is no UTF-8 is replaced, control characters are escaped.
std::string json_text(const Json& value);

// "12.345000000"
std::string seconds_text(mcap::Time time);

}  // namespace recorder
