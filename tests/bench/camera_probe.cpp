// A host of VideoPlayer that measures how long a frame takes from its publication by the simulator until it is in the player's buffer:
// prints "latency MEDIAN P90" [us] of COUNT frames, then ends.
//
//   camera_probe SERVER_ID CAMERA COUNT [options of rtcd]
#include <rtm/InPortBase.h>
#include <rtm/Manager.h>
#include <rtm/RTObject.h>
#include <rtm/idl/InterfaceDataTypesSkel.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <future>
#include <mutex>
#include <vector>

#include "shm/client.h"
#include "support/usage.h"

extern "C" void VideoPlayerInit(RTC::Manager* manager);

namespace {

constexpr std::size_t warm_up = 20;

struct Measured {
  shm::Iface camera;
  std::size_t wanted;
  std::vector<double> times;  // [us]; the port's thread alone until `done`
  std::promise<void> done;
};

class Arrival : public RTC::ConnectorDataListenerT<RTC::CameraImage> {
 public:
  explicit Arrival(Measured& measured) : measured_(measured) {}
  USE_CONNLISTENER_STATUS;
  ReturnCode operator()(RTC::ConnectorInfo&, RTC::CameraImage& image) override {
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    const auto frame = measured_.camera.hold();
    const std::int64_t time = static_cast<std::int64_t>(image.tm.sec) * 1'000'000'000 + image.tm.nsec;
    // A newer frame is out already: this one was too late to be timed, which does not happen at 30 Hz.
    if (!frame || frame->head().stamp.sim_time_ns != time || measured_.times.size() >= measured_.wanted) return NO_CHANGE;
    measured_.times.push_back(1e-3 * static_cast<double>(std::chrono::nanoseconds(now).count() - frame->head().stamp.wall_time_ns));
    if (measured_.times.size() == measured_.wanted) measured_.done.set_value();
    return NO_CHANGE;
  }

 private:
  Measured& measured_;
};

RTC::RTObject_impl* player = nullptr;

void make_player(RTC::Manager* manager) {
  VideoPlayerInit(manager);
  player = manager->createComponent("VideoPlayer?conf.default.window=0");
}

}  // namespace

int main(int argc, char** argv) {
  ::test::answer_help(
      argc, argv,
      "camera_probe SERVER_ID CAMERA COUNT [OPTION_OF_MANAGER]...\nPrints the delays of COUNT images on their way to a VideoPlayer.");
  if (argc < 4) return 2;
  auto camera = shm::Iface::open(static_cast<std::uint32_t>(std::atoi(argv[1])), shm::IfaceType::camera, argv[2]);
  if (!camera) return std::fprintf(stderr, "%s\n", camera.error().message.c_str()), 1;
  if (const auto done = camera->subscribe(); !done) return std::fprintf(stderr, "%s\n", done.error().message.c_str()), 1;
  Measured measured{std::move(*camera), static_cast<std::size_t>(std::atoi(argv[3])) + warm_up, {}, {}};
  argv[3] = argv[0];
  RTC::Manager* manager = RTC::Manager::init(argc - 3, argv + 3);
  manager->setModuleInitProc(make_player);
  manager->activateManager();
  if (player == nullptr) return 1;
  player->getInPorts().front()->addConnectorDataListener(RTC::ConnectorDataListenerType::ON_BUFFER_WRITE, new Arrival(measured));
  manager->runManager(true);
  const bool is_complete = measured.done.get_future().wait_for(std::chrono::minutes(1)) == std::future_status::ready;
  if (is_complete) {
    std::vector<double> times(measured.times.begin() + warm_up, measured.times.end());
    std::ranges::sort(times);
    std::printf("latency %.1f %.1f\n", times[times.size() / 2], times[times.size() * 9 / 10]);
    std::fflush(stdout);
  }
  manager->shutdown();
  return is_complete ? 0 : 1;
}
