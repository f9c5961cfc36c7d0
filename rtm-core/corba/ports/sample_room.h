// Maximum length of samples for an object of this process: a port sets it for its servant, by the type of its data, and the guards of the
// end points read it (corba/orb/giop_gate.h). Any thread.
#pragma once

#include <omniORB4/CORBA.h>

#include <cstddef>
#include <memory>
#include <span>

namespace corba {

// While it lives, samples of so many octets are let in for the object, as far as the settings of the process allow (GiopLimits::sample).
class SampleRoom {
 public:
  SampleRoom(CORBA::Object_ptr object, std::size_t octets);
  ~SampleRoom();
  SampleRoom(const SampleRoom&) = delete;
  SampleRoom& operator=(const SampleRoom&) = delete;

 private:
  struct Key;
  const std::unique_ptr<Key> key_;
};

// What was said for the object with that key; 0 when nothing was.
std::size_t room_for_samples(std::span<const std::byte> object_key);

}  // namespace corba
