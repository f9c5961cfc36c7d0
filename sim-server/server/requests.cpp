// What the server does for each request. Decoding has checked all numbers and names; what can fail here is the world's answer.
#include <cmath>
#include <utility>

#include "base/log.h"
#include "base/suggestion.h"
#include "base/text.h"
#include "server/server_loop.h"
#include "world/world_loader.h"

namespace sim {
namespace {

constexpr std::size_t max_compared = 2000;  // names, for a suggestion: it is made between two steps

shm::Reply refused(shm::RequestStatus status, std::string message) {
  shm::Reply reply;
  reply.status = status;
  reply.message = std::move(message);
  return reply;
}
shm::Reply failed(const base::Error& error) { return refused(shm::RequestStatus::failed, error.message); }

shm::Reply no_model(const Physics& physics, const std::string& name) {
  std::vector<std::string> known;
  for (ModelId id = 0; id < physics.model_slots() && known.size() < max_compared; ++id) {
    if (!physics.exists(id)) continue;
    const ModelDef& model = physics.def(id);
    known.push_back(model.name);
    if (name.find("::") == std::string::npos) continue;
    for (const auto& link : model.links) known.push_back(model.name + "::" + link.name);
  }
  return refused(shm::RequestStatus::not_found, "no model or link " + name + base::suggestion(name, known));
}

shm::Reply no_joint(const Physics& physics, const std::string& name) {
  const auto model = physics.find(name.substr(0, name.find("::")));
  if (!model) return no_model(physics, name.substr(0, name.find("::")));
  std::vector<std::string> known;
  for (const auto& joint : physics.def(*model).joints) known.push_back(physics.def(*model).name + "::" + joint.name);
  const std::string similar = base::suggestion(name, known);
  if (!similar.empty() || known.size() > 20) return refused(shm::RequestStatus::not_found, "no joint " + name + similar);
  return refused(shm::RequestStatus::not_found, "no joint " + name + "; joints: " + (known.empty() ? "none" : base::join(known, ", ")));
}

shm::Reply no_iface(const Simulation& simulation, const std::string& name) {
  std::vector<std::string> known;
  for (const auto& device : simulation.devices()) {
    const std::string& other = device->iface().name();
    if (other != name && known.size() < max_compared) known.push_back(other);
  }
  return refused(shm::RequestStatus::not_found, "no iface " + name + base::suggestion(name, known));
}

// Neither a drive, nor anything that holds something.
shm::Reply no_motors(const Simulation& simulation, const std::string& name) {
  std::vector<std::string> known;
  for (const auto& one : simulation.attachments().states(simulation.physics())) known.push_back(one.name);
  const std::string held = known.empty() ? "" : "; grippers and detachable joints: " + base::join(known, ", ");
  shm::Reply reply = no_iface(simulation, name);
  if (name.find("::") == std::string::npos || base::suggestion(name, known).empty()) return reply.message += held, reply;
  return refused(shm::RequestStatus::not_found, "no iface, gripper or detachable joint " + name + base::suggestion(name, known));
}

void put(double* values, const shm::Pose& p) {
  const double all[7] = {p.x, p.y, p.z, p.qw, p.qx, p.qy, p.qz};
  std::copy(all, all + 7, values);
}

template <class... Kinds>
bool is_one_of(const shm::Request& request) {
  return (std::holds_alternative<Kinds>(request) || ...);
}

// May be served in the middle of a tick: the run goes on as without it, or a wrench begins with the next step. So components can push in
// their ticks, and wait for the answer; the order in which several do does not matter.
bool fits_into_a_tick(const shm::Request& request) {
  return is_one_of<shm::WrenchRequest, shm::PauseRequest, shm::RunRequest, shm::GetPoseRequest, shm::GetVelocityRequest, shm::ListRequest,
                   shm::TreeRequest, shm::StatsRequest, shm::SetRtfRequest, shm::ContactsRequest, shm::DropParticipantRequest,
                   shm::ExportRequest, shm::PosesRequest, shm::FaultsRequest, shm::ModelsRequest, shm::PoseLogRequest>(request);
}

// How long a request that needs the world to stand between two steps waits for a tick to end. Clients wait for ten seconds.
constexpr std::chrono::seconds longest_delay{3};

using Clock = std::chrono::steady_clock;

Eigen::Vector3d vector(const double* v) { return {v[0], v[1], v[2]}; }

}  // namespace

// One overload for each kind of request.
struct ServerLoop::Handler {
  ServerLoop& loop;
  const shm::RequestTicket& ticket;
  Simulation& simulation = loop.simulation_;
  Physics& physics = loop.simulation_.physics();

