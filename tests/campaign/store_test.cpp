// Results of many rows: what is stored, read and drawn of them. RTMSIM_ROWS=100000 makes a large campaign of it.
#include "campaign/results/store.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
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
    made.run.state_hash = std::to_string(number * 7919);
    made.run.simulated_s = 60;
    made.run.wall_s = 1.5;
    made.run.verdicts = {{"no component ends in an error", "", ""},
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

// A file as somebody with bad intentions would make it: that of a campaign, and then more.
class HostileResults : public Stores {
 protected:
  std::string make(const std::string& name, const std::string& sql) const {
    auto store = Store::open(file(name));
    EXPECT_TRUE(store && store->begin_rows(Plan{}, "") && store->add_row(row(1), key(1)) && store->end_rows());
    EXPECT_TRUE(store && store->add_run(key(1), outcome(5), ""));
    auto database = Database::open(file(name), Database::Access::write);
    const auto done = database ? database->execute(sql) : Result<void>(database.error());
    EXPECT_TRUE(done) << sql << ": " << (done ? "" : done.error().message);
    return file(name);
  }
  static std::string problem_of(const std::string& file, std::chrono::milliseconds time = std::chrono::minutes(2)) {
    const auto results = read_results(file, {time});
    return results ? "" : results.error().message;
  }
  static bool says(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }
};

TEST_F(HostileResults, nothing_in_the_file_is_executed) {
  const std::string endless = "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT i, 'k', 1 FROM n";
  EXPECT_EQ(problem_of(make("good.db", "")), "");
  EXPECT_TRUE(says(problem_of(make("view.db", "DROP TABLE rows; CREATE VIEW rows(number, key, seed) AS " + endless)), "have the view"));
  EXPECT_TRUE(
      says(problem_of(make("trigger.db", "CREATE TRIGGER t AFTER INSERT ON runs BEGIN DELETE FROM rows; END")), "have the trigger"));
  EXPECT_TRUE(says(problem_of(make("virtual.db", "CREATE VIRTUAL TABLE more USING fts5(text)")), "have the table \"more\""));
  EXPECT_TRUE(says(problem_of(make("computed.db", "ALTER TABLE audits ADD COLUMN more AS (hex(zeroblob(100000000)))")),
                   "have the computed column"));
}

TEST_F(HostileResults, reading_ends_in_time_whatever_is_in_the_file) {
  const auto many =
      make("join.db",
           "DROP TABLE verdicts; CREATE TABLE verdicts (key, place, expectation, problem, details);"
           "DROP INDEX rows_by_key; DELETE FROM rows;"
           "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 30000) INSERT INTO rows SELECT i, 'k', 1 FROM n;"
           "INSERT INTO verdicts SELECT 'k', number, 'e' || number, 'p', '' FROM rows");
  EXPECT_TRUE(says(problem_of(many, std::chrono::milliseconds(200)), "take too long to read"))
      << problem_of(many, std::chrono::milliseconds(200));
}

TEST_F(HostileResults, more_than_a_campaign_holds_is_refused) {
  const auto names = make("names.db",
                          "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 2000)"
                          "INSERT INTO parameters SELECT 1, 'p' || i, '1' FROM n");
  EXPECT_TRUE(says(problem_of(names), "more than 1000 parameters")) << problem_of(names);
  const auto copies =
      make("copies.db",
           "DELETE FROM rows; DROP TABLE runs; CREATE TABLE runs (key, passed, problem, state, folder, simulated, wall, logs, ended);"
           "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 3000) INSERT INTO rows SELECT i, 'k', 1 FROM n;"
           "INSERT INTO runs VALUES ('k', 0, hex(zeroblob(1000000)), '', '', 1, 1, '', '')");
  EXPECT_TRUE(says(problem_of(copies), "more than 1 GiB of text")) << problem_of(copies);
  EXPECT_NE(problem_of(make("long.db", "UPDATE runs SET problem = hex(zeroblob(40000000))")), "");
}

TEST_F(HostileResults, only_regular_files_are_opened) {
  EXPECT_TRUE(says(problem_of("/dev/zero"), "is not a regular file"));
  ASSERT_EQ(::mkfifo(file("pipe.db").c_str(), 0600), 0);
  EXPECT_TRUE(says(problem_of(file("pipe.db")), "is not a regular file"));
  for (const char* log : {"-wal", "-shm", "-journal"}) {
    const auto name = make(std::string("log") + log + ".db", "");
    fs::create_symlink("/dev/zero", name + log);
    EXPECT_TRUE(says(problem_of(name), "is not a regular file")) << problem_of(name);
  }
  const auto good = make("good.db", "");
  fs::create_symlink(good, file("link.db"));
  EXPECT_EQ(problem_of(file("link.db")), "") << "the user names it";
}

// The head of a journal names another file, which SQLite would delete when it may write.
TEST_F(HostileResults, nothing_is_written_or_deleted_by_reading) {
  const auto name = make("good.db", "");
  std::ofstream(name + "-journal", std::ios::binary) << std::string("\xd9\xd5\x05\xf9\x20\xa1\x63\xd7", 8) << std::string(600, '\1');
  const auto size = fs::file_size(name);
  static_cast<void>(problem_of(name));
  EXPECT_TRUE(fs::exists(name + "-journal"));
  EXPECT_EQ(fs::file_size(name), size);
  fs::remove(name + "-journal");
  EXPECT_EQ(problem_of(name), "");
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(name).parent_path())) files += entry.path().string().starts_with(name) ? 1 : 0;
  EXPECT_EQ(files, 1U) << "nothing beside it";
}

