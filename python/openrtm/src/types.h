// IDL types, compiled from the descriptors of the stubs (tuples, see packages/omniORB). Created and used with the interpreter's lock,
// except where marked; they exist until the process ends.
#pragma once

#include <Python.h>
#include <omniORB4/CORBA.h>

#include <cstdint>
#include <string>
#include <vector>

namespace python {

struct Type;

struct Member {
  PyObject* name = nullptr;  // interned
  const Type* type = nullptr;
};

struct Type {
  CORBA::TCKind kind = CORBA::tk_null;
  PyObject* descriptor = nullptr;
  std::string id, name;
  PyObject* maker = nullptr;        // of structures, unions, exceptions: the class; of enumerations: the items
  std::vector<Member> members{};    // of structures, exceptions; of unions by case
  const Type* element = nullptr;    // of sequences, arrays, aliases; of unions the discriminator
  std::uint32_t bound = 0;          // of texts and sequences; the length of arrays
  std::vector<PyObject*> labels{};  // of the cases of a union
  int default_case = -1;
  bool is_flat = false;   // consists of numbers, texts and records of them: encoded without the ORB
  bool is_plain = false;  // decoded by tp_new and attributes
};

// Counts one level of nested types or values. False if the levels exceed Python's recursion limit; then its RecursionError is set. With the
// interpreter's lock.
class Nesting {
 public:
  Nesting() : is_entered_(Py_EnterRecursiveCall(" in a value of IDL") == 0) {}
  ~Nesting() {
    if (is_entered_) Py_LeaveRecursiveCall();
  }
  Nesting(const Nesting&) = delete;
  Nesting& operator=(const Nesting&) = delete;
  explicit operator bool() const { return is_entered_; }

 private:
  const bool is_entered_;
};

// The type of a descriptor; nullptr with a Python exception.
const Type* type_of(PyObject* descriptor);
// Without aliases. Any thread.
inline const Type& actual(const Type& type) {
  const Type* at = &type;
  while (at->kind == CORBA::tk_alias) at = at->element;
  return *at;
}
// Its type code, for the wire; a new reference. Throws CORBA::Exception.
CORBA::TypeCode_ptr code_of(const Type& type);
// The descriptor of a type code that has come from the wire: that of the stubs if they know the type. nullptr with a Python exception.
PyObject* descriptor_of(CORBA::TypeCode_ptr code);
// Of the class of a value, by its repository id: nullptr with a Python exception.
const Type* type_of_value(PyObject* value);
// "long", "sequence<double>", "RTC/TimedLong". Any thread.
std::string name_of(const Type& type);

// omniORB.<name>, borrowed for ever; nullptr with a Python exception.
PyObject* of_module(const char* module, const char* name);

// What a registry of the module omniORB (typeMapping, objrefMapping) has for a repository id, borrowed. Loads the stub file that has it.
// Null without an exception if there is none.
PyObject* registered(const char* registry, PyObject* id);
PyObject* registered(const char* registry, const char* id);

}  // namespace python
