// Converts samples with a ROS 2 schema (`ros2msg`) to JSON, from any writer. Input is untrusted: lengths are checked. Sequences and arrays
// of uint8 become base64. Values; any thread.
#pragma once

#include <cstddef>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace recorder {

// Of one sample that is shown as JSON; each takes sixteen octets of memory, a named one more.
inline constexpr std::size_t max_values = std::size_t{1} << 23;

class RosDefinition {
 public:
  // The text of a schema: the definition, then those that it needs behind lines of '=' and "MSG: package/Name".
  static base::Result<RosDefinition> parse(std::string_view text);
  // CDR behind the four octets that say the byte order.
  base::Result<nlohmann::ordered_json> decode(std::string_view octets) const;

  enum class Kind { boolean, int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64, string, message };
  struct Field {
    std::string name;
    Kind kind = Kind::message;
    std::size_t message = 0;  // its place
    enum class Shape { one, array, sequence } shape = Shape::one;
    std::size_t size = 0;  // of an array
  };
  struct Message {
    std::string name;  // "package/Name"; that of the root is empty
    std::vector<Field> fields;
  };

 private:
  std::vector<Message> messages_;  // the root first
};

}  // namespace recorder
