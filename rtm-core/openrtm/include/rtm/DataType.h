// Operations of a data type for ports, listeners and time stamps, as a table of functions: all other code of ports is compiled once. For
// the templates of these headers. Any thread.
#pragma once

#include <omniORB4/CORBA.h>

#include <memory>
#include <type_traits>
#include <typeinfo>
#include <utility>

// Lives in the global namespace so that the operators which omniidl writes there are found whatever order headers come in.
struct RtmAnyProbe : CORBA::Any {};

namespace RTC {

class RuntimeAccess;

namespace detail {

// Types with a time stamp: a member `tm` of type RTC::Time.
template <class T, class = void>
struct HasStamp : std::false_type {};
template <class T>
struct HasStamp<T, std::void_t<decltype(std::declval<T&>().tm.sec), decltype(std::declval<T&>().tm.nsec)>> : std::true_type {};

struct TypeTable {
  CORBA::TypeCode_ptr (*code)();  // a new reference
  const std::type_info* type;
  std::shared_ptr<void> (*make)();
  std::shared_ptr<void> (*copy)(const void* value);
  void (*assign)(void* to, const void* from);
  void (*encode)(const void* value, cdrStream& stream);
  void (*decode)(void* value, cdrStream& stream);                              // throws CORBA::MARSHAL
  void (*stamp)(void* value, CORBA::ULong seconds, CORBA::ULong nanoseconds);  // nullptr if the type has none
};

// The functions of one type.
template <class T>
struct TypeFunctions {
  static CORBA::TypeCode_ptr code() {
    RtmAnyProbe any;
    any <<= T{};
    return any.type();
  }
  static std::shared_ptr<void> make() { return std::make_shared<T>(); }
  static std::shared_ptr<void> copy(const void* value) { return std::make_shared<T>(*static_cast<const T*>(value)); }
  static void assign(void* to, const void* from) { *static_cast<T*>(to) = *static_cast<const T*>(from); }
  static void encode(const void* value, cdrStream& stream) { *static_cast<const T*>(value) >>= stream; }
  static void decode(void* value, cdrStream& stream) { *static_cast<T*>(value) <<= stream; }
  static void stamp(void* value, CORBA::ULong seconds, CORBA::ULong nanoseconds) {
    if constexpr (HasStamp<T>::value) {
      static_cast<T*>(value)->tm.sec = seconds;
      static_cast<T*>(value)->tm.nsec = nanoseconds;
    }
  }
  static TypeTable table() { return {&code, &typeid(T), &make, &copy, &assign, &encode, &decode, HasStamp<T>::value ? &stamp : nullptr}; }
};

// The table, and what follows from the type code.
class DataType {
 public:
  explicit DataType(const TypeTable& table);
  ~DataType();
  DataType(const DataType&) = delete;
  DataType& operator=(const DataType&) = delete;

  // "IDL:RTC/TimedLong:1.0"
  const char* id() const;

  // Fits every type and keeps nothing.
  static const DataType& any();

 private:
  friend class RTC::RuntimeAccess;
  struct Ops;
  explicit DataType(std::unique_ptr<Ops> ops);

  std::unique_ptr<Ops> ops_;
};

template <class T>
const DataType& data_type() {
  static const DataType type(TypeFunctions<T>::table());
  return type;
}

// What setTimestamp writes.
struct Stamp {
  CORBA::ULong seconds;
  CORBA::ULong nanoseconds;
};
Stamp current_stamp();

}  // namespace detail
}  // namespace RTC
