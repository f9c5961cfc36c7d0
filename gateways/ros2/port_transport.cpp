// The module ROS2Transport: data ports write and read topics of ROS 2. It registers the transports "ros2", "fast-rtps" and "cyclone-dds",
// and the mappings of data types. Settings of the process (rtc.conf): ros2.domain.id, ros2.network, ros2.distro, ros2.node.name.
#include <rtm/InPortConsumer.h>
#include <rtm/InPortProvider.h>
#include <rtm/Manager.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "base/log.h"
#include "base/text.h"
#include "mappings/mappings.h"
#include "names.h"
#include "port_domain.h"
#include "port_qos.h"
#include "ros2/port_mapping.h"

namespace ros2 {
namespace {

// ---- the settings of a connection ----

constexpr std::array interface_names{"ros2", "fast-rtps", "cyclone-dds"};

// Names in MessageTypes that this module has added itself.
std::set<std::string>& built_in() {
  static std::set<std::string> names;
  return names;
}

void add_built_in() {
  const auto before = MessageTypes::instance().getIdentifiers();
  add_mappings();
  for (const auto& name : MessageTypes::instance().getIdentifiers()) {
    if (std::ranges::find(before, name) == before.end()) built_in().insert(name);
  }
}

std::string text_of_one_side(const coil::Properties& connection, bool is_writer, const std::string& key) {
  const std::string& own = connection.getProperty((is_writer ? "outport." : "inport.") + key);
  return std::string(base::trim(own.empty() ? connection.getProperty(key) : own));
}

bool is_large(const std::string& type) {
  for (const char* large : {"sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage", "sensor_msgs/msg/PointCloud2"}) {
    if (type == large) return true;
  }
  return false;
}

std::string marshaling_of(const coil::Properties& connection, bool is_writer) {
  const std::string marshaling = text_of_one_side(connection, is_writer, "marshaling_type");
  return marshaling.empty() ? std::string(default_mapping) : marshaling;
}

// The name in MessageTypes of a connection's message: that of marshaling_type, or the default one of the data type.
std::string type_name_of(const coil::Properties& connection, bool is_writer) {
  const std::string marshaling = marshaling_of(connection, is_writer);
  if (marshaling == default_mapping) return text_of_one_side(connection, is_writer, "data_type");
  const std::string prefix = std::string(default_mapping) + ":";
  return marshaling.starts_with(prefix) ? marshaling.substr(prefix.size()) : "";
}

base::Result<PortTopic> topic_of_type(const coil::Properties& connection, bool is_writer, const std::string& type_name) {
  auto& types = MessageTypes::instance();
  MessageType* made = types.hasFactory(type_name) ? types.createObject(type_name) : nullptr;
  if (made == nullptr)
    return base::Error{"marshaling_type must be ros2:PKG/TYPE of a mapped message, or must be left out, got " +
                       base::in_quotes(marshaling_of(connection, is_writer))};
  PortTopic topic;
  EndpointSettings& endpoint = topic.endpoint;
  endpoint.type = type_on_wire(made->name());
  endpoint.user_data = "typehash=" + ros::TypeHash::of_text(made->definition()) + ";";
  endpoint.is_large = is_writer && is_large(made->name());
  types.deleteObject(made);
  return topic;
}

// The topic of a connection as it is on the wire.
base::Result<PortTopic> topic_of(const coil::Properties& connection, bool is_writer) {
  const std::string name = text_of_one_side(connection, is_writer, "interface_type");
  const std::string type_name = type_name_of(connection, is_writer);
  const bool is_own_mapping = !built_in().contains(type_name) || !built_in().contains(text_of_one_side(connection, is_writer, "data_type"));
  if (auto checked = check_keys(connection, name, is_own_mapping); !checked) return checked.error();
  const std::string typed = std::string(base::trim(connection.getProperty(name + ".topic")));
  if (typed.empty()) return base::Error{name + ".topic is missing: expected a topic, as in " + name + ".topic=/cmd_vel"};
  const std::string topic = typed.front() == '/' ? typed : "/" + typed;
  if (const auto problem = problem_of_name(topic)) return base::Error{name + ".topic " + *problem + ", got " + base::in_quotes(typed)};
  auto made = topic_of_type(connection, is_writer, type_name);
  if (!made) return made;
  made->endpoint.topic = topic_on_wire(topic);
  if (auto read = read_qos(connection, name, is_writer, *made); !read) return read.error();
  return made;
}

std::string setting_of_process(const char* key) {
  RTC::Manager* manager = RTC::Manager::instance_if_any();
  return manager == nullptr ? std::string() : std::string(base::trim(manager->configValue(key)));
}

base::Result<PortDomainSettings> settings_of_process() {
  PortDomainSettings settings;
  std::string domain = setting_of_process("ros2.domain.id");
  if (domain.empty()) domain = setting_of_process("fast-rtps.domain.id");
  if (const char* given = std::getenv("ROS_DOMAIN_ID"); domain.empty() && given != nullptr) domain = given;
  const auto number = base::parse_integer(domain.empty() ? "0" : domain);
  if (!number || *number < 0 || *number > 232) return base::Error{"ros2.domain.id must be from 0 to 232, got " + base::in_quotes(domain)};
  settings.dds.domain = static_cast<std::uint32_t>(*number);
  const std::string network = setting_of_process("ros2.network");
  const auto reach = network_of(network.empty() ? "host" : network);
  if (!reach) return base::Error{"ros2.network must be host, lan or loopback, got " + base::in_quotes(network)};
  settings.dds.network = *reach;
  const std::string distro = setting_of_process("ros2.distro");
  settings.family = family_of(distro);
  if (!settings.family && !distro.empty() && distro != "auto")
    return base::Error{"ros2.distro must be auto, humble or jazzy, got " + base::in_quotes(distro)};
  const std::string node = setting_of_process("ros2.node.name");
  settings.dds.log_name = "ros2";
  settings.dds.distro_setting = "ros2.distro";
  settings.node.name = token(node.empty() ? "rtm_" + std::to_string(::getpid()) : node);
  return settings;
}

bool complain(const coil::Properties& connection, const base::Error& error) {
  base::log(base::Level::error, "ros2", "connection rejected: {}: {}", connection.getProperty("connector_name"), error.message);
  return false;
}

// ---- the ends of a connection ----

class TopicWriter final : public RTC::InPortConsumer {
 public:
  void init(coil::Properties& properties) override { connection_ = properties; }
  bool subscribeInterface(const SDOPackage::NVList&) override {
    const auto settings = settings_of_process();
    if (!settings) return complain(connection_, settings.error());
    const auto topic = topic_of(connection_, true);
    if (!topic) return complain(connection_, topic.error());
    auto made = publish_port(*settings, topic->endpoint);
    if (!made) return complain(connection_, made.error());
    publication_ = std::move(*made);
    return true;
  }
  void unsubscribeInterface(const SDOPackage::NVList&) override { publication_.reset(); }
  RTC::DataPortStatus put(RTC::ByteData& data) override {
    const RTC::ByteData& bytes = data;
    const bool is_sent = publication_ && publication_->put({bytes.getBuffer(), bytes.getDataLength()});
    return is_sent ? RTC::DataPortStatus::PORT_OK : RTC::DataPortStatus::SEND_FULL;
  }

