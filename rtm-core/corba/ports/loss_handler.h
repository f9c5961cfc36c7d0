// Notifies a port, on any thread, that the other end of a connection does not exist any more. Any thread.
#pragma once

#include <functional>
#include <string>

#include "corba/orb/gate.h"

namespace corba {

// `close` ends it; nobody is inside any more when it returns.
class LossHandler {
 public:
  explicit LossHandler(std::function<void(const std::string& id)> handle) : handle_(std::move(handle)) {}
  void lost(const std::string& id) {
    const Gate::Visit visit(gate_);
    if (visit) handle_(id);
  }
  void close() { gate_.close(); }

 private:
  const std::function<void(const std::string& id)> handle_;
  Gate gate_;
};

}  // namespace corba
