// Who may include whom (docs/ARCHITECTURE.md): reads every source of the project and reports what breaks the table.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "support/paths.h"

namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

// One layer: a folder, the parts of the project whose headers it may include ("stubs" are the headers made from idl/, and its own), and the
// third-party libraries. Standard headers and those of the operating system are allowed everywhere.
struct Layer {
  std::string folder;
  Names may_include;
  Names libraries{};
  Names never{};  // headers, or folders of them, that it may not include although it may include others of their part
};

// The first folder that a file lies in counts.
const std::vector<Layer> layers = {
    {"base", {"base"}, {"spdlog", "CLI11", "uuid", "YAML", "JPEG"}},
    {"rtm-core/core", {"core", "base"}},
    {"rtm-core/corba", {"corba", "core", "base", "stubs"}, {"omniORB"}},
    {"rtm-core/openrtm/include/coil", {"coil"}},
    {"rtm-core/openrtm/include", {"rtm", "coil", "stubs"}, {"omniORB"}},
    {"rtm-core/coil", {"coil"}},
    {"rtm-core/component",
     {"component", "managed", "context clock", "rtm", "coil", "corba", "core", "base", "stubs"},
     {"omniORB"},
     {"rtm/Manager.h"}},
    {"rtm-core/manager", {"manager", "managed", "rtm", "coil", "corba", "core", "base", "stubs"}, {"omniORB"}, {"rtm/RTObject.h"}},
    {"rtm-core/openrtm",
     {"openrtm", "manager", "component", "context clock", "rtm", "coil", "corba", "core", "base", "stubs"},
     {"omniORB"}},
    {"rtm-core/rtcd", {"rtm", "coil", "corba", "core", "base", "stubs"}},
    {"shm", {"shm", "base"}, {"JSON"}},
    {"ros", {"ros", "shm", "base"}},
    {"sim-server/reader", {"reader", "base"}},
    {"sim-server/asset-reader",
     {"asset-reader", "reader", "render", "world", "base"},
     {"Assimp", "PNG", "JPEG", "TIFF", "Eigen", "spdlog"}},
    {"sim-server/world", {"world", "reader", "base"}, {"SDFormat", "pugixml", "YAML", "Eigen", "spdlog"}},
    {"sim-server/physics", {"physics", "world", "base"}, {"ODE", "Eigen", "spdlog"}},
    {"sim-server/rays", {"rays", "world", "base"}, {"Embree", "Eigen", "spdlog"}},
    {"sim-server/render", {"render", "world", "reader", "base"}, {"OpenGL", "PNG", "Eigen", "spdlog"}},
    {"sim-server",
     {"devices", "server", "shm", "world", "physics", "rays", "render", "reader", "base"},
     {"Eigen", "JSON", "PNG", "spdlog"}},
    {"arms", {"arms", "shm", "base"}, {"Eigen"}},
    {"iface-components", {"rtm", "coil", "context clock", "arms", "shm", "base", "stubs"}, {"Eigen"}},
    {"gateways/common", {"common", "shm", "base"}},
    {"gateways/ros2/dds", {"dds", "base"}, {"FastDDS"}},
    {"gateways/ros2", {"dds", "common", "ros2", "ros", "rtm", "coil", "stubs", "shm", "base"}, {"JSON", "YAML", "spdlog"}},
    {"gateways/player/protocol", {"protocol", "base"}},
    {"gateways/player", {"protocol", "common", "arms", "shm", "base"}, {"Eigen", "JSON", "YAML", "spdlog", "zlib"}},
    {"tools/system", {"system", "corba", "shm", "base", "stubs"}, {"omniORB", "pugixml", "JSON", "YAML"}},
    {"tools/channels/views", {"channels", "ros", "shm", "base"}, {"JSON"}},
    {"tools/channels", {"channels", "ros", "base", "stubs"}, {}, {"channels/views/"}},
    {"tools/recording/mcap", {"recording", "base"}, {"zstd", "lz4", "deflate"}},
    {"tools/recording", {"recording", "channels", "ros", "system", "shm", "base", "stubs"}, {"omniORB", "JSON", "PNG"}},
    {"tools/run", {"run", "recording", "channels", "system", "corba", "shm", "base", "stubs"}, {"omniORB", "pugixml", "YAML", "JSON"}},
    {"tools/campaign",
     {"campaign", "run", "recording", "system", "base", "stubs"},
     {"omniORB", "pugixml", "JSON", "YAML", "Eigen", "SQLite"}},
    {"tools/rtse",
     {"rtse", "campaign", "run", "recording", "channels", "system", "corba", "shm", "base", "stubs"},
     {"omniORB", "pugixml", "JSON", "YAML", "spdlog", "ncurses"}},
    {"tools/simctl", {"simctl", "shm", "base"}, {"JSON", "PNG"}},
    {"tools/studio", {"studio", "run", "recording", "channels", "system", "shm", "base", "stubs"}, {"omniORB", "Boost", "JSON", "deflate"}},
    {"tools/page", {"page", "studio", "recording", "base"}, {"deflate"}},
    {"clients/examples", {"rtm", "coil", "stubs"}},
    {"clients/obstacle-avoidance", {"rtm", "coil", "stubs"}},
    {"clients/box-stacker", {"rtm", "coil", "stubs"}},
    {"clients/pilot", {"rtm", "coil", "stubs"}},
    {"clients/warehouse", {"rtm", "coil", "stubs"}},
    {"clients/way-points", {"rtm", "coil", "stubs"}},
    {"clients/video-player", {"rtm", "coil", "stubs"}, {"SDL2", "X11", "JPEG", "PNG"}},
    {"clients/follow", {"protocol", "dds", "ros", "base"}},
    {"python/openrtm", {"python", "manager", "managed", "rtm", "coil", "corba", "base", "stubs"}, {"pybind11", "omniORB"}},
    {"python", {"python", "recording", "shm", "base"}, {"pybind11"}},
};

