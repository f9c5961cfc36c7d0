// The specification of an iface: type, name, constants, and the sizes that follow from them by the table of types. Values; any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "shm/iface_types.h"
#include "shm/segment.h"

namespace shm {

struct IfaceSpec {
  IfaceType type = IfaceType::laser;
  std::string name;
  std::vector<std::byte> info;
  Geometry geometry;
};

// `info` holds the type's info and what follows it. A count that is not plausible (no beams, more than the table allows) makes
// Server::create() fail.
IfaceSpec iface_spec(IfaceType type, const std::string& name, std::span<const std::byte> info);

// Info is the type's own.
template <class Info>
IfaceSpec iface_spec(IfaceType type, const std::string& name, const Info& info) {
  return iface_spec(type, name, std::as_bytes(std::span(&info, 1)));
}

// Places in the lock step: a hundred robots with ten contexts each.
inline constexpr std::uint32_t max_participants = 4096;

// Those that are more than a copy of their info.
IfaceSpec simulation_spec(const SimulationInfo& info, std::uint32_t request_slots = 32, std::uint32_t participants = max_participants);
IfaceSpec sonar_spec(const std::string& name, const SonarInfo& info, std::span<const Pose> poses);      // info.count is set to poses.size()
IfaceSpec joints_spec(const std::string& name, const JointsInfo& info, std::span<const Joint> joints);  // info.count, likewise
// type: camera, depth or points. stride and frame_size are computed when 0.
IfaceSpec camera_spec(IfaceType type, const std::string& name, const CameraInfo& info, std::uint32_t slots = 4);

// The info with its count set to what follows it.
template <class Info, class Element>
IfaceSpec spec_with(IfaceType type, const std::string& name, Info info, std::span<const Element> elements) {
  info.count = static_cast<std::uint32_t>(elements.size());
  const auto fixed = std::as_bytes(std::span<const Info>(&info, 1)), tail = std::as_bytes(elements);
  std::vector<std::byte> bytes(fixed.begin(), fixed.end());
  bytes.insert(bytes.end(), tail.begin(), tail.end());
  return iface_spec(type, name, std::span<const std::byte>(bytes));
}

}  // namespace shm
