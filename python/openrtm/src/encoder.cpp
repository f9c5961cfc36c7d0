// The half of coder.h that encodes.
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>

#include "coder.h"
#include "gil.h"
#include "references.h"
#include "streams.h"

namespace python {
namespace {

// Longer than any message can be.
constexpr Py_ssize_t max_elements = Py_ssize_t{1} << 28;

TextCoding chosen_coding = TextCoding::automatic;

std::string described(PyObject* value) {
  std::string text = Py_TYPE(value)->tp_name;
  const bool is_short = PyLong_Check(value) || PyFloat_Check(value) || (PyUnicode_Check(value) && PyUnicode_GET_LENGTH(value) < 30);
  if (!is_short) return text;
  const Ref shown(PyObject_Repr(value));
  if (const char* utf8 = shown ? PyUnicode_AsUTF8(shown.get()) : nullptr) return text + " " + utf8;
  PyErr_Clear();
  return text;
}

[[noreturn]] void refuse(const Type& type, PyObject* value) {
  PyErr_Clear();
  throw BadValue{{}, name_of(type), described(value)};
}

template <class Number>
Number integer(const Type& type, PyObject* value) {
  Ref index;
  if (!PyLong_Check(value)) {
    if (!PyIndex_Check(value)) refuse(type, value);
    index = Ref(PyNumber_Index(value));  // numbers of numpy
    if (!index) refuse(type, value);
  }
  PyObject* const number = index ? index.get() : value;
  if constexpr (std::is_same_v<Number, unsigned long long>) {
    const unsigned long long result = PyLong_AsUnsignedLongLong(number);
    if (result == static_cast<unsigned long long>(-1) && PyErr_Occurred()) refuse(type, value);
    return result;
  } else {
    int overflow = 0;
    const long long result = PyLong_AsLongLongAndOverflow(number, &overflow);
    using Limits = std::numeric_limits<Number>;
    if (overflow || result < static_cast<long long>(Limits::min()) || result > static_cast<long long>(Limits::max())) refuse(type, value);
    return static_cast<Number>(result);
  }
}

double real(const Type& type, PyObject* value) {
  if (PyFloat_Check(value)) return PyFloat_AS_DOUBLE(value);
  if (!PyLong_Check(value) && (PyUnicode_Check(value) || PyBytes_Check(value) || !Py_TYPE(value)->tp_as_number ||
                               !(Py_TYPE(value)->tp_as_number->nb_float || Py_TYPE(value)->tp_as_number->nb_index)))
    refuse(type, value);
  const double number = PyFloat_AsDouble(value);
  if (number == -1.0 && PyErr_Occurred()) refuse(type, value);
  return number;
}

std::uint32_t enumerator(const Type& type, PyObject* value) {
  const Py_ssize_t count = PyTuple_GET_SIZE(type.maker);
  for (Py_ssize_t i = 0; i < count; ++i)
    if (PyTuple_GET_ITEM(type.maker, i) == value) return static_cast<std::uint32_t>(i);
  // An item of the same enumeration from other stubs.
  const Ref parent(PyObject_GetAttrString(value, "_parent_id"));
  const Ref number(PyObject_GetAttrString(value, "_v"));
  if (!parent || !number || !PyUnicode_Check(parent.get()) || !PyLong_Check(number.get()) ||
      PyUnicode_CompareWithASCIIString(parent.get(), type.id.c_str()) != 0)
    refuse(type, value);
  const long at = PyLong_AsLong(number.get());
  if (at < 0 || at >= count) refuse(type, value);
  return static_cast<std::uint32_t>(at);
}

// The octets of a text.
Ref coded_text(const Type& type, PyObject* value) {
  if (!PyUnicode_Check(value)) refuse(type, value);
  Ref octets;
  if (text_coding() != TextCoding::utf8) {
    octets = Ref(PyUnicode_AsLatin1String(value));
    if (!octets && text_coding() == TextCoding::latin1) refuse(type, value);
    PyErr_Clear();
  }
  if (!octets) octets = Ref(PyUnicode_AsUTF8String(value));
  if (!octets) refuse(type, value);
  const auto size = static_cast<std::size_t>(PyBytes_GET_SIZE(octets.get()));
  if (std::memchr(PyBytes_AS_STRING(octets.get()), 0, size)) {
    throw BadValue{{}, name_of(type) + " without the character 0", described(value)};
  }
  if (type.bound && size > type.bound) throw BadValue{{}, name_of(type), std::to_string(size) + " bytes"};
  return octets;
}

std::vector<CORBA::WChar> wide_text(const Type& type, PyObject* value) {
  if (!PyUnicode_Check(value)) refuse(type, value);
  std::vector<CORBA::WChar> letters;
  for (Py_ssize_t i = 0; i < PyUnicode_GET_LENGTH(value); ++i) {
    const Py_UCS4 letter = PyUnicode_READ_CHAR(value, i);
    if (letter == 0) throw BadValue{{}, "wstring without the character 0", described(value)};
    if (letter < 0x10000) {
      letters.push_back(static_cast<CORBA::WChar>(letter));
    } else {
      letters.push_back(static_cast<CORBA::WChar>(0xd800 + ((letter - 0x10000) >> 10)));
      letters.push_back(static_cast<CORBA::WChar>(0xdc00 + ((letter - 0x10000) & 0x3ff)));
    }
  }
  letters.push_back(0);
  return letters;
}

char narrow_letter(const Type& type, PyObject* value) {
  if (!PyUnicode_Check(value) || PyUnicode_GET_LENGTH(value) != 1 || PyUnicode_READ_CHAR(value, 0) > 255) refuse(type, value);
  return static_cast<char>(PyUnicode_READ_CHAR(value, 0));
}

// Memory of numpy arrays, array.array, bytearray and their kin.
class Memory {
 public:
  explicit Memory(PyObject* value) {
    if (!PyObject_CheckBuffer(value)) return;
    is_there_ = PyObject_GetBuffer(value, &view_, PyBUF_C_CONTIGUOUS | PyBUF_FORMAT) == 0;
    if (!is_there_) PyErr_Clear();
  }
  ~Memory() {
    if (is_there_) PyBuffer_Release(&view_);
  }
  Memory(const Memory&) = delete;
  Memory& operator=(const Memory&) = delete;
  explicit operator bool() const { return is_there_; }
  const void* data() const { return view_.buf; }
  std::size_t size() const { return static_cast<std::size_t>(view_.len); }
  bool holds(CORBA::TCKind kind) const {
    if (!is_there_ || view_.ndim != 1) return false;
    const char* format = view_.format ? view_.format : "B";
    if (*format == '<' || *format == '=' || *format == '@') ++format;
    if (std::strlen(format) != 1) return false;
    const auto is_one_of = [&](const char* letters, std::size_t size) {
      return std::strchr(letters, *format) != nullptr && static_cast<std::size_t>(view_.itemsize) == size;
    };
    switch (kind) {
      case CORBA::tk_octet:
        return is_one_of("B", 1);
      case CORBA::tk_boolean:
        return is_one_of("?", 1);
      case CORBA::tk_short:
        return is_one_of("h", 2);
      case CORBA::tk_ushort:
        return is_one_of("H", 2);
      case CORBA::tk_long:
        return is_one_of("il", 4);
      case CORBA::tk_ulong:
        return is_one_of("IL", 4);
      case CORBA::tk_longlong:
        return is_one_of("lq", 8);
      case CORBA::tk_ulonglong:
        return is_one_of("LQ", 8);
      case CORBA::tk_float:
        return is_one_of("f", 4);
      case CORBA::tk_double:
        return is_one_of("d", 8);
      default:
        return false;
    }
  }

