#include "corba/ports/out_engine.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "base/clock.h"
#include "base/log.h"
#include "base/nondeterminism.h"
#include "base/tick.h"
#include "corba/members/member_watch.h"
#include "corba/orb/nv_list.h"
#include "corba/ports/connector_keys.h"
#include "corba/ports/local_connections.h"
#include "core/fault.h"

namespace corba {
namespace {

// Hands values to an InPort of this process.
class DirectSender final : public Sender {
 public:
  explicit DirectSender(std::shared_ptr<InConnection> receiver) : receiver_(std::move(receiver)) {}
  rt::PortStatus send(Payload& payload) override {
    switch (const rt::PortStatus status = receiver_->receive_here(payload.copied())) {
      case rt::PortStatus::buffer_full:
        return rt::PortStatus::send_full;
      case rt::PortStatus::buffer_timeout:
        return rt::PortStatus::send_timeout;
      default:
        return status;
    }
  }

 private:
  std::shared_ptr<InConnection> receiver_;
};

// A connection that loses, delays, doubles or mixes up what it is to send, because its profile asks for it.
class FaultySender final : public Sender {
 public:
  FaultySender(const ConnectionPlan& plan, std::unique_ptr<Sender> sender, std::vector<rt::Fault> faults)
      : plan_(plan), sender_(std::move(sender)), link_(std::move(faults)) {}

  // What is dropped counts as sent.
  rt::PortStatus send(Payload& payload) override {
    const bool is_direct = plan_.settings.interface == rt::Interface::direct;
    rt::Sample sample = is_direct ? payload.copied() : payload.encoded(plan_.settings.order, *pool_);
    sample.epoch = plan_.epoch();
    auto status = rt::PortStatus::ok;
    for (rt::Sample& passed : link_.pass(std::move(sample), plan_.caller_time())) {
      if (passed.epoch != plan_.epoch()) continue;  // from before a reset
      Payload own(payload.ops(), std::move(passed));
      status = sender_->send(own);
    }
    return status;
  }

 private:
  const ConnectionPlan plan_;
  const std::unique_ptr<Sender> sender_;
  const std::shared_ptr<rt::BlockPool> pool_ = rt::BlockPool::make();
  rt::FaultyLink link_;
};

// What is written when the payload itself has to be changed on the way.
class Changed {
 public:
  Payload& now() { return *payload_; }
  explicit Changed(Payload& original) : payload_(&original) {}

  void replace(rt::Sample sample) {
    const TypeOps& ops = payload_->ops();
    payload_ = &replacement_.emplace(ops, std::move(sample));
  }
  void stamp(std::chrono::nanoseconds time) {
    const TypeOps& ops = payload_->ops();
    const void* value = payload_->value();
    if (!ops.stamp || !value) return;
    rt::Sample sample;
    auto copy = ops.copy(value);
    corba::stamp(ops, copy.get(), time);
    sample.value = std::move(copy);
    replace(std::move(sample));
  }

 private:
  Payload* payload_;
  std::optional<Payload> replacement_;
};

// Lets listeners see, and change, what goes out. Nothing is copied for those that only want to know that it does.
void tell(ConnectorEvents& events, DataEvent event, Changed& payload, rt::ByteOrder order, rt::BlockPool& pool) {
  if (!events.is_observed(event)) return;
  try {
    EventData data(payload.now(), order, pool);
    events.on_data(event, data);
    if (data.is_changed()) payload.replace(data.sample());
  } catch (const CORBA::Exception&) {
    // It cannot be encoded; the sender says so.
  }
}

// What was written in a tick is part of what the run did.
void tell_tick(Payload& payload, const OutConnection& connection) {
  base::Tick* tick = base::current_tick();
  const std::string& port = connection.port();
  if (!tick) return connection.report_nondeterminism();
  if (!tick->keeps_data()) return;
  try {
    std::optional<std::uint64_t> hash;
    tick->passed({true, port, payload.ops().type_id, payload.pieces(rt::ByteOrder::little).parts, &hash});
    payload.set_hash(hash);
  } catch (const CORBA::Exception&) {
    // It cannot be encoded; who sends it says so.
  }
}

}  // namespace

// What a publisher's thread may still use after the connection has been closed.
struct OutConnection::Line {
  const TypeOps ops;  // with the connection's codec
  const ConnectionPlan plan;
  const std::unique_ptr<Sender> sender;
  const std::shared_ptr<LossHandler> loss;
  const std::shared_ptr<rt::BlockPool> pool = rt::BlockPool::make();
  const std::string peer = connection_text(plan);