// Whose header this is: a part of the project, a library, or "" for one of neither.
std::string owner(const std::string& header) {
  static const std::vector<std::pair<std::string, std::string>> prefixes = {
      {"component/managed.h", "managed"},              // what the manager knows of components
      {"component/context_clock.h", "context clock"},  // for contexts on simulated time
      {"rtm/idl/", "stubs"},
      {"rtm/ext/", "stubs"},
      {"idl/any_check.h", "stubs"},
      {"base/", "base"},
      {"core/", "core"},
      {"corba/", "corba"},
      {"rtm/", "rtm"},
      {"coil/", "coil"},
      {"openrtm/", "openrtm"},
      {"manager/", "manager"},
      {"component/", "component"},
      {"reader/", "reader"},
      {"asset-reader/", "asset-reader"},
      {"rays/", "rays"},
      {"render/", "render"},
      {"devices/", "devices"},
      {"server/", "server"},
      {"shm/", "shm"},
      {"arms/", "arms"},
      {"world/", "world"},
      {"physics/", "physics"},
      {"protocol/", "protocol"},
      {"common/", "common"},
      {"dds/", "dds"},
      {"fastdds/", "FastDDS"},
      {"fastrtps/", "FastDDS"},
      {"ros/", "ros"},
      {"ros2/", "ros2"},
      {"system/", "system"},
      {"channels/", "channels"},
      {"recording/", "recording"},
      {"run/", "run"},
      {"campaign/", "campaign"},
      {"rtse/", "rtse"},
      {"simctl/", "simctl"},
      {"studio/", "studio"},
      {"page/", "page"},
      {"python/", "python"},
      {"Python.h", "pybind11"},
      {"omniORB4/", "omniORB"},
      {"omnithread", "omniORB"},
      {"COS/", "omniORB"},
      {"ode/", "ODE"},
      {"embree", "Embree"},
      {"sdf/", "SDFormat"},
      {"GL/", "OpenGL"},
      {"GLES", "OpenGL"},
      {"KHR/", "OpenGL"},
      {"Eigen/", "Eigen"},
      {"nlohmann/", "JSON"},
      {"spdlog/", "spdlog"},
      {"fmt/", "spdlog"},
      {"pugixml", "pugixml"},
      {"yaml-cpp/", "YAML"},
      {"png.h", "PNG"},
      {"zlib.h", "zlib"},
      {"tiffio.h", "TIFF"},
      {"jpeglib", "JPEG"},
      {"turbojpeg", "JPEG"},
      {"assimp/", "Assimp"},
      {"CLI/", "CLI11"},
      {"SDL", "SDL2"},
      {"X11/", "X11"},
      {"uuid/", "uuid"},
      {"ncurses", "ncurses"},
      {"zstd", "zstd"},
      {"lz4", "lz4"},
      {"libdeflate", "deflate"},
      {"sqlite3", "SQLite"},
      {"boost/", "Boost"},
      {"pybind11/", "pybind11"},
  };
  for (const auto& [prefix, name] : prefixes) {
    if (header.starts_with(prefix)) return name;
  }
  return "";
}

