// Results of many rows: what is stored, read and drawn of them. RTMSIM_ROWS=100000 makes a large campaign of it.
#include "campaign/results/store.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "base/text.h"
#include "campaign/results/report.h"
#include "campaign/slurm/outcome_line.h"
#include "campaign/slurm/task_folder.h"

namespace campaign {
namespace {

namespace fs = std::filesystem;

std::size_t row_count() {
  constexpr std::int64_t few = 2000;
  const char* text = std::getenv("RTMSIM_ROWS");
  return static_cast<std::size_t>(text != nullptr ? base::parse_integer(text).value_or(few) : few);
}

// Memory that this process has had at most [MB].
double peak_memory() {
  std::ifstream in("/proc/self/status");
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("VmHWM:")) return std::atof(line.c_str() + 6) / 1024;
  }
  return 0;
}

class Stores : public testing::Test {
 protected:
  Stores() : folder_(fs::path(testing::TempDir()) / ("store_" + std::to_string(getpid()))) { fs::create_directories(folder_); }
  ~Stores() override { fs::remove_all(folder_); }
  std::string file(const std::string& name) const { return (folder_ / name).string(); }

  static Row row(std::size_t number) {
    return {
        number,
        number % 10 + 1,
        {{"component/A0/gain", std::to_string(number % 7)}, {"model/robot/pose/x", base::format_number(static_cast<double>(number) / 8)}}};
  }
  static std::string key(std::size_t number) { return "key-" + std::to_string(number) + "-of-thirty-two-digits"; }
  static Outcome outcome(std::size_t number) {
    Outcome made;
    made.state_hash = std::to_string(number * 7919);
    made.simulated_s = 60;
    made.wall_s = 1.5;
    made.verdicts = {{"no component ends in an error", "", ""},
                     {"path_length: {model: robot, min: 2}", number % 5 == 0 ? "it was 1.5 m" : "", ""}};
    made.measures = {{"clearance", static_cast<double>(number) / 7}, {"speed", 0.1}};
    return made;
  }

  fs::path folder_;
};

TEST_F(Stores, hold_many_rows_and_show_them_in_a_page_of_bounded_size) {
  const auto count = row_count();
  {
    auto store = Store::open(file("rows.db"));
    ASSERT_TRUE(store) << store.error().message;
    ASSERT_TRUE(store->begin_rows(Plan{}, ""));
    for (std::size_t number = 1; number <= count; ++number) ASSERT_TRUE(store->add_row(row(number), key(number)));
    ASSERT_TRUE(store->end_rows());
    for (std::size_t number = 1; number <= count; ++number) ASSERT_TRUE(store->add_run(key(number), outcome(number), ""));
  }
  const auto before = peak_memory();
  const auto results = read_results(file("rows.db"));
  ASSERT_TRUE(results) << results.error().message;
  EXPECT_EQ(results->run_count(), count);
  EXPECT_EQ(results->passed_count(), count - count / 5);
  std::ostringstream text;
  print_tables(text, *results, {"component/A0/gain", "model/robot/pose/x"});
  EXPECT_NE(text.str().find("path_length"), std::string::npos);
  EXPECT_LT(text.str().size(), 10'000U);
  ASSERT_TRUE(write_html(*results, file("page.html"), file("rows.runs")));
  EXPECT_LT(fs::file_size(file("page.html")), 4U << 20U);
  std::printf("%zu rows: %ju octets in the file, %ju in the page, %.0f MB to read and show, %.0f MB in all\n", count,
              static_cast<std::uintmax_t>(fs::file_size(file("rows.db"))), static_cast<std::uintmax_t>(fs::file_size(file("page.html"))),
              peak_memory() - before, peak_memory());
  EXPECT_LT(peak_memory() - before, 64 + static_cast<double>(count) * 4e-3);  // 4 kB a row
}

TEST_F(Stores, get_outcomes_of_other_machines_as_they_were) {
  auto told = outcome(3);
  told.problem = "host of \"A\" was killed\n\xff";
  told.measures["tiny"] = 1.0 / 3e200;
  const auto line = to_line({"key", told, "kept/row-3"});
  EXPECT_EQ(line.find('\n'), line.size() - 1);
  const auto back = from_line(line);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->outcome.measures, told.measures);
  EXPECT_EQ(back->outcome.state_hash, told.state_hash);
  EXPECT_EQ(back->outcome.verdicts.size(), told.verdicts.size());
  EXPECT_EQ(to_line(*back), line);
  for (std::size_t size = 0; size + 1 < line.size(); size += 7) EXPECT_FALSE(from_line(line.substr(0, size)));
  EXPECT_FALSE(from_line("[1, 2]"));
  EXPECT_FALSE(from_line("{\"key\": 3}"));
}

TEST_F(Stores, gather_only_whole_lines_of_tasks_each_once) {
  TaskFolder folder(file("shared"));
  ASSERT_TRUE(folder.open("base"));
  ASSERT_TRUE(folder.begin_attempt({{1, 2, 3, 7}, {9}}, "#!/bin/sh\n"));
  EXPECT_EQ(*folder.rows_of(1, 0), (RowNumbers{1, 2, 3, 7}));
  EXPECT_EQ(*folder.rows_of(1, 1), (RowNumbers{9}));
  EXPECT_FALSE(folder.rows_of(1, 2));
  EXPECT_TRUE(folder.news().empty());
  const auto line = to_line({"one", outcome(1), ""}), next = to_line({"two", outcome(2), ""});
  std::ofstream part(folder.part(1, 0), std::ios::app);
  part << line << next.substr(0, 20) << std::flush;
  EXPECT_EQ(folder.news().size(), 1U);
  EXPECT_TRUE(folder.news().empty());
  part << next.substr(20) << std::flush;
  const auto news = folder.news();
  ASSERT_EQ(news.size(), 1U);
  EXPECT_EQ(news[0].key, "two");
  // Who comes later reads everything; tasks of another sweep refuse.
  TaskFolder later(file("shared"));
  ASSERT_TRUE(later.open("base"));
  EXPECT_EQ(later.news().size(), 2U);
  EXPECT_EQ(later.name(), folder.name());
  EXPECT_EQ(later.attempts(), 1);
  EXPECT_FALSE(later.check_key("other"));
  ASSERT_TRUE(later.open("other"));
  EXPECT_TRUE(later.is_other());
}

}  // namespace
}  // namespace campaign
