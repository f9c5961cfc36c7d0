// The list of files in docs/develop/new-player-interface.md: each is there, and no other file names an interface that is served. A toy
// device made of what the page names alone is listed and served like the others.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "device_kinds.h"
#include "support/paths.h"

namespace gateway {
namespace {

namespace fs = std::filesystem;
const fs::path source = paths::source_dir;

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::set<std::string> listed_files() {
  const std::string page = text_of(source / "docs/develop/new-player-interface.md");
  const std::regex file("`((?:gateways|clients|tests|docs)/[A-Za-z0-9_/.-]+)`");
  std::set<std::string> files;
  for (auto one = std::sregex_iterator(page.begin(), page.end(), file); one != std::sregex_iterator(); ++one) files.insert((*one)[1]);
  return files;
}

TEST(NewPlayerInterface, the_files_of_the_page_exist) {
  const auto files = listed_files();
  EXPECT_GE(files.size(), 10U);
  for (const auto& file : files) {
    const bool is_example = file.find("power_device") != std::string::npos;
    EXPECT_TRUE(is_example || fs::exists(source / file)) << file;
  }
}

// The last one that was added stands for the next.
TEST(NewPlayerInterface, what_one_interface_needs_stands_in_the_files_of_the_page) {
  const auto files = listed_files();
  const std::regex name("\\b(aio|Interface::aio|Analog|analog_device|encode_voltages)\\b");
  std::set<std::string> unlisted;
  for (const auto* folder : {"gateways/player", "tests", "docs"}) {
    for (const auto& entry : fs::recursive_directory_iterator(source / folder)) {
      const auto extension = entry.path().extension();
      if (extension != ".h" && extension != ".cpp" && extension != ".py" && extension != ".txt" && extension != ".md") continue;
      const auto file = fs::relative(entry.path(), source).string();
      const bool is_its_own = file.find("analog_device") != std::string::npos || file.find("new_player_interface") != std::string::npos;
      if (!is_its_own && !files.contains(file) && std::regex_search(text_of(entry.path()), name)) unlisted.insert(file);
    }
  }
  // How devices are numbered is tested with all of them.
  unlisted.erase("tests/player/player_gateway_test.cpp");
  EXPECT_EQ(unlisted, std::set<std::string>());
}

class Toy final : public Device {
 public:
  using Device::Device;
  static constexpr std::array shows{shm::IfaceType::truth};
  static constexpr std::array table = std::to_array<Served>({{player::Type::data, 1, "a toy"}, {player::Type::request, 3, "a question"}});

 private:
  ServedTable served() const override { return table; }
  std::optional<Answer> answer(std::uint8_t, const std::string&, const Later&) override { return ack(); }
};

TEST(NewPlayerInterface, a_class_with_a_table_is_a_device) {
  const DeviceKind kind{player::Interface::aio, Toy::shows, Toy::table, nullptr};
  EXPECT_EQ(describe(kind.served, player::Type::data), "a toy");
  EXPECT_EQ(describe(kind.served, player::Type::request), "a question");
  EXPECT_TRUE(is_served(kind.served, 3, 3));
  EXPECT_FALSE(is_served(kind.served, 3, 1));
}

}  // namespace
}  // namespace gateway
