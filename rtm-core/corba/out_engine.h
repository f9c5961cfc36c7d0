// The connections of one OutPort: what is written goes to each of them by its own transport, policy and pace. Any thread.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/guarded.h"
#include "corba/in_engine.h"
#include "corba/loss_handler.h"
#include "corba/transport.h"
#include "core/connector_settings.h"
#include "core/mailbox.h"
#include "core/publisher.h"

namespace corba {

class OutConnection final : public Source, public Waiting {
 public:
  // Push.
  OutConnection(const TypeOps& ops, const ConnectionPlan& plan, std::unique_ptr<Sender> sender, std::shared_ptr<LossHandler> loss);
  // Pull.
  OutConnection(const TypeOps& ops, const ConnectionPlan& plan);
  ~OutConnection() override;

  const std::string& id() const;
  const TypeOps& ops() const;
  ConnectorEvents& events() const;
  const std::shared_ptr<ConnectorEvents>& shared_events() const;
  const rt::ConnectorSettings& settings() const;

  // ok, error, buffer_full, buffer_timeout, send_full, send_timeout, connection_lost, unknown_error.
  rt::PortStatus write(Payload& payload);
  // write returns when the peer has answered: subscription flush to another process.
  bool waits_for_peer() const;
  // The next sample, encoded; or as a value, for this process.
  rt::PortStatus give(rt::Sample& sample) override;
  rt::PortStatus give_value(rt::Sample& sample);
  // A subscription flush keeps nothing.
  std::size_t unread() const override;
  void drop_unread() override;
  void close();

 private:
  friend class OutEngine;
  struct Line;

  rt::PortStatus write_buffered(Payload& payload);
  rt::PortStatus take(rt::Sample& sample);

  const std::shared_ptr<Line> line_;
  std::unique_ptr<rt::Publisher> publisher_;  // push: new, periodic
  rt::Mailbox mailbox_;                       // pull
  rt::Channel channel_ = rt::Channel::any;
  std::unique_ptr<Provider> provider_;  // pull
  std::shared_ptr<void> served_;        // pull by a foreign interface
};

class OutEngine {
 public:
  using Connections = std::vector<std::shared_ptr<OutConnection>>;

  // `lost` may be called on any thread until the engine dies.
  OutEngine(const TypeOps& ops, std::function<void(const std::string& id)> lost);
  ~OutEngine();

  const TypeOps& ops() const { return ops_; }
  // Pull: makes the connection and adds the keys by which the InPort finds it.
  rt::Refusal provide(ConnectionPlan plan, RTC::ConnectorProfile& profile);
  // Push: makes the connection to the InPort that the profile names.
  rt::Refusal consume(ConnectionPlan plan, const RTC::ConnectorProfile& profile);
  bool close(const std::string& id);
  std::shared_ptr<const Connections> connections() const;
  // Nobody is told of a loss any more.
  void stop_telling() { loss_->close(); }

  // False if there is no connection or one has failed.
  bool write(const void* value);
  // Of the last write, in the order of connections().
  std::vector<rt::PortStatus> statuses() const;

 private:
  void add(std::shared_ptr<OutConnection> connection);

  const TypeOps& ops_;
  const std::shared_ptr<LossHandler> loss_;
  base::Guarded<std::shared_ptr<const Connections>, base::Rank::connector> connections_;
  base::Guarded<std::vector<rt::PortStatus>, base::Rank::connector> statuses_;
};

}  // namespace corba
