#include "types.h"

#include <map>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "gil.h"

namespace python {
namespace {

// The tuple is kept, so that its address stays its own.
std::unordered_map<PyObject*, const Type*>& compiled() {
  static auto& types = *new std::unordered_map<PyObject*, const Type*>;
  return types;
}

const Type* wrong(PyObject* descriptor) {
  if (!PyErr_Occurred()) PyErr_Format(PyExc_TypeError, "%R is no type descriptor", descriptor);
  return nullptr;
}

std::string text_of(PyObject* object) {
  const char* utf8 = object && PyUnicode_Check(object) ? PyUnicode_AsUTF8(object) : nullptr;
  if (!utf8) PyErr_Clear();
  return utf8 ? utf8 : "";
}

const Type* basic(long kind, PyObject* descriptor) {
  static Type* all[33] = {};
  if (kind < 0 || kind > 32) return wrong(descriptor);
  switch (kind) {
    case CORBA::tk_struct:
    case CORBA::tk_union:
    case CORBA::tk_enum:
    case CORBA::tk_sequence:
    case CORBA::tk_array:
    case CORBA::tk_alias:
    case CORBA::tk_except:
    case CORBA::tk_objref:
      return wrong(descriptor);
    default:
      break;
  }
  if (!all[kind]) {
    auto* type = new Type;
    type->kind = static_cast<CORBA::TCKind>(kind);
    type->descriptor = PyLong_FromLong(kind);
    switch (type->kind) {
      case CORBA::tk_null:
      case CORBA::tk_void:
      case CORBA::tk_any:
      case CORBA::tk_TypeCode:
      case CORBA::tk_wchar:
      case CORBA::tk_wstring:
      case CORBA::tk_longdouble:
        break;
      default:
        type->is_flat = true;
    }
    all[kind] = type;
  }
  return all[kind];
}

bool fill_members(Type& type, PyObject* descriptor) {
  const Py_ssize_t size = PyTuple_GET_SIZE(descriptor);
  type.is_flat = true;
  for (Py_ssize_t i = 4; i + 1 < size; i += 2) {
    PyObject* name = PyTuple_GET_ITEM(descriptor, i);
    if (!PyUnicode_Check(name)) return false;
    Py_INCREF(name);
    PyUnicode_InternInPlace(&name);
    const Type* member = type_of(PyTuple_GET_ITEM(descriptor, i + 1));
    if (!member) return false;
    type.is_flat = type.is_flat && member->is_flat;
    type.members.push_back({name, member});
  }
  return true;
}

bool fill_union(Type& type, PyObject* descriptor) {
  if (PyTuple_GET_SIZE(descriptor) < 9) return false;
  type.element = type_of(PyTuple_GET_ITEM(descriptor, 4));
  type.default_case = static_cast<int>(PyLong_AsLong(PyTuple_GET_ITEM(descriptor, 5)));
  PyObject* cases = PyTuple_GET_ITEM(descriptor, 6);
  if (!type.element || PyErr_Occurred() || !PyTuple_Check(cases)) return false;
  for (Py_ssize_t i = 0; i < PyTuple_GET_SIZE(cases); ++i) {
    PyObject* one = PyTuple_GET_ITEM(cases, i);
    if (!PyTuple_Check(one) || PyTuple_GET_SIZE(one) != 3) return false;
    const Type* member = type_of(PyTuple_GET_ITEM(one, 2));
    if (!member) return false;
    type.labels.push_back(PyTuple_GET_ITEM(one, 0));
    type.members.push_back({PyTuple_GET_ITEM(one, 1), member});
  }
  return true;
}

bool fill(Type& type, PyObject* descriptor) {
  const Py_ssize_t size = PyTuple_GET_SIZE(descriptor);
  const auto item = [&](Py_ssize_t i) { return i < size ? PyTuple_GET_ITEM(descriptor, i) : nullptr; };
  switch (type.kind) {
    case CORBA::tk_string:
    case CORBA::tk_wstring:
      type.is_flat = type.kind == CORBA::tk_string;
      type.bound = size > 1 ? static_cast<std::uint32_t>(PyLong_AsUnsignedLong(item(1))) : 0;
      return !PyErr_Occurred();
    case CORBA::tk_struct:
    case CORBA::tk_except:
    case CORBA::tk_union:
      if (size < 4) return false;
      type.maker = item(1);
      type.id = text_of(item(2));
      type.name = text_of(item(3));
      return type.kind == CORBA::tk_union ? fill_union(type, descriptor) : fill_members(type, descriptor);
    case CORBA::tk_enum:
      if (size < 4 || !PyTuple_Check(item(3))) return false;
      type.id = text_of(item(1));
      type.name = text_of(item(2));
      type.maker = item(3);
      type.is_flat = true;
      return true;
    case CORBA::tk_sequence:
    case CORBA::tk_array:
      if (size < 3) return false;
      type.element = type_of(item(1));
      type.bound = static_cast<std::uint32_t>(PyLong_AsUnsignedLong(item(2)));
      type.is_flat = type.element && type.element->is_flat;
      return type.element && !PyErr_Occurred();
    case CORBA::tk_alias:
      if (size < 4) return false;
      type.id = text_of(item(1));
      type.name = text_of(item(2));
      type.element = type_of(item(3));
      type.is_flat = type.element && type.element->is_flat;
      return type.element != nullptr;
    case CORBA::tk_objref:
      type.id = text_of(item(1));
      type.name = text_of(item(2));
      return true;
    default:
      return false;
  }
}

// Stubs register their descriptors; all others can be created again for each any.
bool is_registered(PyObject* descriptor) {
  if (PyTuple_GET_SIZE(descriptor) < 3) return false;
  const bool has_class = PyUnicode_Check(PyTuple_GET_ITEM(descriptor, 2)) && !PyUnicode_Check(PyTuple_GET_ITEM(descriptor, 1));
  PyObject* const id = PyTuple_GET_ITEM(descriptor, has_class ? 2 : 1);
  return PyUnicode_Check(id) && registered("typeMapping", id) == descriptor;
}

// Types with equal parts are stored once: otherwise each value in an any would add a type.
const Type* with_parts(PyObject* descriptor, CORBA::TCKind kind) {
  using Parts =
      std::tuple<CORBA::TCKind, const Type*, std::uint32_t, PyObject*, std::string, std::vector<std::pair<PyObject*, const Type*>>>;
  static auto& known = *new std::map<Parts, const Type*>;
  constexpr std::size_t most = 10'000;  // peers can send any number of types
  Type type;
  type.kind = kind;
  const bool is_good = fill(type, descriptor);
  std::vector<std::pair<PyObject*, const Type*>> members;
  for (const Member& member : type.members) members.emplace_back(member.name, member.type);
  const Type* found = nullptr;
  if (is_good) {
    Parts parts{kind, type.element, type.bound, type.maker, type.id, members};
    if (const auto at = known.find(parts); at != known.end()) {
      found = at->second;
    } else if (known.size() < most) {
      type.descriptor = Py_NewRef(descriptor);
      for (const Member& member : type.members) Py_INCREF(member.name);
      found = known[std::move(parts)] = new Type(std::move(type));
    } else {
      PyErr_SetString(PyExc_TypeError, "too many types that no stubs have");
    }
  }
  for (const auto& member : members) Py_DECREF(member.first);
  return found ? found : wrong(descriptor);
}

bool has_parts_only(CORBA::TCKind kind, PyObject* descriptor) {
  switch (kind) {
    case CORBA::tk_string:
    case CORBA::tk_wstring:
    case CORBA::tk_sequence:
    case CORBA::tk_array:
      return true;
    case CORBA::tk_struct:
    case CORBA::tk_except:
    case CORBA::tk_objref:
      return !is_registered(descriptor);
    default:
      return false;
  }
}

}  // namespace

PyObject* of_module(const char* module, const char* name) {
  const Ref found(PyImport_ImportModule(module));
  PyObject* object = found ? PyObject_GetAttrString(found.get(), name) : nullptr;
  return object;  // of modules that stay: the reference is kept for ever
}

PyObject* registered(const char* registry, PyObject* id) {
  const Ref entries(of_module("omniORB", registry));
  PyObject* found = entries ? PyDict_GetItem(entries.get(), id) : nullptr;
  if (entries && !found) {
    const Ref loaded(PyObject_GetItem(entries.get(), id));
    found = loaded.get();  // the registry keeps it
  }
  if (!found) PyErr_Clear();
  return found;
}

PyObject* registered(const char* registry, const char* id) {
  const Ref text(PyUnicode_FromString(id));
  if (text) return registered(registry, text.get());
  PyErr_Clear();
  return nullptr;
}

const Type* type_of(PyObject* descriptor) {
  if (PyLong_Check(descriptor)) return basic(PyLong_AsLong(descriptor), descriptor);
  if (!PyTuple_Check(descriptor) || PyTuple_GET_SIZE(descriptor) == 0 || !PyLong_Check(PyTuple_GET_ITEM(descriptor, 0)))
    return wrong(descriptor);
  const auto known = compiled().find(descriptor);
  if (known != compiled().end()) return known->second;
  const unsigned long kind = PyLong_AsUnsignedLong(PyTuple_GET_ITEM(descriptor, 0));
  if (kind == 0xffffffffUL) {  // a type inside itself, by its id
    PyObject* const ids = PyTuple_GET_SIZE(descriptor) > 1 ? PyTuple_GET_ITEM(descriptor, 1) : nullptr;
    PyObject* const id = ids && PyList_Check(ids) && PyList_GET_SIZE(ids) > 0 ? PyList_GET_ITEM(ids, 0) : nullptr;
    PyObject* const target = id ? registered("typeMapping", id) : nullptr;
    return target && target != descriptor ? type_of(target) : wrong(descriptor);
  }
  const Nesting nesting;
  if (!nesting) return nullptr;
  if (has_parts_only(static_cast<CORBA::TCKind>(kind), descriptor)) return with_parts(descriptor, static_cast<CORBA::TCKind>(kind));
  auto* type = new Type;
  type->kind = static_cast<CORBA::TCKind>(kind);
  type->descriptor = descriptor;
  Py_INCREF(descriptor);
  compiled()[descriptor] = type;  // before its members, which may be of it
  if (fill(*type, descriptor)) {
    if (type->kind == CORBA::tk_struct && type->maker && PyType_Check(type->maker))
      type->is_plain = reinterpret_cast<PyTypeObject*>(type->maker)->tp_new == PyBaseObject_Type.tp_new;
    return type;
  }
  compiled().erase(descriptor);
  return wrong(descriptor);
}

const Type* type_of_value(PyObject* value) {
  const Ref id(PyObject_GetAttrString(value, "_NP_RepositoryId"));
  if (!id) {
    PyErr_Format(PyExc_TypeError, "the value of a data port must be a structure of an IDL file, got %s", Py_TYPE(value)->tp_name);
    return nullptr;
  }
  PyObject* const descriptor = registered("typeMapping", id.get());
  if (descriptor) return type_of(descriptor);
  PyErr_Format(PyExc_TypeError, "the stubs of %R are not loaded", id.get());
  return nullptr;
}

std::string name_of(const Type& type) {
  static constexpr const char* names[] = {
      "null",  "void",  "short",     "long",      "unsigned short",     "unsigned long", "float", "double", "boolean", "char",
      "octet", "any",   "TypeCode",  "Principal", "reference",          "struct",        "union", "enum",   "string",  "sequence",
      "array", "alias", "exception", "long long", "unsigned long long", "long double",   "wchar", "wstring"};
  switch (type.kind) {
    case CORBA::tk_sequence:
      return "sequence<" + name_of(*type.element) + ">";
    case CORBA::tk_array:
      return name_of(*type.element) + "[" + std::to_string(type.bound) + "]";
    case CORBA::tk_alias:
      return name_of(*type.element);
    case CORBA::tk_string:
    case CORBA::tk_wstring:
      return names[type.kind] + (type.bound ? "<" + std::to_string(type.bound) + ">" : std::string());
    case CORBA::tk_struct:
    case CORBA::tk_union:
    case CORBA::tk_enum:
    case CORBA::tk_except:
    case CORBA::tk_objref: {
      const auto from = type.id.find(':'), to = type.id.rfind(':');
      return from < to && to != std::string::npos ? type.id.substr(from + 1, to - from - 1) : type.name;
    }
    default:
      return static_cast<std::size_t>(type.kind) < std::size(names) ? names[type.kind] : "unknown";
  }
}

}  // namespace python
