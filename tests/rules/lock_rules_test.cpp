// Every lock is one of base/guarded.h, which has ranks and asserts their order, and every thread is joined: reads every source of the
// project and reports raw locks and detached threads.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <string>
#include <vector>

#include "support/paths.h"

namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

// Files that have a raw lock, and why. The list only gets shorter: a file that no longer has one is reported too.
const std::map<std::string, std::string> allowed = {
    {"base/guarded.h", "the locks themselves"},
    {"clients/examples/echo_provider.cpp", "users copy it; it compiles against any OpenRTM"},
    // coil is an author's library and stands alone, and headers for authors may not include ours. Nothing is called under these locks.
    {"rtm-core/openrtm/include/coil/ClockManager.h", "coil stands alone"},
    {"rtm-core/openrtm/include/coil/Factory.h", "coil stands alone"},
    {"rtm-core/openrtm/include/coil/Mutex.h", "an author's lock"},
    {"rtm-core/openrtm/include/coil/PeriodicTask.h", "coil stands alone"},
    {"rtm-core/openrtm/include/coil/Timer.h", "coil stands alone"},
    {"rtm-core/coil/PeriodicTask.cpp", "coil stands alone"},
    {"rtm-core/coil/Task.cpp", "coil stands alone"},
    {"rtm-core/openrtm/include/rtm/CdrBufferBase.h", "an author's header"},
    {"rtm-core/openrtm/include/rtm/CorbaConsumer.h", "an author's header"},
    {"rtm-core/openrtm/include/rtm/ListenerList.h", "an author's header, a template"},
    {"rtm-core/openrtm/include/rtm/LocalServiceAdmin.h", "an author's header"},
    {"rtm-core/openrtm/include/rtm/ManagerActionListener.h", "an author's header, a template"},
    {"rtm-core/openrtm/include/rtm/ManagerServant.h", "an author's header"},
    {"rtm-core/openrtm/include/rtm/ObjectManager.h", "an author's header, a template"},
    {"rtm-core/openrtm/include/rtm/PeriodicLoop.h", "an author's header"},
    {"rtm-core/openrtm/include/rtm/PortConnectListener.h", "an author's header, a template"},
    {"rtm-core/openrtm/include/rtm/RingBuffer.h", "an author's header, a template"},
    {"rtm-core/openrtm/include/rtm/StaticFSM.h", "an author's header, a template"},
};

// Files that detach a thread, and why it cannot be joined. docs/ARCHITECTURE.md lists the same threads.
const std::map<std::string, std::string> detaching = {
    {"clients/video-player/window.cpp", "at the end of the process, when the X server holds the thread up"},
    {"rtm-core/coil/PeriodicTask.cpp", "when the function of the task destroys the task"},
    {"rtm-core/core/publisher.cpp", "when the publisher is destroyed by its own thread, or a peer hangs in a call"},
    {"rtm-core/core/signal_watcher.cpp", "the call may be the end of the process"},
    {"rtm-core/corba/ports/disconnect_notice.cpp", "a peer may hang; the end of the ORB waits for the count of these threads"},
    {"rtm-core/manager/end.cpp", "the end of the process is bounded, also when a stream or a call is not"},
    {"rtm-core/openrtm/include/coil/Async.h", "an author's call that nobody waits for"},
    {"rtm-core/openrtm/rtm/RTObject.cpp", "when the component is destroyed by the thread of its own exit"},
};