  bool is_direct() const { return plan.settings.interface == rt::Interface::direct; }
  rt::ByteOrder order() const { return plan.settings.order; }

  void tell(DataEvent event, Changed& payload) { corba::tell(*plan.events, event, payload, order(), *pool); }

  rt::Sample keep(Payload& payload) {
    rt::Sample sample = is_direct() ? payload.copied() : payload.encoded(order(), *pool);
    sample.epoch = plan.epoch();
    sample.phase_counter = plan.phase_counter();
    return sample;
  }

  // While time waits for it, whoever waits for the peer is told of.
  rt::PortStatus send_watched(Payload& payload) {
    const auto watch = !is_direct() && base::tick_in_lock_step() ? port_watch() : nullptr;
    if (!watch) return sender->send(payload);
    const MemberWatch::Call call(*watch, plan.port, "put", &peer);
    return sender->send(payload);
  }

  rt::PortStatus send(Payload& payload, bool is_flush) {
    Changed changed(payload);
    if (plan.settings.stamp == rt::StampPolicy::on_send || (is_flush && plan.settings.stamp == rt::StampPolicy::on_write)) {
      changed.stamp(plan.caller_time());
    }
    tell(DataEvent::send, changed);
    const rt::PortStatus status = send_watched(changed.now());
    switch (status) {
      case rt::PortStatus::ok:
        tell(DataEvent::received, changed);
        break;
      case rt::PortStatus::send_full:
        tell(DataEvent::receiver_full, changed);
        break;
      case rt::PortStatus::send_timeout:
        tell(DataEvent::receiver_timeout, changed);
        break;
      default:
        tell(DataEvent::receiver_error, changed);
        break;
    }
    return status;
  }
};

OutConnection::OutConnection(const TypeOps& ops, const ConnectionPlan& plan, std::unique_ptr<Sender> sender,
                             std::shared_ptr<LossHandler> loss)
    : line_(std::make_shared<Line>(with_codec(ops, plan.codec), plan, std::move(sender), std::move(loss))) {
  const auto& settings = line_->plan.settings;
  if (settings.subscription == rt::Subscription::flush) return;
  rt::Publisher::Hooks hooks;
  hooks.send = [line = line_](const rt::Sample& sample) {
    if (sample.epoch != line->plan.epoch()) return rt::PortStatus::ok;  // from before a reset; nobody is to hear of it any more
    Payload payload(line->ops, sample);
    Changed changed(payload);
    line->tell(DataEvent::buffer_read, changed);
    return line->send(changed.now(), false);
  };
  hooks.starved = [line = line_] {
    line->plan.events->on_event(ConnectorEvent::buffer_empty);
    line->plan.events->on_event(ConnectorEvent::sender_empty);
  };
  hooks.lost = [line = line_] { line->loss->lost(line->plan.id); };
  publisher_ = std::make_unique<rt::Publisher>(settings.subscription, settings.publisher, settings.buffer, std::move(hooks));
}

OutConnection::OutConnection(const TypeOps& ops, const ConnectionPlan& plan)
    : line_(std::make_shared<Line>(with_codec(ops, plan.codec), plan, nullptr, nullptr)),
      channel_(mailbox_.open(line_->plan.settings.buffer)) {}

OutConnection::~OutConnection() { close(); }

const std::string& OutConnection::id() const { return line_->plan.id; }
const std::string& OutConnection::port() const { return line_->plan.port; }
void OutConnection::report_nondeterminism() const {
  if (line_->plan.phase_counter() != 0)
    base::report_nondeterminism(port_text(line_->plan), "was written by a thread that no tick runs", line_->plan.port_time());
}
const TypeOps& OutConnection::ops() const { return line_->ops; }
ConnectorEvents& OutConnection::events() const { return *line_->plan.events; }
const std::shared_ptr<ConnectorEvents>& OutConnection::shared_events() const { return line_->plan.events; }
const rt::ConnectorSettings& OutConnection::settings() const { return line_->plan.settings; }

void OutConnection::close() {
  if (publisher_) publisher_->stop();
  mailbox_.close(channel_);
}

std::size_t OutConnection::unread() const { return publisher_ ? publisher_->waiting() : line_->sender ? 0 : mailbox_.unread(channel_); }

void OutConnection::drop_unread() {
  if (publisher_) publisher_->drop_waiting();
  if (!line_->sender) mailbox_.drop_unread(channel_);
}

bool OutConnection::waits_for_peer() const { return line_->sender && !publisher_ && !line_->is_direct(); }

rt::PortStatus OutConnection::write(Payload& shared) {
  const auto write_it = [this](Payload& payload) {
    return line_->sender && !publisher_ ? line_->send(payload, true) : write_buffered(payload);
  };
  const void* value = line_->ops.codec ? shared.value() : nullptr;
  if (!value) return write_it(shared);
  Payload own(line_->ops, value);
  return write_it(own);
}

rt::PortStatus OutConnection::write_buffered(Payload& payload) {
  Changed changed(payload);
  if (line_->plan.settings.stamp == rt::StampPolicy::on_write) changed.stamp(line_->plan.caller_time());
  line_->tell(DataEvent::buffer_write, changed);
  rt::WriteResult result;
  try {
    rt::Sample sample = line_->keep(changed.now());
    result = publisher_ ? publisher_->write(std::move(sample), base::tick_in_lock_step()) : mailbox_.write(channel_, std::move(sample));
  } catch (const CORBA::Exception& e) {
    base::log(base::Level::error, "data port", "a {} cannot be encoded: {}", line_->ops.type_id, e._name());
    return rt::PortStatus::error;
  }
  if (result.overwrote) line_->tell(DataEvent::buffer_overwrite, changed);
  if (result.status == rt::PortStatus::buffer_full) line_->tell(DataEvent::buffer_full, changed);
  if (result.status == rt::PortStatus::buffer_timeout) line_->tell(DataEvent::buffer_write_timeout, changed);
  return result.status;
}

rt::PortStatus OutConnection::take(rt::Sample& sample, std::chrono::nanoseconds most) try {
  ConnectorEvents& events = *line_->plan.events;
  if (const std::uint64_t epoch = line_->plan.epoch(); epoch > 0) mailbox_.drop_other_epochs(epoch);
  rt::ReadResult result = mailbox_.read(channel_, line_->plan.phase_counter(), most);
  switch (result.status) {
    case rt::PortStatus::ok:
      break;
    case rt::PortStatus::buffer_empty:
      events.on_event(ConnectorEvent::buffer_empty);
      events.on_event(ConnectorEvent::sender_empty);
      return result.status;
    case rt::PortStatus::buffer_timeout:
      events.on_event(ConnectorEvent::buffer_read_timeout);
      events.on_event(ConnectorEvent::sender_timeout);
      return result.status;
    default:
      events.on_event(ConnectorEvent::sender_error);
      return rt::PortStatus::error;
  }
  Payload payload(line_->ops, result.sample);
  Changed changed(payload);
  if (line_->plan.settings.stamp == rt::StampPolicy::on_send) changed.stamp(line_->plan.port_time());
  line_->tell(DataEvent::buffer_read, changed);
  line_->tell(DataEvent::send, changed);
  sample = line_->keep(changed.now());
  return rt::PortStatus::ok;
} catch (const CORBA::Exception&) {
  return rt::PortStatus::error;
}

rt::PortStatus OutConnection::give(rt::Sample& sample) { return take(sample, line_of(settings()).call_timeout); }

rt::PortStatus OutConnection::give_value(rt::Sample& sample) { return take(sample, rt::Mailbox::as_set); }

OutEngine::OutEngine(const TypeOps& ops, std::function<void(const std::string& id)> lost)
    : ops_(ops), loss_(std::make_shared<LossHandler>(std::move(lost))), connections_(std::make_shared<const Connections>()) {}

OutEngine::~OutEngine() {
  loss_->close();
  const auto all = connections();
  for (const auto& connection : *all) close(connection->id());
}

std::shared_ptr<const OutEngine::Connections> OutEngine::connections() const { return connections_.snapshot(); }

std::vector<DataPort::Connected> OutEngine::connected() const {
  std::vector<Connected> all;
  const auto open = connections();
  for (const auto& connection : *open) all.push_back({connection->shared_events(), connection});
  return all;
}

std::unique_ptr<DataPort> make_out_port(const TypeOps& ops, std::function<void(const std::string& id)> lost) {
  return std::make_unique<OutEngine>(ops, std::move(lost));
}

void OutEngine::add(std::shared_ptr<OutConnection> connection) {
  auto connections = connections_.lock();
  auto more = std::make_shared<Connections>(**connections);
  more->push_back(std::move(connection));
  *connections = std::move(more);
}

rt::Refusal OutEngine::provide(ConnectionPlan plan, RTC::ConnectorProfile& profile) {
  const auto settings = plan.settings;
  const std::string id = plan.id;
  auto connection = std::make_shared<OutConnection>(ops_, plan);
  const corba::Line line = line_of(plan);
  switch (settings.interface) {
    case rt::Interface::corba_cdr:
    case rt::Interface::data_service:
      connection->provider_ = make_cdr_out_provider(settings.interface, connection, line);
      break;
    case rt::Interface::shared_memory:
      connection->provider_ = make_shared_memory_out_provider(connection, line);
      break;
    case rt::Interface::direct:
      add_local(id, connection);
      break;
    case rt::Interface::foreign:
      connection->served_ = plan.carrier->serve(std::weak_ptr<Source>(connection), profile);
      if (!connection->served_)
        return {rt::ReturnCode::error,
                "the OutPort's end of interface_type " + settings.foreign_interface + " cannot be made, or rejects the connection"};
      break;
  }
  if (connection->provider_) publish_reference(profile, settings.interface, rt::Side::out, *connection->provider_);
  add(connection);
  return {};
}

rt::Refusal OutEngine::consume(ConnectionPlan plan, const RTC::ConnectorProfile& profile) {
  const auto settings = plan.settings;
  const corba::Line line = line_of(plan);
  std::unique_ptr<Sender> sender;
  if (settings.interface == rt::Interface::direct) {
    auto receiver = find_local_in(plan.id);
    if (!receiver) return {rt::ReturnCode::error, "interface_type direct: the InPort is not in this process"};
    if (*receiver->ops().type != *ops_.type) return {rt::ReturnCode::bad_parameter, "the InPort takes " + receiver->ops().type_id};
    sender = std::make_unique<DirectSender>(std::move(receiver));
  } else if (settings.interface == rt::Interface::foreign) {
    sender = plan.carrier->make_sender(profile);
    if (!sender)
      return {rt::ReturnCode::error,
              "the OutPort's end of interface_type " + settings.foreign_interface + " cannot be made, or rejects the connection"};
  } else {
    const CORBA::Object_var object = published_reference(profile, settings.interface, rt::Side::in);
    sender = settings.interface == rt::Interface::shared_memory ? make_shared_memory_sender(object, line)
                                                                : make_cdr_sender(settings.interface, object, line);
    if (!sender) return {rt::ReturnCode::error, "the InPort gives no object of its interface_type to send to"};
  }
  if (const auto text = find_text(profile.properties, "dataport.fault"); text && !text->empty()) {
    auto faults = rt::parse_faults(*text);
    if (!faults) return {rt::ReturnCode::bad_parameter, "dataport.fault: " + faults.error().message};
    sender = std::make_unique<FaultySender>(plan, std::move(sender), std::move(*faults));
  }
  auto connection = std::make_shared<OutConnection>(ops_, plan, std::move(sender), loss_);
  add(connection);
  return {};
}

bool OutEngine::close(const std::string& id) {
  std::shared_ptr<OutConnection> closed;
  {
    auto connections = connections_.lock();
    const auto it = std::ranges::find(**connections, id, [](const auto& connection) { return connection->id(); });
    if (it == (*connections)->end()) return false;
    closed = *it;
    auto fewer = std::make_shared<Connections>(**connections);
    std::erase(*fewer, closed);
    *connections = std::move(fewer);
  }
  if (closed->settings().interface == rt::Interface::direct) remove_local_out(id);
  closed->provider_.reset();  // the servant holds the connection
  closed->served_.reset();
  closed->close();
  closed->events().on_event(ConnectorEvent::disconnect);
  return true;
}

bool OutEngine::write(const void* value) {
  const auto all = connections();
  if (all->empty()) {
    statuses_.lock()->clear();
    return false;
  }
  Payload payload(ops_, value);
  // Whether a tool looks on makes no difference to what a run has done.
  const auto member = std::ranges::find_if(*all, [](const auto& connection) { return !connection->settings().is_of_tool; });
  if (member != all->end()) tell_tick(payload, **member);
  bool is_ok = true;
  statuses_.lock()->assign(all->size(), rt::PortStatus::ok);
  const auto write_to = [&](std::size_t i) {
    const rt::PortStatus status = (*all)[i]->write(payload);
    is_ok &= status == rt::PortStatus::ok;
    {
      auto statuses = statuses_.lock();
      if (i < statuses->size()) (*statuses)[i] = status;
    }
    if (status == rt::PortStatus::connection_lost) loss_->lost((*all)[i]->id());
  };
  // Those that wait for their peer come last, so that a peer that hangs keeps no sample from the others.
  for (std::size_t i = 0; i < all->size(); ++i) {
    if (!(*all)[i]->waits_for_peer()) write_to(i);
  }
  for (std::size_t i = 0; i < all->size(); ++i) {
    if ((*all)[i]->waits_for_peer()) write_to(i);
  }
  return is_ok;
}

std::vector<rt::PortStatus> OutEngine::statuses() const { return statuses_.snapshot(); }

}  // namespace corba
