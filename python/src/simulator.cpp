#include "python/src/simulator.h"

#include <unistd.h>

#include <algorithm>
#include <optional>

#include "base/text.h"
#include "shm/control.h"
#include "shm/lockstep.h"
#include "shm/words.h"

namespace python {
namespace {

using namespace std::chrono_literals;

constexpr std::chrono::nanoseconds slice = 100ms;  // between two looks at signals

template <class... Kinds>
bool is_one_of(const shm::Request& request) {
  return (std::holds_alternative<Kinds>(request) || ...);
}

bool changes_the_world(const shm::Request& request) {
  return is_one_of<shm::ResetRequest, shm::SetPoseRequest, shm::SetVelocityRequest, shm::SpawnRequest, shm::DeleteRequest,
                   shm::ResetOdometryRequest, shm::FaultRequest, shm::EndFaultsRequest, shm::SetMotorsRequest, shm::WriteTagRequest>(
      request);
}

}  // namespace

// Two threads of Python cannot share a line while one waits for its answer.
class Simulator::Busy {
 public:
  explicit Busy(Simulator& simulator) : simulator_(simulator) {
    if (simulator_.is_busy_) throw Error("another thread waits for this simulator; use one World per thread");
    simulator_.is_busy_ = true;
  }
  ~Busy() { simulator_.is_busy_ = false; }
  Busy(const Busy&) = delete;
  Busy& operator=(const Busy&) = delete;

