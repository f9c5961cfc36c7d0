// The connections of one InPort: samples of any transport wait here until they are read. Any thread; one reader at a time.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/guarded.h"
#include "corba/ports/data_port.h"
#include "corba/ports/sample_room.h"
#include "core/mailbox.h"
#include "rtm/idl/RTCStub.h"

namespace corba {

// "port LaserObstacleAvoid0:velocity"
std::string port_text(const ConnectionPlan& plan);
// "link1 (ID)"
std::string connection_text(const ConnectionPlan& plan);
Line line_of(const ConnectionPlan& plan);

TypeOps with_codec(const TypeOps& ops, const std::shared_ptr<Codec>& codec);

class InConnection final : public Receiver, public Waiting {
 public:
  InConnection(const TypeOps& ops, ConnectionPlan plan, std::shared_ptr<rt::Mailbox> mailbox);
  ~InConnection() override;

  const std::string& id() const { return plan_.id; }
  const std::string& name() const { return plan_.name; }
  const std::string& port() const { return plan_.port; }
  bool is_pull() const { return fetcher_ != nullptr; }
  const TypeOps& ops() const { return ops_; }
  rt::Channel channel() const { return channel_; }
  ConnectorEvents& events() const { return *plan_.events; }
  const std::shared_ptr<ConnectorEvents>& shared_events() const { return plan_.events; }
  const rt::ConnectorSettings& settings() const { return plan_.settings; }
  std::uint64_t epoch() const { return plan_.epoch(); }

  // From another process, which waits no longer than its calls may take.
  rt::PortStatus receive(rt::Sample sample) override;
  // From an OutPort of this process.
  rt::PortStatus receive_here(rt::Sample sample) { return keep(std::move(sample), plan_.phase_counter(), rt::Mailbox::as_set); }
  rt::BlockPool& pool() override { return *pool_; }

  // Pull connections: asks the peer and keeps what comes for the reader. `only_new`: not if it is what came last time.
  rt::PortStatus fetch(bool only_new);
  // Nothing is received any more; what was not read can still be read.
  void finish();
  // As the calling thread may see it (base/tick.h).
  std::size_t unread() const override;
  void drop_unread() override { mailbox_->drop_unread(channel_); }

 private:
  friend class InEngine;
  // Moment 0: can be read at once. A full buffer waits no longer than `most`.
  rt::PortStatus keep(rt::Sample sample, std::uint64_t phase_counter, std::chrono::nanoseconds most);

  const ConnectionPlan plan_;
  const std::string peer_;  // what the connection is called in messages
  const TypeOps ops_;       // with the connection's codec
  const std::shared_ptr<rt::Mailbox> mailbox_;
  const rt::Channel channel_;
  const std::shared_ptr<rt::BlockPool> pool_ = rt::BlockPool::make();
  std::unique_ptr<Provider> provider_;  // push
  std::unique_ptr<SampleRoom> room_;    // for what comes to it
  std::unique_ptr<Fetcher> fetcher_;    // pull
  std::shared_ptr<void> served_;        // push by a foreign interface
  base::Guarded<rt::Sample, base::Rank::connector> last_fetched_;
};

// What has come before the component's time began anew (a reset of the simulation) is thrown away before anything is read.
class InEngine final : public DataPort {
 public:
  using Connections = std::vector<std::shared_ptr<InConnection>>;

  explicit InEngine(const TypeOps& ops);
  ~InEngine() override;

  const TypeOps& ops() const override { return ops_; }
  rt::Refusal provide(ConnectionPlan plan, RTC::ConnectorProfile& profile) override;
  rt::Refusal consume(ConnectionPlan plan, const RTC::ConnectorProfile& profile) override;
  // What has come and was not read yet is kept for the reader, though not more of it than 64 samples of all closed connections.
  bool close(const std::string& id) override;
  std::shared_ptr<const Connections> connections() const;
  std::vector<Connected> connected() const override;
  std::size_t count() const override { return connections()->size(); }
  std::vector<rt::PortStatus> statuses() const override;

  bool has_new(const std::string& name, std::vector<std::string>& lost) override;
  bool wait_new(std::chrono::nanoseconds most) override { return mailbox_->wait_unread(most); }
  rt::PortStatus read(const std::string& name, void* value, std::vector<std::string>& lost) override;

  bool write(const void*) override { return false; }
  void stop_telling() override {}

 private:
  struct Lists {
    std::shared_ptr<const Connections> open;
    std::shared_ptr<const Connections> closed;  // that something unread has come over, oldest first
  };
  void add(std::shared_ptr<InConnection> connection);
  // Whose samples these are.
  std::shared_ptr<InConnection> find(const Lists& lists, rt::Channel channel) const;
  void drop_past(const Lists& lists);
  // Lets go of closed connections that have been read, and of the oldest if too much is unread.
  void tidy();
  rt::PortStatus deliver(const rt::Sample& sample, InConnection& connection, void* value);
  void note(const Connections& all, const InConnection* read, rt::PortStatus status);

  const TypeOps& ops_;
  const std::shared_ptr<rt::Mailbox> mailbox_ = std::make_shared<rt::Mailbox>();
  base::Guarded<Lists, base::Rank::connector> lists_;
  base::Guarded<std::vector<rt::PortStatus>, base::Rank::connector> statuses_;
};

}  // namespace corba
