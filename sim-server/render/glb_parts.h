// The parts of a .glb: lists of JSON objects, and the bytes that they refer to. Values; one thread at a time.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sim::glb {

// The order of glTF's own lists.
enum class List { nodes, meshes, materials, textures, images, samplers, skins, lights, accessors, views };
inline constexpr std::size_t lists = 10;

enum class Target { none = 0, vertices = 34962, indices = 34963 };
enum class Component { u16 = 5123, u32 = 5125, f32 = 5126 };

// "..." with everything escaped that JSON wants escaped; bytes that are no UTF-8 become "?".
std::string text(std::string_view plain);
// Shortest text that reads back the same. For finite numbers.
std::string number(double value);
std::string numbers(std::span<const double> values);
std::string vector3(const Eigen::Vector3d& v);
// As glTF has it: x y z w.
std::string quaternion(const Eigen::Matrix3d& rotation);
std::string matrix(const Eigen::Matrix4d& m);
std::string join(const std::vector<std::string>& values);
std::string indices(std::span<const std::size_t> values);

class Parts {
 public:
  // The number of what is added.
  std::size_t add(List list, std::string object);
  // Of a place that was added before.
  void set(List list, std::size_t index, std::string object) { lists_[static_cast<std::size_t>(list)][index] = std::move(object); }
  std::size_t count(List list) const { return lists_[static_cast<std::size_t>(list)].size(); }
  // Octets, at a multiple of four.
  std::size_t add_octets(std::span<const std::byte> octets, Target target = Target::none);
  // `limits`: empty, or ,"min":[...],"max":[...]
  std::size_t add_accessor(std::span<const std::byte> octets, Target target, Component component, std::string_view type, std::size_t count,
                           const std::string& limits = {});
  // The whole file. `scene`: the one scene's JSON; `extensions` that are used.
  std::string finish(const std::string& scene, const std::vector<std::string>& extensions) const;

 private:
  std::vector<std::string> lists_[lists];
  std::string octets_;
};

template <class T>
std::span<const std::byte> octets_of(const std::vector<T>& values) {
  return std::as_bytes(std::span(values));
}

}  // namespace sim::glb
