#include "node.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "base/log.h"

namespace ros2 {

Node::Node(Participant& participant, Graph& graph, NodeName name) : participant_(participant), graph_(graph), name_(std::move(name)) {
  graph_.add_node(name_);
}

Node::~Node() {
  for (const auto& writer : writers_) graph_.remove_endpoint(name_, writer->guid());
  for (const auto& reader : readers_) graph_.remove_endpoint(name_, reader->guid());
  services_.clear();
  graph_.remove_node(name_);
}

Writer* Node::add_writer(EndpointSettings settings, std::function<void()> on_match) {
  auto writer = participant_.make_writer(std::move(settings), std::move(on_match));
  if (!writer) {
    base::log(base::Level::error, participant_.settings().log_name, "{}", writer.error().message);
    return nullptr;
  }
  graph_.add_endpoint(name_, (*writer)->guid(), (*writer)->settings(), true);
  writers_.push_back(std::move(*writer));
  return writers_.back().get();
}

void Node::add_readers(EndpointSettings settings, const std::function<void(const Received&)>& take) {
  auto readers = make_two_readers(participant_, graph_, name_, std::move(settings), [take](Received& received) { take(received); });
  if (!readers) return base::log(base::Level::error, participant_.settings().log_name, "{}", readers.error().message);
  std::ranges::move(*readers, std::back_inserter(readers_));
}

void Node::add_service(const std::string& name, ServiceTypes types, OnRequest on_request) {
  auto service = Service::open(participant_, graph_, name_, name, std::move(types), std::move(on_request));
  if (!service) {
    base::log(base::Level::error, participant_.settings().log_name, "{}", service.error().message);
    return;
  }
  services_.push_back(std::move(*service));
}

void Node::update(std::chrono::steady_clock::time_point now) {
  for (const auto& service : services_) service->update(now);
}

std::uint64_t Node::damaged() const {
  std::uint64_t count = damaged_;
  for (const auto& service : services_) count += service->damaged();
  return count;
}

}  // namespace ros2
