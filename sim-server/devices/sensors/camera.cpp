#include "devices/sensors/camera.h"

#include <algorithm>
#include <condition_variable>
#include <cstring>
#include <optional>
#include <thread>

#include "base/guarded.h"
#include "base/log.h"
#include "devices/render_world.h"
#include "devices/sensors/camera_channels.h"
#include "devices/sensors/sensor.h"
#include "render/pixels.h"
#include "shm/server.h"
#include "world/iface_names.h"

namespace sim {
namespace {

std::uint64_t seed_of(std::uint64_t seed, const std::string& name) {
  for (const char c : name) seed = mix_seed(seed, static_cast<unsigned char>(c));
  return seed;
}

// Draws and publishes one picture at a time in its own thread, which begins with the first.
class CameraWorker {
 public:
  CameraWorker(Camera camera, std::vector<CameraChannel> channels) : camera_(std::move(camera)), channels_(std::move(channels)) {}
  ~CameraWorker() {
    state_.lock()->is_ending = true;
    changed_.notify_all();
  }

  bool is_idle() const { return !state_.lock()->is_busy; }
  std::uint64_t drawn() const { return state_.lock()->drawn; }
  bool holds_context() const { return state_.lock()->holds_context; }
  // Gives the context back, soon; the next picture opens another.
  void rest() {
    state_.lock()->should_rest = true;
    changed_.notify_all();
  }
  // Only when idle.
  void set_seed(std::uint64_t seed) { camera_.set_seed(seed); }
  // Only when idle.
  void start(CameraJob job) {
    if (!thread_.joinable()) thread_ = std::jthread([this] { run(); });
    {
      auto state = state_.lock();
      state->job = std::move(job);
      state->is_busy = true;
    }
    changed_.notify_all();
  }
  void wait() {
    auto state = state_.lock();
    while (!state.wait_for(changed_, std::chrono::hours(1), [&] { return !state->is_busy; })) {
    }
  }

 private:
  struct State {
    std::optional<CameraJob> job;
    bool is_busy = false;
    bool is_ending = false;
    bool should_rest = false;
    bool holds_context = false;
    std::uint64_t drawn = 0;
  };

  void run() {
    while (auto work = next()) {
      if (work->is_rest) {
        renderer_.reset();
      } else {
        draw(*work->job);
        work->job.reset();  // the snapshot may be large; nobody needs it now
      }
      {
        auto state = state_.lock();
        state->holds_context = renderer_ != nullptr;
        if (!work->is_rest) {
          state->is_busy = false;
          ++state->drawn;
        }
      }
      changed_.notify_all();
    }
    renderer_.reset();  // in the thread that it belongs to
  }

  // A picture to draw or, without one, the context to give back.
  struct Work {
    std::optional<CameraJob> job;
    bool is_rest = false;
  };
  std::optional<Work> next() {
    auto state = state_.lock();
    while (!state.wait_for(changed_, std::chrono::hours(1), [&] { return state->job || state->is_ending || state->should_rest; })) {
    }
    if (state->is_ending) return std::nullopt;
    const bool is_rest = !state->job;
    state->should_rest = false;
    return Work{std::exchange(state->job, std::nullopt), is_rest};
  }

  void draw(const CameraJob& job) {
    auto done = take(job);
    if (!done && !has_failed_) base::log(base::Level::error, channels_.front().writer->name(), "{}", done.error().message);
    has_failed_ = !done;
    if (done) publish(camera_, job, channels_);
  }

  base::Result<void> take(const CameraJob& job) {
    if (!renderer_) {
      auto opened = Renderer::open();
      if (!opened) return opened.error();
      renderer_ = std::move(*opened);
    }
    const auto wanted = output_of(channels_, job.channels);
    return camera_.take(*renderer_, job.snapshot.scene, *job.snapshot.poses, job.pose, job.time.count(), wanted);
  }

  Camera camera_;
  std::vector<CameraChannel> channels_;
  std::unique_ptr<Renderer> renderer_;
  bool has_failed_ = false;
  base::Guarded<State, base::Rank::worker> state_;
  std::condition_variable changed_;
  std::jthread thread_;  // last: ends before what it uses
};

// Carries the first iface and does the work for all of them.
class CameraDevice final : public Device, public CameraPlaceSource {
 public:
  CameraDevice(DeviceWorld& world, Mount mount, double rate, Camera camera, const std::vector<CameraChannel>& channels)
      : world_(world), mount_(mount), def_(camera.def()), schedule_(rate), channels_(channels), worker_(std::move(camera), channels) {}

  shm::IfaceWriter& iface() override { return *channels_.front().writer; }
  ModelId model() const override { return mount_.link.model; }
  Eigen::Isometry3d camera_pose() const override { return mount_.in_world(world_.physics); }
  const CameraDef& camera_def() const override { return def_; }
  std::uint64_t pictures_drawn() const override { return worker_.drawn(); }
  bool holds_context() const override { return worker_.holds_context(); }

