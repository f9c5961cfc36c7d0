// The graph of ROS 2: announces the nodes of this participant, and reads those of other participants.
//
// Humble and its successors have gids of different size, and a message of the wrong size can end a process of Humble. So no node is
// announced before the distribution of the domain is known: from an option, or from the endpoints of a peer. One thread at a time.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/result.h"
#include "dds/participant.h"

namespace ros2 {

enum class Family { humble, jazzy };  // jazzy: Iron and all later ones, too

// By its name here; nothing for other names.
inline std::optional<Family> family_of(std::string_view name) {
  if (name == "humble") return Family::humble;
  if (name == "jazzy") return Family::jazzy;
  return std::nullopt;
}

struct NodeName {
  std::string space = "/", name;
  std::string full() const { return (space == "/" ? "" : space) + "/" + name; }
  auto operator<=>(const NodeName&) const = default;
};

class Graph {
 public:
  using Time = std::chrono::steady_clock::time_point;

  static base::Result<std::unique_ptr<Graph>> open(Participant& participant, std::optional<Family> family);

  // Each needs its end; the same name twice is one node.
  void add_node(const NodeName& node);
  void remove_node(const NodeName& node);
  void add_endpoint(const NodeName& node, const Guid& guid, const EndpointSettings& settings, bool is_writer);
  void remove_endpoint(const NodeName& node, const Guid& guid);

  // Sends what has changed, once per 50 ms at most; logs endpoints of peers that do not fit. Call it some times a second.
  void update(Time now);
  std::optional<Family> family() const { return family_; }
  // "/slam_toolbox" of an endpoint; "an unknown node" where nobody says.
  std::string node_of(const Guid& endpoint) const;
  const Peer* peer(const Guid& endpoint) const;
  // Of a writer, as it says itself.
  bool is_reliable(const Guid& writer) const;
  // Peers' endpoints of a topic, as on the wire.
  std::vector<const Peer*> peers_of(const std::string& topic) const;

 private:
  struct Own {
    EndpointSettings settings;
    bool is_writer = false;
    NodeName node;
  };
  struct Node {
    std::vector<Guid> readers, writers;
    int uses = 0;
  };
  // A pair that does not fit. The peer may have another endpoint on the topic that does.
  struct Doubt {
    Peer peer;
    Own own;
    Time due;
  };

  Graph(Participant& participant, std::optional<Family> family) : participant_(participant), family_(family), is_set_(family.has_value()) {}
  void see(const Peer& peer);
  void judge_family(const Peer& peer);
  void judge_fit(const Peer& peer);
  bool is_of_twins(const Doubt& doubt) const;
  void learn(const Received& message);
  void publish_nodes();

  Participant& participant_;
  std::optional<Family> family_;
  const bool is_set_;
  bool is_mixed_ = false;
  std::unique_ptr<Writer> writer_;
  std::unique_ptr<Reader> reader_;
  std::map<NodeName, Node> nodes_;
  std::map<Guid, Own> own_;
  std::map<Guid, Peer> peers_;
  std::map<Guid, std::map<Guid, std::string>> named_;  // by writer of the message: endpoints and their nodes
  std::vector<Doubt> doubts_;
  bool has_changed_ = true;
  Time published_{};
};

// A reliable reader, and one of best effort that receives what the reliable one does not: so the topic is heard from all writers. The
// reliable one is first in the discovery data, so that a peer that sends as soon as it has a reader has that one.
base::Result<std::vector<std::unique_ptr<Reader>>> make_two_readers(Participant& participant, Graph& graph, const NodeName& node,
                                                                    EndpointSettings topic,
                                                                    const std::function<void(Received&)>& on_sample);

}  // namespace ros2
