// The frames of foxglove.websocket.v1 that a server sends. Values; any thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "studio/client_message.h"

namespace studio {

inline constexpr std::string_view foxglove_protocol = "foxglove.websocket.v1";
inline constexpr std::string_view foxglove_sdk_protocol = "foxglove.sdk.v1";  // newer clients; the same messages
inline constexpr std::string_view studio_protocol = "rtmsim.studio.v1";

// Octets that are the same on the wire of every machine: the low one first.
void put_u16(std::string& out, std::uint16_t value);
void put_u32(std::string& out, std::uint32_t value);
void put_u64(std::string& out, std::uint64_t value);
void put_f32(std::string& out, float value);

// `has_graph`: it answers subscribeConnectionGraph.
std::string server_info(std::string_view session, bool has_graph);
std::string status(int level, std::string_view message);  // 0 info, 1 warning, 2 error
std::string message_data(std::uint32_t subscription, std::chrono::nanoseconds time, std::span<const char> octets);
std::string time_data(std::chrono::nanoseconds time);

}  // namespace studio
