// Sequences of IDL grow by one. Values.
#pragma once

namespace corba {

template <class Sequence, class Element>
void append(Sequence& sequence, const Element& element) {
  const auto length = sequence.length();
  sequence.length(length + 1);
  sequence[length] = element;
}

}  // namespace corba
