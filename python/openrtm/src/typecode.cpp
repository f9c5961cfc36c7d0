// Type codes of the ORB from compiled types, and back.
#include <cstring>

#include "coder.h"
#include "gil.h"
#include "types.h"

namespace python {
namespace {

CORBA::ORB_var the_orb() {
  int argc = 0;
  return CORBA::ORB_init(argc, nullptr);
}

class Codes {
 public:
  CORBA::TypeCode_ptr make(const Type& type) {
    switch (type.kind) {
      case CORBA::tk_null:
        return CORBA::TypeCode::_duplicate(CORBA::_tc_null);
      case CORBA::tk_void:
        return CORBA::TypeCode::_duplicate(CORBA::_tc_void);
      case CORBA::tk_short:
        return CORBA::TypeCode::_duplicate(CORBA::_tc_short);
      case CORBA::tk_long:
        return CORBA::TypeCode::_duplicate(CORBA::_tc_long);
      case CORBA::tk_ushort:
        return CORBA::TypeCode::_duplicate(CORBA::_tc_ushort);
      case CORBA::tk_ulong:
        return CORBA::TypeCode::_duplicate(CORBA::_tc_ulong);
      case CORBA::tk_float:
        return CORBA::TypeCode::_duplicate(CORBA::_tc_float);
      case CORBA::tk_double:
        return CORBA::TypeCode::_duplicate(CORBA::_tc_double);
      case CORBA::tk_boolean:
        return CORBA::TypeCode::_duplicate(CORBA::_tc_boolean);
      case CORBA::tk_char:
        return CORBA::TypeCode::_duplicate(CORBA::_tc_char);
      case CORBA::tk_octet:
        return CORBA::TypeCode::_duplicate(CORBA::_tc_octet);
      case CORBA::tk_any:
        return CORBA::TypeCode::_duplicate(CORBA::_tc_any);
      case CORBA::tk_TypeCode:
        return CORBA::TypeCode::_duplicate(CORBA::_tc_TypeCode);
      case CORBA::tk_longlong:
        return CORBA::TypeCode::_duplicate(CORBA::_tc_longlong);
      case CORBA::tk_ulonglong:
        return CORBA::TypeCode::_duplicate(CORBA::_tc_ulonglong);
      case CORBA::tk_wchar:
        return CORBA::TypeCode::_duplicate(CORBA::_tc_wchar);
      case CORBA::tk_string:
        return the_orb()->create_string_tc(type.bound);
      case CORBA::tk_wstring:
        return the_orb()->create_wstring_tc(type.bound);
      default:
        return composed(type);
    }
  }

 private:
  CORBA::TypeCode_ptr composed(const Type& type) {
    const CORBA::ORB_var orb = the_orb();
    for (const Type* outer : around_)
      if (outer == &type) return orb->create_recursive_tc(type.id.c_str());
    around_.push_back(&type);
    struct Leave {
      std::vector<const Type*>& around;
      ~Leave() { around.pop_back(); }
    } const leave{around_};
    switch (type.kind) {
      case CORBA::tk_objref:
        return type.id == "IDL:omg.org/CORBA/Object:1.0" ? CORBA::TypeCode::_duplicate(CORBA::_tc_Object)
                                                         : orb->create_interface_tc(type.id.c_str(), type.name.c_str());
      case CORBA::tk_alias: {
        const CORBA::TypeCode_var element = make(*type.element);
        return orb->create_alias_tc(type.id.c_str(), type.name.c_str(), element);
      }
      case CORBA::tk_sequence: {
        const CORBA::TypeCode_var element = make(*type.element);
        return orb->create_sequence_tc(type.bound, element);
      }
      case CORBA::tk_array: {
        const CORBA::TypeCode_var element = make(*type.element);
        return orb->create_array_tc(type.bound, element);
      }
      case CORBA::tk_enum: {
        CORBA::EnumMemberSeq names;
        const Py_ssize_t count = PyTuple_GET_SIZE(type.maker);
        names.length(static_cast<CORBA::ULong>(count));
        for (Py_ssize_t i = 0; i < count; ++i) {
          const Ref name(PyObject_GetAttrString(PyTuple_GET_ITEM(type.maker, i), "_n"));
          names[static_cast<CORBA::ULong>(i)] = name ? PyUnicode_AsUTF8(name.get()) : "";
        }
        return orb->create_enum_tc(type.id.c_str(), type.name.c_str(), names);
      }
      case CORBA::tk_struct:
      case CORBA::tk_except: {
        CORBA::StructMemberSeq members;
        members.length(static_cast<CORBA::ULong>(type.members.size()));
        for (CORBA::ULong i = 0; i < members.length(); ++i) {
          members[i].name = PyUnicode_AsUTF8(type.members[i].name);
          members[i].type = make(*type.members[i].type);
        }
        return type.kind == CORBA::tk_except ? orb->create_exception_tc(type.id.c_str(), type.name.c_str(), members)
                                             : orb->create_struct_tc(type.id.c_str(), type.name.c_str(), members);
      }
      case CORBA::tk_union: {
        const CORBA::TypeCode_var discriminator = make(*type.element);
        CORBA::UnionMemberSeq members;
        members.length(static_cast<CORBA::ULong>(type.members.size()));
        for (CORBA::ULong i = 0; i < members.length(); ++i) {
          members[i].name = PyUnicode_AsUTF8(type.members[i].name);
          members[i].type = make(*type.members[i].type);
          if (static_cast<int>(i) == type.default_case)
            members[i].label <<= CORBA::Any::from_octet(0);
          else
            set_label(members[i].label, *type.element, discriminator, type.labels[i]);
        }
        return orb->create_union_tc(type.id.c_str(), type.name.c_str(), discriminator, members);
      }
      default:
        throw CORBA::BAD_TYPECODE();
    }
  }
  static void set_label(CORBA::Any& label, const Type& type, CORBA::TypeCode_ptr code, PyObject* value) {
    cdrMemoryStream stream;
    CORBA::TypeCode::marshalTypeCode(code, stream);
    try {
      encode(type, value, stream);
    } catch (const BadValue&) {
      throw CORBA::BAD_TYPECODE();
    }
    label <<= stream;
  }

