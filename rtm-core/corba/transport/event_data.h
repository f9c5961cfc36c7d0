// One sample as listeners see it: decoded, encoded and copied only on demand, and changeable. One thread at a time.
#pragma once

#include <memory>
#include <span>

#include "corba/transport/type_ops.h"
#include "core/sample.h"

namespace corba {

class Payload;
struct Pieces;

// In the order of RTC::ConnectorDataListenerType and RTC::ConnectorListenerType.
enum class DataEvent {
  buffer_write,
  buffer_full,
  buffer_write_timeout,
  buffer_overwrite,
  buffer_read,
  send,
  received,
  receiver_full,
  receiver_timeout,
  receiver_error
};
enum class ConnectorEvent { buffer_empty, buffer_read_timeout, sender_empty, sender_timeout, sender_error, connect, disconnect };

class EventData {
 public:
  // The value must live as long as this; it is never changed itself.
  EventData(const TypeOps& ops, const void* value, rt::ByteOrder order);
  EventData(const TypeOps& ops, rt::Sample sample);
  // What is on its way out. Both must live as long as this; blocks for octets are taken from the pool.
  EventData(Payload& payload, rt::ByteOrder order, rt::BlockPool& pool);

  const TypeOps& ops() const { return *ops_; }
  rt::ByteOrder order() const { return order_; }
  // A copy that the caller may change (then call value_changed); nullptr if the octets are no value of the type.
  void* value();
  void value_changed();
  // Encoded in order(); none if the value cannot be. What is already in one piece is not copied. Good as long as this is not changed.
  std::span<const std::byte> octets();
  // How many there are, without a copy.
  std::size_t size();
  // Copies them there: room for size().
  void copy_octets(std::byte* to);
  void replace_octets(std::span<const std::byte> octets);

  bool is_changed() const { return is_changed_; }
  // What it has become.
  rt::Sample sample();

 private:
  // In one or more pieces; none if the value cannot be encoded.
  const Pieces* pieces();

  const TypeOps* ops_;
  const void* original_ = nullptr;
  Payload* payload_ = nullptr;
  rt::BlockPool* pool_ = nullptr;  // when there is a payload
  rt::ByteOrder order_;
  rt::Sample sample_;
  std::shared_ptr<void> value_;
  bool is_changed_ = false;
};

// What a connection tells about itself. Implementations are called on the thread that writes, reads or sends, without locks.
class ConnectorEvents {
 public:
  virtual ~ConnectorEvents() = default;
  // False: nobody would hear it, so nothing needs to be prepared.
  virtual bool is_observed(DataEvent event) const = 0;
  virtual void on_data(DataEvent event, EventData& data) = 0;
  virtual void on_event(ConnectorEvent event) = 0;
};

}  // namespace corba
