// An execution context with one member that writes down how it is called, and both as text.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <ostream>

#include "core/execution_context.h"
#include "support/recording_participant.h"

namespace rt {

inline std::ostream& operator<<(std::ostream& out, Action action) { return out << to_text(action); }
inline std::ostream& operator<<(std::ostream& out, State state) { return out << to_text(state); }
inline std::ostream& operator<<(std::ostream& out, ReturnCode code) { return out << to_text(code); }

}  // namespace rt

namespace support {

struct ContextFixture : testing::Test {
  ContextFixture() : id(context.add(participant)) { context.start(), participant->take(); }

  void activate() {
    ASSERT_EQ(context.request(id, rt::Event::activate), rt::ReturnCode::ok);
    context.step();
    participant->take();
  }
  void fail() {
    activate();
    participant->answers[rt::Action::execute] = RecordingParticipant::Answer::error;
    context.step();
    context.step();
    participant->answers[rt::Action::execute] = RecordingParticipant::Answer::ok;
    participant->take();
    ASSERT_EQ(context.state(id), rt::State::error);
  }

  std::shared_ptr<RecordingParticipant> participant = std::make_shared<RecordingParticipant>();
  rt::ExecutionContext context;
  rt::MemberId id;
};

}  // namespace support
