// The connections of one OutPort: sends each written value to each connection by its transport, policy and pace. Any thread.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/guarded.h"
#include "corba/ports/data_port.h"
#include "corba/ports/in_engine.h"
#include "corba/ports/loss_handler.h"
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
  const std::string& port() const;
  // Of a write outside of all ticks, when the component is in lock step.
  void report_nondeterminism() const;
  const TypeOps& ops() const;
  ConnectorEvents& events() const;
  const std::shared_ptr<ConnectorEvents>& shared_events() const;
  const rt::ConnectorSettings& settings() const;

  // ok, error, buffer_full, buffer_timeout, send_full, send_timeout, connection_lost, unknown_error.
  rt::PortStatus write(Payload& payload);
  // write returns when the peer has answered: subscription flush to another process.
  bool waits_for_peer() const;
  // The next sample, encoded, for another process, which waits no longer than its calls may take; or as a value, for this process.
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
  rt::PortStatus take(rt::Sample& sample, std::chrono::nanoseconds most);

  const std::shared_ptr<Line> line_;
  std::unique_ptr<rt::Publisher> publisher_;  // push: new, periodic
  rt::Mailbox mailbox_;                       // pull
  rt::Channel channel_ = rt::Channel::any;
  std::unique_ptr<Provider> provider_;  // pull
  std::shared_ptr<void> served_;        // pull by a foreign interface
};

class OutEngine final : public DataPort {
 public:
  using Connections = std::vector<std::shared_ptr<OutConnection>>;

  // `lost` may be called on any thread until the engine dies.
  OutEngine(const TypeOps& ops, std::function<void(const std::string& id)> lost);
  ~OutEngine() override;

  const TypeOps& ops() const override { return ops_; }
  rt::Refusal provide(ConnectionPlan plan, RTC::ConnectorProfile& profile) override;
  rt::Refusal consume(ConnectionPlan plan, const RTC::ConnectorProfile& profile) override;
  bool close(const std::string& id) override;
  std::shared_ptr<const Connections> connections() const;
  std::vector<Connected> connected() const override;
  std::size_t count() const override { return connections()->size(); }
  std::vector<rt::PortStatus> statuses() const override;

  bool write(const void* value) override;
  void stop_telling() override { loss_->close(); }

  bool has_new(const std::string&, std::vector<std::string>&) override { return false; }
  bool wait_new(std::chrono::nanoseconds) override { return false; }
  rt::PortStatus read(const std::string&, void*, std::vector<std::string>&) override { return rt::PortStatus::precondition_not_met; }

 private:
  void add(std::shared_ptr<OutConnection> connection);

  const TypeOps& ops_;
  const std::shared_ptr<LossHandler> loss_;
  base::Guarded<std::shared_ptr<const Connections>, base::Rank::connector> connections_;
  base::Guarded<std::vector<rt::PortStatus>, base::Rank::connector> statuses_;
};

}  // namespace corba
