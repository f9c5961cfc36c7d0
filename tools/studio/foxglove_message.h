// Parses what viewers send by foxglove.websocket.v1, strictly. Values; any thread.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "base/result.h"

namespace studio {

using Json = nlohmann::ordered_json;

inline constexpr std::size_t max_subscriptions = 1024;  // of a viewer; also of channels that it publishes, and names in a message

struct Subscribe {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> subscriptions;  // id, channel
};
struct Unsubscribe {
  std::vector<std::uint32_t> ids;
};
struct GraphWish {
  bool is_wanted = false;  // the connection graph
};
// A channel that the viewer publishes on.
struct Publication {
  std::uint32_t id = 0;  // the viewer's choice
  std::string topic, encoding, schema;
};
struct Advertise {
  std::vector<Publication> channels;
};
struct Unadvertise {
  std::vector<std::uint32_t> ids;
};
struct GetParameters {
  std::vector<std::string> names;  // none: all
  std::optional<std::string> id;   // for the answer
};
struct SetParameters {
  std::vector<std::pair<std::string, Json>> values;
  std::optional<std::string> id;  // without it no answer is wanted
};
struct ParameterWish {
  std::vector<std::string> names;  // none: all
  bool is_wanted = false;
};

// Binary frames; the views are into the frame.
struct PublishedData {
  std::uint32_t channel = 0;
  std::string_view payload;
};
struct ServiceCall {
  std::uint32_t service = 0, call = 0;
  std::string_view encoding, payload;
};

using FoxgloveFrame = std::variant<PublishedData, ServiceCall>;
base::Result<FoxgloveFrame> parse_frame(std::string_view octets);

// Messages with other values of `op` are none of these.
using FoxgloveText = std::variant<Subscribe, Unsubscribe, GraphWish, Advertise, Unadvertise, GetParameters, SetParameters, ParameterWish>;
base::Result<std::optional<FoxgloveText>> parse_foxglove(const std::string& op, const Json& message);

}  // namespace studio
