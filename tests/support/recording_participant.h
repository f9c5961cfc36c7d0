// A participant that writes down what it is told and fails on demand. The stepping thread only, except for calls().
#pragma once

#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/execution_context.h"

namespace support {

class RecordingParticipant final : public rt::Participant {
 public:
  enum class Answer { ok, error, std_exception, other_exception };

  std::string name() const override { return "recorder"; }
  rt::ReturnCode call(rt::Action action) override {
    calls_.push_back(action);
    if (during) during(action);
    switch (answers[action]) {
      case Answer::ok:
        return rt::ReturnCode::ok;
      case Answer::error:
        return rt::ReturnCode::error;
      case Answer::std_exception:
        throw std::runtime_error("no milk today");
      case Answer::other_exception:
        throw 42;
    }
    return rt::ReturnCode::ok;
  }

  // What it was called with since the last time.
  std::vector<rt::Action> take() { return std::exchange(calls_, {}); }
  std::size_t count(rt::Action action) const {
    std::size_t n = 0;
    for (const rt::Action call : calls_) n += call == action;
    return n;
  }

  std::map<rt::Action, Answer> answers;
  std::function<void(rt::Action)> during;

 private:
  std::vector<rt::Action> calls_;
};

}  // namespace support
