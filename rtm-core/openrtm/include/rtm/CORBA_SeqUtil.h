// Sequences of the wire used like containers. Sequences are values: one thread at a time.
#pragma once

#include <omniORB4/CORBA.h>
#include <rtm/Manager.h>

#include <chrono>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace CORBA_SeqUtil {

template <class Sequence, class Functor>
Functor for_each(Sequence& sequence, Functor function) {
  for (CORBA::ULong i = 0; i < sequence.length(); ++i) function(sequence[i]);
  return function;
}

// The index of the first element for which the predicate holds, or -1.
template <class Sequence, class Functor>
CORBA::Long find(const Sequence& sequence, Functor predicate) {
  for (CORBA::ULong i = 0; i < sequence.length(); ++i) {
    if (predicate(sequence[i])) return static_cast<CORBA::Long>(i);
  }
  return -1;
}

template <class Sequence, class Element>
void push_back(Sequence& sequence, Element element) {
  const CORBA::ULong length = sequence.length();
  sequence.length(length + 1);
  sequence[length] = element;
}

template <class Sequence>
void push_back_list(Sequence& sequence, const Sequence& more) {
  const CORBA::ULong length = sequence.length();
  const CORBA::ULong added = more.length();
  sequence.length(length + added);
  for (CORBA::ULong i = 0; i < added; ++i) sequence[length + i] = more[i];
}

// Before `index`; at the end if that is beyond it.
template <class Sequence, class Element>
void insert(Sequence& sequence, Element& element, CORBA::ULong index) {
  const CORBA::ULong length = sequence.length();
  if (index > length) index = length;
  sequence.length(length + 1);
  for (CORBA::ULong i = length; i > index; --i) sequence[i] = sequence[i - 1];
  sequence[index] = element;
}

// Only if the sequence is not empty.
template <class Element, class Sequence>
const Element& front(const Sequence& sequence) {
  return sequence[0];
}
template <class Element, class Sequence>
const Element& back(const Sequence& sequence) {
  return sequence[sequence.length() - 1];
}

// Nothing happens beyond the end.
template <class Sequence>
void erase(Sequence& sequence, CORBA::ULong index) {
  const CORBA::ULong length = sequence.length();
  if (index >= length) return;
  for (CORBA::ULong i = index; i + 1 < length; ++i) sequence[i] = sequence[i + 1];
  sequence.length(length - 1);
}

// The first element for which the predicate holds.
template <class Sequence, class Functor>
void erase_if(Sequence& sequence, Functor predicate) {
  const CORBA::Long index = find(sequence, predicate);
  if (index >= 0) erase(sequence, static_cast<CORBA::ULong>(index));
}

template <class Sequence>
void clear(Sequence& sequence) {
  sequence.length(0);
}

// The references of a list, stringified by the ORB of this process.
template <class ObjectList>
std::vector<std::string> refToVstring(const ObjectList& list) {
  int argc = 0;
  const CORBA::ORB_var orb = CORBA::ORB_init(argc, nullptr);
  std::vector<std::string> texts;
  for (CORBA::ULong i = 0; i < list.length(); ++i) {
    const CORBA::String_var text = orb->object_to_string(list[i]);
    texts.emplace_back(text.in());
  }
  return texts;
}

}  // namespace CORBA_SeqUtil
