// Appends to sequences of IDL. Pure; any thread.
#pragma once

namespace corba {

template <class Sequence, class Element>
void append(Sequence& sequence, const Element& element) {
  const auto length = sequence.length();
  sequence.length(length + 1);
  sequence[length] = element;
}

}  // namespace corba