  bool wants_sample(const Moment& moment) override {
    if (!schedule_.is_due(moment.time)) return false;
    auto wanted = subscribed_channels();
    if (std::find(wanted.begin(), wanted.end(), true) == wanted.end()) {
      schedule_.done(moment.time);  // as of any sensor
      rest_when_long_idle(moment.time);
      return false;
    }
    // In its own time: while a picture is drawn, or files are read for it, the next one stays due. Time that waits for pictures waits for
    // that one, too.
    if (world_.pictures->is_synchronous()) worker_.wait();
    if (!worker_.is_idle() || !is_ready()) return false;
    job_ = job_of(moment, std::move(wanted));
    return true;
  }
  void take_sample(const Moment&) override { worker_.start(std::move(*job_)); }
  void publish(const Moment& moment) override {
    schedule_.done(moment.time);
    last_picture_ = moment.time;
    job_.reset();
    if (world_.pictures->is_synchronous()) worker_.wait();
  }
  bool owes_sample() override {
    return std::any_of(channels_.begin(), channels_.end(), [](const CameraChannel& channel) { return channel.writer->owes_sample(); }) &&
           is_ready();
  }
  void show(const Moment& moment) override {
    worker_.wait();
    worker_.start(job_of(moment, subscribed_channels()));
    worker_.wait();
    last_picture_ = moment.time;
  }
  void reset() override {
    worker_.wait();
    worker_.set_seed(seed_of(world_.seed, channels_.front().writer->name()));
    schedule_.restart();
    if (last_picture_) last_picture_ = std::chrono::nanoseconds(0);
  }

 private:
  bool is_ready() { return world_.pictures->is_synchronous() || world_.pictures->prepare(Scene::Content::visuals); }

  CameraJob job_of(const Moment& moment, std::vector<bool> wanted) {
    const Eigen::Isometry3d pose = mount_.in_world(world_.physics);
    constexpr double lapse = 0.0065;  // [K/m] of the standard atmosphere
    const double altitude = world_.world.spherical.elevation + pose.translation().z();
    const double air = world_.world.physics.atmosphere_temperature - lapse * altitude;
    return {world_.pictures->snapshot(moment.time), pose, moment.time, std::move(wanted), air};
  }

  void rest_when_long_idle(std::chrono::nanoseconds now) {
    constexpr std::chrono::seconds long_idle{10};
    if (!last_picture_ || now - *last_picture_ < long_idle) return;
    last_picture_.reset();
    worker_.rest();
  }

  std::vector<bool> subscribed_channels() const {
    std::vector<bool> wanted;
    for (const auto& channel : channels_) wanted.push_back(channel.writer->is_subscribed());
    return wanted;
  }

  DeviceWorld& world_;
  Mount mount_;
  CameraDef def_;
  Schedule schedule_;
  std::vector<CameraChannel> channels_;
  std::optional<CameraJob> job_;
  std::optional<std::chrono::nanoseconds> last_picture_;  // since it had to open a context
  CameraWorker worker_;
};

// Another iface of a camera, whose CameraDevice does the work.
class SecondIface final : public Device {
 public:
  SecondIface(CameraDevice& camera, std::shared_ptr<shm::IfaceWriter> writer) : camera_(camera), writer_(std::move(writer)) {}
  shm::IfaceWriter& iface() override { return *writer_; }
  ModelId model() const override { return camera_.model(); }
  bool owes_sample() override { return false; }
  // Ifaces of one name are shown together.
  void show(const Moment& moment) override {
    if (writer_->name() != camera_.iface().name()) camera_.show(moment);
  }

 private:
  CameraDevice& camera_;
  std::shared_ptr<shm::IfaceWriter> writer_;
};

shm::CameraInfo info_of(const Camera& camera, const DeviceWorld& world, const Mount& mount, const SensorDef& sensor) {
  const CameraDef& def = camera.def();
  const ModelDef& model = world.physics.def(mount.link.model);
  shm::CameraInfo info{};
  info.width = static_cast<std::uint32_t>(def.width);
  info.height = static_cast<std::uint32_t>(def.height);
  info.hfov = def.horizontal_fov;
  info.near_clip = def.near_clip;
  info.far_clip = def.far_clip;
  info.fx = info.fy = camera.focal_length();
  info.cx = camera.principal_point().x();
  info.cy = camera.principal_point().y();
  if (def.distortion) {
    const DistortionDef& d = *def.distortion;
    const double terms[5] = {d.k1, d.k2, d.p1, d.p2, d.k3};
    std::copy(std::begin(terms), std::end(terms), info.distortion);
  }
  info.rate = stated_rate(world, sensor.update_rate);
  info.noise = stated_deviation(def.noise);
  info.pose = pose_on_model(model, mount);
  shm::set_text(info.model, scoped_model(model, sensor.scope));
  return info;
}

}  // namespace

base::Result<std::vector<std::unique_ptr<Device>>> make_cameras(DeviceWorld& world, Mount mount, const SensorDef& sensor) {
  std::vector<std::unique_ptr<Device>> devices;
  const auto all = seen_by(sensor.kind);
  for (const auto& def : std::get<CameraSetDef>(sensor.data).cameras) {
    std::string name = iface_name(world.physics.def(mount.link.model), sensor);
    if (sensor.kind == SensorKind::multi_camera) name += "::" + without_slashes(def.name);
    Camera camera(def, output_of(all), seed_of(world.seed, name));
    const Mount place{mount.link, mount.pose * def.pose};
    const shm::CameraInfo info = info_of(camera, world, place, sensor);
    std::vector<CameraChannel> channels;
    for (const CameraSees what : all) {
      auto channel = make_channel(world, what, name + ending_of(what), info, camera.def());
      if (!channel) return channel.error();
      channels.push_back(std::move(*channel));
    }
    auto device = std::make_unique<CameraDevice>(world, place, sensor.update_rate, std::move(camera), channels);
    CameraDevice& first = *device;
    devices.push_back(std::move(device));
    for (std::size_t i = 1; i < channels.size(); ++i) devices.push_back(std::make_unique<SecondIface>(first, channels[i].writer));
  }
  return devices;
}

}  // namespace sim
