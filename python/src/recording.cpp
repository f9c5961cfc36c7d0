// rtmsim._recording: messages of an MCAP file as bytes, with their schemas. rtmsim/recording.py decodes them. With the GIL; a file that is
// read on one thread at a time.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "python/src/errors.h"
#include "recording/mcap/mcap.h"

namespace python {
namespace {

namespace py = pybind11;

py::bytes bytes_of(std::string_view text) { return py::bytes(text.data(), text.size()); }

// Texts of files need not be UTF-8.
py::str text_of(const std::string& text) {
  return py::reinterpret_steal<py::str>(PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "replace"));
}

py::dict texts_of(const mcap::Texts& texts) {
  py::dict values;
  for (const auto& [key, value] : texts) values[text_of(key)] = text_of(value);
  return values;
}

class File {
 public:
  explicit File(const std::string& path) : reader_(value_of(mcap::Reader::open(path))) {}

  // By number: topic, encoding, schema, schema_encoding, schema_text, metadata, messages.
  py::dict channels() const {
    py::dict all;
    for (const auto& [id, channel] : reader_.channels()) {
      const auto schema = reader_.schemas().find(channel.schema);
      const bool has_schema = schema != reader_.schemas().end();
      const auto counted = reader_.statistics().messages_of.find(id);
      py::dict one;
      one["topic"] = text_of(channel.topic);
      one["encoding"] = text_of(channel.encoding);
      one["schema"] = has_schema ? text_of(schema->second.name) : py::str("");
      one["schema_encoding"] = has_schema ? text_of(schema->second.encoding) : py::str("");
      one["schema_text"] = has_schema ? text_of(schema->second.data) : py::str("");
      one["metadata"] = texts_of(channel.metadata);
      one["messages"] = counted == reader_.statistics().messages_of.end() ? 0 : counted->second;
      all[py::int_(id)] = one;
    }
    return all;
  }
  py::tuple span() const { return py::make_tuple(reader_.statistics().first.count(), reader_.statistics().last.count()); }
  std::string damage() const { return reader_.damage().value_or(""); }
  py::dict metadata() {
    py::dict all;
    for (const auto& one : value_of(reader_.metadata())) all[text_of(one.name)] = texts_of(one.texts);
    return all;
  }
  py::list attachments() const {
    py::list names;
    for (const auto& one : reader_.attachments()) names.append(text_of(one.name));
    return names;
  }
  py::bytes attachment(const std::string& name) { return bytes_of(value_of(reader_.attachment(name)).data); }

  // From now on read() gives the messages of these channels, none: all, between these times [ns].
  void seek(const std::vector<std::uint16_t>& channels, std::uint64_t from, std::uint64_t to) {
    reader_.seek({channels, mcap::Time(from), mcap::Time(to)});
  }
  // Tuples of channel, time [ns] and bytes; fewer than `most`: the end.
  py::list read(std::size_t most) {
    py::list messages;
    while (messages.size() < most) {
      const auto message = value_of(reader_.next());
      if (!message) break;
      messages.append(py::make_tuple(message->channel, message->log_time.count(), bytes_of(message->data)));
    }
    return messages;
  }

 private:
  mcap::Reader reader_;
};

}  // namespace
}  // namespace python

PYBIND11_MODULE(_recording, module) {
  using namespace python;
  py::options options;
  options.disable_function_signatures();
  py::module_::import("rtmsim._core");  // which translates the exceptions of both: translators are those of all modules
  py::class_<File>(module, "File")
      .def(py::init<const std::string&>())
      .def_property_readonly("channels", &File::channels)
      .def_property_readonly("span", &File::span)
      .def_property_readonly("damage", &File::damage)
      .def_property_readonly("metadata", &File::metadata)
      .def_property_readonly("attachments", &File::attachments)
      .def("attachment", &File::attachment)
      .def("seek", &File::seek)
      .def("read", &File::read);
}
