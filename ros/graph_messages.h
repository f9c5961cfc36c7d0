// Messages by which a participant of ROS 2 announces its nodes. A gid is the GUID of a DDS entity: 16 bytes since Iron; Humble has 24, the
// last 8 are 0. Values.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "ros/cdr.h"

namespace ros {

struct Gid {
  static constexpr std::string_view name = "rmw_dds_common/msg/Gid";
  std::array<std::uint8_t, 16> data{};
  static void fields(auto& m, auto& visit) { visit("data", m.data); }
};
struct NodeEntitiesInfo {
  static constexpr std::string_view name = "rmw_dds_common/msg/NodeEntitiesInfo";
  BoundedText<256> node_namespace{};
  BoundedText<256> node_name{};
  std::vector<Gid> reader_gid_seq{};
  std::vector<Gid> writer_gid_seq{};
  static void fields(auto& m, auto& visit) {
    visit("node_namespace", m.node_namespace);
    visit("node_name", m.node_name);
    visit("reader_gid_seq", m.reader_gid_seq);
    visit("writer_gid_seq", m.writer_gid_seq);
  }
};
struct ParticipantEntitiesInfo {
  static constexpr std::string_view name = "rmw_dds_common/msg/ParticipantEntitiesInfo";
  Gid gid{};
  std::vector<NodeEntitiesInfo> node_entities_info_seq{};
  static void fields(auto& m, auto& visit) {
    visit("gid", m.gid);
    visit("node_entities_info_seq", m.node_entities_info_seq);
  }
};
struct HumbleGid {
  static constexpr std::string_view name = "rmw_dds_common/msg/Gid";
  std::array<std::uint8_t, 24> data{};
  static void fields(auto& m, auto& visit) { visit("data", m.data); }
};
struct HumbleNodeEntitiesInfo {
  static constexpr std::string_view name = "rmw_dds_common/msg/NodeEntitiesInfo";
  BoundedText<256> node_namespace{};
  BoundedText<256> node_name{};
  std::vector<HumbleGid> reader_gid_seq{};
  std::vector<HumbleGid> writer_gid_seq{};
  static void fields(auto& m, auto& visit) {
    visit("node_namespace", m.node_namespace);
    visit("node_name", m.node_name);
    visit("reader_gid_seq", m.reader_gid_seq);
    visit("writer_gid_seq", m.writer_gid_seq);
  }
};
struct HumbleParticipantEntitiesInfo {
  static constexpr std::string_view name = "rmw_dds_common/msg/ParticipantEntitiesInfo";
  HumbleGid gid{};
  std::vector<HumbleNodeEntitiesInfo> node_entities_info_seq{};
  static void fields(auto& m, auto& visit) {
    visit("gid", m.gid);
    visit("node_entities_info_seq", m.node_entities_info_seq);
  }
};

}  // namespace ros
