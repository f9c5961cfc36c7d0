#include "recording/port_source.h"

#include <algorithm>
#include <utility>

#include "base/text.h"
#include "channels/idl_text.h"
#include "system/remote.h"
#include "system/value_codec.h"

namespace recorder {

namespace {

// The InPorts of a connection, "COMPONENT:PORT" with commas between: as ports are called in their profiles.
std::string inports_of(const tools::PortView& port, const tools::ConnectorView& connector) {
  std::vector<std::string> names;
  for (CORBA::ULong i = 0; i < connector.ports.length(); ++i) {
    std::string name;
    // One that is gone is not among them.
    (void)tools::remote("port", [&] {
      if (CORBA::is_nil(connector.ports[i]) || connector.ports[i]->_is_equivalent(port.object)) return;
      RTC::PortProfile_var profile = connector.ports[i]->get_port_profile();
      name = profile->name.in();
    });
    const auto dot = name.find('.');
    if (dot != std::string::npos) names.push_back(name.replace(dot, 1, ":"));
  }
  return base::join(names, ",");
}

std::string topic_of(const tools::ComponentView& component, const tools::PortView& port) {
  return "/" + component.instance + "/" + port.name;
}

}  // namespace

channels::Channel channel_of(const tools::ComponentView& component, const tools::PortView& port) {
  channels::Channel channel;
  channel.topic = topic_of(component, port);
  channel.encoding = "cdr";
  const std::string type = port.data_type();
  channel.schema.name = channels::scoped_name(type);
  // Types that we do not know are kept as octets, under their names.
  if (const auto code = tools::type_code_of(type); !CORBA::is_nil(code)) {
    channel.schema.encoding = "omgidl";
    channel.schema.text = channels::idl_text(code);
  }
  channel.metadata = {{"component", component.instance},
                      {"component_type", component.type},
                      {"port", port.name},
                      {"port_type", port.port_type()},
                      {"data_type", type}};
  for (std::size_t i = 0; i < port.connectors.size(); ++i) {
    const auto& connector = port.connectors[i];
    const std::string prefix = "connector" + std::to_string(i) + ".";
    channel.metadata[prefix + "id"] = connector.id;
    channel.metadata[prefix + "name"] = connector.name;
    channel.metadata[prefix + "inports"] = inports_of(port, connector);
    for (const auto& [key, value] : connector.properties) {
      if (!key.ends_with("_ior") && !key.ends_with("_ref")) channel.metadata[prefix + key] = value;
    }
  }
  return channel;
}

base::Result<void> PortSource::add(const tools::ComponentView& component, const tools::PortView& port,
                                   const std::map<std::string, std::string>& extra) {
  auto channel = channel_of(component, port);
  channel.metadata.insert(extra.begin(), extra.end());
  const auto id = exchange_.open(std::move(channel));
  if (!id) return id.error();
  Tapped tapped{*id, {}, std::make_unique<Counter>(), {}};
  tapped.counter->topic = topic_of(component, port);
  if (const auto connected = connect(tapped, port); !connected) return connected;
  tapped_.push_back(std::move(tapped));
  return {};
}

base::Result<void> PortSource::connect_again(const tools::ComponentView& component, const tools::PortView& port) {
  const auto known = std::ranges::find_if(tapped_, [&](const Tapped& one) { return one.counter->topic == topic_of(component, port); });
  if (known == tapped_.end() || known->port->_is_equivalent(port.object)) return {};
  return connect(*known, port);
}

base::Result<void> PortSource::connect(Tapped& tapped, const tools::PortView& port) {
  tapped.tap.reset();
  auto tap = tools::Tap::connect(
      orb_, port, {},
      [this, id = tapped.channel, counter = tapped.counter.get()](std::span<const unsigned char> payload, bool is_little_endian) {
        counter->samples.fetch_add(1, std::memory_order_relaxed);
        exchange_.put(id, clock_.now(), channels::cdr_head(is_little_endian),
                      {reinterpret_cast<const char*>(payload.data()), payload.size()});
      });
  if (!tap) return tap.error();
  tapped.tap = std::move(*tap);
  tapped.port = port.object;
  return {};
}

std::map<std::string, std::uint64_t> PortSource::counts() const {
  std::map<std::string, std::uint64_t> counts;
  for (const auto& one : tapped_) counts[one.counter->topic] = one.counter->samples.load(std::memory_order_relaxed);
  return counts;
}

}  // namespace recorder
