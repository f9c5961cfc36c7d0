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
constexpr char service_octet = 3;

std::uint64_t wire_time(std::chrono::nanoseconds time) { return static_cast<std::uint64_t>(std::max<std::int64_t>(time.count(), 0)); }

}  // namespace

void put_u16(std::string& out, std::uint16_t value) { put(out, value); }
void put_u32(std::string& out, std::uint32_t value) { put(out, value); }
void put_u64(std::string& out, std::uint64_t value) { put(out, value); }
void put_f32(std::string& out, float value) { put(out, std::bit_cast<std::uint32_t>(value)); }

std::string server_info(std::string_view session, Offer offer) {
  Json capabilities = Json::array({"time"});
  if (offer != Offer::nothing)
    capabilities.insert(capabilities.end(), {"connectionGraph", "parameters", "parametersSubscribe", "services"});
  if (offer == Offer::acting) capabilities.push_back("clientPublish");
  return to_text({{"op", "serverInfo"},
                  {"name", "rtm-studio " RTMSIM_VERSION},
                  {"capabilities", capabilities},
                  {"supportedEncodings", Json::array({"json", "cdr"})},
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

std::string service_failure(std::uint32_t service, std::uint32_t call, std::string_view message) {
  return to_text({{"op", "serviceCallFailure"}, {"serviceId", service}, {"callId", call}, {"message", std::string(message)}});
}

std::string service_answer(std::uint32_t service, std::uint32_t call, std::string_view encoding, std::string_view payload) {
  std::string frame(1, service_octet);
  put_u32(frame, service);
  put_u32(frame, call);
  put_u32(frame, static_cast<std::uint32_t>(encoding.size()));
  return frame.append(encoding).append(payload);
}

std::string time_data(std::chrono::nanoseconds time) {
  std::string frame(1, time_octet);
  put_u64(frame, wire_time(time));
  return frame;
}

}  // namespace studio
