#include "port_domain.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <thread>
#include <utility>
#include <vector>

#include "base/guarded.h"
#include "base/log.h"
#include "node.h"
#include "parameters.h"

namespace ros2 {
namespace {

// Who receives from a topic, until it is closed.
class Sink {
 public:
  explicit Sink(OnBytes receiver) : receiver_(std::move(receiver)) {}
  void give(std::span<const std::uint8_t> bytes) {
    const auto mine = turn_.take(timeout);
    if (mine && !is_closed_) receiver_(bytes);
  }
  void close() {
    const auto mine = turn_.take(timeout);  // a running call of the receiver ends first
    if (!mine) base::log(base::Level::error, "ros2", "a receiver of a topic has not returned for 10 s");
    is_closed_ = true;
  }

 private:
  static constexpr std::chrono::seconds timeout{10};
  base::UsersTurn turn_;
  std::atomic<bool> is_closed_ = false;  // also set without the turn, when a receiver does not return
  const OnBytes receiver_;
};

class PortDomain {
 public:
  static base::Result<std::shared_ptr<PortDomain>> of(const PortDomainSettings& settings) {
    static base::Turn<base::Rank::callbacks> opening;
    const auto mine = opening.take();
    if (only()) return only();
    auto made = std::make_shared<PortDomain>();
    if (auto done = made->open(settings); !done) return done.error();
    only() = std::move(made);
    // Registered after the library has made its own objects, so it runs before these are destroyed.
    (void)std::atexit([] {
      only()->stop();
      only().reset();
    });
    return only();
  }

  PortDomain() = default;
  ~PortDomain() {
    stop();
    if (stop_ >= 0) ::close(stop_);
  }
  PortDomain(const PortDomain&) = delete;
  PortDomain& operator=(const PortDomain&) = delete;

  base::Result<std::unique_ptr<Writer>> add_writer(const EndpointSettings& topic) {
    const auto mine = turn_.take();
    auto writer = participant_->make_writer(topic);
    if (writer) graph_->add_endpoint(node_, (*writer)->guid(), topic, true);
    return writer;
  }
  // Of the topic as it is, or of all its writers.
  base::Result<std::vector<std::unique_ptr<Reader>>> add_readers(const EndpointSettings& topic, bool takes_all,
                                                                 const std::shared_ptr<Sink>& sink) {
    const auto mine = turn_.take();
    const auto on_sample = [this, sink](Received& received) { arrived_.emplace_back(sink, std::move(received.bytes)); };
    if (takes_all) return make_two_readers(*participant_, *graph_, node_, topic, on_sample);
    auto reader = participant_->make_reader(topic, on_sample);
    if (!reader) return reader.error();
    graph_->add_endpoint(node_, (*reader)->guid(), topic, false);
    std::vector<std::unique_ptr<Reader>> readers;
    readers.push_back(std::move(*reader));
    return readers;
  }
  template <class End>
  void remove(std::unique_ptr<End> end) {
    const auto mine = turn_.take();
    graph_->remove_endpoint(node_, end->guid());
    end.reset();
  }
  bool write(Writer& writer, std::span<const std::uint8_t> bytes) {
    const auto mine = turn_.take();
    return writer.write(bytes.size(), [&](std::span<char> room) { std::memcpy(room.data(), bytes.data(), bytes.size()); });
  }

 private:
  // Never destroyed: a topic that is still there at the end of the process may not find it gone.
  static std::shared_ptr<PortDomain>& only() {
    static auto& domain = *new std::shared_ptr<PortDomain>;
    return domain;
  }
  void stop() {
    const std::uint64_t one = 1;
    while (stop_ >= 0 && ::write(stop_, &one, sizeof one) < 0 && errno == EINTR) {
    }
    if (thread_.joinable()) thread_.join();
  }

  using Arrived = std::vector<std::pair<std::shared_ptr<Sink>, std::vector<std::uint8_t>>>;

