// The module ROS2Transport: data ports write and read topics of ROS 2. It registers the transports "ros2", "fast-rtps" and "cyclone-dds",
// and the mappings of data types. Settings of the process (rtc.conf): ros2.domain.id, ros2.network, ros2.distro, ros2.node.name.
#include <rtm/InPortConsumer.h>
#include <rtm/InPortProvider.h>
#include <rtm/Manager.h>
#include <rtm/idl/BasicDataTypeSkel.h>
#include <rtm/idl/ExtendedDataTypesSkel.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>

#include "base/log.h"
#include "base/text.h"
#include "names.h"
#include "port_domain.h"
#include "port_mapping.h"
#include "ros/messages.h"

namespace ros2 {
namespace {

struct VelocityAndTwist {
  using Data = RTC::TimedVelocity2D;
  using Message = ros::Twist;
  static Message to_ros(const Data& data) { return {{data.data.vx, data.data.vy, 0}, {0, 0, data.data.va}}; }
  static void from_ros(const Message& twist, Data& data) {
    data.tm = {};  // the message has none
    data.data = {twist.linear.x, twist.linear.y, twist.angular.z};
  }
};

struct VelocityAndStampedTwist {
  using Data = RTC::TimedVelocity2D;
  using Message = ros::TwistStamped;
  static Message to_ros(const Data& data) {
    Message message;
    message.header.stamp = {static_cast<std::int32_t>(data.tm.sec), data.tm.nsec};
    message.twist = VelocityAndTwist::to_ros(data);
    return message;
  }
  static void from_ros(const Message& message, Data& data) {
    VelocityAndTwist::from_ros(message.twist, data);
    data.tm = {static_cast<CORBA::ULong>(message.header.stamp.sec), message.header.stamp.nanosec};
  }
};

struct Int32 {
  static constexpr std::string_view name = "std_msgs/msg/Int32";
  std::int32_t data = 0;
  static void fields(auto& m, auto& visit) { visit("data", m.data); }
};

// A number with time, and one without.
template <class Timed, ros::Message T>
struct NumberAndNumber {
  using Data = Timed;
  using Message = T;
  static Message to_ros(const Data& data) { return {data.data}; }
  static void from_ros(const Message& message, Data& data) {
    data.tm = {};
    data.data = message.data;
  }
};

// ---- the settings of a connection ----

constexpr std::array interface_names{"ros2", "fast-rtps", "cyclone-dds"};

std::string text_of_one_side(const coil::Properties& connection, bool is_writer, const std::string& key) {
  const std::string& own = connection.getProperty((is_writer ? "outport." : "inport.") + key);
  return std::string(base::trim(own.empty() ? connection.getProperty(key) : own));
}

// The value of the first key that is there.
std::string first_text(const coil::Properties& connection, const std::vector<std::string>& keys) {
  for (const auto& key : keys) {
    if (const std::string& value = connection.getProperty(key); !value.empty()) return std::string(base::trim(value));
  }
  return {};
}

base::Result<void> read_qos(const coil::Properties& connection, const std::string& name, bool is_writer, EndpointSettings& endpoint) {
  const std::string python = name + (is_writer ? ".writer_qos." : ".reader_qos.");
  const std::string cpp = name + (is_writer ? ".publisher." : ".subscriber.");
  const auto durability = first_text(connection, {python + "durability.kind", cpp + "qos.durability.kind"});
  endpoint.is_transient = durability == "TRANSIENT_LOCAL_DURABILITY_QOS";
  if (!durability.empty() && !endpoint.is_transient && durability != "VOLATILE_DURABILITY_QOS")
    return base::Error{python + "durability.kind must be VOLATILE_DURABILITY_QOS or TRANSIENT_LOCAL_DURABILITY_QOS, got " +
                       base::in_quotes(durability)};
  const auto reliability = first_text(connection, {python + "reliability.kind", cpp + "qos.reliability.kind"});
  // A reliable writer fits every reader.
  const bool fits =
      reliability.empty() || reliability == "RELIABLE_RELIABILITY_QOS" || (is_writer && reliability == "BEST_EFFORT_RELIABILITY_QOS");
  if (!fits) return base::Error{python + "reliability.kind must be RELIABLE_RELIABILITY_QOS, got " + base::in_quotes(reliability)};
  const auto depth = first_text(connection, {python + "history.depth", cpp + "topic.historyQos.depth"});
  if (depth.empty()) return {};
  const auto number = base::parse_integer(depth);
  if (!number || *number < 1 || *number > 10'000)
    return base::Error{python + "history.depth must be from 1 to 10000, got " + base::in_quotes(depth)};
  endpoint.depth = static_cast<std::size_t>(*number);
  return {};
}

// The topic of a connection as it is on the wire.
base::Result<EndpointSettings> endpoint_of(const coil::Properties& connection, bool is_writer) {
  const std::string name = text_of_one_side(connection, is_writer, "interface_type");
  std::string topic = std::string(base::trim(connection.getProperty(name + ".topic")));
  if (topic.empty()) return base::Error{name + ".topic is missing: expected a topic, as in " + name + ".topic=/cmd_vel"};
  if (topic.front() != '/') topic.insert(0, "/");
  if (const auto problem = problem_of_name(topic)) return base::Error{name + ".topic " + *problem};
  const std::string marshaling = text_of_one_side(connection, is_writer, "marshaling_type");
  auto& types = coil::GlobalFactory<MessageType>::instance();
  const std::string type_name = marshaling.starts_with(mapping_prefix) ? marshaling.substr(std::string(mapping_prefix).size()) : "";
  MessageType* made = types.hasFactory(type_name) ? types.createObject(type_name) : nullptr;
  if (made == nullptr)
    return base::Error{"marshaling_type must be ros2:PKG/TYPE of a mapped message for interface_type " + name + ", got " +
                       base::in_quotes(marshaling)};
  EndpointSettings endpoint;
  endpoint.topic = topic_on_wire(topic);
  endpoint.type = type_on_wire(made->name());
  endpoint.user_data = "typehash=" + made->hash() + ";";
  types.deleteObject(made);
  if (auto read = read_qos(connection, name, is_writer, endpoint); !read) return read.error();
  return endpoint;
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
  settings.node.name = token(node.empty() ? "rtm_" + std::to_string(::getpid()) : node);
  return settings;
}

bool complain(const base::Error& error) {
  base::log(base::Level::error, "ros2", "connection refused: {}", error.message);
  return false;
}

// ---- the ends of a connection ----

class TopicWriter final : public RTC::InPortConsumer {
 public:
  void init(coil::Properties& properties) override { connection_ = properties; }
  bool subscribeInterface(const SDOPackage::NVList&) override {
    const auto settings = settings_of_process();
    if (!settings) return complain(settings.error());
    const auto endpoint = endpoint_of(connection_, true);
    if (!endpoint) return complain(endpoint.error());
    auto made = publish_port(*settings, *endpoint);
    if (!made) return complain(made.error());
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
    if (!settings) return complain(settings.error());
    auto endpoint = endpoint_of(connection_, false);
    if (!endpoint) return complain(endpoint.error());
    settings_ = std::move(*settings);
    topic_ = std::move(*endpoint);
    return true;
  }
  void setConnector(RTC::InPortConnector* connector) override {
    auto made = subscribe_port(settings_, topic_, [connector](std::span<const std::uint8_t> bytes) {
      RTC::ByteData data(bytes.data(), bytes.size());
      connector->write(data);
    });
    if (!made) throw std::runtime_error(made.error().message);
    subscription_ = std::move(*made);
  }

 private:
  coil::Properties connection_;
  PortDomainSettings settings_;
  EndpointSettings topic_;
  std::unique_ptr<Subscription> subscription_;
};

template <class End, class Made>
void add_end() {
  for (const char* name : interface_names) {
    coil::GlobalFactory<End>::instance().addFactory(name, coil::Creator<End, Made>, coil::Destructor<End, Made>);
  }
}

}  // namespace
}  // namespace ros2

extern "C" void ROS2TransportInit(RTC::Manager*) {
  ros2::add_mapping<ros2::VelocityAndTwist>();
  ros2::add_mapping<ros2::VelocityAndStampedTwist>();
  ros2::add_mapping<ros2::NumberAndNumber<RTC::TimedDouble, ros::Float64>>();
  ros2::add_mapping<ros2::NumberAndNumber<RTC::TimedLong, ros2::Int32>>();
  ros2::add_end<RTC::InPortConsumer, ros2::TopicWriter>();
  ros2::add_end<RTC::InPortProvider, ros2::TopicReader>();
}
