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

// What a server offers: a recording; a system that is shown; one that viewers may change.
enum class Offer { nothing, looking, acting };
std::string server_info(std::string_view session, Offer offer);
std::string service_failure(std::uint32_t service, std::uint32_t call, std::string_view message);
std::string service_answer(std::uint32_t service, std::uint32_t call, std::string_view encoding, std::string_view payload);
std::string status(int level, std::string_view message);  // 0 info, 1 warning, 2 error
std::string message_data(std::uint32_t subscription, std::chrono::nanoseconds time, std::span<const char> octets);
std::string time_data(std::chrono::nanoseconds time);

}  // namespace studio
