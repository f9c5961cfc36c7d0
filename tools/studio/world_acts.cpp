// Acts on the simulated world.
#include <algorithm>

#include "base/shell_word.h"
#include "base/text.h"
#include "shm/lockstep.h"
#include "shm/request_board.h"
#include "studio/acts.h"

namespace studio {
namespace {

using base::Error;
using base::Result;
using Touches = Plan::Touches;

constexpr std::chrono::seconds usual_limit{10};
constexpr std::chrono::hours step_limit{24};  // a simulator that dies is noticed anyway, and pause ends it
constexpr double max_steps = 1e9;

using Read = std::function<Json(const shm::Reply&)>;

Json no_result(const shm::Reply&) { return Json::object(); }

Result<Json> ask(std::uint32_t server_id, const shm::Request& request, std::chrono::nanoseconds limit, const Read& read) {
  auto simulator = shm::Requester::open(server_id);
  if (!simulator) return simulator.error();
  const auto reply = simulator->ask(request, limit);
  if (!reply) return reply.error();
  if (reply->status != shm::RequestStatus::ok) return Error{std::string(shm::request_name(request)) + ": " + reply->message};
  return read(*reply);
}

// `words`: of simctl; empty: nothing can be typed for it.
Plan plan(const ActContext& context, shm::Request request, const std::vector<std::string>& words, Read read = no_result,
          Touches touches = Touches::world, std::chrono::nanoseconds limit = usual_limit) {
  std::vector<std::string> line = simctl_words(context.server_id);
  line.insert(line.end(), words.begin(), words.end());
  return {words.empty() ? "" : base::shell_line(line),
          [id = context.server_id, request = std::move(request), read = std::move(read), limit] { return ask(id, request, limit, read); },
          touches};
}

// `verb` of simctl and what it is about, whose name may be anything.
std::vector<std::string> about(const std::string& verb, const std::string& name, const std::vector<double>& numbers = {},
                               const std::vector<std::string>& options = {}) {
  std::vector<std::string> operands{name};
  for (const double number : numbers) operands.push_back(base::format_number(number));
  return base::command_words({verb}, operands, options);
}

std::vector<std::string> with_numbers(std::vector<std::string> words, const std::vector<double>& numbers) {
  for (const double number : numbers) words.push_back(base::format_number(number));
  return words;
}

shm::Pose pose_from(const std::vector<double>& v) { return {v[0], v[1], v[2], v[3], v[4], v[5], v[6]}; }

Json json_of(const shm::Reply& reply) {
  Json json = Json::parse(reply.text, nullptr, false);
  return json.is_object() ? json : Json::object();
}

Result<Plan> run(const ActContext& context, const Json&) { return plan(context, shm::RunRequest{}, {"run"}); }
Result<Plan> pause(const ActContext& context, const Json&) { return plan(context, shm::PauseRequest{}, {"pause"}); }

// Until the next tick of a participant of the lock step: they tick at multiples of their periods.
Result<double> steps_to_tick(std::uint32_t server_id, const std::string& name) {
  auto simulation = shm::Iface::open(server_id, shm::IfaceType::simulation, "world");
  if (!simulation) return simulation.error();
  const auto participants = shm::read_participants(*simulation);
  if (!participants) return participants.error();
  const auto found = std::find_if(participants->begin(), participants->end(), [&](const auto& p) { return p.name == name; });
  if (found == participants->end() || found->period_ns <= 0)
    return Error{"participant " + base::in_quotes(name) + ": takes no part in a lock step"};
  const auto step = simulation->info<shm::SimulationInfo>().step_ns;
  if (!simulation->read() || step <= 0) return Error{"simulator: its clock cannot be read"};
  const auto now = static_cast<std::int64_t>(simulation->sample<shm::SimulationSample>().stamp.sim_time_ns);
  if (now == 0) return 1;  // the first step begins with the tick at 0
  const auto due = (now / found->period_ns + 1) * found->period_ns;
  return static_cast<double>((due - now + step - 1) / step);
}

Result<Plan> step(const ActContext& context, const Json& args) {
  double steps = number_or(args, "steps", 1);
  if (args.contains("participant")) {
    const auto name = text_of(args, "participant");
    if (!name) return name.error();
    const auto until = steps_to_tick(context.server_id, *name);
    if (!until) return until.error();
    steps = *until;
  }
  if (!(steps >= 1 && steps <= max_steps)) return Error{"steps: expected 1 to 1e9"};
  const bool is_paced = flag_of(args, "paced");
  std::vector<std::string> words{"step", base::format_number(steps)};
  if (is_paced) words.emplace_back("--paced");
  return plan(
      context, shm::StepRequest{static_cast<std::int64_t>(steps), is_paced}, words,
      [](const shm::Reply& reply) {
        return Json{{"sim_time", static_cast<double>(reply.sim_time_ns) / 1e9}, {"steps", reply.steps}};
      },
      Touches::world, step_limit);
}

Result<Plan> reset_world(const ActContext& context, const Json& args) {
  const bool poses_only = flag_of(args, "poses_only");
  std::vector<std::string> words{"reset"};
  if (poses_only) words.emplace_back("--poses");
  return plan(context, shm::ResetRequest{poses_only}, words);
}

Result<Plan> speed(const ActContext& context, const Json& args) {
  const auto rtf = number_of(args, "rtf");
  if (!rtf) return rtf.error();
  if (*rtf < 0 || *rtf > 1e6) return Error{"rtf: expected 0 (as fast as possible) to 1e6"};
  return plan(context, shm::SetRtfRequest{*rtf}, {"rtf", base::format_number(*rtf)});
}

Result<Plan> tree(const ActContext& context, const Json& args) {
  const auto model = text_or(args, "model", "");
  const auto words = model.empty() ? std::vector<std::string>{"tree"} : about("tree", model);
  return plan(context, shm::TreeRequest{model}, words, json_of, Touches::nothing);
}

Result<Plan> models(const ActContext& context, const Json&) {
  return plan(context, shm::ModelsRequest{}, {"models"}, json_of, Touches::nothing);
}

Result<Plan> contacts(const ActContext& context, const Json& args) {
  const auto model = text_of(args, "model");
  if (!model) return model.error();
  return plan(context, shm::ContactsRequest{*model}, about("contacts", *model), json_of, Touches::nothing);
}

Result<Plan> set_pose(const ActContext& context, const Json& args) {
  const auto model = text_of(args, "model");
  if (!model) return model.error();
  shm::SetPoseRequest request;
  request.model = *model;
  if (args.contains("planar")) {
    const auto numbers = numbers_of(args, "planar", 3, 3);
    if (!numbers) return numbers.error();
    request.is_planar = true;
    request.pose = shm::planar_pose((*numbers)[0], (*numbers)[1], 0, (*numbers)[2]);
    return plan(context, request, about("pose", *model, *numbers));
  }
  const auto numbers = numbers_of(args, "pose", 7, 7);
  if (!numbers) return numbers.error();
  request.pose = pose_from(*numbers);
  const auto [roll, pitch, yaw] = angles_of(request.pose);
  return plan(context, request, about("pose", *model, {request.pose.x, request.pose.y, request.pose.z, roll, pitch, yaw}));
}

Result<Plan> push(const ActContext& context, const Json& args) {
  const auto name = text_of(args, "name");
  if (!name) return name.error();
  const auto force = numbers_of(args, "force", 3, 3);
  if (!force) return force.error();
  const auto torque = args.contains("torque") ? numbers_of(args, "torque", 3, 3) : Result<std::vector<double>>(std::vector<double>(3, 0.0));
  if (!torque) return torque.error();
  const double seconds = number_or(args, "seconds", 0);
  if (seconds < 0 || seconds > 1e6) return Error{"seconds: expected 0 (one step) to 1e6"};
  shm::WrenchRequest request;
  request.name = *name;
  std::copy(force->begin(), force->end(), request.force);
  std::copy(torque->begin(), torque->end(), request.torque);
  request.duration = seconds;
  auto numbers = *force;
  if (args.contains("torque")) numbers.insert(numbers.end(), torque->begin(), torque->end());
  std::vector<std::string> options;
  if (seconds > 0) options = {"--for", base::format_number(seconds)};
  return plan(context, request, about("wrench", *name, numbers, options));
}

Result<Plan> set_velocity(const ActContext& context, const Json& args) {
  const auto model = text_of(args, "model");
  if (!model) return model.error();
  const auto linear = numbers_of(args, "linear", 3, 3), angular = numbers_of(args, "angular", 3, 3);
  if (!linear) return linear.error();
  if (!angular) return angular.error();
  auto numbers = *linear;
  numbers.insert(numbers.end(), angular->begin(), angular->end());
  shm::SetVelocityRequest request;
  request.model = *model;
  std::copy(linear->begin(), linear->end(), request.linear);
  std::copy(angular->begin(), angular->end(), request.angular);
  return plan(context, request, about("velocity", *model, numbers));
}

// A model of the model path, or SDF as text; never a file of the server's, not in an address in the text either.
Result<Plan> spawn(const ActContext& context, const Json& args) {
  shm::SpawnRequest request;
  request.is_confined = true;
  if (args.contains("sdf")) {
    auto sdf = text_of(args, "sdf");
    if (!sdf) return sdf.error();
    if (sdf->find('<') == std::string::npos) return Error{"sdf: expected the text of a model"};
    request.sdf = std::move(*sdf);
  } else {
    const auto model = text_of(args, "model");
    if (!model) return model.error();
    const auto name = model->starts_with("model://") ? model->substr(8) : *model;
    if (name.empty() || name.find('/') != std::string::npos || name.find("..") != std::string::npos)
      return Error{"model " + base::in_quotes(*model) + ": expected the name of a model on the model path"};
    request.is_path = true;
    request.sdf = "model://" + name;
  }
  request.name = text_or(args, "name", "");
  std::vector<std::string> words{"spawn", request.is_path ? request.sdf : "MODEL.sdf"};
  if (!request.name.empty()) {
    const auto option = base::option_words("--name", request.name);
    words.insert(words.end(), option.begin(), option.end());
  }
  if (args.contains("pose")) {
    const auto numbers = numbers_of(args, "pose", 7, 7);
    if (!numbers) return numbers.error();
    request.has_pose = true;
    request.pose = pose_from(*numbers);
    words = with_numbers(
        [&] {
          words.emplace_back("--pose");
          return words;
        }(),
        {(*numbers)[0], (*numbers)[1], (*numbers)[2], shm::yaw_of(request.pose)});
  }
  return plan(context, request, words, [](const shm::Reply& reply) { return Json{{"name", reply.message}}; });
}

Result<Plan> delete_model(const ActContext& context, const Json& args) {
  const auto model = text_of(args, "model");
  if (!model) return model.error();
  return plan(context, shm::DeleteRequest{*model}, about("delete", *model));
}

// The newest deleted model of this name, as it was.
Result<Plan> restore_model(const ActContext& context, const Json& args) {
  const auto model = text_of(args, "model");
  if (!model) return model.error();
  shm::SpawnRequest request;
  request.is_path = request.is_confined = true;
  request.sdf = "deleted://" + *model;
  return plan(context, request, {"spawn", request.sdf}, [](const shm::Reply& reply) { return Json{{"name", reply.message}}; });
}

Result<Plan> drop_participant(const ActContext& context, const Json& args) {
  const auto name = text_of(args, "name");
  if (!name) return name.error();
  return plan(context, shm::DropParticipantRequest{*name}, about("drop", *name));
}

Result<Plan> reset_odometry(const ActContext& context, const Json& args) {
  const auto iface = text_of(args, "iface");
  if (!iface) return iface.error();
  shm::ResetOdometryRequest request;
  request.iface = *iface;
  return plan(context, request, about("odometry", *iface));
}

Result<Plan> set_motors(const ActContext& context, const Json& args) {
  const auto iface = text_of(args, "iface");
  if (!iface) return iface.error();
  const bool are_enabled = flag_of(args, "on");
  return plan(context, shm::SetMotorsRequest{*iface, are_enabled}, base::command_words({"motors"}, {*iface, are_enabled ? "on" : "off"}));
}

}  // namespace

std::vector<Act> world_acts() {
  return {{"run", false, run},
          {"pause", false, pause},
          {"step", false, step},
          {"reset_world", false, reset_world},
          {"speed", false, speed},
          {"tree", true, tree},
          {"models", true, models},
          {"contacts", true, contacts},
          {"set_pose", false, set_pose},
          {"push", false, push},
          {"set_velocity", false, set_velocity},
          {"spawn", false, spawn},
          {"delete_model", false, delete_model},
          {"restore_model", false, restore_model},
          {"drop_participant", false, drop_participant},
          {"reset_odometry", false, reset_odometry},
          {"set_motors", false, set_motors}};
}

}  // namespace studio