 private:
  Py_buffer view_{};
  bool is_there_ = false;
};

template <class Writer>
void write(Writer& to, const Type& type, PyObject* value);

template <class Writer>
void write_head(Writer& to, const Type& type, std::size_t count) {
  if (type.kind == CORBA::tk_array) {
    if (count != type.bound) throw BadValue{{}, name_of(type), std::to_string(count) + " elements"};
    return;
  }
  if ((type.bound && count > type.bound) || count > 0xffffffffU)
    throw BadValue{{}, "at most " + std::to_string(type.bound) + " elements", std::to_string(count)};
  to.put(static_cast<std::uint32_t>(count));
}

template <class Writer, class Number>
void write_numbers(Writer& to, const Type& type, const Memory& memory) {
  const std::size_t count = memory.size() / sizeof(Number);
  write_head(to, type, count);
  to.numbers(static_cast<const Number*>(memory.data()), count);
}

template <class Writer>
bool write_memory(Writer& to, const Type& type, const Memory& memory) {
  const auto kind = actual(*type.element).kind;
  if (!memory.holds(kind)) return false;
  switch (kind) {
    case CORBA::tk_octet:
    case CORBA::tk_boolean:
      write_numbers<Writer, std::uint8_t>(to, type, memory);
      return true;
    case CORBA::tk_short:
    case CORBA::tk_ushort:
      write_numbers<Writer, std::uint16_t>(to, type, memory);
      return true;
    case CORBA::tk_long:
    case CORBA::tk_ulong:
      write_numbers<Writer, std::uint32_t>(to, type, memory);
      return true;
    case CORBA::tk_longlong:
    case CORBA::tk_ulonglong:
      write_numbers<Writer, std::uint64_t>(to, type, memory);
      return true;
    case CORBA::tk_float:
      write_numbers<Writer, float>(to, type, memory);
      return true;
    default:
      write_numbers<Writer, double>(to, type, memory);
      return true;
  }
}

template <class Writer>
void write_sequence(Writer& to, const Type& type, PyObject* value) {
  const auto kind = actual(*type.element).kind;
  if (kind == CORBA::tk_char && PyUnicode_Check(value)) {
    const Ref octets(PyUnicode_AsLatin1String(value));
    if (!octets) refuse(type, value);
    write_head(to, type, static_cast<std::size_t>(PyBytes_GET_SIZE(octets.get())));
    to.octets(PyBytes_AS_STRING(octets.get()), static_cast<std::size_t>(PyBytes_GET_SIZE(octets.get())));
    return;
  }
  Ref list;
  if (!PyList_Check(value) && !PyTuple_Check(value)) {
    if (PyUnicode_Check(value) || PyDict_Check(value) || value == Py_None) refuse(type, value);
    {
      const Memory memory(value);
      if (memory && kind == CORBA::tk_octet && !PyObject_HasAttrString(value, "dtype")) {
        write_head(to, type, memory.size());
        to.octets(memory.data(), memory.size());
        return;
      }
      if (memory && write_memory(to, type, memory)) return;
    }
    if (PyBytes_Check(value)) refuse(type, value);
    // Other arrays by their elements.
    if (const Py_ssize_t size = PySequence_Check(value) ? PySequence_Size(value) : -1; size < 0 || size > max_elements) refuse(type, value);
    list = Ref(PyObject_HasAttrString(value, "tolist") ? PyObject_CallMethod(value, "tolist", nullptr) : PySequence_List(value));
    if (!list || !PyList_Check(list.get())) refuse(type, value);
    value = list.get();
  }
  const Nesting nesting;
  if (!nesting) throw PythonFailed{};
  const Py_ssize_t count = PySequence_Fast_GET_SIZE(value);
  write_head(to, type, static_cast<std::size_t>(count));
  for (Py_ssize_t i = 0; i < PySequence_Fast_GET_SIZE(value); ++i) {
    try {
      write(to, *type.element, PySequence_Fast_GET_ITEM(value, i));
    } catch (BadValue& bad) {
      bad.path = "[" + std::to_string(i) + "]" + (bad.path.empty() || bad.path[0] == '[' ? "" : ".") + bad.path;
      throw;
    }
  }
  if (PySequence_Fast_GET_SIZE(value) != count) throw BadValue{{}, "a list that keeps its length", "one that changes"};
}

// The exception that is set is that of a look at the member.
[[noreturn]] void refuse_without(const Member& member, const Type& type, PyObject* value) {
  const bool is_missing = PyErr_ExceptionMatches(PyExc_AttributeError) != 0;
  PyObject *error = nullptr, *raised = nullptr, *trace = nullptr;
  PyErr_Fetch(&error, &raised, &trace);
  PyErr_NormalizeException(&error, &raised, &trace);
  const Ref owned_error(error), owned_raised(raised), owned_trace(trace);
  const char* const name = PyUnicode_AsUTF8(member.name);
  const std::string given = described(value) + (is_missing ? ", which has no member " : ", whose member ") + (name ? name : "?");
  if (is_missing) throw BadValue{{}, name_of(type), given};
  const Ref text(PyObject_Str(raised));
  const char* const utf8 = text ? PyUnicode_AsUTF8(text.get()) : nullptr;
  PyErr_Clear();
  throw BadValue{
      {}, name_of(type), given + " raised " + reinterpret_cast<PyTypeObject*>(error)->tp_name + (utf8 ? std::string(": ") + utf8 : "")};
}

template <class Writer>
void write_members(Writer& to, const Type& type, PyObject* value) {
  for (const Member& member : type.members) {
    const Ref part(PyObject_GetAttr(value, member.name));
    if (!part) refuse_without(member, type, value);
    try {
      write(to, *member.type, part.get());
    } catch (BadValue& bad) {
      const char* name = PyUnicode_AsUTF8(member.name);
      bad.path = (name ? name : "?") + std::string(bad.path.empty() || bad.path[0] == '[' ? "" : ".") + bad.path;
      throw;
    }
  }
}

template <class Writer>
void write_union(Writer& to, const Type& type, PyObject* value) {
  const Ref discriminator(PyObject_GetAttrString(value, "_d"));
  const Ref content(PyObject_GetAttrString(value, "_v"));
  if (!discriminator || !content) refuse(type, value);
  write(to, *type.element, discriminator.get());
  int at = type.default_case;
  for (std::size_t i = 0; i < type.labels.size(); ++i) {
    if (static_cast<int>(i) == type.default_case) continue;
    const int is_equal = PyObject_RichCompareBool(type.labels[i], discriminator.get(), Py_EQ);
    if (is_equal < 0) throw PythonFailed{};
    if (is_equal) at = static_cast<int>(i);
  }
  if (at >= 0) write(to, *type.members[static_cast<std::size_t>(at)].type, content.get());
}

template <class Writer>
void write_any(Writer& to, const Type& type, PyObject* value) {
  const Nesting nesting;
  if (!nesting) throw PythonFailed{};
  const Ref code(PyObject_GetAttrString(value, "_t"));
  const Ref content(PyObject_GetAttrString(value, "_v"));
  const Ref descriptor(code ? PyObject_GetAttrString(code.get(), "_d") : nullptr);
  if (!descriptor || !content) refuse(type, value);
  const Type* inner = type_of(descriptor.get());
  if (!inner) throw PythonFailed{};
  const CORBA::TypeCode_var wire = code_of(*inner);
  CORBA::TypeCode::marshalTypeCode(wire, *to.stream());
  write(to, *inner, content.get());
}

template <class Writer>
void write_with_stream(Writer& to, const Type& type, PyObject* value) {
  cdrStream& stream = *to.stream();
  switch (type.kind) {
    case CORBA::tk_wchar:
      if (!PyUnicode_Check(value) || PyUnicode_GET_LENGTH(value) != 1) refuse(type, value);
      stream.marshalWChar(static_cast<CORBA::WChar>(PyUnicode_READ_CHAR(value, 0)));
      return;
    case CORBA::tk_wstring: {
      const auto letters = wide_text(type, value);
      stream.marshalWString(letters.data(), static_cast<int>(type.bound));
      return;
    }
    case CORBA::tk_any:
      write_any(to, type, value);
      return;
    case CORBA::tk_TypeCode: {
      const Ref descriptor(PyObject_GetAttrString(value, "_d"));
      const Type* inner = descriptor ? type_of(descriptor.get()) : nullptr;
      if (!inner) refuse(type, value);
      const CORBA::TypeCode_var wire = code_of(*inner);
      CORBA::TypeCode::marshalTypeCode(wire, stream);
      return;
    }
    case CORBA::tk_objref:
      if (const auto object = reference_in(value))
        CORBA::Object::_marshalObjRef(*object, stream);
      else
        refuse(type, value);
      return;
    default:
      refuse(type, value);
  }
}

template <class Writer>
void write(Writer& to, const Type& type, PyObject* value) {
  switch (type.kind) {
    case CORBA::tk_null:
    case CORBA::tk_void:
      return;
    case CORBA::tk_short:
      return to.put(integer<std::int16_t>(type, value));
    case CORBA::tk_ushort:
      return to.put(integer<std::uint16_t>(type, value));
    case CORBA::tk_long:
      return to.put(integer<std::int32_t>(type, value));
    case CORBA::tk_ulong:
      return to.put(integer<std::uint32_t>(type, value));
    case CORBA::tk_longlong:
      return to.put(integer<long long>(type, value));
    case CORBA::tk_ulonglong:
      return to.put(integer<unsigned long long>(type, value));
    case CORBA::tk_float:
      return to.put(static_cast<float>(real(type, value)));
    case CORBA::tk_double:
      return to.put(real(type, value));
    case CORBA::tk_octet:
      return to.put(integer<std::uint8_t>(type, value));
    case CORBA::tk_boolean: {
      const int truth = PyObject_IsTrue(value);
      if (truth < 0) refuse(type, value);
      return to.put(static_cast<std::uint8_t>(truth));
    }
    case CORBA::tk_char:
      return to.put(static_cast<std::uint8_t>(narrow_letter(type, value)));
    case CORBA::tk_enum:
      return to.put(enumerator(type, value));
    case CORBA::tk_string: {
      const Ref text = coded_text(type, value);
      const auto size = static_cast<std::size_t>(PyBytes_GET_SIZE(text.get()));
      to.put(static_cast<std::uint32_t>(size + 1));
      return to.octets(PyBytes_AS_STRING(text.get()), size + 1);
    }
    case CORBA::tk_alias:
      return write(to, *type.element, value);
    case CORBA::tk_sequence:
    case CORBA::tk_array:
      return write_sequence(to, type, value);
    case CORBA::tk_struct:
    case CORBA::tk_except:
      return write_members(to, type, value);
    case CORBA::tk_union:
      return write_union(to, type, value);
    default:
      if constexpr (std::is_same_v<Writer, FlatWriter>)
        refuse(type, value);
      else
        write_with_stream(to, type, value);
  }
}

}  // namespace

void set_text_coding(TextCoding coding) { chosen_coding = coding; }
TextCoding text_coding() { return chosen_coding; }

void encode(const Type& type, PyObject* value, cdrStream& stream) {
  StreamWriter to(stream);
  write(to, type, value);
}

void encode(const Type& type, PyObject* value, bool is_little, Octets& to) {
  to.clear();
  if (type.is_flat) {
    FlatWriter writer(to, is_little);
    write(writer, type, value);
    return;
  }
  cdrMemoryStream stream(0, true);                    // zeroes between the members
  if (!stream.TCS_W()) throw CORBA::BAD_INV_ORDER();  // there is no ORB yet
  stream.setByteSwapFlag(is_little);
  encode(type, value, stream);
  const auto* first = static_cast<const std::byte*>(stream.bufPtr());
  to.assign(first, first + stream.bufSize());
}

}  // namespace python
