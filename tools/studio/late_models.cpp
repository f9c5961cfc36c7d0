#include "studio/late_models.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace studio {
namespace {

constexpr int triangles = 11;  // of visualization_msgs/msg/Marker

double short_number(double value) { return std::round(value * 1e4) / 1e4; }  // a tenth of a millimetre

Json part_of(const Json& marker) {
  const auto& color = marker.at("color");
  Json points = Json::array();
  for (const auto& point : marker.at("points")) {
    for (const char* axis : {"x", "y", "z"}) points.push_back(short_number(point.at(axis).get<double>()));
  }
  return {{"color", Json::array({color.at("r"), color.at("g"), color.at("b"), color.at("a")})}, {"points", std::move(points)}};
}

std::set<std::string> names_in(const Json& markers) {
  std::set<std::string> names;
  for (const auto& marker : markers.at("markers")) {
    if (marker.value("type", 0) == triangles) names.insert(marker.value("ns", ""));
  }
  return names;
}

}  // namespace

void LateModels::begin(const Json& markers) { first_ = names_in(markers); }

void LateModels::take(const Json& markers, const RecordedScene& scene) {
  std::set<std::string> known;
  for (const auto& model : scene.models) known.insert(model.value("name", ""));
  const auto now = names_in(markers);
  gone_ = Json::array();
  for (const auto& name : first_) {
    if (known.contains(name) && !now.contains(name)) gone_.push_back(name);
  }
  std::map<std::string, std::map<std::string, Json>> found;  // parts of links, by model and frame
  for (const auto& marker : markers.at("markers")) {
    const auto model = marker.value("ns", "");
    if (marker.value("type", 0) != triangles || known.contains(model)) continue;
    auto& parts = found[model].try_emplace(marker.at("header").value("frame_id", ""), Json::array()).first->second;
    parts.push_back(part_of(marker));
  }
  frames_.clear();
  models_ = Json::array();
  for (auto& [name, links] : found) {
    Json list = Json::array();
    for (auto& [frame, parts] : links) {
      frames_.push_back(frame);
      list.push_back({{"name", frame}, {"parts", std::move(parts)}});
    }
    models_.push_back({{"name", name}, {"links", std::move(list)}});
  }
}

Json LateModels::event(const RecordedScene& scene) const {
  return {{"op", "late"}, {"version", scene.version}, {"models", models_}, {"gone", gone_}};
}

}  // namespace studio
