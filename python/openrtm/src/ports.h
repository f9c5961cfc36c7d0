// Data ports whose values are Python objects. A value travels as its bytes, which the writer encodes and the reader decodes with the
// interpreter's lock; inside a process they are handed over without a copy. Any thread.
#pragma once

#include <pybind11/pybind11.h>
#include <rtm/InPort.h>
#include <rtm/OutPort.h>

#include <memory>
#include <string>

#include "coder.h"
#include "complaint.h"
#include "gil.h"

namespace python {

// What the runtime keeps, copies, encodes and decodes.
struct Value {
  std::shared_ptr<const Octets> octets = std::make_shared<const Octets>();
  bool is_little = true;
  const Type* type = nullptr;  // of values that were written here; to encode them in the other byte order
};

// The table of the runtime for a type; made once. With the interpreter's lock.
const RTC::detail::DataType& data_type_of(const Type& type);

class InPort final : public RTC::InPortBase {
 public:
  InPort(const std::string& name, pybind11::object value);
  ~InPort() override { retire(); }
  bool read(std::string name) override;

  using PortBase::setConnectionLimit;
  bool is_new(pybind11::object names);
  // The oldest unread value, the last one again, or the one of the constructor.
  pybind11::object read_value(const std::string& name);
  pybind11::object last;
  const Type& type() const { return type_; }

 private:
  InPort(const std::string& name, pybind11::object value, const Type& type);
  const Type& type_;
  Complaint complaint_;
};

// Samples of any type, which its listeners take.
class EventPort final : public RTC::InPortBase {
 public:
  explicit EventPort(const std::string& name);
  ~EventPort() override { retire(); }
  bool read(std::string) override { return true; }

  using PortBase::setConnectionLimit;
};

class OutPort final : public RTC::OutPortBase {
 public:
  OutPort(const std::string& name, pybind11::object value);
  ~OutPort() override { retire(); }
  bool write() override;

  using PortBase::setConnectionLimit;
  bool write_value(pybind11::object value);
  pybind11::object bound;
  const Type& type() const { return type_; }

 private:
  OutPort(const std::string& name, pybind11::object value, const Type& type);
  void complain(const BadValue& bad);
  const Type& type_;
  Complaint complaint_;
};

void add_ports(pybind11::module_& module);

}  // namespace python
