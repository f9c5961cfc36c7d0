// Checks whether bytes are a valid value of an IDL type, without building the value: truncated data, false counts and invalid enumerators
// are rejected before the value is read. Immutable, so any thread.
//
// Payloads of data ports have no anys. A payload that cannot be a value of the port's type is answered with PORT_ERROR.
#pragma once

#include <omniORB4/CORBA.h>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/sample.h"

namespace corba {

class Shape {
 public:
  // Fits everything.
  Shape() = default;
  explicit Shape(CORBA::TypeCode_ptr code);

  // `octets`: CDR without a head, aligned from the first octet (CORBA 3.1 part 2, 9.3). Never rejects what omniORB decodes; of types with
  // wide text, unions, references, any, fixed and long double it says no more than up to the first of those. What follows the value is not
  // looked at. Never throws; takes time with the number of elements, but not for arrays of numbers.
  // `has_leftovers`: whether the octets that align the members of the value, which say nothing, are other than zero: senders leave in them
  // what was there before, so that equal values have other octets in each run.
  bool fits(std::span<const std::byte> octets, rt::ByteOrder order, bool* has_leftovers = nullptr) const;
  // Makes them zero, as our own encoder does.
  void clear_leftovers(std::span<std::byte> octets, rt::ByteOrder order) const;

  // No value is longer [octets]. Nothing when there is no such number: the type has a sequence or a text of any length, or more than can be
  // said of it.
  std::optional<std::uint64_t> max_octets() const { return max_octets(root_); }

 private:
  enum class Kind : std::uint8_t { unknown, number, enumeration, text, sequence, array, structure };
  struct Node {
    Kind kind = Kind::unknown;
    std::uint8_t size = 0;        // of a number, and of every number in an array or structure that holds nothing else; else 0
    std::uint64_t count = 0;      // such numbers; enumerators; most elements (0: any number) or letters
    std::vector<Node> members{};  // the element of sequences and arrays
  };
  class Walk;

  static Node compile(CORBA::TypeCode_ptr code, int depth);
  static std::optional<std::uint64_t> max_octets(const Node& node);

  Node root_;
};

}  // namespace corba
