#include "video_player.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

// clang-format off
static const char* const videoplayer_spec[] = {
    "implementation_id", "VideoPlayer",
    "type_name", "VideoPlayer",
    "description", "Shows camera images in a window",
    "version", "1.0.0",
    "vendor", "rtm-sim",
    "category", "display",
    "activity_type", "PERIODIC",
    "kind", "DataFlowComponent",
    "max_instance", "0",
    "language", "C++",
    "lang_type", "compile",
    "exec_cxt.periodic.rate", "1000",
    "exec_cxt.sim_time.phase", "1",
    "conf.default.record_dir", "",
    "conf.default.window", "1",
    "conf.__type__.record_dir", "string",
    "conf.__type__.window", "int",
    "conf.__widget__.record_dir", "text",
    "conf.__widget__.window", "radio",
    "conf.__constraints__.window", "(0,1)",
    ""};
// clang-format on

namespace {

namespace fs = std::filesystem;

constexpr double longest_wait = 0.05;                                       // [s] for a frame, in real time
constexpr std::chrono::milliseconds longest_work{100}, longest_tick{1000};  // of reading in one cycle
constexpr std::chrono::milliseconds title_period{500};

class DropListener : public RTC::ConnectorDataListenerT<RTC::CameraImage> {
 public:
  explicit DropListener(VideoPlayer& owner) : owner_(owner) {}
  USE_CONNLISTENER_STATUS;
  ReturnCode operator()(RTC::ConnectorInfo&, RTC::CameraImage&) override {
    owner_.frame_dropped();
    return NO_CHANGE;
  }

 private:
  VideoPlayer& owner_;
};

// The highest number of the files PREFIX-NUMBER.png in the folder; 0: there are none.
std::uint64_t last_number(const fs::path& folder, const std::string& prefix) {
  std::uint64_t last = 0;
  std::error_code error;
  for (fs::directory_iterator file(folder, error), end; !error && file != end; file.increment(error)) {
    const auto name = file->path().filename().string();
    unsigned long long number = 0;
    if (std::sscanf(name.c_str(), (prefix + "-%18llu.png").c_str(), &number) == 1) last = std::max<std::uint64_t>(last, number);
  }
  return last;
}

}  // namespace

VideoPlayer::VideoPlayer(RTC::Manager* manager) : RTC::DataFlowComponentBase(manager), image_in_("image", image_) {}
VideoPlayer::~VideoPlayer() = default;

RTC::ReturnCode_t VideoPlayer::onInitialize() {
  addInPort("image", image_in_);
  image_in_.addConnectorDataListener(RTC::ConnectorDataListenerType::ON_BUFFER_OVERWRITE, new DropListener(*this));
  bindParameter("record_dir", record_dir_, "");
  bindParameter("window", window_wanted_, "1");
  return RTC::RTC_OK;
}

RTC::ReturnCode_t VideoPlayer::onActivated(RTC::UniqueId) {
  frames_ = passed_ = refused_ = frames_at_title_ = 0;
  is_paused_ = false;
  dropped_.store(0, std::memory_order_relaxed);
  title_time_ = Clock::now();
  said_.clear();
  recording_to_.clear();
  if (!open_records()) return RTC::RTC_ERROR;
  if (window_wanted_ == 0) return RTC::RTC_OK;
  std::string problem;
  window_ = video::Window::open(getInstanceName(), problem);
  if (!window_ && record_dir_.empty()) RTC_WARN(("no window: %s; set record_dir to get the frames as PNG files", problem.c_str()));
  if (!window_ && !record_dir_.empty()) RTC_WARN(("no window: %s; the frames go to %s", problem.c_str(), record_dir_.c_str()));
  return RTC::RTC_OK;
}

// The frames go on behind those that the folder has.
bool VideoPlayer::open_records() {
  if (record_dir_ == recording_to_) return true;
  recording_to_ = record_dir_;
  times_ = {};
  if (record_dir_.empty()) return true;
  std::error_code error;
  fs::create_directories(record_dir_, error);
  if (error) {
    RTC_ERROR(("record_dir %s cannot be made: %s", video::quoted(record_dir_).c_str(), error.message().c_str()));
    return false;
  }
  recorded_ = last_number(record_dir_, "frame");
  times_ = std::ofstream(fs::path(record_dir_) / "times.txt", std::ios::app);
  return true;
}

void VideoPlayer::close_window() {
  if (!window_) return;
  if (const auto problem = window_->close(); !problem.empty()) RTC_WARN(("the window: %s", problem.c_str()));
  window_.reset();
}

RTC::ReturnCode_t VideoPlayer::onDeactivated(RTC::UniqueId) {
  close_window();
  const auto passed = passed_ > 0 ? ", " + std::to_string(passed_) + " passed while it paused" : std::string();
  RTC_INFO(("%s frames shown, %s dropped, %s rejected%s", std::to_string(frames_).c_str(),
            std::to_string(dropped_.load(std::memory_order_relaxed)).c_str(), std::to_string(refused_).c_str(), passed.c_str()));
  return RTC::RTC_OK;
}

