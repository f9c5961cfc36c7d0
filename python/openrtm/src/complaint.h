// Limits log lines about errors that repeat, such as one in each sample, call or cycle. An equal text is logged once, until a different one
// follows. Of different texts, eight are logged at once, then one per second. With the interpreter's lock.
#pragma once

#include <optional>
#include <string>

namespace pybind11 {
class module_;
}

namespace python {

class Complaint {
 public:
  // The text as it is to be logged; nothing: it is left out.
  std::optional<std::string> next(const std::string& text);
  // The same, but an equal text counts like another one.
  std::optional<std::string> each(const std::string& text);

 private:
  std::string last_;
  double credit_ = 8;   // lines
  double paid_at_ = 0;  // [s]
  unsigned long left_out_ = 0;
};

void add_complaints(pybind11::module_& module);

}  // namespace python