  shm::Reply operator()(const shm::PauseRequest&) {
    loop.end_steps("another client has paused the simulation");
    loop.mode_.pause();
    loop.publish_clock();
    return {};
  }
  shm::Reply operator()(const shm::RunRequest&) {
    loop.mode_.run();
    loop.start_pace();
    loop.publish_clock();
    return {};
  }
  // Answered when the steps are done.
  shm::Reply operator()(const shm::StepRequest& request) {
    if (loop.step_ticket_) return refused(shm::RequestStatus::failed, "another client's steps are running");
    loop.mode_.make_steps(static_cast<std::uint64_t>(request.steps), request.is_paced);
    loop.start_pace();
    loop.step_ticket_ = ticket;
    loop.ends_at_death_ = request.ends_at_death;
    loop.death_.reset();
    return {};
  }
  shm::Reply operator()(const shm::ResetRequest& request) {
    loop.end_steps("another client has reset the world");
    return loop.reset(request);
  }
  shm::Reply operator()(const shm::GetPoseRequest& request) {
    const auto link = physics.find_link(request.name);
    if (!link) return no_model(physics, request.name);
    const auto model = physics.find(request.name);
    shm::Reply reply;
    put(reply.values, to_pose(model ? physics.model_pose(*model) : physics.link_pose(*link)));
    return reply;
  }
  shm::Reply operator()(const shm::SetPoseRequest& request) {
    const auto model = physics.find(request.model);
    if (!model) return no_model(physics, request.model);
    Eigen::Isometry3d pose = from_pose(request.pose);
    if (request.is_planar) {
      const Eigen::Isometry3d now = physics.model_pose(*model);
      const double turn = shm::yaw_of(request.pose) - yaw_of(now);
      pose.linear() = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()) * now.linear();
      pose.translation().z() = now.translation().z();
    }
    const auto done = simulation.set_pose(*model, pose);
    return done ? shm::Reply{} : failed(done.error());
  }
  shm::Reply operator()(const shm::GetVelocityRequest& request) {
    const auto link = physics.find_link(request.name);
    if (!link) return no_model(physics, request.name);
    const Twist twist = physics.link_twist(*link);
    shm::Reply reply;
    for (int i = 0; i < 3; ++i) reply.values[i] = twist.linear[i], reply.values[i + 3] = twist.angular[i];
    return reply;
  }
  shm::Reply operator()(const shm::SetVelocityRequest& request) {
    const auto model = physics.find(request.model);
    if (!model) return no_model(physics, request.model);
    const auto done = physics.set_model_twist(*model, {vector(request.linear), vector(request.angular)});
    return done ? shm::Reply{} : failed(done.error());
  }
  shm::Reply operator()(const shm::WrenchRequest& request) {
    if (request.is_joint) return push_joint(request);
    const auto link = physics.find_link(request.name);
    if (!link) return no_model(physics, request.name);
    if (request.duration == shm::WrenchRequest::until_the_next) {
      const auto kept = simulation.keep_wrench(*link, vector(request.force), vector(request.torque));
      return kept ? shm::Reply{} : failed(kept.error());
    }
    const auto duration = std::chrono::nanoseconds(std::llround(std::min(request.duration, 1e6) * 1e9));
    const auto done = simulation.add_wrench(*link, vector(request.force), vector(request.torque), duration);
    return done ? shm::Reply{} : failed(done.error());
  }
  shm::Reply push_joint(const shm::WrenchRequest& request) {
    const auto joint = physics.find_joint(request.name);
    if (!joint) return no_joint(physics, request.name);
    const double effort = request.force[0];
    const auto duration = std::chrono::nanoseconds(std::llround(std::min(request.duration, 1e6) * 1e9));
    const bool stays = request.duration == shm::WrenchRequest::until_the_next;
    const auto done = stays ? simulation.keep_effort(*joint, effort) : simulation.add_effort(*joint, effort, duration);
    return done ? shm::Reply{} : failed(done.error());
  }
  shm::Reply operator()(const shm::ListRequest&) {
    shm::Reply reply;
    reply.text = list_text(simulation);
    return reply;
  }
  shm::Reply operator()(const shm::TreeRequest& request) {
    if (!request.model.empty() && !physics.find(request.model)) return no_model(physics, request.model);
    shm::Reply reply;
    reply.text = tree_text(simulation, request.model, request.with_bounds);
    return reply;
  }
  shm::Reply operator()(const shm::ModelsRequest&) {
    shm::Reply reply;
    reply.text = models_text(loop.is_shared() ? loop.model_path_.confined() : loop.model_path_);
    return reply;
  }
  shm::Reply operator()(const shm::SpawnRequest& request) {
    const auto pose = request.has_pose ? std::optional(from_pose(request.pose)) : std::nullopt;
    if (request.name.size() > shm::max_name_length) {
      return refused(shm::RequestStatus::bad_request,
                     "name of a model must have at most " + std::to_string(shm::max_name_length) + " bytes");
    }
    constexpr std::string_view deleted = "deleted://";
    if (request.sdf.starts_with(deleted) && !(request.gains.empty() && request.joints.empty()))
      return refused(shm::RequestStatus::bad_request, "a deleted model is restored as it was; gains and joints cannot be given");
    if (request.is_path && request.sdf.starts_with(deleted)) return restore(request.sdf.substr(deleted.size()));
    // What is asked for others is made of what the model path offers to everybody.
    const ModelPath& path = loop.model_path_;
    if (!loop.spawn_loader_) loop.spawn_loader_ = std::make_unique<SpawnLoader>([board = &loop.board_] { board->wake(); });
    loop.spawn_loader_->take({ticket, request.sdf, request.name, pose, loop.is_shared() || request.is_confined ? path.confined() : path,
                              simulation.world().model_path, simulation.pictures().contents(), request.gains, request.joints});
    return {};
  }
  // As models that have been read: between two steps, under its old name.
  shm::Reply restore(const std::string& name) {
    const ModelDef* model = loop.deleted_.find(name);
    if (model == nullptr)
      return refused(shm::RequestStatus::not_found, "no deleted model " + base::in_quotes(name) + " since the last reset");
    LoadedModel loaded;
    loaded.model = *model;
    loop.loaded_.push_back({{ticket, std::move(loaded), false, {}, nullptr, {}}, Clock::now()});
    loop.board_.wake();
    return {};
  }
  shm::Reply operator()(const shm::DeleteRequest& request) {
    const auto model = physics.find(request.model);
    if (!model) return no_model(physics, request.model);
    loop.deleted_.keep(physics, *model);
    simulation.remove(*model);
    return {};
  }
  // Of this moment; answered when it is drawn and written.
  shm::Reply operator()(const shm::ScreenshotRequest& request) {
    if (loop.is_shared() && !request.path.empty()) {
      return refused(shm::RequestStatus::unsupported,
                     "a server that is shared with other users (--shm-mode) writes no files: ask without a path for the picture itself");
    }
    const auto& actors = simulation.world().actors;
    const bool is_actor = std::any_of(actors.begin(), actors.end(), [&](const ActorDef& a) { return a.name == request.follow; });
    if (request.view == shm::ScreenshotRequest::View::follow && !is_actor && !physics.find(request.follow))
      return no_model(physics, request.follow);
    auto plan = plan_picture(simulation, request);
    if (!plan) return failed(plan.error());
    order(ScreenshotWorker::Picture{std::move(*plan), request.path, request.as_pixels}, {});
    return {};
  }
  shm::Reply operator()(const shm::ExportRequest& request) {
    auto plan = plan_export(simulation, request);
    shm::Reply reply;
    reply.count = static_cast<std::int64_t>(plan.world.poses->size());
    reply.values[0] = static_cast<double>(plan.version);
    order(std::move(plan), std::move(reply));
    return {};
  }
  shm::Reply operator()(const shm::ShowRequest&) {
    if (!loop.mode_.stands_still()) return refused(shm::RequestStatus::failed, "the simulation is running; pause it first");
    simulation.show_present();
    return {};
  }
  shm::Reply operator()(const shm::PosesRequest&) { return poses_reply(simulation); }
  shm::Reply operator()(const shm::PoseLogRequest& request) {
    if (!loop.memory_log_) loop.memory_log_.emplace();
    if (!request.joints.empty()) loop.memory_log_->watch_joints(base::split_list(request.joints, '\n'));
    auto piece = loop.memory_log_->bytes().take(request.from);
    if (!piece) return failed(piece.error());
    shm::Reply reply;
    reply.count = loop.memory_log_->bytes().end();
    reply.text = std::move(*piece);
    return reply;
  }
  template <class Work>
  void order(Work work, shm::Reply reply) {
    if (!loop.screenshots_) loop.screenshots_ = std::make_unique<ScreenshotWorker>([board = &loop.board_] { board->wake(); });
    reply.sim_time_ns = simulation.time().count();
    reply.steps = simulation.steps();
    loop.screenshots_->take({ticket, std::move(work), std::move(reply)});
  }
  shm::Reply operator()(const shm::StatsRequest&) {
    shm::Reply reply;
    reply.text = stats_text(simulation, loop.state());
    reply.values[0] = loop.pace_.reached();
    reply.hash = loop.last_hash_ = simulation.hash();
    loop.last_hash_steps_ = simulation.steps();
    return reply;
  }
  shm::Reply operator()(const shm::ResetOdometryRequest& request) {
    Device* device = simulation.device(request.iface);
    if (device == nullptr) return no_iface(simulation, request.iface);
    const shm::Pose pose = request.is_3d ? request.pose : shm::planar_pose(request.x, request.y, 0, request.a);
    if (!device->set_odometry(from_pose(pose))) return refused(shm::RequestStatus::unsupported, request.iface + " has no odometry");
    return {};
  }
  shm::Reply operator()(const shm::SetMotorsRequest& request) {
    if (const auto turned = simulation.turn_attachment(request.iface, request.are_enabled))
      return *turned ? shm::Reply{} : failed(turned->error());
    Device* device = simulation.device(request.iface);
    if (device == nullptr) return no_motors(simulation, request.iface);
    if (!device->set_motors(request.are_enabled)) return refused(shm::RequestStatus::unsupported, request.iface + " has no motors");
    return {};
  }
  shm::Reply operator()(const shm::WriteTagRequest& request) {
    Device* device = simulation.device(request.iface);
    if (device == nullptr) return no_iface(simulation, request.iface);
    const auto written = device->write_tag(request.id, request.data);
    return written ? shm::Reply{} : failed(written.error());
  }
  shm::Reply operator()(const shm::FaultRequest& request) {
    if (!simulation.can_have_faults(request.iface)) return no_iface(simulation, request.iface);
    const shm::FaultRow& row = *shm::find_fault(request.kind);
    FaultOrder fault{request.iface, row.kind, request.amount.value_or(row.amount.value_or(0)), simulation.time()};
    if (request.duration > 0) fault.until = fault.from + std::chrono::nanoseconds(std::llround(std::min(request.duration, 1e9) * 1e9));
    const auto added = simulation.add_fault(fault);
    return added ? shm::Reply{} : failed(added.error());
  }
  shm::Reply operator()(const shm::EndFaultsRequest& request) {
    if (!request.iface.empty() && !simulation.can_have_faults(request.iface)) return no_iface(simulation, request.iface);
    const shm::FaultRow* row = shm::find_fault(request.kind);
    shm::Reply reply;
    reply.count = static_cast<std::int64_t>(simulation.end_faults(request.iface, row ? std::optional(row->kind) : std::nullopt));
    return reply;
  }
  shm::Reply operator()(const shm::FaultsRequest& request) {
    if (!request.iface.empty() && !simulation.can_have_faults(request.iface)) return no_iface(simulation, request.iface);
    shm::Reply reply;
    reply.text = faults_text(simulation, request.iface);
    return reply;
  }
  shm::Reply operator()(const shm::SetRtfRequest& request) {
    loop.pace_.want(request.rtf);
    loop.start_pace();
    loop.publish_clock();
    return {};
  }
  shm::Reply operator()(const shm::ContactsRequest& request) {
    const auto model = physics.find(request.model);
    if (!model) return no_model(physics, request.model);
    shm::Reply reply;
    const auto total = physics.contacts_so_far(*model);
    reply.count = static_cast<std::int64_t>(total - std::exchange(loop.contacts_told_[*model], total));
    reply.text = contacts_text(simulation, *model);
    return reply;
  }
  shm::Reply operator()(const shm::DropParticipantRequest& request) {
    if (!loop.barrier_->drop(request.name)) return refused(shm::RequestStatus::not_found, "no participant " + request.name);
    return {};
  }
};

