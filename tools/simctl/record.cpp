// record: the frames of a camera as PNG files, or as a film when an encoder (ffmpeg) is installed.
#include <png.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "base/bayer.h"
#include "base/text.h"
#include "simctl/simctl.h"

namespace simctl {
namespace {

using Json = nlohmann::ordered_json;

std::optional<png_uint_32> png_format(shm::Format format) {
  switch (format) {
    case shm::Format::rgb8:
      return PNG_FORMAT_RGB;
    case shm::Format::bgr8:
      return PNG_FORMAT_BGR;
    case shm::Format::rgba8:
      return PNG_FORMAT_RGBA;
    case shm::Format::bgra8:
      return PNG_FORMAT_BGRA;
    case shm::Format::mono8:
      return PNG_FORMAT_GRAY;
    default:
      return std::nullopt;
  }
}

std::optional<base::BayerOrder> bayer_order(shm::Format format) {
  switch (format) {
    case shm::Format::bayer_rggb8:
      return base::BayerOrder{0, 0};
    case shm::Format::bayer_grbg8:
      return base::BayerOrder{0, 1};
    case shm::Format::bayer_gbrg8:
      return base::BayerOrder{1, 0};
    case shm::Format::bayer_bggr8:
      return base::BayerOrder{1, 1};
    default:
      return std::nullopt;
  }
}

// Two octets a pixel, the low one first, as they are. libpng's simple interface would take them for linear light.
bool write_wide_grey(std::FILE* file, png_structp png, png_infop info, const shm::FrameHead& head, const std::uint8_t* data) {
  // libpng comes back here when something fails; nothing that has a destructor may be made below.
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_init_io(png, file);
  png_set_IHDR(png, info, head.width, head.height, 16, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  png_set_swap(png);
  for (std::uint32_t row = 0; row < head.height; ++row) png_write_row(png, data + static_cast<std::size_t>(row) * head.stride);
  png_write_end(png, nullptr);
  return true;
}

base::Result<void> write_wide_grey(const shm::FrameHead& head, const std::uint8_t* data, const std::string& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "wb"), std::fclose);
  const auto fail = [](png_structp png, png_const_charp) { longjmp(png_jmpbuf(png), 1); };
  const auto ignore = [](png_structp, png_const_charp) {};
  png_structp png = file ? png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, fail, ignore) : nullptr;
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  const bool is_written = info && write_wide_grey(file.get(), png, info, head, data) && std::fflush(file.get()) == 0;
  png_destroy_write_struct(&png, &info);
  if (is_written) return {};
  return base::Error{"file " + base::in_quotes(path) + ": cannot be written: " + std::strerror(errno)};
}

// Mosaics become colours; 16 bits of grey stay 16 bits.
base::Result<void> write_frame(const shm::HeldFrame& frame, const std::string& file) {
  const auto& head = frame.head();
  const auto format = shm::shown_as(static_cast<shm::Format>(head.format));
  const auto* data = reinterpret_cast<const std::uint8_t*>(frame.data().data());
  if (frame.data().size() < static_cast<std::size_t>(head.stride) * head.height) return base::Error{"record: the frame is cut short"};
  std::vector<std::uint8_t> scratch;
  std::size_t stride = head.stride;
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = head.width;
  image.height = head.height;
  if (const auto known = png_format(format)) {
    image.format = *known;
  } else if (const auto order = bayer_order(format)) {
    image.format = PNG_FORMAT_RGB;
    stride = std::size_t{3} * head.width;
    scratch.resize(stride * head.height);
    base::demosaic({data, frame.data().size()}, static_cast<int>(head.width), static_cast<int>(head.height), head.stride, *order, scratch);
  } else if (format == shm::Format::mono16) {
    return write_wide_grey(head, data, file);
  } else {
    return base::Error{"record: frames of this format cannot be recorded"};
  }
  const void* rows = scratch.empty() ? data : scratch.data();
  if (png_image_write_to_file(&image, file.c_str(), 0, rows, static_cast<png_int_32>(stride), nullptr) == 0)
    return base::Error{"file " + base::in_quotes(file) + ": " + image.message};
  return {};
}

constexpr const char* encoder = "ffmpeg";

bool has_encoder() {
  const char* path = std::getenv("PATH");
  for (const auto& folder : base::split_list(path != nullptr ? path : "", ':')) {
    if (::access((std::string(folder) + "/" + encoder).c_str(), X_OK) == 0) return true;
  }
  return false;
}

