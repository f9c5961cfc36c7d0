#include "campaign/results/database.h"

#include <fcntl.h>
#include <sqlite3.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <string_view>
#include <thread>
#include <utility>

#include "base/beneath.h"
#include "base/text.h"
#include "campaign/results/disk_room.h"

namespace campaign {
namespace {

using namespace std::chrono_literals;

constexpr std::chrono::milliseconds busy_timeout = 60s;   // for others that write; a list of a million rows takes half of it
constexpr std::chrono::seconds turn_timeout{5};           // for others that close the file
constexpr std::int64_t max_heap = std::int64_t{1} << 30;  // [byte] of all that SQLite keeps

std::string uri(const std::string& file) {
  std::string text = "file:";
  for (const char c : std::filesystem::absolute(file).string()) {
    char octet[4];
    std::snprintf(octet, sizeof octet, "%%%02x", static_cast<unsigned char>(c));
    text += c == '%' || c == '?' || c == '#' ? std::string(octet) : std::string(1, c);
  }
  return text;
}

// In its head, as the file format of SQLite has it.
bool says_it_has_a_log(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::array<char, 20> head{};
  return in.read(head.data(), head.size()) && head[19] == 2;
}

// For a file that may come from others: selects from its tables, by functions that cannot take long, and nothing else.
int allow_reading(void*, int action, const char* first, const char* second, const char* base_name, const char* inner) {
  constexpr std::array<std::string_view, 3> functions{"count", "coalesce", "sum"};
  const bool is_ours = inner == nullptr;  // not called by a view or trigger
  if (action == SQLITE_SELECT && is_ours) return SQLITE_OK;
  if (action == SQLITE_READ && is_ours && (base_name == nullptr || std::string_view(base_name) == "main")) return SQLITE_OK;
  if (action == SQLITE_FUNCTION && is_ours && second != nullptr && std::ranges::find(functions, base::to_lower(second)) != functions.end())
    return SQLITE_OK;
  (void)first;
  return SQLITE_DENY;
}

int has_ended(void* deadline) {
  return std::chrono::steady_clock::now() > *static_cast<const std::chrono::steady_clock::time_point*>(deadline) ? 1 : 0;
}

Error problem(const std::string& file, sqlite3* database) {
  if (database && sqlite3_errcode(database) == SQLITE_INTERRUPT)
    return Error{"results " + base::in_quotes(file) + ": take too long to read; expected the results of a campaign"};
  const auto room = check_room({std::filesystem::path(file).parent_path().string()}, room_to_go_on);
  return Error{"results " + base::in_quotes(file) + ": " + (database ? sqlite3_errmsg(database) : "no memory") +
               (room ? "" : "; " + room.error().message)};
}

}  // namespace

void Statement::Finalize::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

// One at a time, or the last two would each think that the other one is still there.
void Database::Close::operator()(sqlite3* database) const {
  const int turn = folder.empty() ? -1 : ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const auto end = std::chrono::steady_clock::now() + turn_timeout;
  while (turn >= 0 && flock(turn, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(10ms);  // a wait for a lock has no end of its own
  if (!folder.empty()) {
    sqlite3_busy_timeout(database, 0);
    sqlite3_exec(database, "PRAGMA journal_mode=DELETE", nullptr, nullptr, nullptr);  // rejected while others have the file
  }
  sqlite3_close_v2(database);
  if (turn >= 0) ::close(turn);
}

Statement& Statement::bind(int number, std::string_view text) {
  sqlite3_bind_text64(statement_.get(), number, text.data(), text.size(), SQLITE_TRANSIENT, SQLITE_UTF8);
  return *this;
}

Statement& Statement::bind(int number, std::int64_t value) {
  sqlite3_bind_int64(statement_.get(), number, value);
  return *this;
}

Statement& Statement::bind(int number, double value) {
  sqlite3_bind_double(statement_.get(), number, value);
  return *this;
}

Result<bool> Statement::next() {
  const int code = sqlite3_step(statement_.get());
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  return problem(file_, database_);
}

Result<void> Statement::run() {
  const int code = sqlite3_step(statement_.get());
  Result<void> result;
  if (code != SQLITE_DONE && code != SQLITE_ROW) result = problem(file_, database_);
  sqlite3_reset(statement_.get());
  return result;
}

void Statement::end() { sqlite3_reset(statement_.get()); }

std::string Statement::text(int column) const {
  const auto* text = sqlite3_column_text(statement_.get(), column);
  return text ? std::string(reinterpret_cast<const char*>(text), static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column)))
              : "";
}

std::int64_t Statement::integer(int column) const { return sqlite3_column_int64(statement_.get(), column); }
double Statement::number(int column) const { return sqlite3_column_double(statement_.get(), column); }
int Statement::columns() const { return sqlite3_column_count(statement_.get()); }
std::size_t Statement::size(int column) const {
  const int type = sqlite3_column_type(statement_.get(), column);
  const bool is_text = type == SQLITE_TEXT || type == SQLITE_BLOB;
  return is_text ? static_cast<std::size_t>(std::max(0, sqlite3_column_bytes(statement_.get(), column))) : 0;
}
bool Statement::is_null(int column) const { return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL; }

Result<Database> Database::open(const std::string& file, Access access, const ReadLimits& limits) {
  if (access == Access::read) return open_to_read(file, limits);
  const auto parent = std::filesystem::path(file).parent_path().string();
  sqlite3* handle = nullptr;
  const int code = sqlite3_open_v2(file.c_str(), &handle, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
  sqlite3_busy_timeout(handle, static_cast<int>(busy_timeout.count()));
  Database database(handle, file, parent.empty() ? "." : parent);
  if (code != SQLITE_OK) return problem(file, handle);
  if (const auto begun = database.begin_log(); !begun) return begun.error();
  return database;
}

// A file that says that it has a log, and has none: a copy, which nobody writes to. To open it as others are would make the log.
Result<Database> Database::open_to_read(const std::string& file, const ReadLimits& limits) {
  std::error_code error;
  const auto real = std::filesystem::canonical(file, error).string();
  if (error) return Error{"results " + base::in_quotes(file) + ": " + error.message()};
  if (const auto checked = base::check_regular_file(real); !checked) return checked.error();
  for (const char* log : {"-wal", "-shm", "-journal"}) {
    if (const auto checked = base::check_regular_file(real + log, {.follows = false, .may_be_absent = true}); !checked)
      return checked.error();
  }
  const auto log_size = std::filesystem::file_size(real + "-wal", error);
  const bool has_log = !error && log_size > 0;
  const bool is_copy = error && says_it_has_a_log(real);
  for (const bool is_immutable : {is_copy, true}) {
    sqlite3* handle = nullptr;
    const auto name = uri(real) + (is_immutable ? "?immutable=1" : "");
    const int code = sqlite3_open_v2(name.c_str(), &handle, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOFOLLOW, nullptr);
    Database database(handle, file, "");
    if (code != SQLITE_OK) return problem(file, handle);
    const auto guarded = database.guard(limits);
    if (guarded) return database;
    // In a folder that cannot be written a file without a log can be read all the same.
    if (is_immutable || sqlite3_errcode(handle) != SQLITE_CANTOPEN || has_log) return guarded.error();
  }
  return Error{"results " + base::in_quotes(file) + ": cannot be read"};
}

// Which SQLite rejects at once, without waiting, while another one is at it.
Result<void> Database::begin_log() {
  const auto end = std::chrono::steady_clock::now() + busy_timeout;
  for (;;) {
    const auto begun = execute("PRAGMA journal_mode=WAL; PRAGMA synchronous=NORMAL; PRAGMA wal_autocheckpoint=1000;");
    if (begun || sqlite3_errcode(database_.get()) != SQLITE_BUSY || std::chrono::steady_clock::now() > end) return begun;
    std::this_thread::sleep_for(10ms);  // nobody says when
  }
}

// Before anything is read from it but its head.
Result<void> Database::guard(const ReadLimits& limits) {
  auto* handle = database_.get();
  sqlite3_busy_timeout(handle, static_cast<int>(std::min<std::chrono::milliseconds>(busy_timeout, limits.time).count()));
  sqlite3_hard_heap_limit64(max_heap);
  for (const auto& [limit, value] : std::initializer_list<std::pair<int, int>>{{SQLITE_LIMIT_LENGTH, 64 << 20},
                                                                               {SQLITE_LIMIT_SQL_LENGTH, 64 << 10},
                                                                               {SQLITE_LIMIT_COLUMN, 64},
                                                                               {SQLITE_LIMIT_EXPR_DEPTH, 32},
                                                                               {SQLITE_LIMIT_COMPOUND_SELECT, 4},
                                                                               {SQLITE_LIMIT_FUNCTION_ARG, 8},
                                                                               {SQLITE_LIMIT_ATTACHED, 0},
                                                                               {SQLITE_LIMIT_TRIGGER_DEPTH, 1},
                                                                               {SQLITE_LIMIT_WORKER_THREADS, 0}})
    sqlite3_limit(handle, limit, value);
  for (const auto& [setting, value] : std::initializer_list<std::pair<int, int>>{{SQLITE_DBCONFIG_DEFENSIVE, 1},
                                                                                 {SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0},
                                                                                 {SQLITE_DBCONFIG_ENABLE_TRIGGER, 0},
                                                                                 {SQLITE_DBCONFIG_ENABLE_VIEW, 0},
                                                                                 {SQLITE_DBCONFIG_ENABLE_LOAD_EXTENSION, 0},
                                                                                 {SQLITE_DBCONFIG_ENABLE_FTS3_TOKENIZER, 0}})
    sqlite3_db_config(handle, setting, value, static_cast<int*>(nullptr));
  deadline_ = std::make_shared<std::chrono::steady_clock::time_point>(std::chrono::steady_clock::now() + limits.time);
  sqlite3_progress_handler(handle, 1000, has_ended, deadline_.get());
  const char* settings = "PRAGMA query_only=ON; PRAGMA cell_size_check=ON; PRAGMA mmap_size=0; PRAGMA temp_store=MEMORY";
  if (const auto set = execute(settings); !set) return set;
  for (const char* others :
       {"SELECT type, name FROM sqlite_master WHERE (type = 'table' AND rootpage < 1) OR type = 'view' OR type = 'trigger' LIMIT 1",
        "SELECT 'computed column', c.name FROM sqlite_master m, pragma_table_xinfo(m.name) c WHERE m.type = 'table' AND c.hidden > 0 LIMIT "
        "1"}) {
    auto found = prepare(others);
    if (!found) return found.error();
    const auto is_there = found->next();
    if (!is_there) return is_there.error();
    if (*is_there)
      return Error{"results " + base::in_quotes(file_) + ": have the " + base::printable(found->text(0)) + " " +
                   base::in_quotes(found->text(1)) + "; expected the tables of a campaign alone"};
  }
  sqlite3_set_authorizer(handle, allow_reading, nullptr);
  return {};
}

Result<void> Database::execute(const std::string& sql) {
  if (sqlite3_exec(database_.get(), sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK) return {};
  return problem(file_, database_.get());
}

Result<Statement> Database::prepare(const std::string& sql) const {
  sqlite3_stmt* statement = nullptr;
  if (sqlite3_prepare_v2(database_.get(), sql.c_str(), static_cast<int>(sql.size()), &statement, nullptr) != SQLITE_OK)
    return problem(file_, database_.get());
  return Statement(database_.get(), statement, file_);
}

}  // namespace campaign
