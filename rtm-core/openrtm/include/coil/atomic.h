// Atomic arithmetic on plain integers, as the 1.x API has it. Each returns the value from before; sequentially consistent. Any thread.
#pragma once

#include <type_traits>

namespace coil {

template <class T>
T atomic_exchange_add(T* value, std::common_type_t<T> amount) {
  return __atomic_fetch_add(value, amount, __ATOMIC_SEQ_CST);
}
template <class T>
T atomic_add(T* value, std::common_type_t<T> amount) {
  return atomic_exchange_add(value, amount);
}
template <class T>
T atomic_incr(T* value) {
  return atomic_exchange_add(value, 1);
}
template <class T>
T atomic_decr(T* value) {
  return atomic_exchange_add(value, -1);
}

}  // namespace coil
