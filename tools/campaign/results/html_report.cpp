// The page of a campaign's results: data as JSON in a page whose script draws it. It needs no other file and no network.
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/base64.h"
#include "base/beneath.h"
#include "base/text.h"
#include "base/whole_file.h"
#include "campaign/results/report.h"
#include "campaign/results/report_page.h"

namespace campaign {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t max_points = 20'000;  // rows that are drawn
constexpr std::size_t max_failed = 200;     // that are listed
constexpr std::size_t max_pictures = 24;
constexpr std::size_t max_picture = 8 << 20;  // [byte]

// Of a row that failed: where its files are, also when they were moved together with the results.
std::string files_of(const std::string& runs, const ResultRow& row) {
  namespace fs = std::filesystem;
  const fs::path stored = row.run->folder;
  if (stored.empty()) return "";
  const auto beside = fs::path(runs) / stored.filename();
  std::error_code ignored;  // then it stays where it was
  return fs::is_directory(fs::symlink_status(beside, ignored)) ? beside.string() : stored.string();
}

// The file names the folder, so only its last part is used: no picture comes from elsewhere.
std::string picture_of(const std::string& runs, const ResultRow& row) {
  constexpr std::string_view signature = "\x89PNG\r\n\x1a\n";
  const auto folder = std::filesystem::path(row.run->folder).filename();
  if (folder.empty()) return "";
  const std::filesystem::path kept(runs);
  const auto octets = base::read_beneath(kept.parent_path(), kept.filename() / folder / "picture.png", max_picture);
  return octets && octets->starts_with(signature) ? "data:image/png;base64," + base::to_base64(*octets) : "";
}

// Nothing in a name turns the direction of writing, or looks like what it is not.
void make_printable(Json& json) {
  if (json.is_string()) {
    const auto& text = json.get_ref<const std::string&>();
    const bool is_ascii = std::ranges::all_of(text, [](char c) { return c >= ' ' && c <= '~'; });  // as the pictures are, which are long
    if (!is_ascii) json = base::printable(text, "\n\t");
  } else if (json.is_object()) {
    Json fit = Json::object();
    for (auto& [name, value] : json.items()) make_printable(fit[base::printable(name)] = std::move(value));
    json = std::move(fit);
  } else if (json.is_array()) {
    for (auto& value : json) make_printable(value);
  }
}

// Nothing in the data may end the script that it is in.
std::string in_script(const std::string& text) {
  std::string escaped;
  for (const char c : text) escaped += c == '<' ? "\\u003c" : c == '>' ? "\\u003e" : c == '&' ? "\\u0026" : std::string(1, c);
  return escaped;
}

Json value_json(const std::string& text) {
  const auto number = base::parse_number(text);
  return number ? Json(*number) : Json(text);
}

Json rows_json(const Results& results) {
  const auto every = std::max<std::size_t>(1, (results.rows.size() + max_points - 1) / max_points);
  Json rows = Json::array();
  for (std::size_t i = 0; i < results.rows.size(); i += every) {
    const auto& row = results.rows[i];
    if (!row.run) continue;
    Json json = {row.number, row.run->is_passed ? 1 : 0};
    for (const auto& name : results.parameters) json.push_back(value_json(value_of(row, name)));
    for (const auto& name : results.measures) {
      const auto found = row.measures.find(name);
      json.push_back(found == row.measures.end() ? Json() : Json(found->second));
    }
    rows.push_back(std::move(json));
  }
  return rows;
}

Json failed_json(const Results& results, const std::string& runs) {
  Json failed = Json::array();
  std::size_t pictures = 0;
  for (const auto& row : results.rows) {
    if (!row.run || row.run->is_passed) continue;
    if (failed.size() == max_failed) break;
    Json json{{"row", row.number},
              {"seed", row.seed},
              {"problem", row.run->problem},
              {"state", row.run->state_hash},
              {"folder", files_of(runs, row)},
              {"again", command_again(results, row)},
              {"values", row.values}};
    if (pictures < max_pictures) {
      if (auto picture = picture_of(runs, row); !picture.empty()) {
        json["picture"] = std::move(picture);
        ++pictures;
      }
    }
    failed.push_back(std::move(json));
  }
  return failed;
}

Json groups_json(const Results& results) {
  Json all = Json::array();
  for (const auto& parameter : results.parameters) {
    if (parameter == "seed") continue;
    Json json{{"name", parameter}, {"groups", Json::array()}};
    for (const auto& group : groups(results, parameter)) {
      json["groups"].push_back({{"name", group.name},
                                {"passed", group.passed},
                                {"all", group.rows.size()},
                                {"rate", group.rate.rate},
                                {"low", group.rate.low},
                                {"high", group.rate.high}});
    }
    all.push_back(std::move(json));
  }
  return all;
}

}  // namespace

Result<void> write_html(const Results& results, const std::string& file, const std::string& runs) {
  const auto passed = results.passed_count(), all = results.run_count();
  const auto rate = wilson(passed, all);
  Json data{{"plan", results.plan_file},
            {"system", results.system},
            {"world", results.world},
            {"duration", results.duration},
            {"rows", results.rows.size()},
            {"run", all},
            {"passed", passed},
            {"rate", {rate.rate, rate.low, rate.high}},
            {"parameters", results.parameters},
            {"measures", results.measures},
            {"points", rows_json(results)},
            {"failed", failed_json(results, runs)},
            {"groups", groups_json(results)},
            {"unmet", Json::array()}};
  for (const auto& unmet : results.unmet) data["unmet"].push_back({{"expectation", unmet.expectation}, {"rows", unmet.rows}});
  make_printable(data);
  auto text = data.dump(-1, ' ', false, Json::error_handler_t::replace);
  const std::string mark = "/*DATA*/null";
  std::string page = report_page;
  page.replace(page.find(mark), mark.size(), in_script(text));
  return base::write_whole_file(file, page);
}

}  // namespace campaign
