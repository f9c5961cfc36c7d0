// The page of a campaign's results: data as JSON in a page whose script draws it. It needs no other file and no network.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "base/base64.h"
#include "base/text.h"
#include "campaign/results/report.h"
#include "campaign/results/report_page.h"

namespace campaign {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t most_points = 20'000;  // rows that are drawn
constexpr std::size_t most_failed = 200;     // that are listed
constexpr std::size_t most_pictures = 24;

// Of a row that failed: where its files are, also when they were moved together with the results.
std::string files_of(const Results& results, const ResultRow& row) {
  namespace fs = std::filesystem;
  const fs::path stored = row.run->folder;
  if (stored.empty()) return "";
  const auto beside = fs::path(results.file).replace_extension(".runs") / stored.filename();
  std::error_code ignored;  // then it stays where it was
  return !fs::exists(stored, ignored) && fs::exists(beside, ignored) ? beside.string() : stored.string();
}

std::string picture_in(const std::string& folder) {
  std::ifstream in(folder + "/picture.png", std::ios::binary);
  if (folder.empty() || !in) return "";
  const std::string octets((std::istreambuf_iterator<char>(in)), {});
  return "data:image/png;base64," + base::to_base64(octets);
}

Json value_json(const std::string& text) {
  const auto number = base::parse_number(text);
  return number ? Json(*number) : Json(text);
}

Json rows_json(const Results& results) {
  const auto every = std::max<std::size_t>(1, (results.rows.size() + most_points - 1) / most_points);
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

Json failed_json(const Results& results) {
  Json failed = Json::array();
  std::size_t pictures = 0;
  for (const auto& row : results.rows) {
    if (!row.run || row.run->is_passed) continue;
    if (failed.size() == most_failed) break;
    const auto folder = files_of(results, row);
    Json json{{"row", row.number},
              {"seed", row.seed},
              {"problem", row.run->problem},
              {"state", row.run->state_hash},
              {"folder", folder},
              {"again", command_again(results, row)},
              {"values", row.values}};
    if (pictures < most_pictures) {
      if (auto picture = picture_in(folder); !picture.empty()) {
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

Result<void> write_html(const Results& results, const std::string& file) {
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
            {"failed", failed_json(results)},
            {"groups", groups_json(results)},
            {"unmet", Json::array()}};
  for (const auto& unmet : results.unmet) data["unmet"].push_back({{"expectation", unmet.expectation}, {"rows", unmet.rows}});
  auto text = data.dump(-1, ' ', false, Json::error_handler_t::replace);
  // Nothing in the data may end the script that it stands in.
  for (std::size_t at = text.find("<"); at != std::string::npos; at = text.find("<", at)) text.replace(at, 1, "\\u003c");
  std::string page = report_page;
  const std::string mark = "/*DATA*/null";
  page.replace(page.find(mark), mark.size(), text);
  std::ofstream out(file, std::ios::binary);
  out << page;
  if (!out.flush()) return Error{"file " + base::in_quotes(file) + ": cannot be written"};
  return {};
}

}  // namespace campaign
