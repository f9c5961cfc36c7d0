#include "corba/ports/in_engine.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "base/clock.h"
#include "base/log.h"
#include "base/nondeterminism.h"
#include "base/text.h"
#include "base/tick.h"
#include "corba/members/member_watch.h"
#include "corba/orb/object_names.h"
#include "corba/ports/connector_keys.h"
#include "corba/ports/local_connections.h"
#include "corba/ports/out_engine.h"
#include "corba/transport/cdr.h"
#include "corba/transport/payload.h"

namespace corba {
namespace {

// Hands over values of an OutPort of this process.
class DirectFetcher final : public Fetcher {
 public:
  explicit DirectFetcher(std::shared_ptr<OutConnection> source) : source_(std::move(source)) {}
  rt::PortStatus fetch(rt::Sample& sample) override {
    const rt::PortStatus status = source_->give_value(sample);
    return status == rt::PortStatus::buffer_timeout ? rt::PortStatus::recv_timeout : status;
  }

 private:
  std::shared_ptr<OutConnection> source_;
};

constexpr std::size_t max_unread_of_closed = 64;

bool is_same_sample(const rt::Sample& a, const rt::Sample& b) {
  if (a.value || b.value) return a.value == b.value;
  return a.block && b.block && std::ranges::equal(a.block->octets(), b.block->octets());
}

std::uint64_t phase_counter_of_reader() {
  const base::Tick* tick = base::current_tick();
  return tick ? tick->phase_counter() : 0;
}

// [octets] of a message with a sample: without end for types that are, as pictures, as long as their user likes.
std::size_t room_of(const TypeOps& ops) {
  constexpr std::uint64_t around_it = 64 * 1024;  // the head of the message
  const auto most = ops.codec ? std::nullopt : ops.shape.max_octets();
  return static_cast<std::size_t>(most ? *most + around_it : std::numeric_limits<std::size_t>::max());
}

// What was read in a tick is part of what the run did.
base::Tick* tick_that_keeps() {
  base::Tick* tick = base::current_tick();
  return tick && tick->keeps_data() ? tick : nullptr;
}

base::Passage passage_into(const InConnection& connection) { return {false, connection.port(), connection.ops().type_id, {}}; }

template <class Read>
void tell_of_value(base::Tick& tick, const Read& read, const InConnection& connection) {
  try {
    Payload payload(connection.ops(), read);
    base::Passage passage = passage_into(connection);
    passage.octets = payload.pieces(rt::ByteOrder::little).parts;
    tick.passed(passage);
  } catch (const CORBA::Exception&) {
    // It cannot be encoded, so nobody has sent it to another process either.
  }
}

// A copy, as others may have the block, too.
std::shared_ptr<const rt::Block> without_leftovers(const Shape& shape, const rt::Block& block, rt::ByteOrder order) {
  auto clean = std::make_shared<rt::Block>(block.size());
  clean->set_size(block.size());
  std::ranges::copy(block.octets(), clean->data());
  shape.clear_leftovers({clean->data(), clean->size()}, order);
  return clean;
}

void tell_tick(const rt::Sample& sample, const InConnection& connection) {
  base::Tick* tick = tick_that_keeps();
  if (!tick) return;
  base::Passage passage = passage_into(connection);
  if (sample.hash && !connection.ops().codec && tick->passed_again(passage, *sample.hash)) return;
  if (!sample.block) return tell_of_value(*tick, sample, connection);
  const auto octets = sample.block->octets();
  passage.octets = {&octets, 1};
  tick->passed(passage);
}

void tell_tick(const void* value, const InConnection& connection) {
  if (base::Tick* tick = tick_that_keeps()) tell_of_value(*tick, value, connection);
}

}  // namespace

std::chrono::nanoseconds ConnectionPlan::port_time() const { return (clock ? *clock : base::current_clock()).now(); }

std::chrono::nanoseconds ConnectionPlan::caller_time() const {
  return (clock ? base::current_clock_or(*clock) : base::current_clock()).now();
}

std::uint64_t ConnectionPlan::epoch() const { return clock ? clock->epoch() : 0; }

std::uint64_t ConnectionPlan::phase_counter() const { return clock ? clock->phase_counter() : 0; }

std::string port_text(const ConnectionPlan& plan) { return port_text(plan.port); }
std::string connection_text(const ConnectionPlan& plan) { return plan.name + " (" + plan.id + ")"; }

Line line_of(const ConnectionPlan& plan) {
  Line line = line_of(plan.settings);
  line.port = plan.port;
  line.connection = connection_text(plan);
  line.connector_id = plan.id;
  return line;
}

TypeOps with_codec(const TypeOps& ops, const std::shared_ptr<Codec>& codec) {
  TypeOps own = ops;
  own.codec = codec;
  return own;
}

InConnection::InConnection(const TypeOps& ops, ConnectionPlan plan, std::shared_ptr<rt::Mailbox> mailbox)
    : plan_(std::move(plan)),
      peer_(connection_text(plan_)),
      ops_(with_codec(ops, plan_.codec)),
      mailbox_(std::move(mailbox)),
      channel_(mailbox_->open(plan_.settings.buffer, plan_.name + " " + plan_.id)) {
  if (plan_.settings.is_rendezvous) mailbox_->set_rendezvous(channel_, true);
}

InConnection::~InConnection() { mailbox_->close(channel_); }

void InConnection::finish() { mailbox_->finish(channel_); }

std::size_t InConnection::unread() const { return mailbox_->unread(channel_, phase_counter_of_reader()); }

rt::PortStatus InConnection::receive(rt::Sample sample) {
  return keep(std::move(sample), plan_.phase_counter(), line_of(plan_.settings).call_timeout);
}

rt::PortStatus InConnection::keep(rt::Sample sample, std::uint64_t phase_counter, std::chrono::nanoseconds most) {
  bool has_leftovers = false;
  if (sample.block && !ops_.codec && !ops_.shape.fits(sample.block->octets(), sample.order, &has_leftovers)) {
    base::log(base::Level::warn, "data port", "connection {}: {} bytes rejected: not a valid {}", base::in_quotes(plan_.name),
              sample.block->size(), ops_.type_id);
    return rt::PortStatus::error;
  }
  if (has_leftovers) sample.block = without_leftovers(ops_.shape, *sample.block, sample.order);
  if (plan_.settings.stamp == rt::StampPolicy::on_received) sample.received = plan_.port_time();
  const std::uint64_t epoch = plan_.epoch();
  ConnectorEvents& events = *plan_.events;
  if (events.is_observed(DataEvent::received)) {
    EventData data(ops_, sample);
    events.on_data(DataEvent::received, data);
    if (data.is_changed()) {
      const auto received = sample.received;
      sample = data.sample();
      sample.received = received;
    }
  }
  const auto tell = [&](DataEvent event, const rt::Sample& about) {
    if (!events.is_observed(event)) return;
    EventData data(ops_, about);
    events.on_data(event, data);
  };
  // A copy shares the octets; it is needed only for those who listen.
  const bool is_observed =
      std::ranges::any_of(std::initializer_list<DataEvent>{DataEvent::buffer_write, DataEvent::buffer_overwrite, DataEvent::buffer_full,
                                                           DataEvent::buffer_write_timeout, DataEvent::receiver_full,
                                                           DataEvent::receiver_timeout, DataEvent::receiver_error},
                          [&](DataEvent event) { return events.is_observed(event); });
  const rt::Sample about = is_observed ? sample : rt::Sample{};
  sample.epoch = epoch;
  sample.phase_counter = phase_counter;
  if (phase_counter != 0 && !base::is_in_phase(phase_counter) && !base::current_tick())
    base::report_nondeterminism(port_text(plan_), "got a sample between two ticks", plan_.port_time());
  const rt::WriteResult result = mailbox_->write(channel_, std::move(sample), most);
  if (!is_observed) return result.status == rt::PortStatus::precondition_not_met ? rt::PortStatus::error : result.status;
  switch (result.status) {
    case rt::PortStatus::ok:
      if (result.overwrote) tell(DataEvent::buffer_overwrite, about);
      tell(DataEvent::buffer_write, about);
      return result.status;
    case rt::PortStatus::buffer_full:
      tell(DataEvent::buffer_full, about);
      tell(DataEvent::receiver_full, about);
      return result.status;
    case rt::PortStatus::buffer_timeout:
      tell(DataEvent::buffer_write_timeout, about);
      tell(DataEvent::receiver_timeout, about);
      return result.status;
    default:
      tell(DataEvent::receiver_error, about);
      return rt::PortStatus::error;
  }
}

rt::PortStatus InConnection::fetch(bool only_new) {
  if (!fetcher_) return rt::PortStatus::ok;
  rt::Sample sample;
  const bool is_watched = plan_.settings.interface != rt::Interface::direct && base::tick_in_lock_step();
  const auto watch = is_watched ? port_watch() : nullptr;
  std::optional<MemberWatch::Call> call;
  if (watch) call.emplace(*watch, plan_.port, "get", &peer_);
  const rt::PortStatus status = fetcher_->fetch(sample);
  call.reset();
  switch (status) {
    case rt::PortStatus::ok:
      break;
    case rt::PortStatus::buffer_empty:
      plan_.events->on_event(ConnectorEvent::sender_empty);
      return status;
    case rt::PortStatus::recv_timeout:
      plan_.events->on_event(ConnectorEvent::sender_timeout);
      return status;
    default:
      plan_.events->on_event(ConnectorEvent::sender_error);
      return status;
  }
  if (only_new && !plan_.peer_says_when_empty && is_same_sample(sample, *last_fetched_.lock())) return rt::PortStatus::buffer_empty;
  *last_fetched_.lock() = sample;
  return keep(std::move(sample), 0, rt::Mailbox::as_set);  // the peer has kept the rule of delivery
}

InEngine::InEngine(const TypeOps& ops)
    : ops_(ops), lists_(Lists{std::make_shared<const Connections>(), std::make_shared<const Connections>()}) {}

InEngine::~InEngine() {
  const auto all = connections();
  for (const auto& connection : *all) close(connection->id());
}

std::shared_ptr<const InEngine::Connections> InEngine::connections() const { return lists_.lock()->open; }

std::vector<DataPort::Connected> InEngine::connected() const {
  std::vector<Connected> all;
  const auto open = connections();
  for (const auto& connection : *open) all.push_back({connection->shared_events(), connection});
  return all;
}

std::unique_ptr<DataPort> make_in_port(const TypeOps& ops) { return std::make_unique<InEngine>(ops); }

void InEngine::add(std::shared_ptr<InConnection> connection) {
  auto lists = lists_.lock();
  auto more = std::make_shared<Connections>(*lists->open);
  more->push_back(std::move(connection));
  lists->open = std::move(more);
}

void InEngine::tidy() {
  std::shared_ptr<const Connections> before;  // let go without the lock: samples may be large
  auto lists = lists_.lock();
  if (lists->closed->empty()) return;
  auto kept = std::make_shared<Connections>();
  std::size_t unread = 0;
  for (auto it = lists->closed->rbegin(); it != lists->closed->rend(); ++it) {
    const std::size_t count = (*it)->unread();
    unread += count;
    if (count > 0 && unread <= max_unread_of_closed) kept->insert(kept->begin(), *it);
  }
  before = std::exchange(lists->closed, std::move(kept));
}

std::shared_ptr<InConnection> InEngine::find(const Lists& lists, rt::Channel channel) const {
  for (const auto& list : {lists.open, lists.closed}) {
    const auto it = std::ranges::find(*list, channel, [](const auto& connection) { return connection->channel(); });
    if (it != list->end()) return *it;
  }
  return nullptr;
}

rt::Refusal InEngine::provide(ConnectionPlan plan, RTC::ConnectorProfile& profile) {
  const auto settings = plan.settings;
  const std::string id = plan.id;
  auto connection = std::make_shared<InConnection>(ops_, std::move(plan), mailbox_);
  const Line line = line_of(connection->plan_);
  switch (settings.interface) {
    case rt::Interface::corba_cdr:
    case rt::Interface::data_service:
      connection->provider_ = make_cdr_in_provider(settings.interface, connection, line);
      connection->room_ = std::make_unique<SampleRoom>(connection->provider_->reference(), room_of(connection->ops()));
      break;
    case rt::Interface::shared_memory:
      connection->provider_ = make_shared_memory_in_provider(connection, line);
      break;
    case rt::Interface::direct:
      add_local(id, connection);
      break;
    case rt::Interface::foreign:
      connection->served_ = connection->plan_.carrier->serve(std::weak_ptr<Receiver>(connection), profile);
      if (!connection->served_)
        return {rt::ReturnCode::error,
                "the InPort's end of interface_type " + settings.foreign_interface + " cannot be made, or rejects the connection"};
      break;
  }
  if (connection->provider_) publish_reference(profile, settings.interface, rt::Side::in, *connection->provider_);
  add(connection);
  return {};
}

rt::Refusal InEngine::consume(ConnectionPlan plan, const RTC::ConnectorProfile& profile) {
  const auto settings = plan.settings;
  const std::string id = plan.id;
  auto connection = std::make_shared<InConnection>(ops_, std::move(plan), mailbox_);
  const Line line = line_of(connection->plan_);
  if (settings.interface == rt::Interface::direct) {
    const auto source = find_local_out(id);
    if (!source) return {rt::ReturnCode::error, "interface_type direct: the OutPort is not in this process"};
    if (*source->ops().type != *ops_.type) return {rt::ReturnCode::bad_parameter, "the OutPort sends " + source->ops().type_id};
    connection->fetcher_ = std::make_unique<DirectFetcher>(source);
  } else if (settings.interface == rt::Interface::foreign) {
    connection->fetcher_ = connection->plan_.carrier->make_fetcher(profile);
    if (!connection->fetcher_)
      return {rt::ReturnCode::error,
              "the InPort's end of interface_type " + settings.foreign_interface + " cannot be made, or rejects the connection"};
  } else {
    const CORBA::Object_var object = published_reference(profile, settings.interface, rt::Side::out);
    connection->fetcher_ = settings.interface == rt::Interface::shared_memory ? make_shared_memory_fetcher(object, line)
                                                                              : make_cdr_fetcher(settings.interface, object, line);
    if (!connection->fetcher_) return {rt::ReturnCode::error, "the OutPort gives no object of its interface_type to pull from"};
  }
  add(connection);
  return {};
}

bool InEngine::close(const std::string& id) {
  std::shared_ptr<InConnection> closed;
  {
    auto lists = lists_.lock();
    const auto it = std::ranges::find(*lists->open, id, [](const auto& connection) { return connection->id(); });
    if (it == lists->open->end()) return false;
    closed = *it;
    auto fewer = std::make_shared<Connections>(*lists->open);
    std::erase(*fewer, closed);
    auto more = std::make_shared<Connections>(*lists->closed);
    more->push_back(closed);
    lists->open = std::move(fewer);
    lists->closed = std::move(more);
  }
  if (closed->settings().interface == rt::Interface::direct) remove_local_in(id);
  closed->provider_.reset();  // the servant holds the connection
  closed->served_.reset();
  closed->finish();
  tidy();
  closed->events().on_event(ConnectorEvent::disconnect);
  return true;
}

void InEngine::drop_past(const Lists& lists) {
  const auto& known = lists.open->empty() ? *lists.closed : *lists.open;
  const std::uint64_t epoch = known.empty() ? 0 : known.front()->epoch();
  if (epoch > 0) mailbox_->drop_other_epochs(epoch);
}

namespace {

// By name: in which order connections were made may be chance, and those that are asked first give what is read first.
InEngine::Connections in_order_of_asking(const InEngine::Connections& open) {
  InEngine::Connections ordered = open;
  if (std::ranges::count_if(open, &InConnection::is_pull, [](const auto& connection) -> const InConnection& { return *connection; }) > 1)
    std::ranges::stable_sort(ordered, {}, [](const auto& connection) { return std::pair(connection->name(), connection->id()); });
  return ordered;
}

}  // namespace

bool InEngine::has_new(const std::string& name, std::vector<std::string>& lost) {
  const Lists lists = lists_.snapshot();
  drop_past(lists);
  bool is_new = std::ranges::any_of(
      *lists.closed, [&](const auto& connection) { return (name.empty() || connection->name() == name) && connection->unread() > 0; });
  for (const auto& connection : in_order_of_asking(*lists.open)) {
    if (!name.empty() && connection->name() != name) continue;
    if (connection->unread() == 0) {
      if (!connection->fetcher_) continue;
      const rt::PortStatus status = connection->fetch(true);
      if (status == rt::PortStatus::connection_lost) lost.push_back(connection->id());
      if (status != rt::PortStatus::ok) continue;
    }
    is_new = true;
  }
  return is_new;
}

void InEngine::note(const Connections& all, const InConnection* read, rt::PortStatus status) {
  auto statuses = statuses_.lock();
  statuses->assign(all.size(), read ? rt::PortStatus::buffer_empty : status);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].get() == read) (*statuses)[i] = status;
  }
}

