// Maps a data type of ports to a message of ROS 2, as a serializer named "ros2:PKG/TYPE". A mapping is a class with the types Data and
// Message and the functions to_ros(const Data&) and from_ros(const Message&, Data&); add_mapping<M>() in the function of a module registers
// it. One object of it for each thread of a connection. Registering: any thread.
#pragma once

#include <coil/Factory.h>
#include <rtm/ByteDataStreamBase.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "ros/cdr.h"
#include "ros/decode.h"
#include "ros/type_hash.h"

namespace ros2 {

// What the transport must know of a message; found by its name "PKG/TYPE".
class MessageType {
 public:
  virtual ~MessageType() = default;
  virtual std::string name() const = 0;  // "PKG/msg/TYPE"
  virtual std::string hash() const = 0;
};

template <ros::Message T>
class TypedMessage final : public MessageType {
 public:
  std::string name() const override { return std::string(T::name); }
  std::string hash() const override { return ros::TypeHash::of<T>(); }
};

inline constexpr const char* mapping_prefix = "ros2:";

// "geometry_msgs/msg/Twist" -> "geometry_msgs/Twist"
inline std::string short_type(std::string name) {
  if (const auto at = name.find("/msg/"); at != std::string::npos) name.erase(at, 4);
  return name;
}

template <class Mapping>
class MappedStream final : public RTC::ByteDataStream<typename Mapping::Data> {
 public:
  void writeData(const unsigned char* buffer, unsigned long length) override { bytes_.assign(buffer, buffer + length); }
  void readData(unsigned char* buffer, unsigned long length) const override {
    if (length > 0) std::memcpy(buffer, bytes_.data(), length);
  }
  unsigned long getDataLength() const override { return bytes_.size(); }
  bool serialize(const typename Mapping::Data& data) override {
    const typename Mapping::Message message = mapping_.to_ros(data);
    bytes_.resize(ros::encoded_size(message));
    ros::encode(message, {reinterpret_cast<char*>(bytes_.data()), bytes_.size()});
    return true;
  }
  bool deserialize(typename Mapping::Data& data) override {
    const auto message = ros::decode<typename Mapping::Message>(bytes_);
    if (message) mapping_.from_ros(*message, data);
    return message.has_value();
  }

 private:
  Mapping mapping_;
  std::vector<std::uint8_t> bytes_;
};

// A message that is mapped already keeps its mapping.
template <class Mapping>
void add_mapping() {
  using Typed = TypedMessage<typename Mapping::Message>;
  const std::string name = short_type(Typed().name());
  coil::GlobalFactory<MessageType>::instance().addFactory(name, coil::Creator<MessageType, Typed>, coil::Destructor<MessageType, Typed>);
  RTC::addSerializer<typename Mapping::Data, MappedStream<Mapping>>(mapping_prefix + name);
}

}  // namespace ros2
