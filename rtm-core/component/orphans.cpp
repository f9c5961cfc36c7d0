// What becomes of a component when the process of a composite or a context that it takes part in has died: it gets its own life back.
//
// Within two seconds, unless other peers hang; the manager looks at that interval (leaveTheDead).
#include "component/component_impl.h"

#include "corba/orb/call_timeout.h"
#include "corba/orb/orb.h"

namespace RTC {
namespace {

constexpr std::chrono::seconds peer_timeout{1};  // with one peer

// A process that hangs is not dead.
bool is_dead(CORBA::ORB_ptr orb, CORBA::Object_ptr object) {
  try {
    // A reference of its own, so that the time-out is for this call alone.
    CORBA::String_var text = orb->object_to_string(object);
    CORBA::Object_var own = orb->string_to_object(text);
    corba::set_call_timeout(own, peer_timeout);
    return own->_non_existent();
  } catch (const CORBA::TIMEOUT&) {
    return false;
  } catch (const CORBA::TRANSIENT& exception) {
    return exception.minor() != omni::TRANSIENT_CallTimedout;
  } catch (const CORBA::COMM_FAILURE&) {
    return true;
  } catch (const CORBA::Exception&) {
    return false;
  }
}

}  // namespace

void RTObject_impl::leaveTheDead() {
  std::vector<ExecutionContext_var> contexts;
  std::vector<SDOPackage::Organization_var> organizations;
  std::vector<ExecutionContext_var> own;
  {
    auto data = impl_->shared.lock();
    if (data->phase != Impl::Phase::alive) return;
    contexts = data->foreign;
    organizations = data->organizations;
    own = data->own;
  }
  CORBA::ORB_ptr orb = m_pManager != nullptr ? m_pORB.in() : CORBA::ORB::_nil();
  if (CORBA::is_nil(orb)) return;
  // Peers that hang take a second each: who is not asked in time is the first the next time.
  const std::size_t count = contexts.size() + organizations.size();
  const corba::ChainDeadline deadline{peer_timeout};
  bool was_member = false;
  for (std::size_t asked = 0; asked < count && !deadline.is_over(); ++asked) {
    const std::size_t i = impl_->shared.lock()->next_to_look_at++ % count;
    if (i < contexts.size()) {
      if (CORBA::is_nil(contexts[i]) || !is_dead(orb, contexts[i])) continue;
      const auto handle = static_cast<ExecutionContextHandle_t>(i) + foreign_offset;
      rt::log_rejection(rtclog, Logger::RTL_WARN,
                        "the process of execution context " + std::to_string(handle) + " exited: left the context");
      const bool was_active = impl_->shared.lock()->active_in.contains(handle);
      if (was_active) on_deactivated(handle);
      detach_context(handle);
      continue;
    }
    SDOPackage::Organization_var& organization = organizations[i - contexts.size()];
    if (!is_dead(orb, organization)) continue;
    rt::log_rejection(rtclog, Logger::RTL_WARN, "the process of a composite component exited: this component uses its own context again");
    was_member = true;
    auto data = impl_->shared.lock();
    std::erase_if(data->organizations, [&](const SDOPackage::Organization_var& known) { return known->_is_equivalent(organization); });
  }
  if (!was_member || !impl_->shared.lock()->organizations.empty()) return;
  for (ExecutionContext_var& context : own) {
    if (!context->is_running()) context->start();
  }
}

}  // namespace RTC
