#include "campaign/results/store.h"

#include <filesystem>

#include "base/text.h"

namespace campaign {
namespace {

constexpr const char* schema = R"(
BEGIN IMMEDIATE;
CREATE TABLE IF NOT EXISTS campaign (name TEXT PRIMARY KEY, value TEXT) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS rows (number INTEGER PRIMARY KEY, key TEXT NOT NULL, seed INTEGER NOT NULL);
CREATE TABLE IF NOT EXISTS parameters (number INTEGER, name TEXT, value TEXT, PRIMARY KEY (number, name)) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS runs (key TEXT PRIMARY KEY, passed INTEGER NOT NULL, problem TEXT NOT NULL, state TEXT NOT NULL,
  folder TEXT NOT NULL, simulated REAL NOT NULL, wall REAL NOT NULL, logs TEXT NOT NULL, ended TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS measures (key TEXT, name TEXT, value REAL, PRIMARY KEY (key, name)) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS verdicts (key TEXT, place INTEGER, expectation TEXT, problem TEXT, details TEXT, PRIMARY KEY (key, place)) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS audits (key TEXT, at TEXT, state TEXT, same INTEGER);
CREATE INDEX IF NOT EXISTS rows_by_key ON rows (key);
INSERT OR IGNORE INTO campaign VALUES ('version', '1');
COMMIT;
)";

enum StatementNumber {
  insert_row,
  insert_parameter,
  select_run,
  insert_run,
  insert_measure,
  insert_verdict,
  insert_audit,
  set_fact,
  drop_measures,
  drop_verdicts,
  get_fact
};

}  // namespace

Result<Store> Store::open(const std::string& file) {
  auto database = Database::open(file, Database::Access::write);
  if (!database) return database.error();
  if (const auto done = database->execute(schema); !done) return done.error();
  auto asked = database->prepare("SELECT value FROM campaign WHERE name = 'version'");
  if (!asked) return asked.error();
  const auto has = asked->next();
  if (!has) return has.error();
  if (*has && asked->text(0) != std::to_string(version))
    return Error{"results " + base::in_quotes(file) + ": are of version " + asked->text(0) + ", expected " + std::to_string(version)};
  asked->end();
  Store store(std::move(*database));
  if (const auto made = store.make_statements(); !made) return made.error();
  return store;
}

bool Store::has_list(const std::string& file, const std::string& list) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return false;
  const auto database = Database::open(file, Database::Access::read);
  auto asked = database ? database->prepare("SELECT value FROM campaign WHERE name = 'list'") : database.error();
  if (!asked) return false;
  const auto has = asked->next();
  return has && *has && asked->text(0) == list;
}

Result<void> Store::make_statements() {
  for (const char* sql :
       {"INSERT INTO rows VALUES (?, ?, ?)", "INSERT INTO parameters VALUES (?, ?, ?)",
        "SELECT passed, problem, state, folder, simulated, wall FROM runs WHERE key = ?",
        "INSERT OR REPLACE INTO runs VALUES (?, ?, ?, ?, ?, ?, ?, ?, datetime('now'))", "INSERT OR REPLACE INTO measures VALUES (?, ?, ?)",
        "INSERT OR REPLACE INTO verdicts VALUES (?, ?, ?, ?, ?)", "INSERT INTO audits VALUES (?, datetime('now'), ?, ?)",
        "INSERT OR REPLACE INTO campaign VALUES (?, ?)", "DELETE FROM measures WHERE key = ?", "DELETE FROM verdicts WHERE key = ?",
        "SELECT value FROM campaign WHERE name = ?"}) {
    auto statement = database_.prepare(sql);
    if (!statement) return statement.error();
    statements_.push_back(std::move(*statement));
  }
  return {};
}

Result<std::string> Store::fact(const std::string& name) {
  auto& asked = statements_[get_fact];
  const auto found = asked.bind(1, name).next();
  const auto text = found && *found ? asked.text(0) : std::string();
  asked.end();
  return found ? Result<std::string>(text) : found.error();
}

