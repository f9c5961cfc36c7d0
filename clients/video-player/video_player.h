// VideoPlayer: shows the images of the InPort `image` (RTC::CameraImage) in a window, with frame rate, simulated time and dropped frames in
// its title; space pauses, s saves a PNG (in record_dir, or where the process works), q, escape or the window's button close it. A player
// without window and record_dir has nothing left to do then: it deactivates itself; active again it has a new window. Without a display it
// logs that and writes to record_dir.
// Configuration: record_dir: a folder for a PNG of every frame, and times.txt with the simulated time of each (empty: none); what is there
// already stays, and the numbers go on. window: 0 or 1.
#pragma once

#include <rtm/idl/InterfaceDataTypesSkel.h>

#include <rtm/DataFlowComponentBase.h>
#include <rtm/DataInPort.h>
#include <rtm/Manager.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <fstream>
#include <memory>
#include <string>

#include "picture.h"
#include "window.h"

class VideoPlayer : public RTC::DataFlowComponentBase {
 public:
  explicit VideoPlayer(RTC::Manager* manager);
  ~VideoPlayer() override;
  RTC::ReturnCode_t onInitialize() override;
  RTC::ReturnCode_t onActivated(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onDeactivated(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onAborting(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id) override;

  // A frame was overwritten before it was shown. Any thread.
  void frame_dropped() { dropped_.fetch_add(1, std::memory_order_relaxed); }

 private:
  using Clock = std::chrono::steady_clock;

  bool open_records();
  void close_window();
  void take(const RTC::CameraImage& image);
  void handle_events(RTC::UniqueId ec_id);
  void update_title();
  void write_title();
  std::string save(const std::string& folder, const char* prefix, std::uint64_t& number);
  void record();
  void refuse(const std::string& line);

  std::string record_dir_;
  int window_wanted_ = 1;
  RTC::CameraImage image_;
  RTC::InPort<RTC::CameraImage> image_in_;

  std::unique_ptr<video::Window> window_;
  std::shared_ptr<const video::Picture> picture_ = std::make_shared<video::Picture>();
  double picture_time_ = 0;  // [s] of simulated time
  bool is_paused_ = false;
  std::uint64_t frames_ = 0;
  std::string recording_to_;    // the record_dir that is open
  std::uint64_t recorded_ = 0;  // the number of its last frame
  std::uint64_t passed_ = 0;    // good ones while it paused
  std::uint64_t refused_ = 0;
  std::atomic<std::uint64_t> dropped_{0};
  std::uint64_t frames_at_title_ = 0;
  Clock::time_point title_time_{};
  double rate_ = 0;  // [frames/s of real time]
  std::string said_;
  std::ofstream times_;  // of the recorded frames
};

extern "C" {
DLL_EXPORT void VideoPlayerInit(RTC::Manager* manager);
}
