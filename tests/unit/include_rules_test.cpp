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

namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

// One layer: a folder, and the parts of the project whose headers it may include. "stubs" are the headers made from idl/.
struct Layer {
  std::string folder;
  Names may_include;
};

const std::vector<Layer> layers = {
    {"rtm-core/base", {"base"}},
    {"rtm-core/core", {"core", "base"}},
    {"rtm-core/corba", {"corba", "core", "base", "stubs", "omniORB"}},
    {"rtm-core/openrtm/coil", {"coil"}},
    {"rtm-core/openrtm", {"rtm", "coil", "corba", "core", "base", "stubs", "omniORB"}},
    {"rtm-core/rtcd", {"rtm", "coil", "corba", "core", "base", "stubs"}},
    {"sim-server/shm", {"shm", "base"}},
    {"sim-server/world", {"world", "base", "SDFormat"}},
    {"sim-server/physics", {"physics", "world", "base", "ODE"}},
    {"sim-server/rays", {"rays", "world", "base", "Embree"}},
    {"sim-server/render", {"render", "world", "base", "OpenGL"}},
    {"sim-server", {"devices", "server", "simctl", "shm", "world", "physics", "rays", "render", "base"}},
    {"iface-components", {"rtm", "coil", "shm", "base", "stubs"}},
    {"clients/examples", {"rtm", "coil", "base", "stubs"}},
    {"clients/obstacle-avoidance", {"rtm", "coil", "base", "stubs"}},
    {"clients/video-player", {"rtm", "coil", "base", "stubs"}},
    {"clients/system-editor", {"corba", "base", "stubs", "omniORB"}},
    {"clients/player-gateway/protocol", {"protocol", "base"}},
    {"clients/player-gateway", {"protocol", "shm", "base"}},
    {"clients/follow", {"protocol", "base"}},
};

// Whose header this is: a part of the project, a library that belongs to one layer, or "" for everything that anybody may include.
std::string owner(const std::string& header) {
  static const std::vector<std::pair<std::string, std::string>> prefixes = {
      {"rtm/idl/", "stubs"},     {"rtm/ext/", "stubs"},     {"base/", "base"},       {"core/", "core"},     {"corba/", "corba"},
      {"rtm/", "rtm"},           {"coil/", "coil"},         {"shm/", "shm"},         {"world/", "world"},   {"physics/", "physics"},
      {"rays/", "rays"},         {"render/", "render"},     {"devices/", "devices"}, {"server/", "server"}, {"simctl/", "simctl"},
      {"omniORB4/", "omniORB"},  {"omnithread", "omniORB"}, {"COS/", "omniORB"},     {"ode/", "ODE"},       {"embree", "Embree"},
      {"protocol/", "protocol"}, {"sdf/", "SDFormat"},      {"GL/", "OpenGL"},       {"GLES", "OpenGL"},    {"KHR/", "OpenGL"},
  };
  for (const auto& [prefix, name] : prefixes) {
    if (header.starts_with(prefix)) return name;
  }
  return "";
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
  static const std::regex include_line(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"].*)");
  Names found;
  for (const char* top : {"rtm-core", "sim-server", "iface-components", "clients"}) {
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
        const std::string part = owner(match[1]);
        if (part.empty() || std::count(layer->may_include.begin(), layer->may_include.end(), part) != 0) continue;
        found.push_back(file + ":" + std::to_string(number) + ": " + layer->folder + " may not include <" + match[1].str() + "> of " +
                        part);
      }
    }
  }
  std::sort(found.begin(), found.end());
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

TEST(IncludeRules, hold_in_the_whole_project) { EXPECT_EQ(offences(RTMSIM_SOURCE_DIR), Names{}); }

TEST_F(PlantedTree, every_kind_of_offence_is_found) {
  plant("rtm-core/core/a.h", "#pragma once\n#include <omniORB4/CORBA.h>\n#include \"corba/orb.h\"\n#include <vector>\n");
  plant("sim-server/devices/b.cpp", "#include \"shm/segment.h\"\n  #  include <rtm/Manager.h>\n");
  plant("iface-components/c.cpp", "#include <rtm/Manager.h>\n#include \"core/registry.h\"\n");
  plant("clients/video-player/d.cpp", "#include \"shm/segment.h\"\n");
  plant("rtm-core/openrtm/coil/e.h", "#include <rtm/idl/RTCSkel.h>\n");
  plant("sim-server/render/f.cpp", "#include <GL/gl.h>\n#include <ode/ode.h>\n");
  plant("clients/unknown/g.cpp", "\n");
  plant("clients/player-gateway/protocol/h.cpp", "#include \"protocol/xdr.h\"\n#include \"shm/client.h\"\n");
  EXPECT_EQ(offences(root_),
            (Names{
                "clients/player-gateway/protocol/h.cpp:2: clients/player-gateway/protocol may not include <shm/client.h> of shm",
                "clients/unknown/g.cpp: is in no layer of the table",
                "clients/video-player/d.cpp:1: clients/video-player may not include <shm/segment.h> of shm",
                "iface-components/c.cpp:2: iface-components may not include <core/registry.h> of core",
                "rtm-core/core/a.h:2: rtm-core/core may not include <omniORB4/CORBA.h> of omniORB",
                "rtm-core/core/a.h:3: rtm-core/core may not include <corba/orb.h> of corba",
                "rtm-core/openrtm/coil/e.h:1: rtm-core/openrtm/coil may not include <rtm/idl/RTCSkel.h> of stubs",
                "sim-server/devices/b.cpp:2: sim-server may not include <rtm/Manager.h> of rtm",
                "sim-server/render/f.cpp:2: sim-server/render may not include <ode/ode.h> of ODE",
            }));
}

TEST_F(PlantedTree, a_clean_tree_is_clean) {
  plant("rtm-core/core/a.h", "#include \"base/result.h\"\n#include <string>\n");
  plant("rtm-core/corba/b.cpp", "#include <omniORB4/CORBA.h>\n#include <rtm/idl/RTCSkel.h>\n#include \"core/a.h\"\n");
  plant("clients/system-editor/c.cpp", "const char* text = R\"x(\n#include <rtm/Manager.h>\n)x\";\n");
  EXPECT_EQ(offences(root_), Names{});
}

}  // namespace