 private:
  coil::Properties connection_;
  std::unique_ptr<Publication> publication_;
};

class TopicReader final : public RTC::InPortProvider {
 public:
  void init(coil::Properties& properties) override {
    connection_ = properties;
    setInterfaceType(text_of_one_side(connection_, false, "interface_type").c_str());
  }
  bool publishInterface(SDOPackage::NVList&) override {
    auto settings = settings_of_process();
    if (!settings) return complain(connection_, settings.error());
    auto topic = topic_of(connection_, false);
    if (!topic) return complain(connection_, topic.error());
    settings_ = std::move(*settings);
    topic_ = std::move(*topic);
    return true;
  }
  void setConnector(RTC::InPortConnector* connector) override {
    auto made = subscribe_port(settings_, topic_.endpoint, topic_.takes_all, [connector](std::span<const std::uint8_t> bytes) {
      RTC::ByteData data(bytes.data(), bytes.size());
      connector->write(data);
    });
    if (!made) throw std::runtime_error(connection_.getProperty("connector_name") + ": " + made.error().message);
    subscription_ = std::move(*made);
  }

 private:
  coil::Properties connection_;
  PortDomainSettings settings_;
  PortTopic topic_;
  std::unique_ptr<Subscription> subscription_;
};

// A connection that has no marshaling_type has the default mapping of its data type.
template <class End, class Made>
void add_end() {
  coil::Properties options;
  options.setProperty("marshaling_type", std::string(default_mapping));
  for (const char* name : interface_names)
    coil::GlobalFactory<End>::instance().addFactory(name, coil::Creator<End, Made>, coil::Destructor<End, Made>, options);
}

}  // namespace
}  // namespace ros2

extern "C" void ROS2TransportInit(RTC::Manager*) {
  ros2::add_built_in();
  ros2::add_end<RTC::InPortConsumer, ros2::TopicWriter>();
  ros2::add_end<RTC::InPortProvider, ros2::TopicReader>();
}
