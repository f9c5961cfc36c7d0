// A service in both forms that clients of ROS 2 have. rmw_fastrtps relates a reply to its request by the identities of DDS samples;
// rmw_cyclonedds by 16 bytes before the request and the reply. The form is that of the library that made the client. One thread at a time.
//
// A reply waits until the client's reader is matched, at most a second; then it is sent anyway.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "dds/participant.h"
#include "graph.h"

namespace ros2 {

struct ServiceTypes {
  std::string request, response;            // as on the wire
  std::string request_hash, response_hash;  // "RIHS01_..."
};

using Reply = std::function<void(const std::vector<char>& message)>;  // with the head of four bytes; ignored when the service has ended
// The type hashes of a client's request and of its reply; empty where it has none.
struct ClientHashes {
  std::string request, reply;
};
// False when the request cannot be read: it gets no reply.
using OnRequest = std::function<bool(std::span<const std::uint8_t> message, const ClientHashes& client, const Reply& reply)>;

class Service {
 public:
  static base::Result<std::unique_ptr<Service>> open(Participant& participant, Graph& graph, const NodeName& node, const std::string& name,
                                                     ServiceTypes types, OnRequest on_request);
  ~Service();
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  void update(std::chrono::steady_clock::time_point now);
  std::uint64_t damaged() const { return damaged_; }

 private:
  struct Client {
    bool is_fast_dds = false;
    SampleIdentity identity;                // of the reply, for Fast DDS
    std::vector<std::uint8_t> call_number;  // 16 bytes, for Cyclone
    std::string id;                         // "clientid" of Cyclone's endpoints; empty: none
    Guid reply_reader{};                    // where it is known
  };
  struct Waiting {
    Client client;
    std::vector<char> message;
    std::chrono::steady_clock::time_point until;
  };

  Service(Graph& graph, NodeName node, OnRequest on_request) : graph_(graph), node_(std::move(node)), on_request_(std::move(on_request)) {}
  void receive(Received& request);
  void reply(const Client& client, const std::vector<char>& message);
  bool is_matched(const Client& client) const;
  // Of the endpoint that receives the client's replies.
  std::string reply_hash(const Client& client, const Guid& request_writer) const;
  void send(const Client& client, const std::vector<char>& message);

  Graph& graph_;
  const NodeName node_;
  const OnRequest on_request_;
  std::unique_ptr<Reader> requests_;
  std::unique_ptr<Writer> replies_;
  std::vector<Waiting> waiting_;
  std::uint64_t damaged_ = 0;
  std::shared_ptr<bool> is_open_ = std::make_shared<bool>(true);
};

}  // namespace ros2
