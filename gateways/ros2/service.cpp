#include "service.h"

#include <algorithm>
#include <cstdio>
#include <cstring>

#include "names.h"

namespace ros2 {
namespace {

constexpr std::chrono::seconds match_wait{1};
constexpr std::size_t head_size = 4, number_size = 16;
constexpr std::size_t max_replies_waiting = 1000;

// As rmw_cyclonedds writes ids: hexadecimal bytes with dots, the first one padded by a space. Unique in its participant.
std::string service_id(const Guid& guid) {
  std::string id;
  for (std::size_t i = 0; i < guid.size(); ++i) {
    char text[8];
    std::snprintf(text, sizeof text, i == 0 ? "%2x" : ".%x", guid[i]);
    id += text;
  }
  return id;
}

}  // namespace

base::Result<std::unique_ptr<Service>> Service::open(Participant& participant, Graph& graph, const NodeName& node, const std::string& name,
                                                     ServiceTypes types, OnRequest on_request) {
  auto service = std::unique_ptr<Service>(new Service(graph, node, std::move(on_request)));
  static std::uint32_t count = 0;
  Guid id = participant.guid();
  ++count;
  for (std::size_t i = 0; i < 4; ++i) id[12 + i] = static_cast<std::uint8_t>(count >> 8 * (3 - i));
  const std::string mark = "serviceid=" + service_id(id) + ";typehash=";
  auto replies = participant.make_writer({reply_on_wire(name), types.response, mark + types.response_hash + ";", false, 100});
  if (!replies) return replies.error();
  service->replies_ = std::move(*replies);
  service->replies_->separate_by_vendor();
  auto requests = participant.make_reader({request_on_wire(name), types.request, mark + types.request_hash + ";"},
                                          [self = service.get()](Received& request) { self->receive(request); });
  if (!requests) return requests.error();
  service->requests_ = std::move(*requests);
  graph.add_endpoint(node, service->replies_->guid(), service->replies_->settings(), true);
  graph.add_endpoint(node, service->requests_->guid(), service->requests_->settings(), false);
  return service;
}

Service::~Service() {
  *is_open_ = false;
  if (replies_) graph_.remove_endpoint(node_, replies_->guid());
  if (requests_) graph_.remove_endpoint(node_, requests_->guid());
}

void Service::receive(Received& request) {
  Client client;
  client.is_fast_dds = is_fast_dds(request.identity.writer);
  const Peer* from = graph_.peer(request.identity.writer);
  if (client.is_fast_dds) {
    client.identity = {request.related ? request.related->writer : request.identity.writer, request.identity.sequence};
    if (request.related) client.reply_reader = request.related->writer;
  } else {
    if (request.bytes.size() < head_size + number_size) {
      ++damaged_;
      return;
    }
    const auto number = request.bytes.begin() + head_size;
    client.call_number.assign(number, number + number_size);
    // What follows is aligned by 8, as if it began here.
    request.bytes.erase(number, number + number_size);
    if (request.bytes[1] == 0) {  // the reply is little-endian
      std::reverse(client.call_number.begin(), client.call_number.begin() + 8);
      std::reverse(client.call_number.begin() + 8, client.call_number.end());
    }
    if (from != nullptr) client.id = value_in(from->user_data, "clientid").value_or("");
  }
  const ClientHashes hashes{from == nullptr ? "" : value_in(from->user_data, "typehash").value_or(""),
                            reply_hash(client, request.identity.writer)};
  const auto answer = [this, client, is_open = is_open_](const std::vector<char>& message) {
    if (*is_open) reply(client, message);
  };
  if (!on_request_(request.bytes, hashes, answer)) ++damaged_;
}

std::string Service::reply_hash(const Client& client, const Guid& request_writer) const {
  const auto is_its = [&](const Peer& peer) {
    if (client.reply_reader != Guid{}) return peer.guid == client.reply_reader;
    if (!client.id.empty()) return value_in(peer.user_data, "clientid") == client.id;
    return std::equal(peer.guid.begin(), peer.guid.begin() + 12, request_writer.begin());  // of its participant
  };
  for (const Peer* peer : graph_.peers_of(replies_->settings().topic)) {
    if (!peer->is_writer && is_its(*peer)) return value_in(peer->user_data, "typehash").value_or("");
  }
  return "";
}

void Service::reply(const Client& client, const std::vector<char>& message) {
  if (is_matched(client) || waiting_.size() >= max_replies_waiting) return send(client, message);
  waiting_.push_back({client, message, std::chrono::steady_clock::now() + match_wait});
}

void Service::update(std::chrono::steady_clock::time_point now) {
  std::erase_if(waiting_, [&](const Waiting& one) {
    if (now < one.until && !is_matched(one.client)) return false;
    send(one.client, one.message);
    return true;
  });
}

bool Service::is_matched(const Client& client) const {
  return std::ranges::any_of(replies_->readers(), [&](const Guid& reader) {
    if (client.is_fast_dds && client.reply_reader != Guid{}) return reader == client.reply_reader;
    if (client.is_fast_dds) return is_fast_dds(reader);
    const Peer* peer = graph_.peer(reader);
    return client.id.empty() ? !is_fast_dds(reader) : peer != nullptr && value_in(peer->user_data, "clientid") == client.id;
  });
}

void Service::send(const Client& client, const std::vector<char>& message) {
  const std::size_t size = message.size() + client.call_number.size();
  const auto fill = [&](std::span<char> room) {
    std::memcpy(room.data(), message.data(), head_size);
    if (!client.call_number.empty()) std::memcpy(room.data() + head_size, client.call_number.data(), client.call_number.size());
    std::memcpy(room.data() + head_size + client.call_number.size(), message.data() + head_size, message.size() - head_size);
  };
  replies_->write(size, fill, client.is_fast_dds ? std::optional(client.identity) : std::nullopt);
}

}  // namespace ros2
