#include "ticked_context.h"

#include <base/text.h>

namespace iface {
namespace {

constexpr std::chrono::milliseconds asking_limit{10'000};
constexpr std::chrono::milliseconds without_end = std::chrono::hours(24 * 20);

void limit(CORBA::Object_ptr object, std::chrono::milliseconds time) {
  if (!CORBA::is_nil(object)) omniORB::setClientCallTimeout(object, static_cast<CORBA::ULong>(time.count()));
}

}  // namespace

base::Result<TickedContext> TickedContext::resolve(CORBA::ORB_ptr orb, const std::string& reference) {
  const auto fail = [](const std::string& why) { return base::Error{"context that is to be ticked: " + why}; };
  if (!reference.starts_with("IOR:")) return fail("expected its reference, IOR:..., got " + base::in_quotes(reference));
  try {
    CORBA::Object_var object = orb->string_to_object(reference.c_str());
    limit(object, asking_limit);
    TickedContext context;
    context.triggered_ = OpenRTM::ExtTrigExecutionContextService::_narrow(object);
    if (CORBA::is_nil(context.triggered_)) context.logical_ = OpenRTM::LogicalTimeTriggeredEC::_narrow(object);
    if (CORBA::is_nil(context.triggered_) && CORBA::is_nil(context.logical_)) return fail("the object has no tick()");
    limit(context.triggered_, without_end);
    limit(context.logical_, without_end);
    return context;
  } catch (const CORBA::Exception& exception) {
    return fail(std::string("does not answer: ") + exception._name());
  }
}

TickedContext::Answer TickedContext::tick(std::chrono::nanoseconds now, std::string& why) {
  try {
    if (!CORBA::is_nil(triggered_)) {
      triggered_->tick();
    } else {
      const auto us = std::chrono::duration_cast<std::chrono::microseconds>(now).count();
      logical_->tick(static_cast<CORBA::ULong>(us / 1'000'000), static_cast<CORBA::ULong>(us % 1'000'000));
    }
    return Answer::done;
  } catch (const CORBA::COMM_FAILURE& exception) {
    why = exception._name();
  } catch (const CORBA::TRANSIENT& exception) {
    why = exception._name();
  } catch (const CORBA::OBJECT_NOT_EXIST& exception) {
    why = exception._name();
  } catch (const CORBA::Exception& exception) {
    why = exception._name();
    return Answer::threw;
  }
  return Answer::gone;
}

}  // namespace iface
