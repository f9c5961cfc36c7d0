// The half of coder.h that decodes.
#include <cstring>
#include <memory>

#include "coder.h"
#include "gil.h"
#include "idl/any_check.h"
#include "references.h"
#include "streams.h"

namespace python {
namespace {

PyObject* checked(PyObject* object) {
  if (!object) throw PythonFailed{};
  return object;
}

template <class Reader>
PyObject* read(Reader& from, const Type& type);

PyObject* text_from(const std::byte* octets, std::size_t size) {
  const char* letters = reinterpret_cast<const char*>(octets);
  if (text_coding() != TextCoding::latin1) {
    if (PyObject* const text = PyUnicode_DecodeUTF8(letters, static_cast<Py_ssize_t>(size), nullptr)) return text;
    PyErr_Clear();
  }
  return checked(PyUnicode_DecodeLatin1(letters, static_cast<Py_ssize_t>(size), nullptr));
}

template <class Reader>
PyObject* read_text(Reader& from, const Type& type) {
  const auto size = from.template get<std::uint32_t>();
  if (size == 0) return checked(PyUnicode_FromStringAndSize("", 0));
  if (type.bound && size - 1 > type.bound) throw BadOctets{};
  from.expect(size, 1);
  const std::byte* octets = from.octets(size);
  return text_from(octets, octets[size - 1] == std::byte{0} ? size - 1 : size);
}

template <class Reader, class Number, class Make>
PyObject* read_numbers(Reader& from, std::size_t count, Make make) {
  from.expect(count, sizeof(Number));
  Ref list(checked(PyList_New(static_cast<Py_ssize_t>(count))));
  for (std::size_t i = 0; i < count; ++i)
    PyList_SET_ITEM(list.get(), static_cast<Py_ssize_t>(i), checked(make(from.template get<Number>())));
  return list.release();
}

template <class Reader>
PyObject* read_sequence(Reader& from, const Type& type) {
  const std::size_t count = type.kind == CORBA::tk_array ? type.bound : from.template get<std::uint32_t>();
  if (type.kind == CORBA::tk_sequence && type.bound && count > type.bound) throw BadOctets{};
  switch (actual(*type.element).kind) {
    case CORBA::tk_octet:
      from.expect(count, 1);
      return checked(PyBytes_FromStringAndSize(reinterpret_cast<const char*>(from.octets(count)), static_cast<Py_ssize_t>(count)));
    case CORBA::tk_char:
      from.expect(count, 1);
      return checked(PyUnicode_DecodeLatin1(reinterpret_cast<const char*>(from.octets(count)), static_cast<Py_ssize_t>(count), nullptr));
    case CORBA::tk_double:
      return read_numbers<Reader, double>(from, count, PyFloat_FromDouble);
    case CORBA::tk_float:
      return read_numbers<Reader, float>(from, count, [](float number) { return PyFloat_FromDouble(number); });
    case CORBA::tk_long:
      return read_numbers<Reader, std::int32_t>(from, count, [](std::int32_t number) { return PyLong_FromLong(number); });
    case CORBA::tk_null:
    case CORBA::tk_void:
      throw BadOctets{};
    default:
      break;
  }
  const Nesting nesting;
  if (!nesting) throw PythonFailed{};
  from.expect(count, 1);
  Ref list(checked(PyList_New(static_cast<Py_ssize_t>(count))));
  for (std::size_t i = 0; i < count; ++i) {
    PyObject* const one = read(from, *type.element);
    PyList_SET_ITEM(list.get(), static_cast<Py_ssize_t>(i), one);
  }
  return list.release();
}

template <class Reader>
PyObject* read_members(Reader& from, const Type& type) {
  if (type.is_plain) {
    auto* const cls = reinterpret_cast<PyTypeObject*>(type.maker);
    static PyObject* const nothing = PyTuple_New(0);
    Ref object(checked(cls->tp_new(cls, nothing, nullptr)));
    for (const Member& member : type.members) {
      const Ref value(read(from, *member.type));
      if (PyObject_SetAttr(object.get(), member.name, value.get()) != 0) throw PythonFailed{};
    }
    return object.release();
  }
  const Ref arguments(checked(PyTuple_New(static_cast<Py_ssize_t>(type.members.size()))));
  for (std::size_t i = 0; i < type.members.size(); ++i)
    PyTuple_SET_ITEM(arguments.get(), static_cast<Py_ssize_t>(i), read(from, *type.members[i].type));
  return checked(PyObject_Call(type.maker, arguments.get(), nullptr));
}

template <class Reader>
PyObject* read_union(Reader& from, const Type& type) {
  const Ref discriminator(read(from, *type.element));
  int at = type.default_case;
  for (std::size_t i = 0; i < type.labels.size(); ++i) {
    if (static_cast<int>(i) != type.default_case && PyObject_RichCompareBool(type.labels[i], discriminator.get(), Py_EQ) == 1)
      at = static_cast<int>(i);
  }
  const Ref content(at >= 0 ? read(from, *type.members[static_cast<std::size_t>(at)].type) : Py_NewRef(Py_None));
  return checked(PyObject_CallFunctionObjArgs(type.maker, discriminator.get(), content.get(), nullptr));
}

PyObject* read_typecode(cdrStream& stream, Ref& descriptor) {
  static PyObject* const cls = of_module("omniORB.tcInternal", "TypeCode");
  cdrMemoryStream checked_code;
  copy_checked_type_code(stream, checked_code);
  const CORBA::TypeCode_var code = CORBA::TypeCode::unmarshalTypeCode(checked_code);
  descriptor = Ref(checked(descriptor_of(code)));
  if (!cls) throw PythonFailed{};
  return checked(PyObject_CallOneArg(cls, descriptor.get()));
}

template <class Reader>
PyObject* read_with_stream(Reader& from, const Type& type) {
  cdrStream& stream = *from.stream();
  switch (type.kind) {
    case CORBA::tk_wchar:
      return checked(PyUnicode_FromOrdinal(static_cast<int>(stream.unmarshalWChar())));
    case CORBA::tk_wstring: {
      const std::unique_ptr<CORBA::WChar, void (*)(CORBA::WChar*)> letters(stream.unmarshalWString(static_cast<int>(type.bound)),
                                                                           [](CORBA::WChar* text) { CORBA::wstring_free(text); });
      std::vector<Py_UCS4> text;
      for (const CORBA::WChar* at = letters.get(); *at; ++at) {
        const auto unit = static_cast<Py_UCS4>(*at);
        if (unit >= 0xdc00 && unit < 0xe000 && !text.empty() && text.back() >= 0xd800 && text.back() < 0xdc00)
          text.back() = 0x10000 + ((text.back() - 0xd800) << 10) + (unit - 0xdc00);
        else
          text.push_back(unit);
      }
      return checked(PyUnicode_FromKindAndData(PyUnicode_4BYTE_KIND, text.data(), static_cast<Py_ssize_t>(text.size())));
    }
    case CORBA::tk_any: {
      static PyObject* const cls = of_module("omniORB.CORBA", "Any");
      const Nesting nesting;
      if (!nesting) throw PythonFailed{};
      Ref descriptor;
      const Ref code(read_typecode(stream, descriptor));
      const Type* inner = type_of(descriptor.get());
      if (!inner || !cls) throw PythonFailed{};
      const Ref content(read(from, *inner));
      return checked(PyObject_CallFunctionObjArgs(cls, code.get(), content.get(), nullptr));
    }
    case CORBA::tk_TypeCode: {
      Ref descriptor;
      return read_typecode(stream, descriptor);
    }
    case CORBA::tk_objref: {
      const CORBA::Object_var object = CORBA::Object::_unmarshalObjRef(stream);
      return checked(reference_out(object, type.id.c_str()));
    }
    default:
      throw BadOctets{};
  }
}

template <class Reader>
PyObject* read(Reader& from, const Type& type) {
  switch (type.kind) {
    case CORBA::tk_null:
    case CORBA::tk_void:
      return Py_NewRef(Py_None);
    case CORBA::tk_short:
      return checked(PyLong_FromLong(from.template get<std::int16_t>()));
    case CORBA::tk_ushort:
      return checked(PyLong_FromLong(from.template get<std::uint16_t>()));
    case CORBA::tk_long:
      return checked(PyLong_FromLong(from.template get<std::int32_t>()));
    case CORBA::tk_ulong:
      return checked(PyLong_FromUnsignedLong(from.template get<std::uint32_t>()));
    case CORBA::tk_longlong:
      return checked(PyLong_FromLongLong(from.template get<std::int64_t>()));
    case CORBA::tk_ulonglong:
      return checked(PyLong_FromUnsignedLongLong(from.template get<std::uint64_t>()));
    case CORBA::tk_float:
      return checked(PyFloat_FromDouble(from.template get<float>()));
    case CORBA::tk_double:
      return checked(PyFloat_FromDouble(from.template get<double>()));
    case CORBA::tk_octet:
      return checked(PyLong_FromLong(from.template get<std::uint8_t>()));
    case CORBA::tk_boolean:
      return Py_NewRef(from.template get<std::uint8_t>() ? Py_True : Py_False);
    case CORBA::tk_char:
      return checked(PyUnicode_FromOrdinal(from.template get<std::uint8_t>()));
    case CORBA::tk_enum: {
      const auto number = from.template get<std::uint32_t>();
      if (number >= static_cast<std::uint32_t>(PyTuple_GET_SIZE(type.maker))) throw BadOctets{};
      return Py_NewRef(PyTuple_GET_ITEM(type.maker, number));
    }
    case CORBA::tk_string:
      return read_text(from, type);
    case CORBA::tk_alias:
      return read(from, *type.element);
    case CORBA::tk_sequence:
    case CORBA::tk_array:
      return read_sequence(from, type);
    case CORBA::tk_struct:
    case CORBA::tk_except:
      return read_members(from, type);
    case CORBA::tk_union:
      return read_union(from, type);
    default:
      if constexpr (std::is_same_v<Reader, FlatReader>)
        throw BadOctets{};
      else
        return read_with_stream(from, type);
  }
}

}  // namespace

PyObject* decode(const Type& type, cdrStream& stream) {
  StreamReader from(stream);
  return read(from, type);
}

PyObject* decode(const Type& type, std::span<const std::byte> octets, bool is_little) {
  if (type.is_flat) {
    FlatReader reader(octets, is_little);
    return read(reader, type);
  }
  std::vector<std::uint64_t> aligned(octets.size() / 8 + 1);
  std::memcpy(aligned.data(), octets.data(), octets.size());
  cdrMemoryStream stream(aligned.data(), octets.size());
  if (!stream.TCS_W()) throw CORBA::BAD_INV_ORDER();
  stream.setByteSwapFlag(is_little);
  try {
    return decode(type, stream);
  } catch (const CORBA::MARSHAL&) {
    throw BadOctets{};
  }
}

}  // namespace python