RTC::ReturnCode_t VideoPlayer::onAborting(RTC::UniqueId) {
  close_window();
  return RTC::RTC_OK;
}

RTC::ReturnCode_t VideoPlayer::onExecute(RTC::UniqueId ec_id) {
  if (!open_records()) return RTC::RTC_ERROR;  // it may change meanwhile
  image_in_.waitNew(longest_wait);
  // Frames may come faster than they can be recorded. What is left after this time waits for the next cycle, or is dropped: keys,
  // configuration and transitions must have their turn. In simulated time a cycle takes all that has come, as far as anybody can wait.
  const auto end = Clock::now() + (RTC::inSimulatedTime() ? longest_tick : longest_work);
  while (image_in_.isNew() && image_in_.read()) {
    take(image_);
    if (Clock::now() >= end) break;
  }
  if (window_) handle_events(ec_id);
  update_title();
  return RTC::RTC_OK;
}

void VideoPlayer::refuse(const std::string& line) {
  ++refused_;
  if (said_ != line) RTC_ERROR(("%s", line.c_str()));
  said_ = line;
}

void VideoPlayer::take(const RTC::CameraImage& image) {
  std::string problem;
  auto picture = video::to_picture(image, problem);
  if (!picture) return refuse(problem);
  if (is_paused_) {
    ++passed_;
    return;
  }
  ++frames_;
  picture_ = std::make_shared<const video::Picture>(std::move(*picture));
  picture_time_ = image.tm.sec + image.tm.nsec * 1e-9;
  if (window_) window_->show(picture_);
  if (!record_dir_.empty()) record();
}

// As the first number after the given one that is free. The file's name; empty when there is none.
std::string VideoPlayer::save(const std::string& folder, const char* prefix, std::uint64_t& number) {
  if (picture_->rgb.empty()) return {};
  fs::path file;
  std::error_code error;
  auto free = number;
  do {
    char name[64];
    std::snprintf(name, sizeof name, "%s-%06llu.png", prefix, static_cast<unsigned long long>(++free));
    file = fs::path(folder) / name;
  } while (fs::exists(file, error));
  if (const auto problem = video::write_png(*picture_, file.string()); !problem.empty()) {
    if (said_ != problem) RTC_ERROR(("%s", problem.c_str()));
    said_ = problem;
    return {};
  }
  number = free;
  return file.filename().string();
}

void VideoPlayer::record() {
  const auto name = save(record_dir_, "frame", recorded_);
  char time[32];
  std::snprintf(time, sizeof time, "%u.%09u", static_cast<unsigned>(image_.tm.sec), static_cast<unsigned>(image_.tm.nsec));
  if (!name.empty()) times_ << name << ' ' << time << std::endl;
}

void VideoPlayer::handle_events(RTC::UniqueId ec_id) {
  const auto events = window_->events();
  if (!events.problem.empty() && events.problem != said_) RTC_ERROR(("%s", events.problem.c_str()));
  if (!events.problem.empty()) said_ = events.problem;
  if (events.save) {
    const std::string folder = record_dir_.empty() ? "." : record_dir_;
    auto last = last_number(folder, "picture");
    save(folder, "picture", last);
  }
  if (events.toggle_pause) {
    is_paused_ = !is_paused_;
    write_title();
  }
  if (!events.close && !events.lost) return;
  if (events.close) close_window();
  window_.reset();
  if (events.lost && record_dir_.empty()) RTC_WARN(("the display is lost; set record_dir to get the frames as PNG files"));
  if (events.lost && !record_dir_.empty()) RTC_WARN(("the display is lost; the frames go to %s", record_dir_.c_str()));
  if (!record_dir_.empty()) return;
  if (events.close) RTC_INFO(("the window was closed"));
  deactivate(ec_id);
}

void VideoPlayer::update_title() {
  const auto now = Clock::now();
  if (now - title_time_ < title_period) return;
  rate_ = static_cast<double>(frames_ - frames_at_title_) / std::chrono::duration<double>(now - title_time_).count();
  title_time_ = now;
  frames_at_title_ = frames_;
  write_title();
}

void VideoPlayer::write_title() {
  if (!window_) return;
  char title[200];
  std::snprintf(title, sizeof title, "%s  %dx%d  %.1f frames/s  t = %.2f s  dropped %llu%s", getInstanceName(), picture_->width,
                picture_->height, rate_, picture_time_, static_cast<unsigned long long>(dropped_.load(std::memory_order_relaxed)),
                is_paused_ ? "  paused" : "");
  window_->set_title(title);
}

extern "C" {
void VideoPlayerInit(RTC::Manager* manager) {
  coil::Properties profile(videoplayer_spec);
  manager->registerFactory(profile, RTC::Create<VideoPlayer>, RTC::Delete<VideoPlayer>);
}
}
