#include "channels/views/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>

#include "shm/request_board.h"

namespace channels {

namespace {

using Json = nlohmann::json;

constexpr std::size_t head_size = 12, chunk_head_size = 8;
constexpr int u16_component = 5123, u32_component = 5125;

base::Error wrong() { return {"simulator: its export is no glTF that this program reads"}; }

std::uint32_t u32_at(std::string_view octets, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, octets.data() + at, sizeof value);
  return value;
}

// Kept linear there; people mean sRGB.
float to_srgb(double linear) {
  return static_cast<float>(linear <= 0.0031308 ? 12.92 * std::max(linear, 0.0) : 1.055 * std::pow(std::min(linear, 1.0), 1 / 2.4) - 0.055);
}

class Reader {
 public:
  Reader(const Json& json, std::string_view octets) : json_(json), octets_(octets) {}

  std::vector<ros::Marker> read();

 private:
  // The octets of an accessor; empty when they are not all there.
  std::string_view data_of(const Json& accessor, std::size_t element) const;
  std::vector<ros::Point> triangles(const Json& mesh, const Json& node) const;
  ros::ColorRGBA color_of(const Json& mesh) const;
  void add_shapes(const Json& link, const std::string& model);

  const Json& json_;
  const std::string_view octets_;
  std::vector<ros::Marker> markers_;
  std::map<std::string, std::int32_t> ids_;  // the next one of a model
};

std::string_view Reader::data_of(const Json& accessor, std::size_t element) const {
  const auto& view = json_.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>());
  const auto from = view.value("byteOffset", std::size_t{0}) + accessor.value("byteOffset", std::size_t{0});
  const auto count = accessor.at("count").get<std::size_t>();
  if (from > octets_.size() || count > (octets_.size() - from) / element) return {};
  return octets_.substr(from, count * element);
}

// Points on the link, three for each triangle.
std::vector<ros::Point> Reader::triangles(const Json& mesh, const Json& node) const {
  const auto& primitive = mesh.at("primitives").at(0);
  const auto accessor = [&](const Json& number) -> const Json& { return json_.at("accessors").at(number.get<std::size_t>()); };
  const auto places = data_of(accessor(primitive.at("attributes").at("POSITION")), 3 * sizeof(float));
  const auto& indices = accessor(primitive.at("indices"));
  const int kind = indices.at("componentType").get<int>();
  if (kind != u16_component && kind != u32_component) return {};
  const std::size_t width = kind == u16_component ? 2 : 4;
  const auto order = data_of(indices, width);
  std::array<double, 16> m = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};  // by columns
  if (node.contains("matrix")) m = node.at("matrix").get<std::array<double, 16>>();
  std::vector<ros::Point> points;
  const std::size_t count = order.size() / width / 3 * 3;
  points.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t index = 0;
    std::memcpy(&index, order.data() + i * width, width);
    std::array<float, 3> p{};
    if ((std::size_t{index} + 1) * sizeof p > places.size()) return {};
    std::memcpy(p.data(), places.data() + index * sizeof p, sizeof p);
    const auto row = [&](std::size_t r) { return m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r]; };
    points.push_back({row(0), row(1), row(2)});
  }
  return points;
}

ros::ColorRGBA Reader::color_of(const Json& mesh) const {
  const auto& material = json_.at("materials").at(mesh.at("primitives").at(0).at("material").get<std::size_t>());
  const auto factor = material.at("pbrMetallicRoughness").at("baseColorFactor").get<std::array<double, 4>>();
  return {to_srgb(factor[0]), to_srgb(factor[1]), to_srgb(factor[2]), static_cast<float>(factor[3])};
}

void Reader::add_shapes(const Json& link, const std::string& model) {
  std::int32_t& id = ids_[model];
  for (const auto& child : link.value("children", std::vector<std::size_t>())) {
    const auto& node = json_.at("nodes").at(child);
    if (!node.contains("mesh") || node.contains("skin")) continue;
    const auto& mesh = json_.at("meshes").at(node.at("mesh").get<std::size_t>());
    ros::Marker marker;
    marker.header.frame_id = link.value("name", "");
    marker.ns = model;
    marker.id = id++;
    marker.type = ros::Marker::triangle_list;
    marker.action = ros::Marker::add;
    marker.scale = {1, 1, 1};
    marker.color = color_of(mesh);
    marker.frame_locked = true;
    marker.points = triangles(mesh, node);
    if (!marker.points.empty()) markers_.push_back(std::move(marker));
  }
}

std::vector<ros::Marker> Reader::read() {
  const auto& nodes = json_.at("nodes");
  for (const auto& top : nodes.at(0).value("children", std::vector<std::size_t>())) {
    const auto& model = nodes.at(top);
    if (!model.contains("extras") || !model.at("extras").value("model", false)) continue;
    for (const auto& link : model.value("children", std::vector<std::size_t>())) add_shapes(nodes.at(link), model.value("name", ""));
  }
  return std::move(markers_);
}

// The smallest first, until there is no more room.
void limit_size(std::vector<ros::Marker>& markers) {
  const auto size = [](const ros::Marker& marker) { return marker.points.size() * sizeof(ros::Point) + 256; };
  std::vector<std::size_t> sizes;
  for (const auto& marker : markers) sizes.push_back(size(marker));
  std::ranges::sort(sizes);
  std::size_t sum = 0, largest = 0;
  for (const auto one : sizes) {
    sum += one;
    if (sum > max_shapes) break;
    largest = one;
  }
  if (sum > max_shapes) std::erase_if(markers, [&](const ros::Marker& marker) { return size(marker) > largest; });
}

// The JSON before the octets.
base::Result<std::string_view> text_in(std::string_view glb) {
  if (glb.size() < head_size + chunk_head_size || !glb.starts_with("glTF")) return wrong();
  const std::size_t size = u32_at(glb, head_size);
  const std::size_t at = head_size + chunk_head_size;
  if (size > glb.size() - at) return wrong();
  return glb.substr(at, size);
}

}  // namespace

base::Result<std::vector<std::string>> links_in(std::string_view glb) {
  const auto text = text_in(glb);
  if (!text) return text.error();
  std::vector<std::string> names;
  try {
    const auto json = Json::parse(*text);
    for (const auto& link : json.at("scenes").at(0).at("extras").at("links"))
      names.push_back(json.at("nodes").at(link.get<std::size_t>()).value("name", ""));
  } catch (const Json::exception&) {
    return wrong();
  }
  return names;
}

base::Result<std::vector<ros::Marker>> markers_in(std::string_view glb) {
  const auto text = text_in(glb);
  if (!text) return text.error();
  const auto json = Json::parse(*text, nullptr, false);
  auto octets = glb.substr(head_size + chunk_head_size + text->size());
  octets.remove_prefix(std::min(octets.size(), chunk_head_size));
  try {
    auto markers = Reader(json, octets).read();
    limit_size(markers);
    return markers;
  } catch (const Json::exception&) {
    return wrong();
  }
}

base::Result<std::vector<ros::Marker>> shapes_of(std::uint32_t server_id) {
  auto requester = shm::Requester::open(server_id);
  if (!requester) return requester.error();
  const auto reply = requester->ask(shm::ExportRequest{}, std::chrono::minutes(1));
  if (!reply) return reply.error();
  if (reply->status != shm::RequestStatus::ok) return base::Error{reply->message};
  return markers_in(reply->text);
}

}  // namespace channels
