#include "rtc_simulation.h"

#include <base/text.h>
#include <shm/request_board.h>

#include "conversions.h"
#include "simulated_time.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCSimulation",
    .description = "Clock and control of a simulation",
    .phase = iface::sensor_phase,
};

namespace {

constexpr std::chrono::seconds answer_limit{5};

base::Result<shm::Reply> ask_server(int server_id, const shm::Request& request) {
  auto requester = shm::Requester::open(static_cast<std::uint32_t>(server_id));
  if (!requester) return requester.error();
  auto reply = requester->ask(request, answer_limit);
  if (reply && reply->status != shm::RequestStatus::ok) return base::Error{std::string(shm::request_name(request)) + ": " + reply->message};
  return reply;
}

shm::Reply ask_or_throw(int server_id, const shm::Request& request) {
  auto reply = ask_server(server_id, request);
  if (!reply) throw rtmsim::Failed(reply.error().message.c_str());  // the declared way to say no
  return *reply;
}

shm::Pose from_wire(const rtmsim::Pose& pose) { return shm::euler_pose(pose.x, pose.y, pose.z, pose.roll, pose.pitch, pose.yaw); }

}  // namespace

void SimulationServiceImpl::run() { ask_or_throw(server_id_, shm::RunRequest{}); }
void SimulationServiceImpl::pause() { ask_or_throw(server_id_, shm::PauseRequest{}); }
void SimulationServiceImpl::step(CORBA::ULong steps) { ask_or_throw(server_id_, shm::StepRequest{steps}); }
void SimulationServiceImpl::reset() { ask_or_throw(server_id_, shm::ResetRequest{}); }
CORBA::Double SimulationServiceImpl::now() { return static_cast<double>(ask_or_throw(server_id_, shm::StatsRequest{}).sim_time_ns) * 1e-9; }

rtmsim::Pose SimulationServiceImpl::get_pose(const char* model) {
  const auto reply = ask_or_throw(server_id_, shm::GetPoseRequest{model});
  const auto& v = reply.values;
  const shm::Pose pose{v[0], v[1], v[2], v[3], v[4], v[5], v[6]};
  const auto angles = iface::to_orientation(pose);
  return {pose.x, pose.y, pose.z, angles.r, angles.p, angles.y};
}

void SimulationServiceImpl::set_pose(const char* model, const rtmsim::Pose& target) {
  shm::SetPoseRequest request;
  request.model = model;
  request.pose = from_wire(target);
  ask_or_throw(server_id_, request);
}

char* SimulationServiceImpl::spawn(const char* sdf, const char* name, const rtmsim::Pose& target) {
  shm::SpawnRequest request;
  request.sdf = sdf;
  request.is_path = request.sdf.find('<') == std::string::npos;
  request.name = name;
  request.has_pose = true;
  request.pose = from_wire(target);
  request.is_confined = !opens_all_files_;
  return CORBA::string_dup(ask_or_throw(server_id_, request).message.c_str());
}

void SimulationServiceImpl::remove(const char* model) { ask_or_throw(server_id_, shm::DeleteRequest{model}); }

void SimulationServiceImpl::push(const char* name, const rtmsim::Wrench& pushed, CORBA::Double seconds) {
  ask_or_throw(server_id_, shm::WrenchRequest{name, {pushed.fx, pushed.fy, pushed.fz}, {pushed.tx, pushed.ty, pushed.tz}, seconds});
}

void SimulationServiceImpl::push_joint(const char* model, const char* joint, CORBA::Double effort, CORBA::Double seconds) {
  ask_or_throw(server_id_, shm::WrenchRequest{std::string(model) + "::" + joint, {effort}, {}, seconds, true});
}

RTCSimulation::RTCSimulation(RTC::Manager* manager)
    : RTC::DataFlowComponentBase(manager),
      link_(shm::IfaceType::simulation,
            [this](bool is_problem, const std::string& line) {
              if (is_problem) {
                RTC_WARN(("%s", line.c_str()));
              } else {
                RTC_INFO(("%s", line.c_str()));
              }
            }),
      async_requests_([this](bool, const std::string& line) { RTC_WARN(("%s", line.c_str())); }),
      time_out_("time", time_),
      simulation_port_("simulation") {}

RTC::ReturnCode_t RTCSimulation::onInitialize() {
  addOutPort("time", time_out_);
  const std::string rights = RTC::Manager::instance().configValue("manager.remote_rights");
  if (base::to_lower(base::trim(rights)) == "everything") service_.open_all_files();
  simulation_port_.registerProvider("simulation", "rtmsim::SimulationService", service_);
  addPort(simulation_port_);
  bindParameter("server_id", server_id_, std::to_string(iface::default_server()).c_str());
  service_.set_server(server_id_);
  return RTC::RTC_OK;
}

// In lock step the server answers between ticks, so a component that is in a tick cannot wait for the answer.
RTC::ReturnCode_t RTCSimulation::ask(const shm::Request& request) {
  if (iface::in_simulated_time()) {
    async_requests_.post(server_id_, request);
    return RTC::RTC_OK;
  }
  const auto reply = ask_server(server_id_, request);
  if (reply) return RTC::RTC_OK;
  if (const auto line = limit_.next(reply.error().message)) RTC_ERROR(("%s", line->c_str()));
  return RTC::RTC_ERROR;
}

RTC::ReturnCode_t RTCSimulation::attach() {
  service_.set_server(server_id_);
  if (const auto done = link_.attach({server_id_, "world"}, false); !done) {
    if (const auto line = limit_.next(done.error().message)) RTC_ERROR(("%s", line->c_str()));
    return RTC::RTC_ERROR;
  }
  return RTC::RTC_OK;
}

RTC::ReturnCode_t RTCSimulation::onActivated(RTC::UniqueId) {
  const auto attached = attach();
  return attached == RTC::RTC_OK ? ask(shm::RunRequest{}) : attached;
}

RTC::ReturnCode_t RTCSimulation::onDeactivated(RTC::UniqueId) {
  link_.detach();
  // Without a simulator no time goes on that could be stopped.
  if (const auto world = shm::Iface::open(static_cast<std::uint32_t>(server_id_), shm::IfaceType::simulation, "world"); !world) {
    if (const auto line = limit_.next(world.error().message + ": no simulation to pause")) RTC_WARN(("%s", line->c_str()));
    return RTC::RTC_OK;
  }
  return ask(shm::PauseRequest{});
}

RTC::ReturnCode_t RTCSimulation::onReset(RTC::UniqueId) { return ask(shm::ResetRequest{}); }

RTC::ReturnCode_t RTCSimulation::onExecute(RTC::UniqueId) {
  if (link_.device().server_id != server_id_ && attach() != RTC::RTC_OK) return RTC::RTC_ERROR;
  auto* clock = link_.fresh(iface::wait_limit());
  if (!clock) return RTC::RTC_OK;
  const auto& sample = clock->sample<shm::SimulationSample>();
  time_.tm = iface::to_time(sample.stamp.sim_time_ns);
  time_.data = static_cast<double>(sample.stamp.sim_time_ns) * 1e-9;
  time_out_.write();
  return RTC::RTC_OK;
}

extern "C" {
void RTCSimulationInit(RTC::Manager* manager) { iface::register_type<RTCSimulation>(manager, specification); }
}
