#include "studio/foxglove.h"

#include <bit>

namespace studio {
namespace {

template <class T>
void put(std::string& out, T value) {
  for (std::size_t i = 0; i < sizeof value; ++i) out += static_cast<char>(value >> (8 * i) & 0xff);
}

constexpr char message_octet = 1;
constexpr char time_octet = 2;

std::uint64_t wire_time(std::chrono::nanoseconds time) { return static_cast<std::uint64_t>(std::max<std::int64_t>(time.count(), 0)); }

}  // namespace

void put_u16(std::string& out, std::uint16_t value) { put(out, value); }
void put_u32(std::string& out, std::uint32_t value) { put(out, value); }
void put_u64(std::string& out, std::uint64_t value) { put(out, value); }
void put_f32(std::string& out, float value) { put(out, std::bit_cast<std::uint32_t>(value)); }

std::string server_info(std::string_view session, bool has_graph) {
  return to_text({{"op", "serverInfo"},
                  {"name", "rtm-studio " RTMSIM_VERSION},
                  {"capabilities", has_graph ? Json::array({"time", "connectionGraph"}) : Json::array({"time"})},
                  {"metadata", Json::object()},
                  {"sessionId", std::string(session)}});
}

std::string status(int level, std::string_view message) {
  return to_text({{"op", "status"}, {"level", level}, {"message", std::string(message)}});
}

std::string message_data(std::uint32_t subscription, std::chrono::nanoseconds time, std::span<const char> octets) {
  std::string frame(1, message_octet);
  frame.reserve(13 + octets.size());
  put_u32(frame, subscription);
  put_u64(frame, wire_time(time));
  frame.append(octets.data(), octets.size());
  return frame;
}

std::string time_data(std::chrono::nanoseconds time) {
  std::string frame(1, time_octet);
  put_u64(frame, wire_time(time));
  return frame;
}

}  // namespace studio
