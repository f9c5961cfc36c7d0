// The connections of one InPort: what comes in over any transport waits here until it is read. Any thread; one reader at a time.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/guarded.h"
#include "corba/event_data.h"
#include "corba/transport.h"
#include "core/connector_settings.h"
#include "core/mailbox.h"
#include "rtm/idl/RTCStub.h"

namespace base {
class Clock;
}

namespace corba {

// What a port knows about a connection before it exists.
struct ConnectionPlan {
  std::string id;
  std::string name;
  rt::ConnectorSettings settings;
  std::shared_ptr<ConnectorEvents> events;
  std::shared_ptr<Codec> codec;              // null: CDR
  std::shared_ptr<Carrier> carrier;          // of foreign interfaces
  bool peer_says_when_empty = false;         // the OutPort of a pull connection does not hand out old samples again
  std::shared_ptr<const base::Clock> clock;  // of the port's component, for time stamps; null: the calling thread's

  // The time by the component's clock; of a call that a component makes, by the clock of the context that runs it.
  std::chrono::nanoseconds port_time() const;
  std::chrono::nanoseconds caller_time() const;
};

TypeOps with_codec(const TypeOps& ops, const std::shared_ptr<Codec>& codec);

// What waits in a connection to be read or sent. Any thread.
class Waiting {
 public:
  virtual ~Waiting() = default;
  virtual std::size_t unread() const = 0;
  virtual void drop_unread() = 0;
};

class InConnection final : public Receiver, public Waiting {
 public:
  InConnection(const TypeOps& ops, ConnectionPlan plan, std::shared_ptr<rt::Mailbox> mailbox);
  ~InConnection() override;

  const std::string& id() const { return plan_.id; }
  const std::string& name() const { return plan_.name; }
  const TypeOps& ops() const { return ops_; }
  rt::Channel channel() const { return channel_; }
  ConnectorEvents& events() const { return *plan_.events; }
  const std::shared_ptr<ConnectorEvents>& shared_events() const { return plan_.events; }
  const rt::ConnectorSettings& settings() const { return plan_.settings; }

  rt::PortStatus receive(rt::Sample sample) override;
  rt::BlockPool& pool() override { return *pool_; }

  // Pull connections: asks the peer and keeps what comes for the reader. `only_new`: not if it is what came last time.
  rt::PortStatus fetch(bool only_new);
  // Nothing is received any more; what was not read can still be read.
  void finish();
  std::size_t unread() const override { return mailbox_->unread(channel_); }
  void drop_unread() override { mailbox_->drop_unread(channel_); }

 private:
  friend class InEngine;

  const ConnectionPlan plan_;
  const TypeOps ops_;  // with the connection's codec
  const std::shared_ptr<rt::Mailbox> mailbox_;
  const rt::Channel channel_;
  const std::shared_ptr<rt::BlockPool> pool_ = rt::BlockPool::make();
  std::unique_ptr<Provider> provider_;  // push
  std::unique_ptr<Fetcher> fetcher_;    // pull
  std::shared_ptr<void> served_;        // push by a foreign interface
  base::Guarded<rt::Sample, base::Rank::connector> last_fetched_;
};

class InEngine {
 public:
  using Connections = std::vector<std::shared_ptr<InConnection>>;

  explicit InEngine(const TypeOps& ops);
  ~InEngine();

  const TypeOps& ops() const { return ops_; }
  // Push: makes the connection and adds the keys by which the OutPort finds it.
  rt::Refusal provide(ConnectionPlan plan, RTC::ConnectorProfile& profile);
  // Pull: makes the connection to the OutPort that the profile names.
  rt::Refusal consume(ConnectionPlan plan, const RTC::ConnectorProfile& profile);
  // Undoes either. False if there is no such connection. What has come and was not read yet is kept for the reader, though not more of it
  // than 64 samples of all closed connections.
  bool close(const std::string& id);
  std::shared_ptr<const Connections> connections() const;

  // Something unread is there (on the connections of that name). Asks the peers of pull connections. `lost`: ids of connections whose peer
  // is gone.
  bool has_new(const std::string& name, std::vector<std::string>& lost);
  // Decodes the next sample into `value`; ok, or why not. `value` changes only if ok.
  rt::PortStatus read(const std::string& name, void* value, std::vector<std::string>& lost);
  // Of the last read, in the order of connections().
  std::vector<rt::PortStatus> statuses() const;

 private:
  struct Lists {
    std::shared_ptr<const Connections> open;
    std::shared_ptr<const Connections> closed;  // that something unread has come over, oldest first
  };
  void add(std::shared_ptr<InConnection> connection);
  // Whose samples these are.
  std::shared_ptr<InConnection> find(const Lists& lists, rt::Channel channel) const;
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
