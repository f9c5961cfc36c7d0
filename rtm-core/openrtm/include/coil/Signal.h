// Signal handlers as the classic API sets them. Any thread.
#pragma once

#include <csignal>

namespace coil {

using SignalHandler = void (*)(int);

inline SignalHandler signal(int signum, SignalHandler handler) { return std::signal(signum, handler); }

class SignalAction {
 public:
  SignalAction() = default;
  // Sets the handler at once for signum, if that is not 0. `mask` are the signals held back meanwhile.
  SignalAction(SignalHandler handler, int signum, const sigset_t* mask = nullptr, int flags = 0) {
    action_.sa_handler = handler;
    action_.sa_flags = flags;
    if (mask != nullptr)
      action_.sa_mask = *mask;
    else
      ::sigemptyset(&action_.sa_mask);
    if (signum != 0) ::sigaction(signum, &action_, nullptr);
  }
  SignalHandler handler() const { return action_.sa_handler; }
  void handler(SignalHandler handler) { action_.sa_handler = handler; }
  sigset_t mask() const { return action_.sa_mask; }
  void mask(sigset_t mask) { action_.sa_mask = mask; }
  int flags() const { return action_.sa_flags; }
  void flags(int flags) { action_.sa_flags = flags; }
  int register_action(int signum, SignalAction* old = nullptr) { return ::sigaction(signum, &action_, old ? &old->action_ : nullptr); }

 private:
  struct sigaction action_ {};
};

}  // namespace coil
