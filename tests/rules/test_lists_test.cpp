// A test that no list names never runs, and one that two lists name runs twice: every source of tests is named once.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "support/paths.h"

namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

bool is_list(const fs::path& file) { return file.extension() == ".cmake" || file.filename() == "CMakeLists.txt"; }

// What lies below the folder, without the libraries that npm has installed there.
std::vector<fs::path> files_below(const fs::path& folder) {
  std::vector<fs::path> files;
  for (auto entry = fs::recursive_directory_iterator(folder); entry != fs::recursive_directory_iterator(); ++entry) {
    if (entry->path().filename() == "node_modules") entry.disable_recursion_pending();
    if (entry->is_regular_file()) files.push_back(entry->path());
  }
  return files;
}

// How often the lists name each source, by its path below `tests`.
std::map<std::string, int> named(const fs::path& tests) {
  const std::regex source("[\\w./-]+_test\\.(cpp|py)");
  const std::regex noise("#[^\n]*|\\$\\{CMAKE_CURRENT_SOURCE_DIR\\}/");
  std::map<std::string, int> counts;
  for (const auto& list : files_below(tests)) {
    if (!is_list(list)) continue;
    const auto text = std::regex_replace(text_of(list), noise, "");
    for (auto one = std::sregex_iterator(text.begin(), text.end(), source); one != std::sregex_iterator(); ++one)
      ++counts[fs::relative(list.parent_path() / one->str(), tests).string()];
  }
  return counts;
}

std::set<std::string> sources(const fs::path& tests) {
  std::set<std::string> all;
  for (const auto& file : files_below(tests)) {
    const auto name = file.filename().string();
    if (name.ends_with("_test.cpp") || name.ends_with("_test.py")) all.insert(fs::relative(file, tests).string());
  }
  return all;
}

TEST(TestLists, name_each_test_once) {
  const fs::path tests = fs::path(paths::source_dir) / "tests";
  auto counts = named(tests);
  const auto files = sources(tests);
  EXPECT_GT(files.size(), 100U);
  for (const auto& file : files) EXPECT_EQ(counts[file], 1) << file;
  for (const auto& [name, count] : counts) EXPECT_TRUE(files.contains(name)) << name << ": is not there";
}

}  // namespace
