// The operations of a data type as a table of functions, so that the code of ports is compiled once. Any
// thread.
#pragma once

#include <omniORB4/CORBA.h>

#include <chrono>
#include <memory>
#include <span>
#include <string>
#include <typeinfo>

#include "corba/transport/shape.h"
#include "core/sample.h"

namespace corba {

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
  std::shared_ptr<void> (*make)();
  std::shared_ptr<void> (*copy)(const void* value);
  void (*assign)(void* to, const void* from);
  void (*encode)(const void* value, cdrStream& stream);
  void (*decode)(void* value, cdrStream& stream);                              // throws CORBA::MARSHAL
  void (*stamp)(void* value, CORBA::ULong seconds, CORBA::ULong nanoseconds);  // nullptr if the type has no `tm`
  bool has_wide_text;                                                          // or something else that is encoded from temporary memory
  Shape shape{};                                                               // of its values in CDR
  std::shared_ptr<Codec> codec{};                                              // used instead of encode and decode if there is one
};

bool has_wide_text(CORBA::TypeCode_ptr code);

// The type must have a `tm`.
void stamp(const TypeOps& ops, void* value, std::chrono::nanoseconds time);

}  // namespace corba
