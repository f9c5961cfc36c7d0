// What the headers of component authors bring along. Sources count on headers that they do not include themselves, because those that they
// do include bring them in other implementations: so each of ours brings the same, and nothing of the inside.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "support/paths.h"

namespace include_closure {
namespace {

namespace fs = std::filesystem;
using Names = std::set<std::string>;

const fs::path root = fs::path(paths::source_dir) / "rtm-core/openrtm/include";

// The headers that one header includes, directly.
Names includes_of(const std::string& header) {
  static const std::regex line_of(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"].*)");
  Names names;
  std::ifstream in(root / header);
  std::smatch match;
  for (std::string line; std::getline(in, line);)
    if (std::regex_match(line, match, line_of)) names.insert(match[1]);
  return names;
}

Names closure_of(const std::string& header) {
  Names all;
  std::vector<std::string> waiting{header};
  while (!waiting.empty()) {
    const std::string next = waiting.back();
    waiting.pop_back();
    for (const std::string& name : includes_of(next))
      if (all.insert(name).second) waiting.push_back(name);
  }
  return all;
}

Names public_headers() {
  Names names;
  for (const auto& entry : fs::recursive_directory_iterator(root))
    if (entry.path().extension() == ".h") names.insert(fs::relative(entry.path(), root).generic_string());
  return names;
}

// Header, and what a source that includes it and nothing else has.
const std::map<std::string, Names> brought = {
    {"rtm/RTC.h", {"rtm/idl/RTCSkel.h", "iostream", "sstream", "fstream", "iomanip", "algorithm", "map", "set", "string", "vector"}},
    {"rtm/Manager.h",
     {"rtm/RTC.h", "rtm/SystemLogger.h", "coil/Guard.h", "coil/Mutex.h", "coil/Properties.h", "coil/stringutil.h", "coil/Task.h",
      "coil/Timer.h", "coil/Signal.h", "thread", "chrono"}},
    {"rtm/RTObject.h",
     {"rtm/RTC.h", "rtm/idl/OpenRTMSkel.h", "rtm/CORBA_SeqUtil.h", "rtm/NVUtil.h", "rtm/ConfigAdmin.h", "rtm/SystemLogger.h",
      "rtm/PortConnectListener.h", "rtm/ComponentActionListener.h", "rtm/ExecutionContextBase.h", "coil/Properties.h"}},
    {"rtm/DataFlowComponentBase.h",
     {"rtm/RTObject.h", "rtm/PeriodicExecutionContext.h", "rtm/Manager.h", "rtm/PortBase.h", "rtm/idl/RTCSkel.h", "thread", "chrono",
      "iostream"}},
    {"rtm/DataInPort.h",
     {"rtm/InPort.h", "rtm/InPortBase.h", "rtm/PortBase.h", "rtm/PortCallback.h", "rtm/Typename.h", "rtm/Timestamp.h", "coil/OS.h",
      "coil/TimeMeasure.h"}},
    {"rtm/DataOutPort.h",
     {"rtm/OutPort.h", "rtm/OutPortBase.h", "rtm/PortBase.h", "rtm/PortCallback.h", "rtm/Typename.h", "rtm/Timestamp.h", "coil/OS.h",
      "coil/TimeMeasure.h"}},
    {"rtm/PortBase.h",
     {"rtm/RTC.h", "rtm/idl/RTCSkel.h", "rtm/CORBA_SeqUtil.h", "rtm/NVUtil.h", "rtm/SystemLogger.h", "rtm/PortConnectListener.h",
      "coil/Guard.h", "coil/Mutex.h", "string", "vector", "iostream"}},
    {"rtm/CorbaPort.h", {"rtm/PortBase.h", "rtm/CorbaConsumer.h", "rtm/NVUtil.h", "list"}},
    {"rtm/CORBA_SeqUtil.h", {"rtm/Manager.h", "thread", "chrono"}},
    {"rtm/CORBA_RTCUtil.h", {"rtm/RTC.h", "rtm/NVUtil.h", "coil/Properties.h"}},
    {"rtm/SdoServiceConsumerBase.h", {"rtm/RTObject.h", "rtm/NVUtil.h", "coil/Factory.h", "coil/Timer.h", "rtm/idl/SDOPackageSkel.h"}},
    {"rtm/InPortProvider.h",
     {"rtm/NVUtil.h", "rtm/BufferBase.h", "rtm/DataPortStatus.h", "rtm/InPortConnector.h", "rtm/SystemLogger.h", "rtm/ConnectorListener.h",
      "coil/Factory.h", "string"}},
    {"rtm/OutPortProvider.h",
     {"rtm/NVUtil.h", "rtm/BufferBase.h", "rtm/DataPortStatus.h", "rtm/OutPortConnector.h", "rtm/SystemLogger.h", "rtm/ConnectorListener.h",
      "coil/Factory.h", "string"}},
    {"rtm/NamingManager.h",
     {"rtm/RTC.h", "rtm/CorbaNaming.h", "rtm/RTObject.h", "rtm/SystemLogger.h", "rtm/ManagerServant.h", "coil/Task.h", "coil/Mutex.h",
      "coil/Guard.h", "string", "vector"}},
    {"rtm/Macho.h", {"rtm/StaticFSM.h"}},
};

TEST(IncludeClosure, every_header_brings_what_sources_count_on) {
  for (const auto& [header, wanted] : brought) {
    ASSERT_TRUE(fs::exists(root / header)) << header;
    const Names all = closure_of(header);
    for (const std::string& name : wanted) EXPECT_TRUE(all.count(name)) << header << " does not bring " << name;
  }
}

TEST(IncludeClosure, no_header_brings_itself) {
  for (const std::string& header : public_headers()) EXPECT_FALSE(closure_of(header).count(header)) << header;
}

// Else it is not installed with them.
TEST(IncludeClosure, every_header_of_ours_that_is_included_is_one_of_authors_or_made_from_idl) {
  for (const std::string& header : public_headers()) {
    for (const std::string& name : includes_of(header)) {
      const bool is_ours = name.starts_with("rtm/") || name.starts_with("coil/");
      if (is_ours && !name.starts_with("rtm/idl/") && !name.starts_with("rtm/ext/")) {
        EXPECT_TRUE(fs::exists(root / name)) << header << " includes " << name;
      }
      for (const char* inside : {"base/", "core/", "corba/", "component/", "manager/", "openrtm/"})
        EXPECT_FALSE(name.starts_with(inside)) << header << " includes " << name;
    }
  }
}

}  // namespace
}  // namespace include_closure
