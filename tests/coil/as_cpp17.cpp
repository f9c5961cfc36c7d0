// What sources of authors compare, in both orders, as C++17: that it compiles is the test.
#include <coil/Factory.h>
#include <coil/TimeValue.h>
#include <coil/atomic.h>
#include <coil/stringutil.h>

#include <string>
#include <vector>

namespace {

static_assert(coil::FactoryReturn::ERROR == 1 && 1 == coil::FactoryReturn::ERROR);
static_assert(coil::FactoryReturn::ERROR != 0 && 0 != coil::FactoryReturn::ERROR);

constexpr coil::TimeValue shorter(1, 0), longer(2, 0);
static_assert(shorter < longer && shorter <= longer && longer > shorter && longer >= shorter);
static_assert(shorter != longer && !(shorter == longer) && longer - shorter == shorter && shorter + shorter == longer);
static_assert(shorter == 1.0 && 2.5 > longer);

[[maybe_unused]] bool compares(const coil::ChangedString& changed, const std::string& text) {
  return changed == text || text == changed || changed == "a" || "a" == changed || changed != text || text != changed || changed != "a" ||
         "a" != changed;
}

[[maybe_unused]] int counts() {
  int number = 0;
  return coil::atomic_add(&number, 2) + coil::atomic_incr(&number) + coil::atomic_decr(&number);
}

[[maybe_unused]] bool reads(std::vector<double>& numbers, const char* text) { return coil::stringTo(numbers, text); }

}  // namespace