bool encode(const std::string& folder, double rate, const std::string& target) {
  // What ffmpeg is to read is a pattern, too.
  std::string files;
  for (const char c : folder) files += c == '%' ? "%%" : std::string(1, c);
  files += "/frame-%06d.png";
  // It would take the terminal's keys. Players want even sizes.
  std::vector<std::string> words = {encoder,
                                    "-nostdin",
                                    "-loglevel",
                                    "error",
                                    "-y",
                                    "-framerate",
                                    base::format_number(rate),
                                    "-i",
                                    files,
                                    "-vf",
                                    "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                                    "-pix_fmt",
                                    "yuv420p",
                                    target};
  std::vector<char*> arguments;
  for (auto& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  if (posix_spawnp(&child, encoder, nullptr, nullptr, arguments.data(), environ) != 0) return false;
  int status = 0;
  return waitpid(child, &status, 0) == child && status == 0;
}

// An empty text when the folder is there and holds no frames yet.
std::string prepare(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return "folder " + base::in_quotes(folder) + ": cannot be made: " + error.message();
  if (std::filesystem::exists(folder + "/frame-000001.png", error)) return "folder " + base::in_quotes(folder) + ": holds frames already";
  return {};
}

std::string frame_file(const std::string& folder, int number) {
  char file[32];
  std::snprintf(file, sizeof file, "/frame-%06d.png", number);
  return folder + file;
}

// And the folder, unless it holds something else.
void remove_frames(const std::string& folder, int frames) {
  std::error_code error;
  for (int i = 1; i <= frames; ++i) std::filesystem::remove(frame_file(folder, i), error);
  std::filesystem::remove(folder, error);
}

struct Film {
  int frames = 0;
  std::uint64_t missed = 0;
  bool is_cut = false;  // the simulator ended before all was taken
  std::int64_t first_ns = 0, last_ns = 0;

  // Frames a simulated second, as they came.
  double rate(double usual) const {
    return frames > 1 && last_ns > first_ns ? (frames - 1) * 1e9 / static_cast<double>(last_ns - first_ns) : usual;
  }
};

// Until enough has been taken, an interrupt, or the end of the simulator.
base::Result<Film> take_frames(shm::Iface& camera, const std::string& folder, int frames, double seconds) {
  Film film;
  std::uint64_t last = 0;
  bool has_said = false;
  while (!is_interrupted() && (frames <= 0 || film.frames < frames)) {
    const auto what = camera.wait(last, std::chrono::milliseconds(200));
    if (what == shm::Wait::closed) {
      if (film.frames == 0) return base::Error{"iface " + camera.name() + ": the simulator has exited"};
      film.is_cut = frames > 0 || seconds > 0;
      break;
    }
    if (what == shm::Wait::timed_out) {
      if (!has_said && film.frames <= 1 && is_paused(camera.server_id())) {
        std::cerr << "simctl: the simulation is paused; frames come when it runs" << std::endl;
        has_said = true;
      }
      continue;
    }
    const auto frame = camera.hold();
    if (!frame) continue;
    const auto now = frame->head().stamp.sim_time_ns;
    if (film.frames == 0) film.first_ns = now;
    if (seconds > 0 && static_cast<double>(now - film.first_ns) * 1e-9 > seconds) break;
    if (film.frames > 0) film.missed += frame->sequence() - last - 1;
    last = frame->sequence();
    film.last_ns = now;
    if (const auto written = write_frame(*frame, frame_file(folder, ++film.frames)); !written) return written.error();
  }
  return film;
}

}  // namespace

void record(Control& control, const std::string& name, const std::string& target, int frames, double seconds) {
  auto camera = control.open(name, shm::IfaceType::camera);
  if (!camera) return;
  if (camera->type() != shm::IfaceType::camera)
    return control.fail("iface " + name + ": is a " + std::string(shm::to_text(camera->type())) + ", record takes a camera");
  const bool is_film = target.ends_with(".mp4"), is_encoded = is_film && has_encoder();
  const auto folder = is_film ? target + ".frames" : target;
  if (const auto trouble = prepare(folder); !trouble.empty()) return control.fail(trouble);
  if (is_film && !is_encoded) std::cerr << "simctl: no encoder (" << encoder << ") is installed; the frames go to " << folder << '\n';
  if (const auto done = camera->subscribe(); !done) return control.fail(done.error().message);
  catch_interrupts();
  const auto film = take_frames(*camera, folder, frames, seconds);
  if (!film) return control.fail(film.error().message);
  if (is_encoded && film->frames > 0) {
    if (!encode(folder, film->rate(camera->info<shm::CameraInfo>().rate), target))
      return control.fail("record: " + std::string(encoder) + " could not write " + target + "; the frames are in " + folder);
    remove_frames(folder, film->frames);
  }
  if (film->is_cut) control.fail("iface " + name + ": the simulator has exited after " + std::to_string(film->frames) + " frames");
  if (control.json()) return control.print(Json{{"frames", film->frames}, {"missed", film->missed}, {"rate", film->rate(0)}});
  std::cout << film->frames << " frames, " << film->missed << " missed\n";
}

}  // namespace simctl
