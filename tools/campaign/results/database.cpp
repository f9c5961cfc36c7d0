#include "campaign/results/database.h"

#include <fcntl.h>
#include <sqlite3.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <thread>
#include <utility>

#include "base/text.h"
#include "campaign/results/disk_room.h"

namespace campaign {
namespace {

using namespace std::chrono_literals;

constexpr std::chrono::milliseconds patience = 60s;  // for others that write; a list of a million rows takes half of it
constexpr std::chrono::seconds turn_patience{5};     // for others that close the file

std::string uri(const std::string& file) {
  std::string text = "file:";
  for (const char c : std::filesystem::absolute(file).string()) {
    char octet[4];
    std::snprintf(octet, sizeof octet, "%%%02x", static_cast<unsigned char>(c));
    text += c == '%' || c == '?' || c == '#' ? std::string(octet) : std::string(1, c);
  }
  return text;
}

Error problem(const std::string& file, sqlite3* database) {
  const auto room = check_room({std::filesystem::path(file).parent_path().string()}, room_to_go_on);
  return Error{"results " + base::in_quotes(file) + ": " + (database ? sqlite3_errmsg(database) : "no memory") +
               (room ? "" : "; " + room.error().message)};
}

}  // namespace

void Statement::Finalize::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

// One at a time, or the last two would each think that the other one is still there.
void Database::Close::operator()(sqlite3* database) const {
  const int turn = folder.empty() ? -1 : ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const auto end = std::chrono::steady_clock::now() + turn_patience;
  while (turn >= 0 && flock(turn, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(10ms);  // a wait for a lock has no end of its own
  if (!folder.empty()) {
    sqlite3_busy_timeout(database, 0);
    sqlite3_exec(database, "PRAGMA journal_mode=DELETE", nullptr, nullptr, nullptr);  // refused while others have the file
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
bool Statement::is_null(int column) const { return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL; }

Result<Database> Database::open(const std::string& file, Access access) {
  const bool writes = access == Access::write;
  const auto parent = std::filesystem::path(file).parent_path().string();
  const auto opened = [&](const std::string& name, int flags) {
    sqlite3* handle = nullptr;
    const int code = sqlite3_open_v2(name.c_str(), &handle, flags, nullptr);
    sqlite3_busy_timeout(handle, static_cast<int>(patience.count()));
    return std::pair(Database(handle, file, writes ? (parent.empty() ? "." : parent) : ""), code);
  };
  if (writes) {
    auto [database, code] = opened(file, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
    if (code != SQLITE_OK) return problem(file, database.database_.get());
    if (const auto begun = database.begin_log(); !begun) return begun.error();
    return std::move(database);
  }
  // A file of others, or on a disk that cannot be written; with a log that nobody wrote to the file, only where that can be read, too.
  const auto reads = [](sqlite3* handle) { return sqlite3_exec(handle, "SELECT 1 FROM sqlite_master", nullptr, nullptr, nullptr); };
  for (const int flags : {SQLITE_OPEN_READWRITE, SQLITE_OPEN_READONLY}) {
    auto [database, code] = opened(file, flags);
    if (code == SQLITE_OK && reads(database.database_.get()) == SQLITE_OK) return std::move(database);
    const bool is_last = flags == SQLITE_OPEN_READONLY;
    std::error_code ignored;
    const auto log = std::filesystem::file_size(file + "-wal", ignored);
    if (is_last && (sqlite3_errcode(database.database_.get()) != SQLITE_CANTOPEN || (!ignored && log > 0)))
      return problem(file, database.database_.get());
  }
  auto [database, code] = opened(uri(file) + "?immutable=1", SQLITE_OPEN_READONLY | SQLITE_OPEN_URI);
  if (code != SQLITE_OK) return problem(file, database.database_.get());
  return std::move(database);
}

// Which SQLite refuses at once, without waiting, while another one is at it.
Result<void> Database::begin_log() {
  const auto end = std::chrono::steady_clock::now() + patience;
  for (;;) {
    const auto begun = execute("PRAGMA journal_mode=WAL; PRAGMA synchronous=NORMAL; PRAGMA wal_autocheckpoint=1000;");
    if (begun || sqlite3_errcode(database_.get()) != SQLITE_BUSY || std::chrono::steady_clock::now() > end) return begun;
    std::this_thread::sleep_for(10ms);  // nobody says when
  }
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