std::vector<rt::PortStatus> InEngine::statuses() const { return statuses_.snapshot(); }

rt::PortStatus InEngine::read(const std::string& name, void* value, std::vector<std::string>& lost) {
  Lists lists = lists_.snapshot();
  drop_past(lists);
  const auto is_meant = [&](const auto& connection) { return name.empty() || connection->name() == name; };
  rt::Channel channel = rt::Channel::any;
  std::size_t selected = 0;
  std::size_t pulled = 0;
  rt::PortStatus pull_status = rt::PortStatus::ok;
  for (const auto& connection : in_order_of_asking(*lists.open)) {
    if (!is_meant(connection)) continue;
    ++selected;
    if (!name.empty()) channel = connection->channel();
    if (!connection->fetcher_) continue;
    ++pulled;
    if (connection->unread() > 0) continue;
    const rt::PortStatus status = connection->fetch(false);
    if (status == rt::PortStatus::connection_lost) lost.push_back(connection->id());
    if (status != rt::PortStatus::ok) pull_status = status;
  }
  // What is left of a closed connection comes before what a new one of that name has brought.
  const auto left =
      std::ranges::find_if(*lists.closed, [&](const auto& connection) { return is_meant(connection) && connection->unread() > 0; });
  const bool is_left = left != lists.closed->end();
  if (is_left && !name.empty()) channel = (*left)->channel();
  if (selected == 0 && !is_left) {
    note(*lists.open, nullptr, rt::PortStatus::precondition_not_met);
    return rt::PortStatus::precondition_not_met;
  }
  // Where every peer has been asked and none has anything, there is nothing: what to do then was the peer's policy.
  if (!is_left && pulled == selected && pull_status != rt::PortStatus::ok && mailbox_->unread(channel, phase_counter_of_reader()) == 0) {
    note(*lists.open, nullptr, pull_status);
    return pull_status;
  }

  const rt::ReadResult result = mailbox_->read(channel, phase_counter_of_reader());
  std::shared_ptr<InConnection> connection = find(lists, result.channel);
  if (!connection && result.status == rt::PortStatus::ok) {  // it came, and something came over it, while we were looking
    lists = lists_.snapshot();
    connection = find(lists, result.channel);
  }
  if (!connection && result.status != rt::PortStatus::ok && !lists.open->empty()) connection = lists.open->front();
  rt::PortStatus status = result.status;
  if (status == rt::PortStatus::ok && connection) {
    status = deliver(result.sample, *connection, value);
  } else if (status == rt::PortStatus::ok) {
    status = rt::PortStatus::error;  // the connection came and went while we were looking
  } else if (connection) {
    if (status == rt::PortStatus::buffer_empty) connection->events().on_event(ConnectorEvent::buffer_empty);
    if (status == rt::PortStatus::buffer_timeout) connection->events().on_event(ConnectorEvent::buffer_read_timeout);
  }
  note(*lists.open, connection.get(), status);
  if (is_left) tidy();
  return status;
}