  std::vector<const Type*> around_;
};

// A text of a type code from the network, which can contain any bytes.
PyObject* text(const char* octets) { return PyUnicode_DecodeUTF8(octets, static_cast<Py_ssize_t>(std::strlen(octets)), "replace"); }

PyObject* by_stubs(const char* id) {
  PyObject* const found = id && *id ? registered("typeMapping", id) : nullptr;
  Py_XINCREF(found);
  return found;
}

PyObject* members_of(CORBA::TypeCode_ptr code, bool is_exception) {
  static PyObject* const make_class = of_module("omniORB.any", "_anonymous_struct");
  const CORBA::ULong count = code->member_count();
  const Ref names(PyTuple_New(count));
  const Ref tuple(PyTuple_New(4 + 2 * static_cast<Py_ssize_t>(count)));
  for (CORBA::ULong i = 0; i < count; ++i) {
    PyTuple_SET_ITEM(names.get(), i, text(code->member_name(i)));
    const CORBA::TypeCode_var member = code->member_type(i);
    PyObject* const descriptor = descriptor_of(member);
    if (!descriptor) return nullptr;
    PyTuple_SET_ITEM(tuple.get(), 4 + 2 * i, text(code->member_name(i)));
    PyTuple_SET_ITEM(tuple.get(), 5 + 2 * i, descriptor);
  }
  PyObject* const made = make_class ? PyObject_CallOneArg(make_class, names.get()) : nullptr;
  if (!made) return nullptr;
  PyTuple_SET_ITEM(tuple.get(), 0, PyLong_FromLong(is_exception ? CORBA::tk_except : CORBA::tk_struct));
  PyTuple_SET_ITEM(tuple.get(), 1, made);
  PyTuple_SET_ITEM(tuple.get(), 2, text(code->id()));
  PyTuple_SET_ITEM(tuple.get(), 3, text(code->name()));
  return Py_NewRef(tuple.get());
}

}  // namespace

CORBA::TypeCode_ptr code_of(const Type& type) { return Codes().make(type); }

PyObject* descriptor_of(CORBA::TypeCode_ptr code) {
  const auto kind = code->kind();
  switch (kind) {
    case CORBA::tk_string:
    case CORBA::tk_wstring:
      return Py_BuildValue("(iI)", static_cast<int>(kind), code->length());
    case CORBA::tk_sequence:
    case CORBA::tk_array: {
      const CORBA::TypeCode_var content = code->content_type();
      PyObject* const element = descriptor_of(content);
      return element ? Py_BuildValue("(iNI)", static_cast<int>(kind), element, code->length()) : nullptr;
    }
    case CORBA::tk_alias:
      if (PyObject* known = by_stubs(code->id())) return known;
      {
        const CORBA::TypeCode_var content = code->content_type();
        return descriptor_of(content);
      }
    case CORBA::tk_objref:
      if (PyObject* known = by_stubs(code->id())) return known;
      return Py_BuildValue("(iNN)", static_cast<int>(kind), text(code->id()), text(code->name()));
    case CORBA::tk_struct:
    case CORBA::tk_except:
      if (PyObject* known = by_stubs(code->id())) return known;
      return members_of(code, kind == CORBA::tk_except);
    case CORBA::tk_enum:
    case CORBA::tk_union:
      if (PyObject* known = by_stubs(code->id())) return known;
      PyErr_Format(PyExc_TypeError, "the stubs of %s are not loaded", code->id());
      return nullptr;
    default:
      return PyLong_FromLong(kind);
  }
}

}  // namespace python