  base::Result<void> open(const PortDomainSettings& settings) {
    node_ = settings.node;
    auto participant = Participant::open(settings.dds);
    if (!participant) return participant.error();
    participant_ = std::move(*participant);
    auto graph = Graph::open(*participant_, settings.family);
    if (!graph) return graph.error();
    graph_ = std::move(*graph);
    own_node_ = std::make_unique<Node>(*participant_, *graph_, node_);
    complete_node(*own_node_, {.is_sim_time = false});
    stop_ = ::eventfd(0, EFD_CLOEXEC);
    if (stop_ < 0) return base::Error{"cannot create an eventfd for the node of ROS 2: " + std::string(std::strerror(errno))};
    thread_ = std::thread([this] { loop(); });
    return {};
  }

  void loop() {
    constexpr int tend_period = 100;  // [ms]
    std::array<pollfd, 2> wanted{pollfd{participant_->descriptor(), POLLIN, 0}, pollfd{stop_, POLLIN, 0}};
    while (true) {
      ::poll(wanted.data(), wanted.size(), tend_period);
      if (wanted[1].revents != 0) return;
      for (auto& [sink, bytes] : take()) sink->give(bytes);
    }
  }
  Arrived take() {
    const auto mine = turn_.take();
    participant_->deliver();
    const auto now = std::chrono::steady_clock::now();
    graph_->update(now);
    own_node_->update(now);
    return std::exchange(arrived_, {});
  }

  base::Turn<base::Rank::worker> turn_;  // of the participant, the graph and their endpoints
  NodeName node_;
  std::unique_ptr<Participant> participant_;
  std::unique_ptr<Graph> graph_;
  std::unique_ptr<Node> own_node_;
  Arrived arrived_;
  int stop_ = -1;
  std::thread thread_;
};

class PortPublication final : public Publication {
 public:
  PortPublication(std::shared_ptr<PortDomain> domain, std::unique_ptr<Writer> writer)
      : domain_(std::move(domain)), writer_(std::move(writer)) {}
  ~PortPublication() override { domain_->remove(std::move(writer_)); }
  bool put(std::span<const std::uint8_t> bytes) override { return domain_->write(*writer_, bytes); }

 private:
  const std::shared_ptr<PortDomain> domain_;
  std::unique_ptr<Writer> writer_;
};

class PortSubscription final : public Subscription {
 public:
  PortSubscription(std::shared_ptr<PortDomain> domain, std::shared_ptr<Sink> sink, std::vector<std::unique_ptr<Reader>> readers)
      : domain_(std::move(domain)), readers_(std::move(readers)), sink_(std::move(sink)) {}
  ~PortSubscription() override {
    for (auto& reader : readers_) domain_->remove(std::move(reader));
    sink_->close();
  }

 private:
  const std::shared_ptr<PortDomain> domain_;
  std::vector<std::unique_ptr<Reader>> readers_;
  const std::shared_ptr<Sink> sink_;
};

}  // namespace

base::Result<std::unique_ptr<Publication>> publish_port(const PortDomainSettings& settings, const EndpointSettings& topic) {
  auto domain = PortDomain::of(settings);
  if (!domain) return domain.error();
  auto writer = (*domain)->add_writer(topic);
  if (!writer) return writer.error();
  return std::unique_ptr<Publication>(std::make_unique<PortPublication>(*domain, std::move(*writer)));
}

base::Result<std::unique_ptr<Subscription>> subscribe_port(const PortDomainSettings& settings, const EndpointSettings& topic,
                                                           bool takes_all, OnBytes receiver) {
  auto domain = PortDomain::of(settings);
  if (!domain) return domain.error();
  auto sink = std::make_shared<Sink>(std::move(receiver));
  auto readers = (*domain)->add_readers(topic, takes_all, sink);
  if (!readers) return readers.error();
  return std::unique_ptr<Subscription>(std::make_unique<PortSubscription>(*domain, std::move(sink), std::move(*readers)));
}

}  // namespace ros2
