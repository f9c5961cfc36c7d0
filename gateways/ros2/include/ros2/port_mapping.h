// Maps a data type of ports to a message of ROS 2, as a serializer named "ros2:PKG/TYPE". A mapping is a class with
//
//   using Data = RTC::TimedString;                          // the data type of the port
//   using Message = ros::Text;                              // the message
//   Message to_ros(const Data& data);                       // or std::optional<Message>: empty when the message cannot express the value
//   void from_ros(const Message& message, Data& data);      // or bool: false drops the sample
//   void init(const coil::Properties& connection);          // optional: the properties of the connection, without "dataport."
//
// ros2::add_mapping<M>() in the function of a module registers it. Of several mappings of a data type the first is used where a connection
// has no marshaling_type. A connection makes one object for each thread, so functions may keep memory in it. Spans in a message to send
// must be valid until the next call; those in a received message are valid during the call. Registering: any thread.
#pragma once

#include <coil/Factory.h>
#include <rtm/ByteDataStreamBase.h>
#include <rtm/Typename.h>

#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "ros/cdr.h"
#include "ros/decode.h"
#include "ros/messages.h"
#include "ros/type_hash.h"

namespace ros2 {

// The name of the serializer that is used without a marshaling_type; with a colon and "PKG/TYPE" behind it, one for that message.
inline constexpr std::string_view default_mapping = "ros2";

// "geometry_msgs/msg/Twist" -> "geometry_msgs/Twist"
inline std::string short_type(std::string_view name) {
  std::string text(name);
  if (const auto at = text.find("/msg/"); at != std::string::npos) text.erase(at, 4);
  return text;
}

// What the transport must know of a message. Found by its name "PKG/TYPE", and by the repository id of the data type that it is the
// default of.
class MessageType {
 public:
  virtual ~MessageType() = default;
  virtual std::string name() const = 0;        // "PKG/msg/TYPE"
  virtual std::string definition() const = 0;  // what its type hash is made of
};
using MessageTypes = coil::GlobalFactory<MessageType>;

template <ros::Message T>
class TypedMessage final : public MessageType {
 public:
  std::string name() const override { return std::string(T::name); }
  std::string definition() const override { return ros::TypeHash::text_of<T>(); }
};

template <class Mapping>
class MappedStream final : public RTC::ByteDataStream<typename Mapping::Data> {
  using Data = typename Mapping::Data;
  using Message = typename Mapping::Message;

 public:
  void init(const coil::Properties& connection) override {
    if constexpr (requires { mapping_.init(connection); }) mapping_.init(connection);
  }
  void writeData(const unsigned char* buffer, unsigned long length) override { bytes_.assign(buffer, buffer + length); }
  void readData(unsigned char* buffer, unsigned long length) const override {
    if (length > 0) std::memcpy(buffer, bytes_.data(), length);
  }
  unsigned long getDataLength() const override { return bytes_.size(); }
  bool serialize(const Data& data) override {
    const std::optional<Message> message = mapping_.to_ros(data);
    if (!message) return false;
    bytes_.resize(ros::encoded_size(*message));
    ros::encode(*message, {reinterpret_cast<char*>(bytes_.data()), bytes_.size()});
    return true;
  }
  bool deserialize(Data& data) override {
    ros::Decoder decoder(bytes_);
    Message message{};
    if (!decoder.read(message)) return false;
    if constexpr (std::is_void_v<decltype(mapping_.from_ros(message, data))>) {
      mapping_.from_ros(message, data);
      return true;
    } else {
      return mapping_.from_ros(message, data);
    }
  }

 private:
  Mapping mapping_;
  std::vector<std::uint8_t> bytes_;
};

// A message that is mapped already keeps its mapping.
template <class Mapping>
void add_mapping() {
  using Data = typename Mapping::Data;
  using Stream = MappedStream<Mapping>;
  using Typed = TypedMessage<typename Mapping::Message>;
  const std::string name = short_type(Mapping::Message::name);
  for (const std::string& key : {name, std::string(CORBA_Util::toRepositoryId<Data>())})
    MessageTypes::instance().addFactory(key, coil::Creator<MessageType, Typed>, coil::Destructor<MessageType, Typed>);
  RTC::addSerializer<Data, Stream>(std::string(default_mapping) + ":" + name);
  RTC::addSerializer<Data, Stream>(std::string(default_mapping));
}

// ---- for mappings of messages with a header ----

inline ros::Time stamp_of(const auto& tm) {
  const auto most = static_cast<decltype(tm.sec)>(INT32_MAX);
  return {static_cast<std::int32_t>(tm.sec < most ? tm.sec : most), static_cast<std::uint32_t>(tm.nsec)};
}
// Stamps before 1970 are 0.
inline void set_time(auto& tm, const ros::Time& stamp) {
  tm.sec = static_cast<decltype(tm.sec)>(stamp.sec < 0 ? 0 : stamp.sec);
  tm.nsec = static_cast<decltype(tm.nsec)>(stamp.sec < 0 ? 0 : stamp.nanosec);
}

// A property of the connection, below the name of its transport: "frame_id" is ros2.frame_id. Empty if there is none.
inline std::string property_of(const coil::Properties& connection, const std::string& key) {
  for (const char* transport : {"ros2", "fast-rtps", "cyclone-dds"}) {
    if (const std::string& value = connection.getProperty(std::string(transport) + "." + key); !value.empty()) return value;
  }
  return {};
}

// A base of mappings: their frames, from ros2.frame_id and ros2.child_frame_id.
class Frames {
 public:
  Frames() = default;
  explicit Frames(std::string usual, std::string usual_child = {}) : frame_(std::move(usual)), child_(std::move(usual_child)) {}
  void init(const coil::Properties& connection) {
    if (auto given = property_of(connection, "frame_id"); !given.empty()) frame_ = std::move(given);
    if (auto given = property_of(connection, "child_frame_id"); !given.empty()) child_ = std::move(given);
  }
  ros::Header header(const auto& tm) const { return {stamp_of(tm), frame_}; }
  const std::string& child() const { return child_; }

 private:
  std::string frame_ = "base_link", child_{};
};

}  // namespace ros2