rt::PortStatus InEngine::deliver(const rt::Sample& received, InConnection& connection, void* value) {
  const TypeOps& ops = connection.ops();
  const rt::Sample* sample = &received;
  rt::Sample changed;
  if (connection.events().is_observed(DataEvent::buffer_read)) {
    EventData data(ops, received);
    connection.events().on_data(DataEvent::buffer_read, data);
    if (data.is_changed()) {
      changed = data.sample();
      changed.received = received.received;
      sample = &changed;
    }
  }
  // A sender of another make may have stamped it with the clock of its machine: what is stamped here is told with the stamp of here.
  const auto policy = connection.settings().stamp;
  const bool is_stamped = ops.stamp && (policy == rt::StampPolicy::on_received || policy == rt::StampPolicy::on_read);
  if (!is_stamped) tell_tick(*sample, connection);
  if (sample->value) {
    ops.assign(value, sample->value.get());
  } else if (!decode_safely(ops, value, sample->block->octets(), sample->order)) {
    base::log(base::Level::warn, "data port", "connection {}: {} bytes dropped: not a valid {}", base::in_quotes(connection.name()),
              sample->block->size(), ops.type_id);
    mailbox_->forget_last(connection.channel());
    return rt::PortStatus::error;
  }
  if (is_stamped) {
    stamp(ops, value, policy == rt::StampPolicy::on_received ? sample->received : connection.plan_.caller_time());
    tell_tick(static_cast<const void*>(value), connection);
  }
  return rt::PortStatus::ok;
}

}  // namespace corba
