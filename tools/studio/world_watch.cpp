#include "studio/world_watch.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "shm/iface_json.h"
#include "shm/lockstep.h"

namespace studio {
namespace {

using namespace std::chrono_literals;

constexpr auto frame_period = 33ms;   // of poses while time passes
constexpr auto still_period = 250ms;  // of poses while it stands: people may move things from elsewhere
constexpr auto time_period = 200ms;
constexpr auto world_period = 1000ms;
constexpr auto absence_period = 500ms;
constexpr auto answer_limit = 2s;

std::string text(const char* characters, std::size_t most) { return {characters, strnlen(characters, most)}; }

Json models_json(shm::Requester& simulator) {
  const auto reply = simulator.ask(shm::ListRequest{}, answer_limit);
  if (!reply || reply->status != shm::RequestStatus::ok) return Json::array();
  const Json list = Json::parse(reply->text, nullptr, false);
  Json models = Json::array();
  for (const Json& model : list.is_object() ? list.value("models", Json::array()) : Json::array())
    models.push_back({{"name", model.value("name", "")}, {"static", model.value("static", false)}});
  return models;
}

Json ifaces_json(std::uint32_t server_id) {
  Json ifaces = Json::array();
  for (const auto& found : shm::find_segments(server_id)) {
    if (!found.is_alive || found.name.type == shm::IfaceType::simulation) continue;
    const auto iface = shm::Iface::open(server_id, found.name.type, found.name.iface);
    if (!iface) continue;
    Json info = simctl::info_json(*iface);
    const auto model = info.value("model", "");
    ifaces.push_back({{"type", std::string(shm::to_text(found.name.type))},
                      {"name", found.name.iface},
                      {"model", model},
                      {"commands", shm::row_of(found.name.type).command_values > 0},
                      {"info", std::move(info)}});
  }
  return ifaces;
}

Json participants_json(const shm::Iface& simulation) {
  const auto records = shm::read_participants(simulation);
  return records ? simctl::participants_json(*records) : Json::array();
}

Json time_json(const shm::Iface& simulation) {
  const auto& sample = simulation.sample<shm::SimulationSample>();
  Json parts = Json::array();
  for (std::uint32_t i = 0; i < std::min<std::uint32_t>(sample.part_count, RTMSIM_PARTS); ++i) {
    const auto& part = sample.parts[i];
    parts.push_back({{"name", text(part.name, sizeof part.name)},
                     {"calls", part.calls},
                     {"total_ms", static_cast<double>(part.total_ns) * 1e-6},
                     {"max_us", static_cast<double>(part.max_ns) * 1e-3}});
  }
  return {{"op", "time"},
          {"sim_time", static_cast<double>(sample.stamp.sim_time_ns) / 1e9},
          {"steps", sample.steps},
          {"paused", sample.paused != 0},
          {"waiting_for", sample.waiting_for},
          {"rtf", sample.rtf_reached},
          {"rtf_wanted", sample.rtf_wanted},
          {"load", sample.load},
          {"models", sample.models},
          {"bodies", sample.bodies},
          {"contacts", sample.contacts},
          {"parts", std::move(parts)},
          {"participants", participants_json(simulation)}};
}

Json absent_world(std::uint32_t server_id, const std::string& problem) {
  return {{"op", "world"},          {"present", false},        {"problem", problem},
          {"server_id", server_id}, {"models", Json::array()}, {"ifaces", Json::array()}};
}

}  // namespace

WorldWatch::WorldWatch(std::uint32_t server_id, WorldCallbacks tell)
    : server_id_(server_id), tell_(std::move(tell)), thread_([this] { run(); }) {}

WorldWatch::~WorldWatch() {
  data_.lock()->is_ending = true;
  changed_.notify_all();
  thread_.join();
}

void WorldWatch::set_watched(bool is_watched) {
  data_.lock()->is_watched = is_watched;
  changed_.notify_all();
}

void WorldWatch::look_now() {
  data_.lock()->is_hurried = true;
  changed_.notify_all();
}

bool WorldWatch::sleep() {
  auto data = data_.lock();
  data.wait(changed_, [&] { return data->is_ending || data->is_watched; });
  data.wait_until(changed_, next_, [&] { return data->is_ending || data->is_hurried; });
  was_hurried_ = std::exchange(data->is_hurried, false);
  return !data->is_ending;
}

void WorldWatch::run() {
  while (sleep()) {
    if (!simulator_) attach();
    if (simulator_) look();
    next_ = Clock::now() + (simulator_ ? std::chrono::milliseconds(frame_period) : absence_period);
  }
}

// The same whichever call is the first to find it out.
std::string WorldWatch::exit_text() const {
  return "simulator " + std::to_string(server_id_) + " has exited; this page waits for it to restart";
}

void WorldWatch::attach() {
  auto found = shm::Requester::open(server_id_);
  if (!found) {
    const auto segments = shm::find_segments(server_id_);
    if (segments.empty()) return detach("no simulator of number " + std::to_string(server_id_) + " runs");
    const bool is_alive = std::ranges::any_of(segments, [](const auto& segment) { return segment.is_alive; });
    return detach(is_alive ? found.error().message : exit_text());
  }
  simulator_ = std::move(*found);
  seen_sample_ = 0;
  version_ = 0;
  has_poses_ = true;
  poses_at_ = world_at_ = time_at_ = {};
}

void WorldWatch::detach(const std::string& problem) {
  simulator_.reset();
  auto now = to_text(absent_world(server_id_, problem));
  if (now == told_world_) return;
  told_world_ = now;
  told_time_.clear();
  tell_.poses(nullptr);
  tell_.world(std::move(now));
}

void WorldWatch::look() {
  auto& simulation = simulator_->simulation();
  if (simulation.status() != shm::Status::live) return detach(exit_text());
  (void)simulation.read();  // without a sample the last one stays
  look_at_poses(std::exchange(was_hurried_, false));
  if (!simulator_) return;
  if (Clock::now() - time_at_ >= time_period) tell_time();
  if (Clock::now() - world_at_ >= world_period) look_at_world();
}

void WorldWatch::look_at_poses(bool is_hurried) {
  auto& simulation = simulator_->simulation();
  const auto sequence = simulation.sequence();
  const bool has_moved = std::exchange(seen_sample_, sequence) != sequence;
  if (has_moved) tell_.clock(std::chrono::nanoseconds(simulation.sample<shm::SimulationSample>().stamp.sim_time_ns));
  if (!has_poses_ || (!has_moved && !is_hurried && Clock::now() - poses_at_ < still_period)) return;
  const auto reply = simulator_->ask(shm::PosesRequest{}, answer_limit);
  if (!reply) {
    const bool is_alive = simulation.status() == shm::Status::live;
    return detach(is_alive ? "simulator " + std::to_string(server_id_) + ": " + reply.error().message : exit_text());
  }
  poses_at_ = Clock::now();
  has_poses_ = reply->status == shm::RequestStatus::ok;
  if (!has_poses_) return;
  auto poses = std::make_shared<Poses>();
  poses->version = static_cast<std::uint32_t>(reply->values[0]);
  poses->time = std::chrono::nanoseconds(reply->sim_time_ns);
  poses->numbers.resize(
      std::min(reply->text.size() / sizeof(float), static_cast<std::size_t>(std::max<std::int64_t>(reply->count, 0)) * 7));
  std::memcpy(poses->numbers.data(), reply->text.data(), poses->numbers.size() * sizeof(float));
  if (std::exchange(version_, poses->version) != poses->version) world_at_ = {};
  tell_.poses(std::move(poses));
}

void WorldWatch::look_at_world() {
  world_at_ = Clock::now();
  const auto& info = simulator_->simulation().info<shm::SimulationInfo>();
  auto now = to_text({{"op", "world"},
                      {"present", true},
                      {"problem", ""},
                      {"server_id", server_id_},
                      {"name", text(info.world, sizeof info.world)},
                      {"file", text(info.file, sizeof info.file)},
                      {"lockstep", info.lockstep != 0},
                      {"step", static_cast<double>(info.step_ns) * 1e-9},
                      {"version", version_},
                      {"birth", std::to_string(simulator_->simulation().segment().facts().generation)},
                      {"models", models_json(*simulator_)},
                      {"ifaces", ifaces_json(server_id_)}});
  if (now == told_world_) return;
  told_world_ = now;
  tell_.world(std::move(now));
}

void WorldWatch::tell_time() {
  time_at_ = Clock::now();
  auto now = to_text(time_json(simulator_->simulation()));
  if (now == told_time_) return;
  told_time_ = now;
  tell_.time(std::move(now));
}

}  // namespace studio
