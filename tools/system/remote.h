// Calls to other processes, made safe: every CORBA exception becomes one line. Any thread.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "base/result.h"
#include "rtm/idl/RTCStub.h"

namespace tools {

using base::Error;
using base::Result;

// Key/value view of an NVList whose values are strings; other kinds of value are left out.
using Properties = std::map<std::string, std::string>;
Properties to_properties(const SDOPackage::NVList& list);
SDOPackage::NVList to_nv_list(const Properties& properties);
std::string property(const Properties& properties, const std::string& key, const std::string& otherwise = "");

// What an exception means to the person who called: "does not answer within the timeout", "does not exist any more", ...
std::string describe(const CORBA::Exception& exception);
// True when the exception says that the peer is there but silent.
bool is_time_out(const CORBA::Exception& exception);

// Runs `call` and turns what it throws into an error "<what>: <reason>".
Result<void> remote(const std::string& what, const std::function<void()>& call);

// "ok" or an error "<what>: <CODE>, <meaning>".
Result<void> check(const std::string& what, RTC::ReturnCode_t code, const std::string& meaning = "");

// Calls that this thread makes give up after `limit`, for the guard's life.
class CallLimit {
 public:
  explicit CallLimit(std::chrono::milliseconds limit);
  ~CallLimit();
  CallLimit(const CallLimit&) = delete;
  CallLimit& operator=(const CallLimit&) = delete;

 private:
  const unsigned long before_;  // [ms]; the limit of the guard around this one
};

// Calls work(0) ... work(count - 1) on up to `threads` threads and returns when all are done. Each call runs under the limit.
void in_parallel(std::size_t count, std::chrono::milliseconds limit, const std::function<void(std::size_t)>& work,
                 std::size_t threads = 32);

// Its service for parameters. Throws CORBA::NO_IMPLEMENT when the component has none, and what the call throws.
SDOPackage::Configuration_var configuration_of(RTC::RTObject_ptr component);

std::string state_text(RTC::LifeCycleState state);
std::string kind_text(RTC::ExecutionKind kind);

}  // namespace tools
