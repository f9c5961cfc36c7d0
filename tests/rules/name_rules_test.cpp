// A cold build compiles several sources of a library or of a test program as one, and a source more moves the borders between such batches:
// what stands in the unnamed namespaces of such sources must not have the same name twice. Reads every source of the project as text.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "support/paths.h"

namespace {

namespace fs = std::filesystem;
using Lines = std::vector<std::string>;

// The folder of the library: the next one upwards that has a list of sources.
fs::path library_of(const fs::path& source, const fs::path& root) {
  fs::path folder = source.parent_path();
  while (folder != root && !fs::exists(folder / "CMakeLists.txt")) folder = folder.parent_path();
  return folder;
}

// The test program of each source of tests, by its path below `tests`.
std::map<std::string, std::string> test_programs(const fs::path& tests) {
  static const std::regex program(R"(rtmsim_test\(([^)]*)\))");
  std::map<std::string, std::string> programs;
  if (!fs::exists(tests)) return programs;
  for (const auto& list : fs::directory_iterator(tests)) {
    if (list.path().extension() != ".cmake" && list.path().filename() != "CMakeLists.txt") continue;
    std::stringstream text;
    text << std::ifstream(list.path()).rdbuf();
    const std::string all = text.str();
    for (auto one = std::sregex_iterator(all.begin(), all.end(), program); one != std::sregex_iterator(); ++one) {
      std::stringstream words((*one)[1]);
      std::string name, source;
      for (words >> name; words >> source && source != "LIBRARIES";) programs[source] = name;
    }
  }
  return programs;
}

// What a line at the margin of an unnamed namespace declares, as "name" or "function(its first parameters"; empty: nothing.
std::string declared(const std::string& line) {
  static const std::regex type(R"(^(?:struct|class|enum|enum class) (\w+)\b(?!.*;$).*)");
  static const std::regex alias(R"(^using (\w+ = .*);$)");
  static const std::regex value(R"(^(?:[\w:<>,*& ]+) (\w+)(?: = .*|\{.*|;|\[.*))");
  static const std::regex function(R"(^(?!using |template|return )[\w:<>,*& ]+[ &*](\w+\(.*))");
  if (line.empty() || std::isalpha(static_cast<unsigned char>(line.front())) == 0) return {};
  std::smatch match;
  if (std::regex_match(line, match, type) || std::regex_match(line, match, alias)) return match[1];
  if (line.starts_with("using ") || line.starts_with("namespace ") || line.starts_with("template")) return {};
  if (std::regex_match(line, match, value) || std::regex_match(line, match, function)) return match[1];
  return {};
}

using Places = std::map<std::string, std::map<std::string, Lines>>;  // by library, namespace and name, then by file: what follows the name

void collect(const fs::path& source, const std::string& library, const std::string& file, Places& places) {
  static const std::regex opening(R"(^(?:inline )?namespace ?([\w:]*) ?\{)");
  Lines scopes;
  std::ifstream in(source);
  for (std::string line; std::getline(in, line);) {
    std::smatch match;
    if (std::regex_search(line, match, opening)) {
      scopes.push_back(match[1]);
    } else if (line.starts_with("}  // namespace")) {
      if (!scopes.empty()) scopes.pop_back();
    } else if (!scopes.empty() && scopes.back().empty()) {
      std::string scope;
      for (const auto& one : scopes) scope += one + "::";
      const auto name = declared(line);
      const auto alias = name.find(" = ");
      if (!name.empty()) places[library + " " + scope + name.substr(0, alias)][file].push_back(name.substr(std::min(alias, name.size())));
    }
  }
}

// "library namespace::name: files", for each name that two sources of a library or of a test program have. Aliases of one type are allowed.
Lines names_of_two(const fs::path& root) {
  Places places;
  for (const char* top :
       {"base", "shm", "ros", "arms", "rtm-core", "sim-server", "iface-components", "gateways", "tools", "clients", "python"}) {
    if (!fs::exists(root / top)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(root / top)) {
      if (!entry.is_regular_file() || entry.path().extension() != ".cpp") continue;
      const fs::path library = library_of(entry.path(), root);
      collect(entry.path(), fs::relative(library, root).generic_string(), fs::relative(entry.path(), root).generic_string(), places);
    }
  }
  for (const auto& [source, program] : test_programs(root / "tests")) collect(root / "tests" / source, program, "tests/" + source, places);
  Lines found;
  for (const auto& [name, files] : places) {
    std::set<std::string> meanings;
    std::string text = name + ":";
    for (const auto& [file, rest] : files) {
      meanings.insert(rest.front());
      text += " " + file;
    }
    const bool is_one_alias = meanings.size() == 1 && !meanings.begin()->empty();
    if (files.size() > 1 && !is_one_alias) found.push_back(text);
  }
  return found;
}

TEST(NameRules, sources_of_a_library_or_test_program_have_no_unnamed_thing_of_one_name) {
  for (const auto& found : names_of_two(paths::source_dir)) ADD_FAILURE() << found << ": expected another name, or one place for both";
}

TEST(NameRules, every_kind_of_a_double_is_found) {
  const fs::path root = fs::path(testing::TempDir()) / ("name_rules_" + std::to_string(getpid()));
  fs::create_directories(root / "clients" / "a");
  std::ofstream(root / "clients" / "a" / "CMakeLists.txt") << "\n";
  constexpr std::string_view both =
      "namespace one {\nnamespace {\nconstexpr int limit = 3;\nstruct Row {\n  int limit;\n};\nvoid act(int a) {\n}\nusing Same = int;\n";
  std::ofstream(root / "clients" / "a" / "x.cpp")
      << both << "using Other = int;\nvoid two(int a) {\n}\n}  // namespace\n}  // namespace one\n";
  std::ofstream(root / "clients" / "a" / "y.cpp") << both << "using Other = char;\nvoid two(char a) {\n}\n}  // namespace\nint free = 1;\n";
  std::ofstream(root / "clients" / "a" / "z.cpp") << "namespace two {\nnamespace {\nint limit = 3;\n}  // namespace\nint free = 1;\n";
  fs::create_directories(root / "tests");
  std::ofstream(root / "tests" / "a.cmake")
      << "rtmsim_test(a_test\n  b_test.cpp c_test.cpp LIBRARIES base)\nrtmsim_test(d_test d_test.cpp LIBRARIES base)\n";
  for (const char* name : {"b_test.cpp", "c_test.cpp", "d_test.cpp"})
    std::ofstream(root / "tests" / name) << "namespace {\nint count = 1;\n}  // namespace\n";
  const auto found = names_of_two(root);
  fs::remove_all(root);
  ASSERT_EQ(found.size(), 5u) << testing::PrintToString(found);
  EXPECT_EQ(found[0], "a_test ::count: tests/b_test.cpp tests/c_test.cpp");
  EXPECT_TRUE(found[1].starts_with("clients/a one::::Other:")) << found[1];
  EXPECT_TRUE(found[2].starts_with("clients/a one::::Row:")) << found[2];
  EXPECT_TRUE(found[3].starts_with("clients/a one::::act(int a) {:")) << found[3];
  EXPECT_TRUE(found[4].starts_with("clients/a one::::limit:")) << found[4];
}

}  // namespace