shm::Reply ServerLoop::spawn(SpawnLoader::Done&& done) {
  if (!done.model) return failed(done.model.error());
  ModelDef& model = done.model.value().model;
  if (done.has_own_name) {  // one that nobody asked for gives way
    const std::string name = model.name;
    for (int i = 1; simulation_.physics().find(model.name); ++i) model.name = name + "_" + std::to_string(i);
  }
  for (const auto& finding : done.model.value().findings) base::log(base::Level::warn, "sim-server", "{}", finding.text());
  simulation_.adopt(std::move(done.triangles));
  if (done.pictures) simulation_.pictures().adopt(std::move(*done.pictures));
  std::vector<std::string> notes;
  const auto id = simulation_.spawn(model, notes);
  for (const auto& note : notes) base::log(base::Level::warn, "sim-server", "{}", note);
  if (!id) return failed(id.error());
  for (const auto content : done.drawn) simulation_.pictures().has_read(*id, content);
  shm::Reply reply;
  reply.message = simulation_.physics().def(*id).name;
  return reply;
}

void ServerLoop::spawn_loaded(When when) {
  std::vector<Loaded> kept;
  for (auto& [done, since] : std::exchange(loaded_, {})) {
    if (!board_.is_awaited(done.ticket)) continue;
    const auto ticket = done.ticket;
    if (when == When::in_tick && Clock::now() - since < longest_delay) {
      kept.push_back({std::move(done), since});
      continue;
    }
    shm::Reply reply =
        when == When::between_steps
            ? spawn(std::move(done))
            : refused(shm::RequestStatus::failed, "simulated time does not advance: " + late_participants() + " has not ended its tick");
    reply.sim_time_ns = simulation_.time().count();
    reply.steps = simulation_.steps();
    board_.reply(ticket, reply);
  }
  loaded_ = std::move(kept);
}

