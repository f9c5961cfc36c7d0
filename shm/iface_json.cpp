#include "shm/iface_json.h"

#include <charconv>
#include <cmath>
#include <cstring>

namespace simctl {

using Json = nlohmann::ordered_json;
using shm::Field;

namespace {

Json pose_json(const shm::Pose& p) { return {{"position", {p.x, p.y, p.z}}, {"orientation", {p.qw, p.qx, p.qy, p.qz}}}; }

Json stamp_json(const shm::Stamp& stamp) {
  return {{"sequence", stamp.sequence},
          {"sim_time", static_cast<double>(stamp.sim_time_ns) / 1e9},
          {"wall_time", static_cast<double>(stamp.wall_time_ns) / 1e9},
          {"valid", stamp.valid != 0}};
}

// The shortest decimal that is this float, not the double next to it: 1.56 instead of 1.5600000619888306.
double shortest(float value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value);
  double result = value;
  std::from_chars(text, end.ptr, result);
  return result;
}

// JSON has no infinity: null stands for "nothing hit", -1 for "too near".
Json range_json(float range) { return std::isfinite(range) ? Json(shortest(range)) : range < 0 ? Json(-1) : Json(); }

// One value, or all of an array.
template <class T>
Json numbers(const void* at, std::size_t count) {
  const auto* values = static_cast<const T*>(at);
  if (count == 1) return values[0];
  return Json(std::vector<T>(values, values + count));
}

Json value_json(const Field& field, const void* whole) {
  const void* at = field.in(whole);
  switch (field.kind) {
    case Field::Kind::u32:
      return numbers<std::uint32_t>(at, field.count);
    case Field::Kind::u64:
      return numbers<std::uint64_t>(at, field.count);
    case Field::Kind::f64:
      return numbers<double>(at, field.count);
    case Field::Kind::f32:
      return range_json(*static_cast<const float*>(at));
    case Field::Kind::text:
      return std::string(static_cast<const char*>(at), strnlen(static_cast<const char*>(at), field.count));
    case Field::Kind::pose:
      return pose_json(*static_cast<const shm::Pose*>(at));
    case Field::Kind::stamp:
      return stamp_json(*static_cast<const shm::Stamp*>(at));
    case Field::Kind::flag:
      return *static_cast<const std::uint32_t*>(at) != 0;
    case Field::Kind::nanoseconds:
      return static_cast<double>(*static_cast<const std::int64_t*>(at)) / 1e9;
    case Field::Kind::followers:
      break;
  }
  return {};
}

// An array of what follows: of values, or of structures when the fields of an element have names.
Json array_json(const shm::Tail& tail, const std::byte* first, std::size_t count) {
  Json array = Json::array();
  for (std::size_t i = 0; i < count; ++i) {
    const std::byte* element = first + i * tail.size;
    if (tail.fields.front().name.empty()) {
      array.push_back(value_json(tail.fields.front(), element));
      continue;
    }
    Json object;
    for (const Field& field : tail.fields) object[std::string(field.name)] = value_json(field, element);
    array.push_back(std::move(object));
  }
  return array;
}

}  // namespace

Json info_json(const shm::Iface& iface) {
  const auto& row = shm::row_of(iface.type());
  Json json;
  for (const Field& field : row.info) {
    json[std::string(field.name)] = field.kind == Field::Kind::followers
                                        ? array_json(row.info_tail, iface.info_followers(field.count), iface.count())
                                        : value_json(field, iface.info_data().data());
  }
  return json;
}

Json sample_json(const shm::Iface& iface) {
  const auto& row = shm::row_of(iface.type());
  Json json;
  for (const Field& field : row.sample) {
    json[std::string(field.name)] = field.kind == Field::Kind::followers
                                        ? array_json(row.sample_tail, iface.sample_followers(field.count), iface.filled())
                                        : value_json(field, iface.sample_data().data());
  }
  return json;
}

Json frame_json(const shm::HeldFrame& frame) {
  Json json;
  for (const Field& field : shm::row_of(shm::IfaceType::camera).sample) json[std::string(field.name)] = value_json(field, &frame.head());
  return json;
}

Json participants_json(const std::vector<shm::ParticipantRecord>& participants) {
  Json list = Json::array();
  for (const auto& p : participants) {
    list.push_back({{"name", p.name},
                    {"pid", p.pid},
                    {"phase", p.phase},
                    {"period_ns", p.period_ns},
                    {"rate", p.period_ns > 0 ? 1e9 / static_cast<double>(p.period_ns) : 0.0},
                    {"ticks", p.ticks},
                    {"missed", p.missed},
                    {"mean_us", static_cast<double>(p.mean_ns) * 1e-3},
                    {"max_us", static_cast<double>(p.max_ns) * 1e-3},
                    {"active", p.is_active},
                    {"late", p.is_late}});
  }
  return list;
}

}  // namespace simctl
