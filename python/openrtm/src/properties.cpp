#include "properties.h"

#include <pybind11/stl.h>

#include <sstream>

namespace py = pybind11;

namespace python {
namespace {

std::string text_of(const py::handle& value) { return value.is_none() ? std::string() : py::cast<std::string>(py::str(value)); }

Properties make(py::object key, py::object value, py::object defaults_map, py::object defaults_str, py::object num, py::object prop) {
  if (!prop.is_none()) return Properties::copy_of(*py::cast<Properties&>(prop).node);
  auto own = std::make_shared<coil::Properties>(text_of(key), text_of(value));
  if (!defaults_map.is_none()) {
    for (const auto& [name, text] : py::cast<py::dict>(defaults_map)) own->setDefault(text_of(name), text_of(text));
  } else if (!defaults_str.is_none()) {
    const auto words = py::cast<py::sequence>(defaults_str);
    const std::size_t count = num.is_none() ? words.size() : std::min(words.size(), py::cast<std::size_t>(num));
    for (std::size_t i = 0; i + 1 < count && !text_of(words[i]).empty(); i += 2) own->setDefault(text_of(words[i]), text_of(words[i + 1]));
  }
  return {own, own.get()};
}

py::object wrapped(const Properties& from, coil::Properties* node) {
  return node ? py::cast(Properties{from.owner, node}) : py::object(py::none());
}

std::string shown(const Properties& properties) {
  std::ostringstream out;
  properties.node->list(out);
  return out.str();
}

py::list leaves(const Properties& self) {
  py::list list;
  for (auto* one : self.node->getLeaf()) list.append(Properties{self.owner, one});
  return list;
}

py::object parent(const Properties& self) { return wrapped(self, const_cast<coil::Properties*>(self.node->getRoot())); }
std::string name(const Properties& self) { return self.node->getName(); }
std::string value(const Properties& self) { return self.node->getValue(); }
std::string default_value(const Properties& self) { return self.node->getDefaultValue(); }

}  // namespace

void add_properties(py::module_& module) {
  const py::arg_v none_key("key", py::none());
  py::class_<Properties>(module, "Properties")
      .def(py::init(&make), py::arg("key") = py::none(), py::arg("value") = py::none(), py::arg("defaults_map") = py::none(),
           py::arg("defaults_str") = py::none(), py::arg("num") = py::none(), py::arg("prop") = py::none())
      .def(
          "getProperty",
          [](const Properties& self, const std::string& key, py::object otherwise) {
            if (otherwise.is_none()) return self.node->getProperty(key);
            return self.node->getProperty(key, text_of(otherwise));
          },
          py::arg("key"), py::arg("default") = py::none())
      // Without a value, the default becomes the value.
      .def(
          "setProperty",
          [](Properties& self, const std::string& key, py::object value) {
            return self.node->setProperty(key, value.is_none() ? self.node->getProperty(key) : text_of(value));
          },
          py::arg("key"), py::arg("value") = py::none())
      .def("getDefault", [](const Properties& self, const std::string& key) { return self.node->getDefault(key); })
      .def("setDefault",
           [](Properties& self, const std::string& key, py::object value) { return self.node->setDefault(key, text_of(value)); })
      .def(
          "setDefaults",
          [](Properties& self, py::sequence words, py::object) {
            for (std::size_t i = 0; i + 1 < words.size(); i += 2) self.node->setDefault(text_of(words[i]), text_of(words[i + 1]));
          },
          py::arg("defaults"), py::arg("num") = py::none())
      .def("getNode",
           [](Properties& self, const std::string& key) {
             return Properties{self.owner, &self.node->getNode(key)};
           })
      .def("findNode", [](Properties& self, const std::string& key) { return wrapped(self, self.node->findNode(key)); })
      .def("hasKey", [](Properties& self, const std::string& key) { return wrapped(self, self.node->hasKey(key)); })
      .def("createNode", [](Properties& self, const std::string& key) { return self.node->createNode(key); })
      .def("removeNode",
           [](Properties& self, const std::string& name) -> py::object {
             std::shared_ptr<coil::Properties> removed(self.node->removeNode(name));
             return removed ? py::cast(Properties{removed, removed.get()}) : py::object(py::none());
           })
      .def("getLeaf", &leaves)
      .def("getRoot", &parent)
      .def("getName", &name)
      .def("getValue", &value)
      .def("getDefaultValue", &default_value)
      .def_property_readonly("leaf", &leaves)
      .def_property_readonly("root", &parent)
      .def_property_readonly("name", &name)
      .def_property_readonly("value", &value)
      .def_property_readonly("default_value", &default_value)
      .def("propertyNames", [](const Properties& self) { return self.node->propertyNames(); })
      .def("size", [](const Properties& self) { return self.node->size(); })
      .def("clear", [](Properties& self) { self.node->clear(); })
      .def("mergeProperties",
           [](Properties& self, const Properties& other) {
             *self.node << *other.node;
             return self;
           })
      .def("__lshift__",
           [](Properties& self, const Properties& other) {
             *self.node << *other.node;
             return self;
           })
      .def("load",
           [](Properties& self, py::object lines) {
             std::string text;
             for (const auto& line : lines) {
               text += text_of(line);
               if (!text.ends_with('\n')) text += '\n';
             }
             std::istringstream in(text);
             self.node->load(in);
           })
      .def("list", [](const Properties& self, py::object out) { out.attr("write")(shown(self)); })
      .def("store",
           [](Properties& self, py::object out, const std::string& header) {
             std::ostringstream text;
             self.node->store(text, header);
             out.attr("write")(text.str());
           })
      .def("save",
           [](Properties& self, py::object out, const std::string& header) {
             std::ostringstream text;
             self.node->save(text, header);
             out.attr("write")(text.str());
           })
      .def("__str__", &shown)
      .def("__repr__", &shown);
}

}  // namespace python
