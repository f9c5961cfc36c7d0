// What a data port must know about its type, as a table of functions, so that everything else about ports is compiled once.
// Any thread.
#pragma once

#include <omniORB4/CORBA.h>

#include <chrono>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <typeinfo>

#include "corba/shape.h"
#include "core/sample.h"

// Lives in the global namespace so that the operators which omniidl writes there are found whatever order headers come in.
struct RtmAnyProbe : CORBA::Any {};

namespace corba {

template <class T>
struct ValueOf final : rt::Value {
  ValueOf() = default;
  explicit ValueOf(const T& v) : value(v) {}
  void* address() override { return &value; }
  T value{};
};

// Another encoding than CDR for the values of one connection. Any thread.
class Codec {
 public:
  virtual ~Codec() = default;
  // The marshaling type of the connection.
  virtual const std::string& name() const = 0;
  // nullptr if the value cannot be encoded. Never throws.
  virtual std::shared_ptr<rt::Block> encode(const void* value, rt::ByteOrder order) = 0;
  // False if the octets are no value; `value` may be half written then. Never throws.
  virtual bool decode(void* value, std::span<const std::byte> octets, rt::ByteOrder order) = 0;
};

struct TypeOps {
  std::string type_id;  // "IDL:RTC/TimedLong:1.0"
  const std::type_info* type;
  std::shared_ptr<rt::Value> (*make)();
  std::shared_ptr<rt::Value> (*copy)(const void* value);
  void (*assign)(void* to, const void* from);
  void (*encode)(const void* value, cdrStream& stream);
  void (*decode)(void* value, cdrStream& stream);             // throws CORBA::MARSHAL
  void (*stamp)(void* value, std::chrono::nanoseconds time);  // nullptr if the type has no `tm`
  bool is_stamp_first;                                        // `tm` is the first member
  bool has_wide_text;                                         // or something else that is encoded from temporary memory
  Shape shape{};                                              // of its values in CDR
  std::shared_ptr<Codec> codec{};                             // used instead of encode and decode if there is one
};

bool has_wide_text(CORBA::TypeCode_ptr code);

template <class T>
CORBA::TypeCode_ptr type_code_of() {
  RtmAnyProbe any;
  any <<= T{};
  return any.type();
}

template <class T>
void stamp_value(void* value, std::chrono::nanoseconds time) {
  if constexpr (requires(T & v) { v.tm.sec, v.tm.nsec; }) {
    T& v = *static_cast<T*>(value);
    v.tm.sec = static_cast<CORBA::ULong>(time.count() / 1'000'000'000);
    v.tm.nsec = static_cast<CORBA::ULong>(time.count() % 1'000'000'000);
  }
}

template <class T>
TypeOps make_type_ops() {
  TypeOps ops{};
  const CORBA::TypeCode_var code = type_code_of<T>();
  ops.type_id = code->id();
  ops.has_wide_text = has_wide_text(code);
  ops.shape = Shape(code);
  ops.type = &typeid(T);
  ops.make = []() -> std::shared_ptr<rt::Value> { return std::make_shared<ValueOf<T>>(); };
  ops.copy = [](const void* value) -> std::shared_ptr<rt::Value> { return std::make_shared<ValueOf<T>>(*static_cast<const T*>(value)); };
  ops.assign = [](void* to, const void* from) { *static_cast<T*>(to) = *static_cast<const T*>(from); };
  ops.encode = [](const void* value, cdrStream& stream) { *static_cast<const T*>(value) >>= stream; };
  ops.decode = [](void* value, cdrStream& stream) { *static_cast<T*>(value) <<= stream; };
  if constexpr (requires(T & v) { v.tm.sec, v.tm.nsec; }) {
    ops.stamp = &stamp_value<T>;
    const T probe{};
    ops.is_stamp_first = static_cast<const void*>(&probe) == static_cast<const void*>(&probe.tm);
  }
  return ops;
}

template <class T>
const TypeOps& type_ops() {
  static const TypeOps ops = make_type_ops<T>();
  return ops;
}

}  // namespace corba
