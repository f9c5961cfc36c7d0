// No source is longer than 500 lines: reads every source of the project as text.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include "support/paths.h"

namespace {

namespace fs = std::filesystem;

constexpr std::ptrdiff_t max_lines = 500;
// Tables, which may be longer.
const std::set<std::string> tables = {"ros/messages.h", "shm/iface_types.h", "shm/rtmsim_layout.h"};
const std::set<std::string> folders = {"arms",       "base",   "clients", "gateways", "idl",     "iface-components",
                                       "packaging",  "python", "ros",     "rtm-core", "scripts", "shm",
                                       "sim-server", "tests",  "tools",   "worlds"};
const std::set<std::string> endings = {".cpp", ".h", ".idl", ".py", ".sh", ".ts"};

std::ptrdiff_t lines_of(const fs::path& source) {
  std::ifstream in(source, std::ios::binary);
  return std::count(std::istreambuf_iterator<char>(in), {}, '\n');
}

TEST(Lengths, of_sources_are_at_most_500_lines) {
  const fs::path root = paths::source_dir;
  std::set<std::string> long_tables;
  int sources = 0;
  for (const auto& folder : folders) {
    ASSERT_TRUE(fs::is_directory(root / folder)) << folder;
    for (auto entry = fs::recursive_directory_iterator(root / folder); entry != fs::recursive_directory_iterator(); ++entry) {
      if (entry->path().filename() == "node_modules") entry.disable_recursion_pending();
      if (!entry->is_regular_file() || !endings.contains(entry->path().extension())) continue;
      ++sources;
      const auto lines = lines_of(entry->path());
      const auto name = entry->path().lexically_relative(root).generic_string();
      if (!tables.contains(name)) {
        EXPECT_LE(lines, max_lines) << name;
      } else if (lines > max_lines) {
        long_tables.insert(name);
      }
    }
  }
  EXPECT_GT(sources, 1000);
  EXPECT_EQ(long_tables, tables) << "a table that is short needs no exception";
}

}  // namespace
