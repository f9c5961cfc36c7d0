// record: the frames of a camera as PNG files, or as a film when an encoder is installed.
#include <png.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <iostream>
#include <vector>

#include "base/text.h"
#include "simctl.h"

namespace simctl {
namespace {

// Rows are packed first: the ring may pad them.
base::Result<void> write_frame(const shm::HeldFrame& frame, const std::string& file) {
  const auto& head = frame.head();
  const auto format = static_cast<shm::Format>(head.format);
  if (format != shm::Format::rgb8 && format != shm::Format::mono8) return base::Error{"record: only rgb and mono cameras can be recorded"};
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = head.width;
  image.height = head.height;
  image.format = format == shm::Format::rgb8 ? PNG_FORMAT_RGB : PNG_FORMAT_GRAY;
  if (frame.data().size() < static_cast<std::size_t>(head.stride) * head.height) return base::Error{"record: the frame is cut short"};
  if (png_image_write_to_file(&image, file.c_str(), 0, frame.data().data(), static_cast<png_int_32>(head.stride), nullptr) == 0)
    return base::Error{"file " + base::in_quotes(file) + ": " + image.message};
  return {};
}

bool encode(const std::string& folder, double rate, const std::string& target) {
  const std::string frames = folder + "/frame-%06d.png";
  const std::string rate_text = base::format_number(rate);
  std::vector<std::string> words = {"ffmpeg", "-loglevel", "error",    "-y",      "-framerate", rate_text,
                                    "-i",     frames,      "-pix_fmt", "yuv420p", target};
  std::vector<char*> arguments;
  for (auto& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  if (posix_spawnp(&child, "ffmpeg", nullptr, nullptr, arguments.data(), environ) != 0) return false;
  int status = 0;
  return waitpid(child, &status, 0) == child && status == 0;
}

}  // namespace

void record(Control& control, const std::string& name, const std::string& target, int frames, double seconds) {
  auto camera = control.open(name);
  if (!camera) return;
  if (camera->type() != shm::IfaceType::camera)
    return control.fail("iface " + name + ": is a " + std::string(shm::to_text(camera->type())) + ", record takes a camera");
  if (const auto done = camera->subscribe(); !done) return control.fail(done.error().message);
  const bool is_film = target.ends_with(".mp4");
  const auto folder = is_film ? target + ".frames" : target;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return control.fail("folder " + base::in_quotes(folder) + ": cannot be made: " + error.message());
  catch_interrupts();
  std::uint64_t last = 0;
  std::int64_t first_ns = -1;
  int taken = 0;
  while (!is_interrupted() && (frames <= 0 || taken < frames)) {
    const auto what = camera->wait(last, std::chrono::milliseconds(200));
    if (what == shm::Wait::closed) {
      control.fail("iface " + name + ": the simulator is gone");
      break;
    }
    if (what == shm::Wait::timed_out) continue;
    const auto frame = camera->hold();
    if (!frame) continue;
    last = frame->sequence();
    const auto now = frame->head().stamp.sim_time_ns;
    if (first_ns < 0) first_ns = now;
    if (seconds > 0 && static_cast<double>(now - first_ns) * 1e-9 > seconds) break;
    char file[32];
    std::snprintf(file, sizeof file, "/frame-%06d.png", ++taken);
    if (const auto written = write_frame(*frame, folder + file); !written) return control.fail(written.error().message);
  }
  if (!is_film) return;
  if (encode(folder, camera->info<shm::CameraInfo>().rate, target)) {
    std::filesystem::remove_all(folder, error);
  } else {
    control.fail("record: no encoder (ffmpeg) could write " + target + "; the frames are in " + folder);
  }
}

}  // namespace simctl
