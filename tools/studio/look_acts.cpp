// What viewers ask to know, and changes nothing: what a signal has in it, what contexts have really done, a picture by the simulator.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/base64.h"
#include "base/shell_word.h"
#include "base/text.h"
#include "run/time_members.h"
#include "shm/client.h"
#include "shm/iface_json.h"
#include "shm/request_board.h"
#include "studio/acts.h"
#include "system/session.h"
#include "system/value_codec.h"

namespace studio {
namespace {

using base::Error;
using base::Result;

constexpr std::size_t max_found = 400;  // members of one signal
constexpr int deepest = 12;
constexpr std::chrono::seconds picture_limit{25};
constexpr double longest_side = 4096;  // [pixels]

// ---- members

void add_member(Json& list, const std::string& path, const char* type) {
  if (list.size() < max_found && !path.empty()) list.push_back({{"path", path}, {"type", type}});
}

// Of a sequence its first element.
void add_members(Json& list, CORBA::TypeCode_ptr code, const std::string& path, int depth) {
  const auto type = tools::resolved(code);
  switch (type->kind()) {
    case CORBA::tk_struct:
      for (CORBA::ULong i = 0; depth < deepest && i < type->member_count(); ++i) {
        const CORBA::TypeCode_var member = type->member_type(i);
        add_members(list, member, (path.empty() ? "" : path + ".") + type->member_name(i), depth + 1);
      }
      break;
    case CORBA::tk_sequence:
    case CORBA::tk_array: {
      const CORBA::TypeCode_var element = type->content_type();
      if (depth < deepest) add_members(list, element, path + "[0]", depth + 1);
      break;
    }
    case CORBA::tk_string:
    case CORBA::tk_wstring:
      add_member(list, path, "text");
      break;
    case CORBA::tk_boolean:
      add_member(list, path, "boolean");
      break;
    default:
      add_member(list, path, "number");
  }
}

void add_members(Json& list, const Json& value, const std::string& path) {
  if (value.is_object()) {
    for (const auto& [key, inner] : value.items()) add_members(list, inner, (path.empty() ? "" : path + ".") + key);
  } else if (value.is_array()) {
    for (std::size_t i = 0; i < value.size() && list.size() < max_found; ++i)
      add_members(list, value[i], path + "[" + std::to_string(i) + "]");
  } else {
    add_member(list, path, value.is_boolean() ? "boolean" : value.is_string() ? "text" : "number");
  }
}

// With a value of that type in which everything is zero: what one changes to write to such a port.
Result<Json> members_of_port(const ActContext& context, const std::string& path) {
  const tools::Session session(context.orb, context.name_server, context.call_limit);
  const auto port = session.port(path);
  if (!port) return port.error();
  const auto type = tools::type_code_of(port->port.data_type());
  if (CORBA::is_nil(type)) return Error{"port " + path + ": its type " + port->port.data_type() + " is not known"};
  Json list = Json::array();
  add_members(list, type, "", 0);
  const auto octets = tools::encode(type, Json::object());
  if (!octets) return octets.error();
  const auto zero = tools::decode(type, *octets);
  if (!zero) return zero.error();
  return Json{{"members", std::move(list)}, {"zero", *zero}};
}

Result<Json> members_of_iface(const ActContext& context, const std::string& topic) {
  const auto colon = std::min(topic.find(':'), topic.size());
  const auto type = shm::parse_type(topic.substr(0, colon));
  if (!type || colon == topic.size()) return Error{"signal " + topic + ": expected TYPE:IFACE"};
  auto iface = shm::Iface::open(context.server_id, *type, topic.substr(colon + 1));
  if (!iface) return iface.error();
  Json list = Json::array();
  if (shm::has_frames(*type)) return Json{{"members", std::move(list)}};
  (void)iface->read();  // what was never measured is zero
  add_members(list, Json(simctl::sample_json(*iface)), "");
  return Json{{"members", std::move(list)}};
}

Result<Plan> members(const ActContext& context, const Json& args) {
  const auto topic = text_of(args, "topic");
  if (!topic) return topic.error();
  return Plan{"", [context, topic = *topic] {
                return topic.starts_with('/') ? members_of_port(context, topic) : members_of_iface(context, topic);
              }};
}

// ---- statistics

// What contexts of this runtime have really done, by component; others tell their rate.
Result<Json> context_statistics(const ActContext& context) {
  const tools::Session session(context.orb, context.name_server, context.call_limit);
  const auto tree = session.tree();
  if (!tree) return tree.error();
  Json list = Json::array();
  for (const auto& component : tools::read_components(*tree, {.contexts = true}, context.call_limit)) {
    const auto* shown = component.problem.empty() ? component.shown_context() : nullptr;
    if (shown == nullptr) continue;
    const auto number = [&](const char* key) {
      return base::parse_number(tools::property(shown->properties, std::string("statistics.") + key)).value_or(0);
    };
    Json one{{"path", component.path}, {"rate", shown->rate}, {"running", shown->is_running}};
    if (shown->properties.contains("statistics.cycles")) {
      one["cycles"] = number("cycles");
      one["missed"] = number("missed_cycles");
      one["mean_ms"] = 1000 * number("mean_execution_time");
      one["max_ms"] = 1000 * number("max_execution_time");
      one["wait_ms"] = 1000 * number("mean_waiting_time");
    }
    list.push_back(std::move(one));
  }
  return Json{{"contexts", std::move(list)}};
}

Result<Plan> statistics(const ActContext& context, const Json&) {
  return Plan{"", [context] { return context_statistics(context); }};
}

// ---- pictures

// Of the eye that is given: {png} in base64.
Result<Plan> screenshot(const ActContext& context, const Json& args) {
  const auto pose = numbers_of(args, "pose", 7, 7);
  if (!pose) return pose.error();
  const double width = number_or(args, "width", 800), height = number_or(args, "height", 600), span = number_or(args, "span", 0);
  if (!(width >= 1 && width <= longest_side && height >= 1 && height <= longest_side)) return Error{"width, height: expected 1 to 4096"};
  if (!(span >= 0 && span <= 1e5)) return Error{"span: expected 0 to 1e5"};
  shm::ScreenshotRequest request;
  const auto& v = *pose;
  request.pose = {v[0], v[1], v[2], v[3], v[4], v[5], v[6]};
  request.width = static_cast<std::uint32_t>(width);
  request.height = static_cast<std::uint32_t>(height);
  request.span = span;
  request.with_scans = flag_of(args, "scans");
  request.with_collisions = flag_of(args, "collisions");
  const bool is_from_top = flag_of(args, "top");
  request.view = is_from_top ? shm::ScreenshotRequest::View::top : shm::ScreenshotRequest::View::from;
  std::vector<std::string> words = simctl_words(context.server_id);
  words.insert(words.end(),
               {"screenshot", "world.png", "--size", base::format_number(request.width) + "x" + base::format_number(request.height)});
  const auto short_number = [](double value) { return base::format_number(std::round(value * 1e4) / 1e4); };
  if (is_from_top) {
    words.emplace_back("--top");
    if (span > 0) words.insert(words.end(), {"--at", base::join({short_number(v[0]), short_number(v[1])}, " ")});
  } else {
    const auto [roll, pitch, yaw] = angles_of(request.pose);
    std::vector<std::string> numbers;
    for (const double number : {v[0], v[1], v[2], roll, pitch, yaw}) numbers.push_back(short_number(number));
    words.insert(words.end(), {"--from", base::join(numbers, " ")});
  }
  if (span > 0) words.insert(words.end(), {"--span", short_number(span)});
  if (request.with_scans) words.emplace_back("--scans");
  if (request.with_collisions) words.insert(words.end(), {"--show", "collisions"});
  return Plan{base::shell_line(words), [id = context.server_id, request]() -> Result<Json> {
                auto simulator = shm::Requester::open(id);
                if (!simulator) return simulator.error();
                const auto reply = simulator->ask(request, picture_limit);
                if (!reply) return reply.error();
                if (reply->status != shm::RequestStatus::ok) return Error{"screenshot: " + reply->message};
                return Json{{"png", base::to_base64(reply->text)}};
              }};
}

}  // namespace

std::array<double, 3> angles_of(const shm::Pose& p) {
  return {std::atan2(2 * (p.qw * p.qx + p.qy * p.qz), 1 - 2 * (p.qx * p.qx + p.qy * p.qy)),
          std::asin(std::clamp(2 * (p.qw * p.qy - p.qz * p.qx), -1.0, 1.0)),
          std::atan2(2 * (p.qw * p.qz + p.qx * p.qy), 1 - 2 * (p.qy * p.qy + p.qz * p.qz))};
}

std::vector<Act> look_acts() { return {{"members", true, members}, {"statistics", true, statistics}, {"screenshot", true, screenshot}}; }

}  // namespace studio