// A standard header of C++ (its name has neither dot nor slash), or one of C, of the processor or of the operating system.
bool is_everybodys(const std::string& header) {
  if (header.find_first_of("./") == std::string::npos) return true;
  static const Names folders = {"sys/", "linux/", "netinet/", "net/", "arpa/", "bits/"};
  if (std::any_of(folders.begin(), folders.end(), [&](const std::string& folder) { return header.starts_with(folder); })) return true;
  static const Names names = {
      "cxxabi.h", "dirent.h",  "dlfcn.h",     "elf.h",     "errno.h", "execinfo.h",  "fcntl.h",     "fnmatch.h", "getopt.h", "glob.h",
      "grp.h",    "ifaddrs.h", "immintrin.h", "limits.h",  "link.h",  "locale.h",    "malloc.h",    "math.h",    "netdb.h",  "pmmintrin.h",
      "poll.h",   "pthread.h", "pwd.h",       "regex.h",   "sched.h", "semaphore.h", "signal.h",    "spawn.h",   "stddef.h", "stdint.h",
      "stdio.h",  "stdlib.h",  "string.h",    "termios.h", "time.h",  "unistd.h",    "xmmintrin.h",
  };
  return std::find(names.begin(), names.end(), header) != names.end();
}

const Layer* layer_of(const std::string& file) {
  for (const Layer& layer : layers) {
    if (file.starts_with(layer.folder + "/")) return &layer;
  }
  return nullptr;
}

// The text of a file with raw string literals emptied (programs that write sources have #include lines in them); lines keep their numbers.
std::string source_text(const fs::path& path) {
  std::ifstream in(path);
  std::string text((std::istreambuf_iterator<char>(in)), {});
  for (auto start = text.find("R\""); start != std::string::npos; start = text.find("R\"", start + 2)) {
    const auto open = text.find('(', start);
    if (open == std::string::npos || open - start > 18) continue;
    const std::string close = ")" + text.substr(start + 2, open - start - 2) + "\"";
    const auto end = std::min(text.find(close, open), text.size());
    std::replace_if(
        text.begin() + static_cast<long>(open), text.begin() + static_cast<long>(end), [](char c) { return c != '\n'; }, ' ');
  }
  return text;
}