Result<void> Store::set(const std::string& name, const std::string& value) {
  return statements_[set_fact].bind(1, name).bind(2, value).run();
}

Result<bool> Store::begin_rows(const Plan& plan, const std::string& list) {
  const auto file = plan.file.empty() ? std::string() : std::filesystem::absolute(plan.file).lexically_normal().string();
  if (const auto begun = database_.execute("BEGIN IMMEDIATE"); !begun) return begun.error();
  const auto old = fact("list");
  if (!old) return old.error();
  if (*old == list && !list.empty()) {  // what is read now is of one moment
    if (const auto ended = database_.execute("COMMIT; BEGIN;"); !ended) return ended.error();
    return false;
  }
  if (const auto dropped = database_.execute("DELETE FROM rows; DELETE FROM parameters;"); !dropped) return dropped.error();
  for (const auto& [name, value] : {std::pair<std::string, std::string>("plan", plan.text),
                                    {"plan_file", file},
                                    {"system", plan.run.system},
                                    {"world", plan.run.world},
                                    {"list", list},
                                    {"duration", base::format_number(plan.run.duration_s)}}) {
    if (const auto done = set(name, value); !done) return done.error();
  }
  return true;
}

Result<void> Store::add_row(const Row& row, const std::string& key) {
  const auto number = static_cast<std::int64_t>(row.number);
  if (const auto added = statements_[insert_row].bind(1, number).bind(2, key).bind(3, static_cast<std::int64_t>(row.seed)).run(); !added)
    return added;
  for (const auto& [name, value] : row.values) {
    if (const auto added = statements_[insert_parameter].bind(1, number).bind(2, name).bind(3, value).run(); !added) return added;
  }
  return {};
}

Result<void> Store::end_rows() { return database_.execute("COMMIT"); }

Result<std::optional<StoredRun>> Store::run(const std::string& key) {
  auto& select = statements_[select_run];
  const auto found = select.bind(1, key).next();
  if (!found) return found.error();
  std::optional<StoredRun> run;
  if (*found) run = StoredRun{select.integer(0) != 0, select.text(1), select.text(2), select.text(3), select.number(4), select.number(5)};
  select.end();
  return run;
}

Result<void> Store::add_run(const std::string& key, const Outcome& outcome, const std::string& folder) {
  if (const auto begun = database_.execute("BEGIN IMMEDIATE"); !begun) return begun;
  const auto add = [&]() -> Result<void> {
    const auto problem = outcome.run.first_problem();
    auto& run = statements_[insert_run];
    run.bind(1, key).bind(2, std::int64_t{problem.empty()}).bind(3, problem).bind(4, outcome.run.state_hash).bind(5, folder);
    run.bind(6, outcome.run.simulated_s).bind(7, outcome.run.wall_s).bind(8, outcome.run.logs);
    if (const auto added = run.run(); !added) return added;
    for (const auto number : {drop_measures, drop_verdicts}) {
      if (const auto dropped = statements_[number].bind(1, key).run(); !dropped) return dropped;
    }
    for (const auto& [name, value] : outcome.measures) {
      if (const auto added = statements_[insert_measure].bind(1, key).bind(2, name).bind(3, value).run(); !added) return added;
    }
    std::int64_t place = 0;
    for (const auto& verdict : outcome.run.verdicts) {
      auto& insert = statements_[insert_verdict];
      insert.bind(1, key).bind(2, place++).bind(3, verdict.expectation).bind(4, verdict.problem).bind(5, verdict.details);
      if (const auto added = insert.run(); !added) return added;
    }
    return {};
  };
  if (const auto added = add(); !added) {
    static_cast<void>(database_.execute("ROLLBACK"));
    return added;
  }
  return database_.execute("COMMIT");
}

Result<void> Store::add_audit(const std::string& key, const std::string& state_hash, bool is_same) {
  return statements_[insert_audit].bind(1, key).bind(2, state_hash).bind(3, std::int64_t{is_same}).run();
}

}  // namespace campaign