TEST_F(HostileResults, pictures_come_from_the_kept_files_alone) {
  const std::string png = "\x89PNG\r\n\x1a\n";
  const auto page_of = [&](const std::string& folder) {
    const auto name = make("pictures.db", "UPDATE runs SET folder = '" + folder + "'");
    const auto results = read_results(name);
    EXPECT_TRUE(results && write_html(*results, file("page.html"), file("pictures.runs")));
    std::ifstream in(file("page.html"));
    const std::string page((std::istreambuf_iterator<char>(in)), {});
    fs::remove(name);
    return says(page, "data:image/png;base64,");
  };
  fs::create_directories(file("pictures.runs/row-1"));
  std::ofstream(file("pictures.runs/row-1/picture.png"), std::ios::binary) << png << "kept";
  EXPECT_TRUE(page_of("/elsewhere/pictures.runs/row-1"));
  fs::create_directories(file("private"));
  std::ofstream(file("private/picture.png"), std::ios::binary) << png << "private";
  EXPECT_FALSE(page_of(file("private")));
  EXPECT_FALSE(page_of("../private"));
  EXPECT_FALSE(page_of(".."));
  fs::create_directory_symlink(file("private"), file("pictures.runs/row-2"));
  EXPECT_FALSE(page_of("row-2"));
  for (const char* row : {"row-3", "row-4", "row-5", "row-6"}) fs::create_directories(file(std::string("pictures.runs/") + row));
  fs::create_symlink("/dev/zero", file("pictures.runs/row-3/picture.png"));
  EXPECT_FALSE(page_of("row-3"));
  ASSERT_EQ(::mkfifo(file("pictures.runs/row-4/picture.png").c_str(), 0600), 0);
  EXPECT_FALSE(page_of("row-4"));
  std::ofstream(file("pictures.runs/row-5/picture.png")) << "no picture";
  EXPECT_FALSE(page_of("row-5"));
  std::ofstream(file("pictures.runs/row-6/picture.png"), std::ios::binary) << png;
  fs::resize_file(file("pictures.runs/row-6/picture.png"), 1ULL << 40U);
  EXPECT_FALSE(page_of("row-6"));
}

TEST_F(HostileResults, names_are_text_in_the_page_and_words_in_its_commands) {
  const std::string name = "</script><img src=x onerror=alert(1)>\x1b[201~\n\xe2\x80\xae--help";
  const auto results = read_results(make("names.db", "UPDATE runs SET problem = '" + name + "', passed = 0; UPDATE campaign SET value = '" +
                                                         name + "' WHERE name = 'plan_file'"));
  ASSERT_TRUE(results) << results.error().message;
  ASSERT_TRUE(write_html(*results, file("page.html"), file("names.runs")));
  std::ifstream in(file("page.html"));
  const std::string page((std::istreambuf_iterator<char>(in)), {});
  for (const char* part : {"<img", "\x1b", "\xe2\x80\xae"}) EXPECT_FALSE(says(page, part)) << part;
  EXPECT_EQ(page.find("</script>"), page.rfind("</script>"));
  const auto again = command_again(*results, results->rows.front());
  EXPECT_TRUE(std::ranges::all_of(again, [](char c) { return c >= ' ' && c <= '~'; })) << again;
  EXPECT_TRUE(says(again, "\\x1b[201~\\x0a")) << again;
  auto dashed = *results;
  dashed.plan_file = "-x.yaml";
  EXPECT_EQ(command_again(dashed, dashed.rows.front()), "rtse sweep --row 1 -- -x.yaml");
}

TEST_F(Stores, get_outcomes_of_other_machines_as_they_were) {
  auto told = outcome(3);
  told.run.problem = "host of \"A\" was killed\n\xff";
  told.measures["tiny"] = 1.0 / 3e200;
  const auto line = to_line({"key", told, "kept/row-3"});
  EXPECT_EQ(line.find('\n'), line.size() - 1);
  const auto back = from_line(line);
  ASSERT_TRUE(back);
  EXPECT_TRUE(back->outcome.run.has_begun) << "a row with a problem is a result";
  EXPECT_EQ(back->outcome.measures, told.measures);
  EXPECT_EQ(back->outcome.run.state_hash, told.run.state_hash);
  EXPECT_EQ(back->outcome.run.verdicts.size(), told.run.verdicts.size());
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
