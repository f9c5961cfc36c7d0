#include "results/database.h"

#include <sqlite3.h>

#include <filesystem>

#include "base/text.h"
#include "results/disk_room.h"

namespace campaign {
namespace {

Error problem(const std::string& file, sqlite3* database) {
  const auto room = check_room({std::filesystem::path(file).parent_path().string()}, room_to_go_on);
  return Error{"results " + base::in_quotes(file) + ": " + (database ? sqlite3_errmsg(database) : "no memory") +
               (room ? "" : "; " + room.error().message)};
}

}  // namespace

void Statement::Finalize::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
void Database::Close::operator()(sqlite3* database) const { sqlite3_close_v2(database); }

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

std::string Statement::text(int column) const {
  const auto* text = sqlite3_column_text(statement_.get(), column);
  return text ? std::string(reinterpret_cast<const char*>(text), static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column)))
              : "";
}

std::int64_t Statement::integer(int column) const { return sqlite3_column_int64(statement_.get(), column); }
double Statement::number(int column) const { return sqlite3_column_double(statement_.get(), column); }
bool Statement::is_null(int column) const { return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL; }

Result<Database> Database::open(const std::string& file, Access access) {
  constexpr int patience_ms = 10'000;  // for others that write
  sqlite3* handle = nullptr;
  const int flags = access == Access::write ? SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE : SQLITE_OPEN_READWRITE;
  int code = sqlite3_open_v2(file.c_str(), &handle, flags, nullptr);
  if (code != SQLITE_OK && access == Access::read) {  // a file of others
    sqlite3_close_v2(handle);
    code = sqlite3_open_v2(file.c_str(), &handle, SQLITE_OPEN_READONLY, nullptr);
  }
  Database database(handle, file);
  if (code != SQLITE_OK) return problem(file, handle);
  sqlite3_busy_timeout(handle, patience_ms);
  return database;
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
