#include "corba/asker.h"

// Each needs the one before it.
// clang-format off
#include <omniORB4/CORBA.h>
#include <omniORB4/omniInterceptors.h>
#include <omniORB4/internal/giopStream.h>
#include <omniORB4/internal/giopStrand.h>
#include <omniORB4/internal/GIOP_C.h>
// clang-format on

#include <utility>

#include "base/log.h"
#include "corba/call_context.h"
#include "corba/guarded_transport.h"
#include "corba/orb.h"
#include "corba/remote_participant.h"

namespace corba {
namespace {

constexpr std::chrono::milliseconds longest_answer{2000};

thread_local Asker asker_of_thread = Asker::own;
thread_local bool asks_on_its_own = false;

bool was_sent_on(omni::GIOP_C& call) {
  auto* descriptor = call.calldescriptor();
  if (descriptor == nullptr || descriptor->objref() == nullptr) return false;
  const omni_tracedmutex_lock held(*omni::internalLock);
  return descriptor->objref()->_isForwardLocation() != 0;
}

_CORBA_Boolean say_asker(omni::omniInterceptors::clientSendRequest_T::info_T& call) {
  Asker who = asker_of_thread;
  if (who == Asker::own && !asks_on_its_own && doors_are_open() && was_sent_on(call.giop_c)) who = Asker::network;
  if (who != Asker::own) add_to_call(call.service_contexts, CallContext::asker, static_cast<std::uint64_t>(who));
  return true;
}

}  // namespace

Asker asker() { return asker_of_thread; }

void set_asker(Asker asker) {
  asker_of_thread = asker;
  asks_on_its_own = true;
}

ForAsker::ForAsker(Asker asker) : before_(std::exchange(asker_of_thread, asker)) {}
ForAsker::~ForAsker() { asker_of_thread = before_; }

AsksOnItsOwn::AsksOnItsOwn() : before_(std::exchange(asks_on_its_own, true)) {}
AsksOnItsOwn::~AsksOnItsOwn() { asks_on_its_own = before_; }

bool may_keep(CORBA::Object_ptr object) {
  if (CORBA::is_nil(object) || asker_of_thread == Asker::own) return true;
  try {
    const CORBA::Object_var asked = impatient_copy(object, longest_answer);
    if (!asked->_non_existent()) return true;
  } catch (const CORBA::Exception& e) {
    base::log(base::Level::warn, "doors", "{}: a reference of its call does not answer it: {}", caller(), to_text(e));
  }
  return false;
}

void pass_on_asker() { omniORB::getInterceptors()->clientSendRequest.add(&say_asker); }

}  // namespace corba
