#include "complaint.h"

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace python {

std::optional<std::string> Complaint::next(const std::string& text) {
  return std::exchange(last_, text) == text ? std::nullopt : each(text);
}

std::optional<std::string> Complaint::each(const std::string& text) {
  constexpr double burst = 8;
  const double now = std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  credit_ = std::min(burst, credit_ + now - std::exchange(paid_at_, now));
  if (credit_ < 1) {
    ++left_out_;
    return std::nullopt;
  }
  credit_ -= 1;
  const unsigned long left_out = std::exchange(left_out_, 0);
  return left_out == 0 ? text : "(" + std::to_string(left_out) + " other lines before this one are not in the log) " + text;
}

void add_complaints(pybind11::module_& module) {
  pybind11::class_<Complaint>(module, "Complaint").def(pybind11::init<>()).def("next", &Complaint::next);
}

}  // namespace python
