// Parses the messages of a viewer strictly. Invalid ones are rejected, with no other effect. Values; any thread.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "base/result.h"
#include "studio/foxglove_message.h"

namespace studio {

inline constexpr std::size_t max_message = 1 << 20;   // octets of a frame
inline constexpr std::size_t max_open_requests = 32;  // of a viewer
inline constexpr std::size_t max_watches = 512;       // signals that all viewers watch
inline constexpr std::size_t max_members = 256;       // of a watch

// Of rtmsim.studio.v1.
struct Request {
  std::int64_t id = 0;
  std::string name;
  Json args;
  bool is_dry = false;
};
// Of foxglove.websocket.v1, and not offered by us: a client may say it all the same.
struct Unused {
  std::string op;
};

using ClientMessage =
    std::variant<Subscribe, Unsubscribe, GraphWish, Advertise, Unadvertise, GetParameters, SetParameters, ParameterWish, Request, Unused>;

base::Result<ClientMessage> parse_message(std::string_view text);

// Its brackets, outside of texts, are at most 24 deep: more would be work for nothing.
bool is_flat_enough(std::string_view text);

// JSON as text for the wire; what is no UTF-8 becomes a replacement character.
std::string to_text(const Json& json);
// The text that answers the request `id`: a result or an error, and what one would have typed, if anything.
std::string reply_text(std::int64_t id, const base::Result<Json>& result, const std::string& command = "");

// What the newest values of a watch are called while they wait for a slow viewer.
std::string values_key(std::uint32_t watch);

// The list with this key; an empty one when there is none.
const Json& list_in(const Json& object, const char* key);

// ---- arguments of requests: the value, or an error that names it and says what was expected ----
base::Result<std::string> text_of(const Json& args, const std::string& key);
std::string text_or(const Json& args, const std::string& key, const std::string& otherwise);
base::Result<double> number_of(const Json& args, const std::string& key);
base::Result<std::uint32_t> whole_number_of(const Json& args, const std::string& key);
// At most 1024.
base::Result<std::vector<std::uint32_t>> whole_numbers_of(const Json& args, const std::string& key);
double number_or(const Json& args, const std::string& key, double otherwise);
bool flag_of(const Json& args, const std::string& key);
// `min` to `max` finite numbers.
base::Result<std::vector<double>> numbers_of(const Json& args, const std::string& key, std::size_t min, std::size_t max);
base::Result<std::vector<std::string>> texts_of(const Json& args, const std::string& key, std::size_t min, std::size_t max);
// An object of texts.
base::Result<std::vector<std::pair<std::string, std::string>>> values_of(const Json& args, const std::string& key);

}  // namespace studio
