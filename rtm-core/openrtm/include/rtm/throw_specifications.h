// Lets sources written before C++17 compile that say which exceptions a function throws: void f() throw (CORBA::SystemException). Included
// before everything else (-include) by the package OpenRTM where a project has such sources, and by hand elsewhere.
// `throw (types)` becomes a noexcept; an expression behind it, as in throw (error), does not compile, so that nothing thrown is lost.
#pragma once

#if defined(__cplusplus) && !defined(throw)
// The library's own headers throw in this form.
#if __has_include(<bits/stdc++.h>)
#include <bits/stdc++.h>
#endif
#include <type_traits>

namespace rtm_sim {
template <class... Exceptions>
constexpr std::enable_if_t<!(std::is_function_v<Exceptions> || ...), bool> throws_nothing() {
  return sizeof...(Exceptions) == 0;
}
}  // namespace rtm_sim

#define throw(...) noexcept(::rtm_sim::throws_nothing<__VA_ARGS__>())
#endif