// "file:line: layer folder may not include <header> of part", one per offence, sorted.
Names offences(const fs::path& root) {
  static const std::regex include_line(R"(^\s*#\s*include\s*([<"])([^>"]+)[>"].*)");
  Names found;
  for (const char* top :
       {"base", "shm", "ros", "arms", "rtm-core", "sim-server", "iface-components", "gateways", "tools", "clients", "python"}) {
    if (!fs::exists(root / top)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(root / top)) {
      const std::string extension = entry.path().extension().string();
      if (!entry.is_regular_file() || (extension != ".h" && extension != ".cpp" && extension != ".hpp" && extension != ".cc")) continue;
      const std::string file = fs::relative(entry.path(), root).generic_string();
      const Layer* layer = layer_of(file);
      if (layer == nullptr) {
        found.push_back(file + ": is in no layer of the table");
        continue;
      }
      std::istringstream in(source_text(entry.path()));
      std::string line;
      for (int number = 1; std::getline(in, line); ++number) {
        std::smatch match;
        if (!std::regex_match(line, match, include_line)) continue;
        const std::string header = match[2];
        const std::string part = owner(header);
        const auto has = [&](const Names& names) { return std::count(names.begin(), names.end(), part) != 0; };
        const std::string at = file + ":" + std::to_string(number) + ": ";
        if (part.empty()) {
          if (match[1] == "<" && !is_everybodys(header)) found.push_back(at + "<" + header + "> is of no library in the table");
          // A quoted name without a part is a header of the same room. Among the tools every name begins with its room.
          const bool is_here = header.ends_with("Stub.h") || header.ends_with("Skel.h") || header.ends_with("_manual.h") ||  // generated
                               fs::exists(entry.path().parent_path() / header) || fs::exists(root / layer->folder / header);
          if (match[1] == "\"" && (!is_here || file.starts_with("tools/")))
            found.push_back(at + "\"" + header + "\" is no header of " + layer->folder);
        } else if ((!has(layer->may_include) && !has(layer->libraries)) ||
                   std::any_of(layer->never.begin(), layer->never.end(), [&](const auto& name) { return header.starts_with(name); })) {
          found.push_back(at + layer->folder + " may not include <" + header + "> of " + part);
        }
      }
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

// Headers with a source of their own are compiled alone by that (cmake/headers_alone.cmake): it must include them before anything else.
Names not_own_first(const fs::path& root) {
  Names found;
  for (const char* folder : {"rtm-core/openrtm/rtm", "rtm-core/coil", "rtm-core/component", "rtm-core/manager", "rtm-core/openrtm"}) {
    if (!fs::exists(root / folder)) continue;
    for (const auto& entry : fs::directory_iterator(root / folder)) {
      if (entry.path().extension() != ".cpp") continue;
      const std::string name = entry.path().stem().string() + ".h";
      std::string part = entry.path().parent_path().filename().string();
      if (part == "extensions") part = "rtm";  // whose headers lie among those of <rtm/...>
      const bool has_header = fs::exists(entry.path().parent_path() / name) || fs::exists(root / "rtm-core/openrtm/include" / part / name);
      const std::string text = source_text(entry.path());
      const auto line = text.substr(std::min(text.find("#include"), text.size()), 200);
      const auto first = line.substr(0, line.find('\n'));
      const bool is_own = first.find("/" + name) != std::string::npos || first.find("\"" + name) != std::string::npos;
      if (has_header && !is_own)
        found.push_back(std::string(folder) + "/" + entry.path().filename().string() + ": does not begin with " + name);
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

// Types of the runtime that headers for authors name, as "file: namespace::Type". They have no definition there, so no author can use them.
Names internal_names(const fs::path& root) {
  static const std::regex name(R"(\b(base|rt|corba|shm|iface)::\w+)");
  Names found;
  const fs::path folder = root / "rtm-core/openrtm/include";
  if (!fs::exists(folder)) return found;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".h") continue;
    std::istringstream in(source_text(entry.path()));
    for (std::string line; std::getline(in, line);) {
      const auto code = line.substr(0, line.find("//"));
      for (std::sregex_iterator at(code.begin(), code.end(), name), end; at != end; ++at)
        found.push_back(fs::relative(entry.path(), folder).generic_string() + ": " + at->str());
    }
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

// Functions that the runtime alone needs are behind the one friend of these classes, component/runtime_access.h.
Names friends(const fs::path& root) {
  static const std::regex line_of_friend(R"(^\s*friend (class|struct) ([\w:]+);)");
  Names found;
  for (const char* file : {"RTObject.h", "ExecutionContextBase.h", "ConnectorBase.h", "CdrBufferBase.h", "DataPortBase.h", "DataType.h"}) {
    std::ifstream in(root / "rtm-core/openrtm/include/rtm" / file);
    std::smatch match;
    for (std::string line; std::getline(in, line);)
      if (std::regex_search(line, match, line_of_friend)) found.push_back(std::string(file) + ": " + match[2].str());
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

class PlantedTree : public testing::Test {
 protected:
  PlantedTree() : root_(fs::path(testing::TempDir()) / ("include_rules_" + std::to_string(getpid()))) {}
  ~PlantedTree() override { fs::remove_all(root_); }

  void plant(const std::string& file, const std::string& text) {
    fs::create_directories((root_ / file).parent_path());
    std::ofstream(root_ / file) << text;
  }

  const fs::path root_;
};

TEST(IncludeRules, hold_in_the_whole_project) { EXPECT_EQ(offences(paths::source_dir), Names{}); }

TEST(IncludeRules, a_source_begins_with_its_own_header) { EXPECT_EQ(not_own_first(paths::source_dir), Names{}); }

TEST_F(PlantedTree, a_source_that_does_not_begin_with_its_own_header_is_found) {
  plant("rtm-core/openrtm/include/rtm/a.h", "");
  plant("rtm-core/openrtm/rtm/a.cpp", "#include <rtm/b.h>\n#include <rtm/a.h>\n");
  plant("rtm-core/component/c.h", "");
  plant("rtm-core/component/c.cpp", "// text\n#include \"component/c.h\"\n");
  plant("rtm-core/component/d.cpp", "#include <string>\n");
  EXPECT_EQ(not_own_first(root_), Names{"rtm-core/openrtm/rtm/a.cpp: does not begin with a.h"});
}

TEST(IncludeRules, headers_for_authors_name_no_type_of_the_runtime) { EXPECT_EQ(internal_names(paths::source_dir), Names{}); }

TEST(IncludeRules, what_the_runtime_alone_does_with_classes_of_authors_is_behind_one_friend) {
  EXPECT_EQ(friends(paths::source_dir),
            (Names{"CdrBufferBase.h: RuntimeAccess", "ConnectorBase.h: RuntimeAccess", "DataPortBase.h: RuntimeAccess",
                   "DataType.h: RTC::RuntimeAccess", "ExecutionContextBase.h: RuntimeAccess", "RTObject.h: RuntimeAccess"}));
}

TEST_F(PlantedTree, a_type_of_the_runtime_in_a_header_for_authors_is_found) {
  plant("rtm-core/openrtm/include/rtm/a.h", "// like base::Clock\nstd::shared_ptr<rt::Worker> worker_;\nint rest(corba::Orb&);\n");
  plant("rtm-core/openrtm/rtm/a.cpp", "base::Clock clock;\n");
  EXPECT_EQ(internal_names(root_), (Names{"rtm/a.h: corba::Orb", "rtm/a.h: rt::Worker"}));
}

TEST_F(PlantedTree, every_kind_of_offence_is_found) {
  plant("rtm-core/core/a.h", "#pragma once\n#include <omniORB4/CORBA.h>\n#include \"corba/orb/orb.h\"\n#include <vector>\n");
  plant("sim-server/devices/b.cpp", "#include \"shm/segment.h\"\n  #  include <rtm/Manager.h>\n");
  plant("iface-components/c.cpp", "#include <rtm/Manager.h>\n#include \"core/registry.h\"\n");
  plant("clients/video-player/d.cpp", "#include \"shm/segment.h\"\n#include <base/text.h>\n#include <coil/Mutex.h>\n");
  plant("clients/examples/q.cpp", "#include <rtm/Manager.h>\n#include \"component/runtime_access.h\"\n");
  plant("clients/obstacle-avoidance/r.h", "#include \"base/result.h\"\n");
  plant("rtm-core/component/i.h", "#include \"core/lifecycle.h\"\n#include \"manager/manager_impl.h\"\n");
  plant("rtm-core/manager/l.cpp", "#include <rtm/RTObject.h>\n#include \"component/managed.h\"\n#include \"component/component_impl.h\"\n");
  plant("rtm-core/core/j.cpp", "#include <sys/types.h>\n#include \"neighbour.h\"\n#include <poco/any.h>\n#include <Eigen/Core>\n");
  plant("rtm-core/openrtm/include/coil/e.h", "#include <rtm/idl/RTCSkel.h>\n");
  plant("rtm-core/openrtm/include/rtm/k.h", "#include \"component/component_impl.h\"\n#include <rtm/idl/RTCSkel.h>\n");
  plant("sim-server/render/f.cpp", "#include <GL/gl.h>\n#include <ode/ode.h>\n");
  plant("clients/unknown/g.cpp", "\n");
  plant("gateways/player/protocol/h.cpp", "#include \"protocol/xdr.h\"\n#include \"shm/client.h\"\n");
  plant("gateways/player/m.cpp", "#include \"session.h\"\n#include \"system/session.h\"\n#include \"m.h\"\n");
  plant("gateways/player/m.h", "");
  plant("tools/system/n.cpp", "#include \"n.h\"\n#include \"run/run_system.h\"\n");
  plant("tools/system/n.h", "");
  plant("shm/o.cpp", "#include \"world/world_def.h\"\n");
  plant("rtm-core/corba/p.cpp", "#include \"shm/client.h\"\n");
  EXPECT_EQ(offences(root_),
            (Names{
                "clients/examples/q.cpp:2: clients/examples may not include <component/runtime_access.h> of component",
                "clients/obstacle-avoidance/r.h:1: clients/obstacle-avoidance may not include <base/result.h> of base",
                "clients/unknown/g.cpp: is in no layer of the table",
                "clients/video-player/d.cpp:1: clients/video-player may not include <shm/segment.h> of shm",
                "clients/video-player/d.cpp:2: clients/video-player may not include <base/text.h> of base",
                "gateways/player/m.cpp:1: \"session.h\" is no header of gateways/player",
                "gateways/player/m.cpp:2: gateways/player may not include <system/session.h> of system",
                "gateways/player/protocol/h.cpp:2: gateways/player/protocol may not include <shm/client.h> of shm",
                "iface-components/c.cpp:2: iface-components may not include <core/registry.h> of core",
                "rtm-core/component/i.h:2: rtm-core/component may not include <manager/manager_impl.h> of manager",
                "rtm-core/corba/p.cpp:1: rtm-core/corba may not include <shm/client.h> of shm",
                "rtm-core/core/a.h:2: rtm-core/core may not include <omniORB4/CORBA.h> of omniORB",
                "rtm-core/core/a.h:3: rtm-core/core may not include <corba/orb/orb.h> of corba",
                "rtm-core/core/j.cpp:2: \"neighbour.h\" is no header of rtm-core/core",
                "rtm-core/core/j.cpp:3: <poco/any.h> is of no library in the table",
                "rtm-core/core/j.cpp:4: rtm-core/core may not include <Eigen/Core> of Eigen",
                "rtm-core/manager/l.cpp:1: rtm-core/manager may not include <rtm/RTObject.h> of rtm",
                "rtm-core/manager/l.cpp:3: rtm-core/manager may not include <component/component_impl.h> of component",
                "rtm-core/openrtm/include/coil/e.h:1: rtm-core/openrtm/include/coil may not include <rtm/idl/RTCSkel.h> of stubs",
                "rtm-core/openrtm/include/rtm/k.h:1: rtm-core/openrtm/include may not include <component/component_impl.h> of component",
                "shm/o.cpp:1: shm may not include <world/world_def.h> of world",
                "sim-server/devices/b.cpp:2: sim-server may not include <rtm/Manager.h> of rtm",
                "sim-server/render/f.cpp:2: sim-server/render may not include <ode/ode.h> of ODE",
                "tools/system/n.cpp:1: \"n.h\" is no header of tools/system",
                "tools/system/n.cpp:2: tools/system may not include <run/run_system.h> of run",
            }));
}

TEST_F(PlantedTree, a_clean_tree_is_clean) {
  plant("rtm-core/core/a.h", "#include \"base/result.h\"\n#include <string>\n");
  plant("rtm-core/corba/b.cpp", "#include <omniORB4/CORBA.h>\n#include <rtm/idl/RTCSkel.h>\n#include \"core/a.h\"\n");
  plant("tools/rtse/c.cpp", "const char* text = R\"x(\n#include <rtm/Manager.h>\n)x\";\n");
  EXPECT_EQ(offences(root_), Names{});
}

}  // namespace
