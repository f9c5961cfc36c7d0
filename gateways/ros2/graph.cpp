#include "graph.h"

#include <algorithm>

#include "base/log.h"
#include "names.h"
#include "ros/decode.h"
#include "ros/graph_messages.h"
#include "ros/type_hash.h"

namespace ros2 {
namespace {

constexpr const char* graph_topic = "ros_discovery_info";
constexpr std::chrono::milliseconds between_messages{50};
constexpr std::chrono::seconds name_wait{1};                     // until a peer has told of its nodes
constexpr std::size_t max_peers = 100'000, max_names = 200'000;  // of endpoints, of all participants

ros::Gid gid16(const Guid& guid) { return {guid}; }
ros::HumbleGid gid24(const Guid& guid) {
  ros::HumbleGid gid;
  std::ranges::copy(guid, gid.data.begin());
  return gid;
}

bool starts_as_ros(const std::string& topic) { return topic.starts_with("rt/") || topic.starts_with("rq/") || topic.starts_with("rr/"); }

Guid first_16(const auto& data) {
  Guid guid{};
  std::copy_n(data.begin(), guid.size(), guid.begin());
  return guid;
}

// Stops when `names` would have more than `most` entries.
template <class Message>
void add_names(const Message& message, std::size_t most, std::map<Guid, std::string>& names) {
  for (const auto& node : message.node_entities_info_seq) {
    if (names.size() + node.reader_gid_seq.size() + node.writer_gid_seq.size() > most) return;
    const std::string name = NodeName{node.node_namespace, node.node_name}.full();
    for (const auto& gid : node.reader_gid_seq) names[first_16(gid.data)] = name;
    for (const auto& gid : node.writer_gid_seq) names[first_16(gid.data)] = name;
  }
}

template <class Message, class NodeInfo, class Nodes, class ToGid>
Message message_of(const Guid& participant, const Nodes& nodes, ToGid to_gid) {
  Message message;
  message.gid = to_gid(participant);
  for (const auto& [name, node] : nodes) {
    NodeInfo info;
    info.node_namespace.assign(name.space);
    info.node_name.assign(name.name);
    for (const Guid& guid : node.readers) info.reader_gid_seq.push_back(to_gid(guid));
    for (const Guid& guid : node.writers) info.writer_gid_seq.push_back(to_gid(guid));
    message.node_entities_info_seq.push_back(std::move(info));
  }
  return message;
}

// Why the two are not matched; empty when they are.
std::string misfit(const EndpointSettings& own, bool is_writer, const Peer& peer) {
  const std::string name = peer.topic.starts_with("rt/") ? peer.topic.substr(2) : peer.topic;
  if (own.type != peer.type)
    return name + " has type " + type_of_ros(peer.type) + ", expected " + type_of_ros(own.type) + ", in an endpoint";
  if (is_writer && peer.is_transient && !own.is_transient)
    return name + " is offered as volatile, but transient local is requested by a reader";
  if (is_writer && peer.is_reliable && !own.is_reliable) return name + " is offered as best effort, but reliable is requested by a reader";
  if (!is_writer && own.is_reliable && !peer.is_reliable) return name + " is requested as reliable, but best effort is offered by a writer";
  if (!is_writer && own.is_transient && !peer.is_transient)
    return name + " is requested as transient local, but volatile is offered by a writer";
  if (!peer.unmatched_policy.empty())
    return name + " has the default QoS, but " + peer.unmatched_policy + " is " +
           (is_writer ? "requested by a reader" : "offered by a writer");
  return "";
}

template <class Message>
void send(Writer& writer, const Message& message) {
  writer.write(ros::encoded_size(message), [&](std::span<char> room) { ros::encode(message, room); });
}

}  // namespace

base::Result<std::unique_ptr<Graph>> Graph::open(Participant& participant, std::optional<Family> family) {
  auto graph = std::unique_ptr<Graph>(new Graph(participant, family));
  EndpointSettings settings;
  settings.topic = graph_topic;
  settings.type = type_on_wire(ros::ParticipantEntitiesInfo::name);
  settings.user_data = "typehash=" + ros::TypeHash::of<ros::ParticipantEntitiesInfo>() + ";";
  settings.is_transient = true;
  settings.depth = 1;
  auto writer = participant.make_writer(settings);
  if (!writer) return writer.error();
  auto reader = participant.make_reader(settings, [self = graph.get()](const Received& message) { self->learn(message); });
  if (!reader) return reader.error();
  graph->writer_ = std::move(*writer);
  graph->reader_ = std::move(*reader);
  participant.watch([self = graph.get()](const Peer& peer) { self->see(peer); });
  return graph;
}

void Graph::add_node(const NodeName& node) {
  ++nodes_[node].uses;
  has_changed_ = true;
}

void Graph::remove_node(const NodeName& node) {
  if (const auto found = nodes_.find(node); found != nodes_.end() && --found->second.uses == 0) nodes_.erase(found);
  has_changed_ = true;
}

void Graph::add_endpoint(const NodeName& node, const Guid& guid, const EndpointSettings& settings, bool is_writer) {
  auto& lists = nodes_[node];
  (is_writer ? lists.writers : lists.readers).push_back(guid);
  own_[guid] = {settings, is_writer, node};
  has_changed_ = true;
  for (const Peer* peer : peers_of(settings.topic)) judge_fit(*peer);
}

void Graph::remove_endpoint(const NodeName& node, const Guid& guid) {
  own_.erase(guid);
  if (const auto found = nodes_.find(node); found != nodes_.end()) {
    std::erase(found->second.readers, guid);
    std::erase(found->second.writers, guid);
  }
  has_changed_ = true;
}

void Graph::update(Time now) {
  if (has_changed_ && family_ && now >= published_ + between_messages) {
    published_ = now;
    has_changed_ = false;
    publish_nodes();
  }
  std::set<std::string> lines;
  std::erase_if(doubts_, [&](const Doubt& doubt) {
    if (now < doubt.due) return false;
    if (!is_of_twins(doubt)) lines.insert(misfit(doubt.own.settings, doubt.own.is_writer, doubt.peer) + " of " + node_of(doubt.peer.guid));
    return true;
  });
  for (const auto& line : lines) base::log(base::Level::warn, participant_.settings().log_name, "{}", line);
}

void Graph::publish_nodes() {
  const Guid& guid = participant_.guid();
  if (*family_ == Family::humble) {
    send(*writer_, message_of<ros::HumbleParticipantEntitiesInfo, ros::HumbleNodeEntitiesInfo>(guid, nodes_, gid24));
  } else {
    send(*writer_, message_of<ros::ParticipantEntitiesInfo, ros::NodeEntitiesInfo>(guid, nodes_, gid16));
  }
}

std::string Graph::node_of(const Guid& endpoint) const {
  for (const auto& [writer, names] : named_) {
    if (const auto found = names.find(endpoint); found != names.end()) return found->second;
  }
  return "an unknown node";
}

const Peer* Graph::peer(const Guid& endpoint) const {
  const auto found = peers_.find(endpoint);
  return found == peers_.end() ? nullptr : &found->second;
}

bool Graph::is_reliable(const Guid& writer) const {
  const Peer* from = peer(writer);
  return from != nullptr && from->is_reliable;
}

std::vector<const Peer*> Graph::peers_of(const std::string& topic) const {
  std::vector<const Peer*> found;
  for (const auto& [guid, peer] : peers_) {
    if (peer.topic == topic) found.push_back(&peer);
  }
  return found;
}

void Graph::see(const Peer& peer) {
  if (peer.is_gone) {
    peers_.erase(peer.guid);
    named_.erase(peer.guid);
    return;
  }
  if (peers_.size() >= max_peers) return;
  const bool is_new = peers_.insert_or_assign(peer.guid, peer).second;
  judge_family(peer);
  if (is_new) judge_fit(peer);
}

// A graph writer without a type hash belongs to Humble. A topic with a type hash belongs to Iron or later. Other endpoints decide nothing.
void Graph::judge_family(const Peer& peer) {
  const bool has_hash = value_in(peer.user_data, "typehash").has_value();
  const bool is_graph = peer.topic == graph_topic;
  if (!(is_graph && peer.is_writer) && !(starts_as_ros(peer.topic) && has_hash)) return;
  const Family seen = has_hash ? Family::jazzy : Family::humble;
  const char* name = seen == Family::humble ? "Humble" : "Iron, Jazzy or later";
  if (!family_) {
    family_ = seen;
    base::log(base::Level::info, participant_.settings().log_name, "the domain has nodes of {}", name);
  } else if (seen != *family_ && !is_mixed_) {
    is_mixed_ = true;
    base::log(
        base::Level::error, participant_.settings().log_name,
        "the domain has a node of {}, but this program serves {} ({}). Nodes of both cannot share a domain: use another ROS_DOMAIN_ID",
        name, *family_ == Family::humble ? "Humble" : "Iron and later",
        is_set_ ? participant_.settings().distro_setting.c_str() : "the first node that it saw");
  }
}

void Graph::judge_fit(const Peer& peer) {
  for (const auto& [guid, own] : own_) {
    const bool is_pair = own.settings.topic == peer.topic && own.is_writer != peer.is_writer;
    if (is_pair && !misfit(own.settings, own.is_writer, peer).empty())
      doubts_.push_back({peer, own, std::chrono::steady_clock::now() + name_wait});
  }
}

// A node may have endpoints of two types, or of two reliabilities, on a topic. One that fits is enough, on either side.
bool Graph::is_of_twins(const Doubt& doubt) const {
  const auto fits = [](const Own& own, const Peer& peer) {
    return own.settings.topic == peer.topic && own.is_writer != peer.is_writer && misfit(own.settings, own.is_writer, peer).empty();
  };
  const auto is_same_node = [&](const Guid& guid) {
    return std::equal(guid.begin(), guid.begin() + 12, doubt.peer.guid.begin()) && node_of(guid) == node_of(doubt.peer.guid);
  };
  return std::ranges::any_of(own_, [&](const auto& own) { return own.second.node == doubt.own.node && fits(own.second, doubt.peer); }) ||
         std::ranges::any_of(peers_, [&](const auto& peer) { return fits(doubt.own, peer.second) && is_same_node(peer.first); });
}

void Graph::learn(const Received& message) {
  named_.erase(message.identity.writer);
  std::size_t room = max_names;
  for (const auto& [writer, names] : named_) room -= std::min(room, names.size());
  std::map<Guid, std::string> names;
  const Peer* from = peer(message.identity.writer);
  const bool is_humble = from != nullptr ? !value_in(from->user_data, "typehash") : family_ == Family::humble;
  if (is_humble) {
    if (const auto info = ros::decode<ros::HumbleParticipantEntitiesInfo>(message.bytes)) add_names(*info, room, names);
  } else if (const auto info = ros::decode<ros::ParticipantEntitiesInfo>(message.bytes)) {
    add_names(*info, room, names);
  }
  if (!names.empty()) named_[message.identity.writer] = std::move(names);
}

base::Result<std::vector<std::unique_ptr<Reader>>> make_two_readers(Participant& participant, Graph& graph, const NodeName& node,
                                                                    EndpointSettings topic,
                                                                    const std::function<void(Received&)>& on_sample) {
  std::vector<std::unique_ptr<Reader>> readers;
  for (const bool is_reliable : {true, false}) {
    topic.is_reliable = is_reliable;
    auto made = participant.make_reader(topic, [&graph, on_sample, is_reliable](Received& received) {
      if (is_reliable || !graph.is_reliable(received.identity.writer)) on_sample(received);
    });
    if (!made) return made.error();
    readers.push_back(std::move(*made));
  }
  // Without the other one, the reliable reader would be reported as one that does not fit.
  for (const std::size_t i : {1, 0}) graph.add_endpoint(node, readers[i]->guid(), readers[i]->settings(), false);
  return readers;
}

}  // namespace ros2
