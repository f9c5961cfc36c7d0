// A thin interface to SQLite: a file, statements, values. One thread at a time.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

struct sqlite3;
struct sqlite3_stmt;

namespace campaign {

using base::Error;
using base::Result;

class Statement {
 public:
  // Numbers from 1, in the order of the question marks.
  Statement& bind(int number, std::string_view text);
  Statement& bind(int number, std::int64_t value);
  Statement& bind(int number, double value);
  // True: there is a row. Fails as Database::execute does.
  Result<bool> next();
  // Runs it to its end, and makes it ready for the next values.
  Result<void> run();
  // Needs no more rows: one that is not told so keeps what it reads from being written.
  void end();

  std::string text(int column) const;
  std::int64_t integer(int column) const;
  double number(int column) const;
  bool is_null(int column) const;
  int columns() const;
  std::size_t size(int column) const;  // [byte] of a text; of a number 0

 private:
  friend class Database;
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  Statement(sqlite3* database, sqlite3_stmt* statement, std::string file)
      : database_(database), statement_(statement), file_(std::move(file)) {}
  sqlite3* database_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
  std::string file_;
};

// What reading a file may take, whatever is in it.
struct ReadLimits {
  std::chrono::milliseconds time{std::chrono::minutes(2)};  // from its opening on, all statements together
};

class Database {
 public:
  enum class Access { read, write };
  // Writing makes the file when there is none. While somebody writes, SQLite keeps a log beside the file; the last one takes it away, so
  // that what stays is one file that can be read wherever it lies.
  //
  // A file that is read may come from others: it and the logs beside it must be regular files, nothing is written, and nothing in it is
  // executed (views, triggers, functions, virtual tables). Statements may only select from its tables.
  static Result<Database> open(const std::string& file, Access access, const ReadLimits& limits = {});
  // Several statements, without values.
  Result<void> execute(const std::string& sql);
  Result<Statement> prepare(const std::string& sql) const;
  const std::string& file() const { return file_; }

 private:
  struct Close {
    std::string folder;  // of the file of one who writes; empty: of one who reads
    void operator()(sqlite3* database) const;
  };
  Database(sqlite3* database, std::string file, std::string folder)
      : database_(database, Close{std::move(folder)}), file_(std::move(file)) {}
  static Result<Database> open_to_read(const std::string& file, const ReadLimits& limits);
  Result<void> begin_log();
  Result<void> guard(const ReadLimits& limits);
  std::shared_ptr<std::chrono::steady_clock::time_point> deadline_;  // SQLite has its address; only when reading
  std::unique_ptr<sqlite3, Close> database_;
  std::string file_;
};

}  // namespace campaign