shm::Reply ServerLoop::handle(const shm::Request& request, const shm::RequestTicket& ticket) {
  return std::visit(Handler{*this, ticket}, request);
}

bool ServerLoop::are_files_read(const shm::Request& request) {
  RenderWorld& pictures = simulation_.pictures();
  if (pictures.is_synchronous()) return true;
  if (const auto* shot = std::get_if<shm::ScreenshotRequest>(&request))
    return pictures.prepare(shot->with_collisions ? Scene::Content::collisions : Scene::Content::visuals);
  if (!is_one_of<shm::ExportRequest, shm::PosesRequest>(request)) return true;
  const auto* file = std::get_if<shm::ExportRequest>(&request);
  return pictures.prepare(Scene::Content::visuals) &&
         (file == nullptr || !file->with_collisions || pictures.prepare(Scene::Content::collisions));
}

void ServerLoop::handle_requests(When when) {
  if (screenshots_) {
    for (const auto& done : screenshots_->finished()) board_.reply(done.ticket, done.reply);
  }
  if (spawn_loader_) {
    for (auto& done : spawn_loader_->finished()) loaded_.push_back({std::move(done), Clock::now()});
  }
  auto waiting = std::exchange(postponed_, {});
  for (auto& asked : board_.poll()) waiting.push_back({std::move(asked), Clock::now()});
  if (when == When::between_steps && !(waiting.empty() && loaded_.empty())) {
    // While an observer is waited for they are those of a tick: some are answered, and what has to wait is told who is late.
    postponed_ = std::move(waiting);
    if (!barrier_->settle()) return;
    waiting = std::exchange(postponed_, {});
  }
  spawn_loaded(when);
  for (auto& [asked, since] : waiting) {
    // What its client was told has failed must not happen later.
    if (!board_.is_awaited(asked.ticket)) continue;
    if (when == When::in_tick && !fits_into_a_tick(asked.request)) {
      if (Clock::now() - since < longest_delay) {
        postponed_.push_back({std::move(asked), since});
      } else {
        board_.reply(asked.ticket, refused(shm::RequestStatus::failed,
                                           "simulated time does not advance: " + late_participants() + " has not ended its tick"));
      }
      continue;
    }
    if (!are_files_read(asked.request)) {
      postponed_.push_back({std::move(asked), Clock::now()});
      continue;
    }
    base::log(base::Level::debug, "sim-server", "request {} of pid {}", shm::request_name(asked.request), asked.pid);
    shm::Reply reply = handle(asked.request, asked.ticket);
    if (is_one_of<shm::StepRequest, shm::ScreenshotRequest, shm::ExportRequest, shm::SpawnRequest>(asked.request) &&
        reply.status == shm::RequestStatus::ok)
      continue;
    reply.sim_time_ns = simulation_.time().count();
    reply.steps = simulation_.steps();
    board_.reply(asked.ticket, reply);
  }
}

std::string ServerLoop::late_participants() const {
  std::vector<std::string> names;
  for (const auto& record : barrier_->records()) {
    if (record.is_late) names.push_back(record.name);
  }
  return names.empty() ? "a participant" : base::join(names, ", ");
}

}  // namespace sim
