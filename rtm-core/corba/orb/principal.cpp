#include "corba/orb/principal.h"

// Each needs the one before it.
// clang-format off
#include <omniORB4/CORBA.h>
#include <omniORB4/omniIOR.h>
#include <omniORB4/omniInterceptors.h>
#include <omniORB4/internal/omniIdentity.h>
#include <omniORB4/internal/giopStream.h>
#include <omniORB4/internal/giopStrand.h>
#include <omniORB4/internal/GIOP_C.h>
// clang-format on

#include <atomic>
#include <chrono>
#include <random>
#include <span>
#include <unordered_map>
#include <utility>

#include "base/guarded.h"
#include "base/hash64.h"
#include "base/log.h"
#include "corba/members/remote_participant.h"
#include "corba/orb/call_context.h"
#include "corba/orb/guarded_transport.h"
#include "corba/orb/orb.h"

namespace corba {
namespace {

constexpr std::size_t max_references = 1'000'000;  // some 40 MB; each connection that a stranger makes gives one or two

thread_local Principal principal_of_thread = Principal::own;

// References of strangers by what is in them, which copies and narrowed ones have, too.
struct Given {
  const std::uint64_t seed = std::random_device()() | std::uint64_t{std::random_device()()} << 32U;
  base::Guarded<std::unordered_map<std::uint64_t, Principal>, base::Rank::log> references;
  std::atomic<bool> are_any{false};
  static Given& instance() {
    static Given& all = *new Given;  // never destroyed: threads may call at the very end
    return all;
  }
};

std::uint64_t fingerprint(omniObjRef* reference) {
  const omniIOR_var ior = reference->_getIOR();
  base::Hash64 hash(Given::instance().seed);
  const auto& profiles = ior->iopProfiles();
  for (CORBA::ULong i = 0; i < profiles.length(); ++i) {
    hash.add(std::uint64_t{profiles[i].tag});
    hash.add(std::as_bytes(std::span(profiles[i].profile_data.get_buffer(), profiles[i].profile_data.length())));
  }
  return hash.value();
}

Principal sender_of(omniObjRef* reference) {
  Given& given = Given::instance();
  if (reference == nullptr || !given.are_any.load(std::memory_order_acquire)) return Principal::own;  // pairs with the store in remember
  const auto print = fingerprint(reference);
  auto references = given.references.lock();
  const auto found = references->find(print);
  return found == references->end() ? Principal::own : found->second;
}

// Who is least trusted counts. False when there are too many.
bool remember(std::uint64_t print, Principal principal) {
  Given& given = Given::instance();
  auto references = given.references.lock();
  if (references->size() >= max_references && !references->contains(print)) return false;
  const auto [place, is_new] = references->try_emplace(print, principal);
  if (!is_new && place->second != principal) place->second = Principal::network;
  given.are_any.store(true, std::memory_order_release);  // pairs with the load in sender_of
  return true;
}

bool is_here(omniObjRef* reference) {
  const omni_tracedmutex_lock held(*omni::internalLock);
  return reference->_identity()->inThisAddressSpace() != 0;
}

omniObjRef* target_of(omni::GIOP_C& call) {
  auto* descriptor = call.calldescriptor();
  return descriptor != nullptr ? descriptor->objref() : nullptr;
}

_CORBA_Boolean say_principal(omni::omniInterceptors::clientSendRequest_T::info_T& call) {
  const Principal who = principal_of_thread != Principal::own ? principal_of_thread : sender_of(target_of(call.giop_c));
  if (who != Principal::own) add_to_call(call.service_contexts, CallContext::principal, static_cast<std::uint64_t>(who));
  return true;
}

// The ORB would put the new reference in the place of the one that we know, or are about to.
_CORBA_Boolean refuse_to_move(omni::omniInterceptors::clientReceiveReply_T::info_T& reply) {
  if (reply.giop_c.replyStatus() != GIOP::LOCATION_FORWARD_PERM) return true;
  if (principal_of_thread == Principal::own && sender_of(target_of(reply.giop_c)) == Principal::own) return true;
  throw CORBA::NO_PERMISSION(0, CORBA::COMPLETED_NO);
}

}  // namespace

Principal principal() { return principal_of_thread; }

void set_principal(Principal principal) { principal_of_thread = principal; }

OnBehalfOf::OnBehalfOf(Principal principal) : before_(std::exchange(principal_of_thread, principal)) {}
OnBehalfOf::~OnBehalfOf() { principal_of_thread = before_; }

Principal sender_of(CORBA::Object_ptr object) { return CORBA::is_nil(object) ? Principal::own : sender_of(object->_PR_getobj()); }

OnBehalfOfSender::OnBehalfOfSender(CORBA::Object_ptr object) {
  if (const Principal sender = sender_of(object); sender != Principal::own) principal_.emplace(sender);
}

bool may_keep(CORBA::Object_ptr object, std::chrono::milliseconds timeout) {
  if (CORBA::is_nil(object) || principal_of_thread == Principal::own) return true;
  omniObjRef* reference = object->_PR_getobj();
  if (reference != nullptr && is_here(reference)) return true;  // ours, and called without a message
  if (reference == nullptr || timeout <= std::chrono::milliseconds::zero()) return false;
  try {
    const CORBA::Object_var asked = copy_with_timeout(object, timeout);
    if (asked->_non_existent()) return false;
  } catch (const CORBA::Exception& e) {
    base::log(base::Level::warn, "doors", "{}: a reference of its call does not answer it: {}", caller(), to_text(e));
    return false;
  }
  // Not before: it may be one of ours, that we call for ourselves meanwhile.
  if (remember(fingerprint(reference), principal_of_thread)) return true;
  base::log(base::Level::warn, "doors", "{}: a reference of its call is rejected: untrusted callers have sent {}", caller(),
            max_references);
  return false;
}

void pass_on_principal() {
  omniORB::getInterceptors()->clientSendRequest.add(&say_principal);
  omniORB::getInterceptors()->clientReceiveReply.add(&refuse_to_move);
}

}  // namespace corba
