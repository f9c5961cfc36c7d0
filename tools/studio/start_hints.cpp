#include "studio/start_hints.h"

#include <cstdlib>
#include <filesystem>
#include <vector>

#include "base/child_process.h"
#include "base/shell_word.h"
#include "base/text.h"

namespace studio {
namespace {

namespace fs = std::filesystem;

// Below this folder without what is above it.
std::string shown(const fs::path& path) {
  std::error_code error;
  const fs::path here = fs::current_path(error);
  const auto near = path.lexically_relative(here);
  return error || near.empty() || *near.begin() == ".." ? path.string() : near.string();
}

bool is_there(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error);
}

// By its name alone when a shell finds this one.
std::string program(const std::string& name) {
  const fs::path own = base::own_program(name);
  const char* path = std::getenv("PATH");
  for (const auto& folder : base::split_list(path == nullptr ? "" : path, ':')) {
    std::error_code error;
    if (!is_there(fs::path(folder) / name)) continue;
    if (fs::equivalent(fs::path(folder) / name, own, error)) return name;
    break;
  }
  return shown(own);
}

fs::path prefix() { return fs::path(base::own_program("rtcd")).parent_path().parent_path(); }

}  // namespace

std::string usual_world() {
  std::error_code error;
  for (const auto& folder : {fs::current_path(error), prefix() / "share/rtm-sim", prefix().parent_path().parent_path()}) {
    if (is_there(folder / "worlds/obstacle_course.sdf")) return shown(folder / "worlds/obstacle_course.sdf");
  }
  return {};
}

std::string own_modules() {
  const fs::path installed = prefix() / "lib/rtm-sim";
  return shown(is_there(installed / "RTCLaser.so") ? installed : prefix() / "lib");
}

StartHints start_hints(std::uint32_t server_id, const std::string& name_server) {
  const std::string world = usual_world();
  std::vector<std::string> simulator{program("sim-server"), world.empty() ? "WORLD.sdf" : world};
  if (server_id != 0) simulator.insert(simulator.end(), {"-s", std::to_string(server_id)});
  std::vector<std::string> host{program("rtcd"), "--with-naming", "-o", "manager.modules.load_path:" + own_modules()};
  if (name_server != "localhost" && name_server != "localhost:2809") host.insert(host.end(), {"-o", "corba.nameservers:" + name_server});
  const std::string device = server_id == 0 ? "" : "?conf.default.server_id=" + std::to_string(server_id);
  host.insert(host.end(), {"RTCLaser" + device, "RTCPosition2d" + device, "LaserObstacleAvoid"});
  return {base::shell_line(simulator), base::shell_line(host)};
}

}  // namespace studio
