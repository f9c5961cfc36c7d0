// Robots and joints that viewers move by hand: the part of the studio that has the drives.
#include <algorithm>

#include "base/shell_word.h"
#include "base/text.h"
#include "studio/studio.h"

namespace studio {

using base::Error;
using base::Result;

void Studio::handle_drive(ClientSession& session, const Request& request) {
  const auto iface = text_of(request.args, "iface");
  if (!iface) return answer(session, request.id, iface.error());
  const auto velocity = numbers_of(request.args, "velocity", 3, 6);
  if (!velocity || (velocity->size() != 3 && velocity->size() != 6))
    return answer(session, request.id, Error{"velocity: expected 3 numbers (position2d) or 6 (position3d)"});
  std::vector<std::string> words = simctl_words(options_.server_id);
  words.emplace_back("velocity");
  std::vector<std::string> operands{*iface};
  for (const double number : *velocity) operands.push_back(base::format_number(number));
  const auto command = base::shell_line(base::command_words(std::move(words), operands));
  if (request.is_dry) return answer(session, request.id, Json::object(), command);
  if (options_.is_read_only) return answer(session, request.id, read_only(), command);
  const auto done = drives_.drive(session.viewer->id(), *iface, *velocity);
  answer(session, request.id, done ? Result<Json>(Json::object()) : Result<Json>(done.error()), command);
}

namespace {

Result<std::vector<JointCommand>> joint_commands(const Json& args) {
  const auto joints = args.find("joints");
  const Error wrong{"joints: expected an object of NAME: {mode, value}, at most 4096"};
  if (joints == args.end() || !joints->is_object() || joints->empty() || joints->size() > 4096) return wrong;
  std::vector<JointCommand> commands;
  for (const auto& [name, wanted] : joints->items()) {
    if (!wanted.is_object()) return wrong;
    const auto mode = text_of(wanted, "mode");
    const auto modes = joint_modes();
    if (!mode || std::ranges::find(modes, *mode) == modes.end())
      return Error{"mode of joint " + base::in_quotes(name) + ": expected position, velocity, effort, free or brake"};
    const bool has_value = *mode != "free" && *mode != "brake";
    const auto value = has_value ? number_of(wanted, "value") : Result<double>(0.0);
    if (!value) return Error{"value of joint " + base::in_quotes(name) + ": expected a number"};
    commands.push_back({name, *mode, *value});
  }
  return commands;
}

// A line for each mode, one beside the other: each waits until its joints have arrived.
std::string joints_line(std::uint32_t server_id, const std::string& iface, const std::vector<JointCommand>& commands) {
  const std::string ending = "::joints", model = iface.ends_with(ending) ? iface.substr(0, iface.size() - ending.size()) : iface;
  std::string line;
  for (const auto mode : joint_modes()) {
    std::vector<std::string> operands{model};
    for (const auto& command : commands) {
      if (command.mode != mode) continue;
      const bool has_value = mode != "free" && mode != "brake";
      operands.push_back(command.joint + (has_value ? "=" + base::format_number(command.value) : ""));
    }
    if (operands.size() == 1) continue;
    std::vector<std::string> words = simctl_words(server_id);
    words.emplace_back("joints");
    const auto options = mode == "position" ? std::vector<std::string>{} : std::vector<std::string>{"--mode", std::string(mode)};
    line += (line.empty() ? "" : " & ") + base::shell_line(base::command_words(std::move(words), operands, options));
  }
  return line;
}

}  // namespace

void Studio::handle_joints(ClientSession& session, const Request& request) {
  const auto iface = text_of(request.args, "iface");
  if (!iface) return answer(session, request.id, iface.error());
  const auto commands = joint_commands(request.args);
  if (!commands) return answer(session, request.id, commands.error());
  const auto line = joints_line(options_.server_id, *iface, *commands);
  if (request.is_dry) return answer(session, request.id, Json::object(), line);
  if (options_.is_read_only) return answer(session, request.id, read_only(), line);
  const auto done = drives_.move_joints(session.viewer->id(), *iface, *commands);
  answer(session, request.id, done ? Result<Json>(Json::object()) : Result<Json>(done.error()), line);
}

void Studio::handle_release(ClientSession& session, const Request& request) {
  const auto iface = text_of(request.args, "iface");
  if (!iface) return answer(session, request.id, iface.error());
  if (options_.is_read_only) return answer(session, request.id, read_only());
  drives_.release(session.viewer->id(), *iface);
  answer(session, request.id, Json::object());
}

}  // namespace studio
