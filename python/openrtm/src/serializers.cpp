#include "serializers.h"

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cstring>
#include <map>
#include <memory>
#include <set>

#include "base/guarded.h"
#include "coder.h"
#include "gil.h"
#include "ports.h"
#include "properties.h"

namespace py = pybind11;

namespace python {
namespace {

// The result of a call with the lock; throws Raised when it raises.
template <class Call>
auto raising(Call call) {
  try {
    return call();
  } catch (py::error_already_set& error) {
    error.restore();
    throw Raised(take_error());
  } catch (const py::cast_error& problem) {
    throw Raised(problem.what());
  } catch (const PythonFailed&) {
    throw Raised(take_error());
  }
}

// The two results of serialize and deserialize; nothing if the code is not 0.
std::optional<py::object> good_result(const py::object& result) {
  if (!py::isinstance<py::tuple>(result) || py::len(result) != 2) throw Raised("expected a pair (code, value)");
  const auto pair = py::reinterpret_borrow<py::tuple>(result);
  if (py::cast<int>(pair[0]) != 0) return std::nullopt;
  return py::reinterpret_borrow<py::object>(pair[1]);
}

class Stream final : public RTC::ByteDataStreamBase {
 public:
  Stream(const py::object& serializer, const Type& type) : serializer_(serializer.ptr()), type_(type) {}

  void init(const coil::Properties& connection) override {
    const Locked locked;
    raising([&] { author().attr("init")(Properties::copy_of(connection)); });
  }
  void writeData(const unsigned char* buffer, unsigned long length) override {
    octets_.assign(reinterpret_cast<const char*>(buffer), length);
  }
  void readData(unsigned char* buffer, unsigned long length) const override { std::memcpy(buffer, octets_.data(), length); }
  unsigned long getDataLength() const override { return octets_.size(); }
  void isLittleEndian(bool is_little) override {
    const Locked locked;
    raising([&] { author().attr("isLittleEndian")(is_little); });
  }

  bool serialize(const Value& value) {
    const Locked locked;
    return raising([&] {
      const auto object = py::reinterpret_steal<py::object>(decode(type_, *value.octets, value.is_little));
      const auto octets = good_result(author().attr("serialize")(object));
      if (octets) octets_ = py::cast<std::string>(py::bytes(*octets));
      return octets.has_value();
    });
  }
  bool deserialize(Value& value) {
    const Locked locked;
    return raising([&] {
      const auto object = good_result(author().attr("deserialize")(py::bytes(octets_), py::handle(type_.maker)));
      if (!object) return false;
      auto octets = std::make_shared<Octets>();
      try {
        encode(type_, object->ptr(), true, *octets);
      } catch (const BadValue& bad) {
        throw Raised("its value is no " + name_of(type_) + ": " + bad.text());
      }
      value = Value{.octets = std::move(octets), .is_little = true, .type = &type_};
      return true;
    });
  }

 private:
  py::handle author() const { return serializer_.get(); }

  const Kept serializer_;
  const Type& type_;
  std::string octets_;
};

// By type, "" for all types. Profiles of ports need them, also while Python code keeps the interpreter's lock for ever.
using NamesByType = base::Guarded<std::map<std::string, std::vector<std::string>>, base::Rank::noted>;
NamesByType& all_names() {
  static auto& names = *new NamesByType;  // ports end after main()
  return names;
}

class Authors final : public RTC::detail::Serializers {
 public:
  explicit Authors(const Type& type) : type_(type) {}

  std::vector<std::string> names() const override {
    std::set<std::string> all;
    auto known = all_names().lock();
    for (const auto& id : {std::string(), type_.id})
      if (const auto found = known->find(id); found != known->end()) all.insert(found->second.begin(), found->second.end());
    all.erase("cdr");
    std::vector<std::string> list{"cdr"};
    list.insert(list.end(), all.begin(), all.end());
    return list;
  }
  RTC::ByteDataStreamBase* create(const std::string& name) const override {
    const Locked locked;
    return raising([&]() -> RTC::ByteDataStreamBase* {
      const py::object made = factories().attr("_create")(name, type_.id);
      return made.is_none() ? nullptr : new Stream(made, type_);
    });
  }
  void destroy(RTC::ByteDataStreamBase* stream) const override { delete stream; }
  bool serialize(RTC::ByteDataStreamBase& stream, const void* value) const override {
    return static_cast<Stream&>(stream).serialize(*static_cast<const Value*>(value));
  }
  bool deserialize(RTC::ByteDataStreamBase& stream, void* value) const override {
    return static_cast<Stream&>(stream).deserialize(*static_cast<Value*>(value));
  }

 private:
  static py::object factories() {
    static PyObject* const cls = of_module("OpenRTM_aist.serializers", "SerializerFactories");
    if (!cls) throw py::error_already_set();
    return py::handle(cls).attr("instance")();
  }
  const Type& type_;
};

}  // namespace

const RTC::detail::Serializers& serializers_of(const Type& type) {
  static auto& known = *new std::map<const Type*, std::unique_ptr<Authors>>;
  auto& made = known[&type];
  if (!made) made = std::make_unique<Authors>(type);
  return *made;
}

void add_serializers(py::module_& module) {
  module.def("set_serializer_names",
             [](const std::string& id, const std::vector<std::string>& names) { (*all_names().lock())[id] = names; });
}

}  // namespace python
