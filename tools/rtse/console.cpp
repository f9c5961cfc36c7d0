#include "rtse/console.h"

#include <iostream>
#include <nlohmann/json.hpp>

#include "base/text.h"

namespace tools {

void Console::print(const nlohmann::ordered_json& value) const {
  std::cout << value.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';  // texts of peers may be invalid UTF-8
}

void Console::fail(const base::Error& error) {
  std::cout.flush();
  std::cerr << "rtse: " + base::printable(error.message, "\n\t") + "\n";  // it contains texts of peers
  failed_ = true;
}

void Console::reject(const base::Error& error) {
  fail(error);
  is_rejected_ = true;
}

void Console::fail(const std::vector<base::Error>& errors) {
  for (const auto& error : errors) fail(error);
}

void Console::warn(const std::string& text) { std::cerr << "rtse: " + base::printable(text, "\n\t") + "\n"; }

}  // namespace tools
