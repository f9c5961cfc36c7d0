// Encodes Python values to CDR and decodes them, by compiled types. With the interpreter's lock.
#pragma once

#include <Python.h>
#include <omniORB4/CORBA.h>

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "types.h"

namespace python {

// A value that the type has no place for: the way to it from the value that was to be encoded ("data[3].x", empty for itself).
struct BadValue {
  std::string path, expected, given;
  std::string text() const { return (path.empty() ? "" : path + ": ") + "expected " + expected + ", got " + given; }
};
// Octets that are no value of the type.
struct BadOctets {};
// A Python exception is set.
struct PythonFailed {};

using Octets = std::vector<std::byte>;

// Plain CDR without a head, aligned from the first octet of `to`, which is cleared first. Throws BadValue, PythonFailed, CORBA::Exception.
void encode(const Type& type, PyObject* value, bool is_little, Octets& to);
// A new reference. Octets after the value are left alone. Throws BadOctets, PythonFailed, CORBA::Exception.
PyObject* decode(const Type& type, std::span<const std::byte> octets, bool is_little);

// The same over streams of the ORB.
void encode(const Type& type, PyObject* value, cdrStream& stream);
PyObject* decode(const Type& type, cdrStream& stream);

// Text of IDL strings. Written as Latin-1 if it fits and as UTF-8 otherwise, read as UTF-8 if it is that and as Latin-1 otherwise, unless
// text_coding has been set to "utf-8" or "latin-1".
enum class TextCoding { automatic, utf8, latin1 };
void set_text_coding(TextCoding coding);
TextCoding text_coding();

}  // namespace python