 private:
  Simulator& simulator_;
};

Simulator::Simulator(std::uint32_t server_id) : owner_(getpid()) {
  requester_ = std::make_unique<shm::Requester>(value_of(shm::Requester::open(server_id)));
}

Simulator::~Simulator() {
  if (getpid() != owner_) static_cast<void>(requester_.release());  // the parent's place in the simulator
}

void Simulator::close() {
  if (getpid() != owner_) static_cast<void>(requester_.release());
  if (is_busy_) throw Error("another thread waits for this simulator; close the World after that");
  requester_.reset();
  how_it_died_ = py::none();
}

shm::Requester& Simulator::line() {
  if (!requester_) throw Error("the World is closed");
  if (getpid() != owner_) throw Error("the World belongs to the parent process; make one after the fork");
  return *requester_;
}

void Simulator::fail(const std::string& message) {
  if (is_alive()) throw Error(message);
  const std::string said = how_it_died_.is_none() ? "" : py::str(how_it_died_());
  throw ServerDied(said.empty() ? message : said);
}

void Simulator::check_alive() {
  if (!is_alive()) fail("server " + std::to_string(server_id()) + " has ended");
}

void Simulator::pause_after_interrupt() {
  py::gil_scoped_release release;
  static_cast<void>(requester_->ask(shm::PauseRequest{}, 2s));  // an interrupt is reported, whatever this says
}

void Simulator::begin_steps(std::int64_t count) {
  if (count < 1) throw Error("steps must be at least 1, got " + std::to_string(count));
  const Busy busy(*this);
  if (const auto begun = line().begin(shm::StepRequest{count}); !begun) fail(begun.error().message);
}

double Simulator::end_steps(Seconds timeout) {
  const Busy busy(*this);
  shm::Requester& requester = line();
  const auto limit = std::chrono::duration_cast<std::chrono::nanoseconds>(timeout);
  auto progress = std::chrono::steady_clock::now();
  std::int64_t reached = -1;
  while (true) {
    const auto answer = [&] {
      py::gil_scoped_release release;
      return requester.await(std::min(slice, limit));
    }();
    if (!answer) fail(answer.error().message);
    if (*answer) {
      const auto done = shm::without_refusal(shm::StepRequest{}, **answer);
      if (!done) fail(done.error().message);
      is_changed_ = false;
      return static_cast<double>(done->sim_time_ns) / 1e9;
    }
    if (PyErr_CheckSignals() != 0) {
      pause_after_interrupt();
      throw py::error_already_set();
    }
    const auto now = std::chrono::steady_clock::now();
    const std::int64_t at = requester.simulation().read() ? requester.simulation().sample<shm::SimulationSample>().stamp.sim_time_ns : 0;
    if (at != reached) reached = at, progress = now;
    if (now - progress < limit) continue;
    const std::string late = late_participants();
    pause_after_interrupt();
    throw TimedOut("step: simulated time stands at " + base::format_number(static_cast<double>(at) / 1e9) + " s for " +
                   base::format_number(timeout.count()) + " s" + (late.empty() ? "" : "; late: " + late));
  }
}

std::string Simulator::late_participants() {
  std::vector<std::string> names;
  const auto records = shm::read_participants(line().simulation());
  if (!records) return "";
  for (const auto& record : *records) {
    if (record.is_late) names.push_back(record.name);
  }
  return base::join(names, ", ");
}

shm::Reply Simulator::ask(const shm::Request& request, Seconds timeout) {
  const Busy busy(*this);
  shm::Requester& requester = line();
  const auto limit = std::chrono::duration_cast<std::chrono::nanoseconds>(timeout);
  std::optional<shm::Reply> reply;
  if (!shm::encode(request).text.empty()) {
    auto answer = [&] {
      py::gil_scoped_release release;
      return requester.ask(request, limit);
    }();
    if (!answer) fail(answer.error().message);
    reply = std::move(*answer);
  } else if (const auto begun = requester.begin(request); !begun) {
    fail(begun.error().message);
  }
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (!reply) {
    const auto left = std::chrono::duration_cast<std::chrono::nanoseconds>(deadline - std::chrono::steady_clock::now());
    auto answer = [&] {
      py::gil_scoped_release release;
      return requester.await(std::min(slice, left));
    }();
    if (!answer) fail(answer.error().message);
    if (*answer) {
      reply = std::move(**answer);
    } else if (PyErr_CheckSignals() != 0) {
      throw py::error_already_set();
    } else if (left.count() <= 0) {
      throw TimedOut(std::string(shm::request_name(request)) + ": no answer within " + base::format_number(timeout.count()) + " s");
    }
  }
  if (reply->status == shm::RequestStatus::ok) {
    is_changed_ = is_changed_ || changes_the_world(request);
    return std::move(*reply);
  }
  const std::string message = std::string(shm::request_name(request)) + ": " + reply->message;
  if (reply->status == shm::RequestStatus::not_found) throw NotFound(message);
  throw Error(message);
}

// The first one is published when the world is loaded.
const shm::SimulationSample& Simulator::clock() {
  shm::Iface& simulation = line().simulation();
  const auto deadline = std::chrono::steady_clock::now() + 30s;
  while (!simulation.read()) {
    check_alive();
    if (std::chrono::steady_clock::now() > deadline) throw TimedOut("the simulator has not published its clock within 30 s");
    const Busy busy(*this);
    {
      py::gil_scoped_release release;
      static_cast<void>(simulation.wait(0, slice));
    }
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
  return simulation.sample<shm::SimulationSample>();
}
void Simulator::show_changes(Seconds timeout) {
  if (!is_changed_) return;
  is_changed_ = false;
  if (is_paused()) ask(shm::ShowRequest{}, timeout);
}

const shm::SimulationInfo& Simulator::info() { return line().simulation().info<shm::SimulationInfo>(); }

double Simulator::time() { return static_cast<double>(clock().stamp.sim_time_ns) / 1e9; }
std::uint64_t Simulator::steps() { return clock().steps; }
bool Simulator::is_paused() { return clock().paused != 0; }
std::uint64_t Simulator::seed() { return shm::load(line().simulation().segment().as<shm::SimulationInfo>(shm::AreaIndex::info).seed); }
double Simulator::step_size() { return static_cast<double>(info().step_ns) / 1e9; }
std::string Simulator::world() { return info().world; }
std::string Simulator::world_file() { return info().file; }
std::uint32_t Simulator::server_id() { return line().simulation().server_id(); }
pid_t Simulator::pid() { return line().simulation().segment().facts().server.pid; }
bool Simulator::is_alive() { return requester_ && requester_->simulation().status() == shm::Status::live; }
bool Simulator::is_shared() { return line().simulation().segment().is_shared(); }

}  // namespace python
