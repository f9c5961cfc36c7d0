#include "system/remote.h"

#include <omniORB4/minorCode.h>
#include <omnithread.h>

#include <algorithm>
#include <atomic>
#include <thread>

#include "corba/orb/return_code.h"
#include "corba/orb/tls.h"

namespace tools {

Properties to_properties(const SDOPackage::NVList& list) {
  Properties properties;
  for (CORBA::ULong i = 0; i < list.length(); ++i) {
    const char* text = nullptr;
    if (list[i].value >>= text) properties[list[i].name.in()] = text;
  }
  return properties;
}

SDOPackage::NVList to_nv_list(const Properties& properties) {
  SDOPackage::NVList list;
  list.length(static_cast<CORBA::ULong>(properties.size()));
  CORBA::ULong i = 0;
  for (const auto& [key, value] : properties) {
    list[i].name = key.c_str();
    list[i].value <<= value.c_str();
    ++i;
  }
  return list;
}

std::string property(const Properties& properties, const std::string& key, const std::string& otherwise) {
  const auto found = properties.find(key);
  return found == properties.end() ? otherwise : found->second;
}

bool is_time_out(const CORBA::Exception& exception) {
  if (dynamic_cast<const CORBA::TIMEOUT*>(&exception)) return true;
  const auto* transient = dynamic_cast<const CORBA::TRANSIENT*>(&exception);
  return transient && transient->minor() == omni::TRANSIENT_CallTimedout;
}

std::string describe(const CORBA::Exception& exception) {
  if (is_time_out(exception)) return "does not answer within the timeout (hung, or stopped?)";
  if (dynamic_cast<const CORBA::OBJECT_NOT_EXIST*>(&exception)) return "does not exist any more (its process is running)";
  if (const auto* transient = dynamic_cast<const CORBA::TRANSIENT*>(&exception)) {
    if (transient->minor() == omni::TRANSIENT_NoUsableProfile)
      return "cannot be reached (no such host, or nothing in its address can be used)";
    return corba::tls_of_environment().is_on() ? "cannot be reached (its process has exited, the host does not exist, or over TLS one side "
                                                 "rejects the other's certificate)"
                                               : "cannot be reached (its process has exited, or the host does not exist)";
  }
  if (dynamic_cast<const CORBA::NO_PERMISSION*>(&exception)) return "rejected the call (NO_PERMISSION); see its log";
  if (dynamic_cast<const CORBA::BAD_PARAM*>(&exception)) return "has an invalid address, expected HOST:PORT (BAD_PARAM)";
  if (dynamic_cast<const CORBA::COMM_FAILURE*>(&exception)) return "closed the connection in the middle of the call";
  if (dynamic_cast<const CORBA::NO_IMPLEMENT*>(&exception)) return "does not have this service (NO_IMPLEMENT)";
  if (dynamic_cast<const CORBA::MARSHAL*>(&exception)) return "sent an answer that cannot be read (MARSHAL)";
  if (dynamic_cast<const CORBA::BAD_OPERATION*>(&exception)) return "does not know this operation (BAD_OPERATION)";
  return std::string("failed with ") + exception._name();
}

SDOPackage::Configuration_var configuration_of(RTC::RTObject_ptr component) {
  SDOPackage::Configuration_var configuration = component->get_configuration();
  if (CORBA::is_nil(configuration)) throw CORBA::NO_IMPLEMENT();
  return configuration;
}

Result<void> remote(const std::string& what, const std::function<void()>& call) {
  try {
    call();
    return {};
  } catch (const SDOPackage::NotAvailable& e) {
    return Error{what + ": not available: " + e.description.in()};
  } catch (const SDOPackage::InvalidParameter& e) {
    return Error{what + ": invalid parameter: " + e.description.in()};
  } catch (const SDOPackage::InterfaceNotImplemented& e) {
    return Error{what + ": not implemented: " + e.description.in()};
  } catch (const SDOPackage::InternalError& e) {
    return Error{what + ": internal error: " + e.description.in()};
  } catch (const CORBA::Exception& e) {
    return Error{what + " " + describe(e)};
  }
}

Result<void> check(const std::string& what, RTC::ReturnCode_t code, const std::string& meaning) {
  if (code == RTC::RTC_OK) return {};
  return Error{what + ": " + std::string(rt::to_text(corba::from_wire(code))) + (meaning.empty() ? "" : ", " + meaning)};
}

namespace {

thread_local CORBA::ULong limit_of_thread = 0;  // [ms]; the ORB does not tell it

void set_limit(CORBA::ULong limit) {
  limit_of_thread = limit;
  omniORB::setClientThreadCallTimeout(limit);
}

}  // namespace

CallLimit::CallLimit(std::chrono::milliseconds limit) : before_(limit_of_thread) { set_limit(static_cast<CORBA::ULong>(limit.count())); }
CallLimit::~CallLimit() { set_limit(static_cast<CORBA::ULong>(before_)); }

void in_parallel(std::size_t count, std::chrono::milliseconds limit, const std::function<void(std::size_t)>& work, std::size_t threads) {
  std::atomic<std::size_t> next{0};
  const auto worker = [&] {
    const omni_thread::ensure_self known_to_the_orb;  // time-outs per thread need it
    const CallLimit limited(limit);
    for (std::size_t i = next.fetch_add(1); i < count; i = next.fetch_add(1)) work(i);
  };
  if (count <= 1) return worker();
  std::vector<std::jthread> pool;
  for (std::size_t i = 0; i < std::min(count, threads); ++i) pool.emplace_back(worker);
}

std::string state_text(RTC::LifeCycleState state) {
  switch (state) {
    case RTC::CREATED_STATE:
      return "Created";
    case RTC::INACTIVE_STATE:
      return "Inactive";
    case RTC::ACTIVE_STATE:
      return "Active";
    case RTC::ERROR_STATE:
      return "Error";
    default:
      return "Unknown";
  }
}

std::string kind_text(RTC::ExecutionKind kind) {
  switch (kind) {
    case RTC::PERIODIC:
      return "PERIODIC";
    case RTC::EVENT_DRIVEN:
      return "EVENT_DRIVEN";
    default:
      return "OTHER";
  }
}

}  // namespace tools