// "file:line", one per line of code with this, sorted.
Names lines_with(const std::regex& wanted, const fs::path& root) {
  Names found;
  for (const char* top :
       {"base", "shm", "ros", "arms", "rtm-core", "sim-server", "iface-components", "gateways", "tools", "clients", "python", "idl"}) {
    if (!fs::exists(root / top)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(root / top)) {
      const std::string extension = entry.path().extension().string();
      if (!entry.is_regular_file() || (extension != ".h" && extension != ".cpp")) continue;
      const std::string file = fs::relative(entry.path(), root).generic_string();
      std::ifstream in(entry.path());
      std::string line;
      for (int number = 1; std::getline(in, line); ++number) {
        const auto code = line.substr(0, line.find("//"));
        if (std::regex_search(code, wanted)) found.push_back(file + ":" + std::to_string(number));
      }
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

Names raw_locks(const fs::path& root) {
  static const std::regex lock(
      R"(\b(std::(recursive_|timed_|recursive_timed_|shared_|shared_timed_)?mutex|pthread_(mutex|rwlock|spin)\w*|omni_mutex|std::binary_semaphore)\b)");
  return lines_with(lock, root);
}

Names detached_threads(const fs::path& root) {
  static const std::regex detach(R"((\}\)|\bthread\w*|\bexiter)\.detach\(\))");
  return lines_with(detach, root);
}

// The lock of `for (auto& one : data.lock()->list)` is gone before the first turn of the loop (C++20).
Names loops_without_their_lock(const fs::path& root) {
  static const std::regex loop(R"(\bfor \(.*[^:]:[^:].*\.lock\(\)->)");
  return lines_with(loop, root);
}

std::string file_of(const std::string& place) { return place.substr(0, place.rfind(':')); }

TEST(LockRules, every_lock_of_the_project_has_a_rank) {
  for (const auto& place : raw_locks(paths::source_dir))
    EXPECT_TRUE(allowed.contains(file_of(place))) << place << ": a raw lock; expected base::Guarded, base::Turn or base::UsersTurn";
}

TEST(LockRules, the_list_of_exceptions_has_no_file_without_a_raw_lock) {
  Names files;
  for (const auto& place : raw_locks(paths::source_dir)) files.push_back(file_of(place));
  for (const auto& [file, reason] : allowed) EXPECT_TRUE(std::ranges::count(files, file) > 0) << file << " (" << reason << ")";
}

TEST(LockRules, raw_locks_of_every_kind_are_found) {
  const fs::path root = fs::path(testing::TempDir()) / ("lock_rules_" + std::to_string(getpid()));
  fs::create_directories(root / "sim-server");
  std::ofstream(root / "sim-server" / "a.cpp")
      << "#include <mutex>\nstd::mutex a;\n// std::mutex b;\nstd::recursive_mutex c;\nmy_mutex d;\n"
         "std::shared_mutex e;\npthread_mutex_t f;\n";
  const auto found = raw_locks(root);
  fs::remove_all(root);
  EXPECT_EQ(found, (Names{"sim-server/a.cpp:2", "sim-server/a.cpp:4", "sim-server/a.cpp:6", "sim-server/a.cpp:7"}));
}

TEST(LockRules, a_thread_is_joined_or_named_as_an_exception) {
  Names files;
  for (const auto& place : detached_threads(paths::source_dir)) {
    files.push_back(file_of(place));
    EXPECT_TRUE(detaching.contains(files.back())) << place << ": a detached thread; expected an owner that joins it";
  }
  for (const auto& [file, reason] : detaching) EXPECT_TRUE(std::ranges::count(files, file) > 0) << file << " (" << reason << ")";
}

TEST(LockRules, detached_threads_are_found) {
  const fs::path root = fs::path(testing::TempDir()) / ("detached_" + std::to_string(getpid()));
  fs::create_directories(root / "tools");
  std::ofstream(root / "tools" / "a.cpp") << "std::thread([] {}).detach();\nthread_.detach();\nlink_.detach();  // no thread\n";
  const auto found = detached_threads(root);
  fs::remove_all(root);
  EXPECT_EQ(found, (Names{"tools/a.cpp:1", "tools/a.cpp:2"}));
}

// The table of ranks in a header like base/guarded.h.
struct RankRow {
  std::string name;
  int number = 0;
  std::string guards;  // what the comment says
};

std::vector<RankRow> rank_table(const fs::path& header) {
  static const std::regex row(R"(^  (\w+) = (\d+),?\s*(?://\s*(.*))?$)");
  std::vector<RankRow> table;
  std::ifstream in(header);
  std::string line;
  while (std::getline(in, line) && !line.starts_with("enum class Rank")) {
  }
  while (std::getline(in, line) && !line.starts_with("}")) {
    std::smatch match;
    if (std::regex_match(line, match, row)) table.push_back({match[1], std::stoi(match[2]), match[3]});
  }
  return table;
}

// How many locks have each rank.
std::map<std::string, int> locks_of_ranks(const fs::path& root) {
  static const std::regex lock(R"(\b(Guarded|Turn)<.*\bRank::(\w+)>)");
  std::map<std::string, int> counts;
  for (const auto& place : lines_with(lock, root)) {
    std::ifstream in(root / file_of(place));
    std::string line;
    for (int number = std::stoi(place.substr(place.rfind(':') + 1)); number > 0; --number) std::getline(in, line);
    std::smatch match;
    if (std::regex_search(line, match, lock)) ++counts[match[2]];
  }
  return counts;
}

// What is wrong with the ranks of a tree.
Names problems_of_ranks(const fs::path& root) {
  Names found;
  const auto counts = locks_of_ranks(root);
  int all = 0, last = 0;
  for (const auto& [name, count] : counts) all += count;
  for (const auto& [name, number, guards] : rank_table(root / "base" / "guarded.h")) {
    const int count = counts.contains(name) ? counts.at(name) : 0;
    if (guards.empty()) found.push_back(name + ": the table does not say what it guards");
    if (number <= last) found.push_back(name + ": is not in the order of the numbers");
    if (count == 0 && name != "turn") found.push_back(name + ": no lock has it");
    if (count * 5 > all) found.push_back(name + ": guards " + std::to_string(count) + " of " + std::to_string(all) + " locks");
    last = number;
  }
  return found;
}

TEST(LockRules, the_table_of_ranks_says_what_each_guards_and_none_guards_a_fifth_of_all) {
  EXPECT_GT(rank_table(paths::source_dir / fs::path("base/guarded.h")).size(), 10u);
  EXPECT_EQ(problems_of_ranks(paths::source_dir), Names());
}

TEST(LockRules, a_rank_that_guards_everything_nothing_or_out_of_order_is_found) {
  const fs::path root = fs::path(testing::TempDir()) / ("lock_ranks_" + std::to_string(getpid()));
  fs::create_directories(root / "base");
  std::ofstream(root / "base" / "guarded.h") << "enum class Rank : int {\n  first = 5,   // one\n  second = 4,  // two\n  third = 9\n};\n";
  std::ofstream(root / "base" / "a.cpp")
      << "Guarded<int, Rank::first> a;\nbase::Turn<base::Rank::first> b;\nGuarded<int, Rank::second> c;\n";
  const auto found = problems_of_ranks(root);
  fs::remove_all(root);
  EXPECT_EQ(found, (Names{"first: guards 2 of 3 locks", "second: is not in the order of the numbers", "second: guards 1 of 3 locks",
                          "third: the table does not say what it guards", "third: no lock has it"}));
}

TEST(LockRules, no_loop_has_a_lock_that_ends_before_it) { EXPECT_EQ(loops_without_their_lock(paths::source_dir), Names()); }

TEST(LockRules, a_loop_whose_lock_ends_before_it_is_found) {
  const fs::path root = fs::path(testing::TempDir()) / ("lock_loops_" + std::to_string(getpid()));
  fs::create_directories(root / "clients");
  std::ofstream(root / "clients" / "a.cpp") << "for (auto& a : data.lock()->list) {}\nfor (;;) data.lock()->push_back(std::string());\n"
                                               "const auto all = data.lock();\nfor (auto& a : all->list) {}\n";
  const auto found = loops_without_their_lock(root);
  fs::remove_all(root);
  EXPECT_EQ(found, Names{"clients/a.cpp:1"});
}

}  // namespace
