// The transports corba_cdr and data_service: the same calls under other names. The octets of a sample go from the encoder to the socket and
// from the socket into a block of the receiving port without further copies; that is why calls are put together here and not by the stubs.
// First, because the next two do not stand alone.
#include <omniORB4/CORBA.h>

#include <omniORB4/callDescriptor.h>
#include <omniORB4/callHandle.h>
#include <omniORB4/minorCode.h>
#include <omniORB4/omniORB.h>

#include <cstring>
#include <set>
#include <string>

#include "base/guarded.h"
#include "base/log.h"
#include "corba/orb/call_timeout.h"
#include "corba/ports/provider.h"
#include "corba/transport/transport.h"
#include "rtm/idl/DataPortSkel.h"
#include "rtm/idl/DataPort_OpenRTMSkel.h"

namespace corba {
namespace {

// The wire's PortStatus, the same numbers in OpenRTM and RTC.
enum class WireStatus : CORBA::ULong { ok, error, buffer_full, buffer_empty, buffer_timeout, unknown_error };

WireStatus to_wire(rt::PortStatus status) {
  switch (status) {
    case rt::PortStatus::ok:
      return WireStatus::ok;
    case rt::PortStatus::buffer_full:
      return WireStatus::buffer_full;
    case rt::PortStatus::buffer_empty:
      return WireStatus::buffer_empty;
    case rt::PortStatus::buffer_timeout:
      return WireStatus::buffer_timeout;
    case rt::PortStatus::unknown_error:
      return WireStatus::unknown_error;
    default:
      return WireStatus::error;
  }
}

rt::PortStatus from_put(WireStatus status) {
  switch (status) {
    case WireStatus::ok:
      return rt::PortStatus::ok;
    case WireStatus::buffer_full:
      return rt::PortStatus::send_full;
    case WireStatus::buffer_timeout:
      return rt::PortStatus::send_timeout;
    case WireStatus::unknown_error:
      return rt::PortStatus::unknown_error;
    default:
      return rt::PortStatus::error;
  }
}

rt::PortStatus from_get(WireStatus status) {
  switch (status) {
    case WireStatus::ok:
      return rt::PortStatus::ok;
    case WireStatus::buffer_empty:
      return rt::PortStatus::buffer_empty;
    case WireStatus::buffer_timeout:
      return rt::PortStatus::recv_timeout;
    case WireStatus::unknown_error:
      return rt::PortStatus::unknown_error;
    default:
      return rt::PortStatus::error;
  }
}

WireStatus read_status(cdrStream& stream) {
  const CORBA::ULong number = stream.unmarshalULong();
  return number <= static_cast<CORBA::ULong>(WireStatus::unknown_error) ? static_cast<WireStatus>(number) : WireStatus::error;
}

std::shared_ptr<rt::Block> read_octets(cdrStream& stream, rt::BlockPool& pool) {
  const CORBA::ULong size = stream.unmarshalULong();
  // Before any memory is taken for a length that somebody made up.
  if (size > omniORB::giopMaxMsgSize() || !stream.checkInputOverrun(1, size)) throw CORBA::MARSHAL();
  auto block = pool.take(size);
  if (size) stream.get_octet_array(reinterpret_cast<CORBA::Octet*>(block->data()), static_cast<int>(size));
  return block;
}

std::shared_ptr<rt::Block> copy_octets(const _CORBA_Unbounded_Sequence_Octet& octets, rt::BlockPool& pool) {
  auto block = pool.take(octets.length());
  if (octets.length()) std::memcpy(block->data(), octets.get_buffer(), octets.length());
  return block;
}

// What differs between the two interfaces.
struct CdrNames {
  using InSkeleton = POA_OpenRTM::InPortCdr;
  using OutSkeleton = POA_OpenRTM::OutPortCdr;
  using InStub = OpenRTM::InPortCdr;
  using OutStub = OpenRTM::OutPortCdr;
  using Octets = OpenRTM::CdrData;
  using Status = OpenRTM::PortStatus;
  static constexpr const char* put = "put";
  static constexpr const char* get = "get";
  static Status call_put(OpenRTM::_impl_InPortCdr& servant, const Octets& octets) { return servant.put(octets); }
  static Status call_get(OpenRTM::_impl_OutPortCdr& servant, OpenRTM::CdrData_out octets) { return servant.get(octets); }
  using InImpl = OpenRTM::_impl_InPortCdr;
  using OutImpl = OpenRTM::_impl_OutPortCdr;
  using OctetsVar = OpenRTM::CdrData_var;
  using OctetsOut = OpenRTM::CdrData_out;
};

struct ServiceNames {
  using InSkeleton = POA_RTC::DataPushService;
  using OutSkeleton = POA_RTC::DataPullService;
  using InStub = RTC::DataPushService;
  using OutStub = RTC::DataPullService;
  using Octets = RTC::OctetSeq;
  using Status = RTC::PortStatus;
  static constexpr const char* put = "push";
  static constexpr const char* get = "pull";
  static Status call_put(RTC::_impl_DataPushService& servant, const Octets& octets) { return servant.push(octets); }
  static Status call_get(RTC::_impl_DataPullService& servant, RTC::OctetSeq_out octets) { return servant.pull(octets); }
  using InImpl = RTC::_impl_DataPushService;
  using OutImpl = RTC::_impl_DataPullService;
  using OctetsVar = RTC::OctetSeq_var;
  using OctetsOut = RTC::OctetSeq_out;
};

// put, the caller's side.
template <class Names>
class PutCall final : public omniCallDescriptor {
 public:
  explicit PutCall(const Pieces& pieces)
      : omniCallDescriptor(&call_local, Names::put, std::strlen(Names::put) + 1, false, nullptr, 0, false), pieces_(pieces) {}

  void marshalArguments(cdrStream& stream) override {
    stream.marshalULong(static_cast<CORBA::ULong>(pieces_.size));
    for (const auto& part : pieces_.parts) {
      stream.put_octet_array(reinterpret_cast<const CORBA::Octet*>(part.data()), static_cast<int>(part.size()));
    }
  }
  void unmarshalReturnedValues(cdrStream& stream) override { status_ = read_status(stream); }

  WireStatus status() const { return status_; }

 private:
  // The peer's object is in this process.
  static void call_local(omniCallDescriptor* descriptor, omniServant* servant) {
    auto& call = *static_cast<PutCall*>(descriptor);
    auto* target = static_cast<typename Names::InImpl*>(servant->_ptrToInterface(Names::InStub::_PD_repoId));
    const auto size = static_cast<CORBA::ULong>(call.pieces_.size);
    if (call.pieces_.parts.size() == 1) {
      auto* octets = reinterpret_cast<CORBA::Octet*>(const_cast<std::byte*>(call.pieces_.parts.front().data()));
      const typename Names::Octets borrowed(size, size, octets, false);
      call.status_ = static_cast<WireStatus>(Names::call_put(*target, borrowed));
      return;
    }
    typename Names::Octets joined;
    joined.length(size);
    CORBA::Octet* to = joined.get_buffer();
    for (const auto& part : call.pieces_.parts) {
      std::memcpy(to, part.data(), part.size());
      to += part.size();
    }
    call.status_ = static_cast<WireStatus>(Names::call_put(*target, joined));
  }

  const Pieces& pieces_;
  WireStatus status_ = WireStatus::unknown_error;
};

// put, the servant's side.
template <class Names>
class PutUpcall final : public omniCallDescriptor {
 public:
  PutUpcall(Receiver& receiver, rt::ByteOrder order)
      : omniCallDescriptor(&call_local, Names::put, std::strlen(Names::put) + 1, false, nullptr, 0, true), receiver_(receiver) {
    sample_.order = order;
  }

  void unmarshalArguments(cdrStream& stream) override { sample_.block = read_octets(stream, receiver_.pool()); }
  void marshalReturnedValues(cdrStream& stream) override { stream.marshalULong(static_cast<CORBA::ULong>(status_)); }

 private:
  static void call_local(omniCallDescriptor* descriptor, omniServant*) {
    auto& call = *static_cast<PutUpcall*>(descriptor);
    call.status_ = to_wire(call.receiver_.receive(std::move(call.sample_)));
  }

  Receiver& receiver_;
  rt::Sample sample_;
  WireStatus status_ = WireStatus::unknown_error;
};

template <class Names>
class InServant final : public Names::InSkeleton, public PortableServer::RefCountServantBase {
 public:
  InServant(std::shared_ptr<Receiver> receiver, rt::ByteOrder order) : receiver_(std::move(receiver)), order_(order) {}

  CORBA::Boolean _dispatch(omniCallHandle& handle) override {
    if (std::strcmp(handle.operation_name(), Names::put) != 0) return Names::InSkeleton::_dispatch(handle);
    PutUpcall<Names> call(*receiver_, order_);
    handle.upcall(this, call);
    return true;
  }

  // Calls from this process.
  typename Names::Status put(const typename Names::Octets& octets) { return take(octets); }
  typename Names::Status push(const typename Names::Octets& octets) { return take(octets); }

 private:
  typename Names::Status take(const typename Names::Octets& octets) {
    rt::Sample sample;
    sample.block = copy_octets(octets, receiver_->pool());
    sample.order = order_;
    return static_cast<typename Names::Status>(to_wire(receiver_->receive(std::move(sample))));
  }

  std::shared_ptr<Receiver> receiver_;
  rt::ByteOrder order_;
};

template <class Names>
class OutServant final : public Names::OutSkeleton, public PortableServer::RefCountServantBase {
 public:
  explicit OutServant(std::shared_ptr<Source> source) : source_(std::move(source)) {}

  typename Names::Status get(typename Names::OctetsOut octets) { return give(octets); }
  typename Names::Status pull(typename Names::OctetsOut octets) { return give(octets); }

 private:
  typename Names::Status give(typename Names::OctetsOut octets) {
    rt::Sample sample;
    const rt::PortStatus status = source_->give(sample);
    typename Names::OctetsVar result = new typename Names::Octets();
    if (status == rt::PortStatus::ok) {
      result->length(static_cast<CORBA::ULong>(sample.block->size()));
      if (sample.block->size()) std::memcpy(result->get_buffer(), sample.block->data(), sample.block->size());
    }
    octets = result._retn();
    return static_cast<typename Names::Status>(to_wire(status));
  }

  std::shared_ptr<Source> source_;
};

// Calls the peer. A connection that ends while the answer is awaited may only have been idle too long for the peer's taste: once more then.
template <class Call>
rt::PortStatus calling(const Line& line, Call call) {
  for (bool is_second = false;; is_second = true) {
    try {
      return call();
    } catch (const CORBA::COMM_FAILURE& e) {
      if (is_second || e.minor() != omni::COMM_FAILURE_WaitingForReply) return status_of(e, line);
    } catch (const CORBA::SystemException& e) {
      return status_of(e, line);
    }
  }
}

template <class Names>
class CdrSender final : public Sender {
 public:
  CdrSender(typename Names::InStub::_ptr_type in_port, const Line& line) : in_port_(in_port), line_(line) {}

  rt::PortStatus send(Payload& payload) override {
    const Pieces* pieces = nullptr;
    try {
      pieces = &payload.pieces(line_.order);
    } catch (const CORBA::SystemException& e) {
      base::log(base::Level::error, line_.port, "a {} cannot be encoded: {}", payload.ops().type_id, e._name());
      return rt::PortStatus::error;
    }
    return calling(line_, [&] {
      PutCall<Names> call(*pieces);
      in_port_->_PR_getobj()->_invoke(call);
      return from_put(call.status());
    });
  }

 private:
  typename Names::InStub::_var_type in_port_;
  const Line line_;
};

// get, the caller's side.
template <class Names>
class GetCall final : public omniCallDescriptor {
 public:
  explicit GetCall(rt::BlockPool& pool)
      : omniCallDescriptor(&call_local, Names::get, std::strlen(Names::get) + 1, false, nullptr, 0, false), pool_(pool) {}

  void unmarshalReturnedValues(cdrStream& stream) override {
    status = read_status(stream);
    block = read_octets(stream, pool_);
  }

  WireStatus status = WireStatus::unknown_error;
  std::shared_ptr<rt::Block> block;

 private:
  static void call_local(omniCallDescriptor* descriptor, omniServant* servant) {
    auto& call = *static_cast<GetCall*>(descriptor);
    auto* target = static_cast<typename Names::OutImpl*>(servant->_ptrToInterface(Names::OutStub::_PD_repoId));
    typename Names::OctetsVar octets;
    call.status = static_cast<WireStatus>(Names::call_get(*target, octets.out()));
    call.block = copy_octets(octets.in(), call.pool_);
  }

  rt::BlockPool& pool_;
};

template <class Names>
class CdrFetcher final : public Fetcher {
 public:
  CdrFetcher(typename Names::OutStub::_ptr_type out_port, const Line& line) : out_port_(out_port), line_(line) {}

  rt::PortStatus fetch(rt::Sample& sample) override {
    return calling(line_, [&] {
      GetCall<Names> call(*pool_);
      out_port_->_PR_getobj()->_invoke(call);
      if (call.status == WireStatus::ok) {
        sample.block = std::move(call.block);
        sample.order = line_.order;
      }
      return from_get(call.status);
    });
  }

 private:
  typename Names::OutStub::_var_type out_port_;
  const Line line_;
  std::shared_ptr<rt::BlockPool> pool_ = rt::BlockPool::make();
};

// nil if it is another interface or does not answer when asked for it.
template <class Stub>
typename Stub::_ptr_type narrow(CORBA::Object_ptr object, const Line& line) {
  limit_calls(object, std::min(line.call_timeout, port_call_timeout()));
  try {
    typename Stub::_var_type narrowed = Stub::_narrow(object);
    limit_calls(narrowed, line.call_timeout);
    return narrowed._retn();
  } catch (const CORBA::Exception&) {
    return Stub::_nil();
  }
}

// Connections whose peer has thrown, until they are gone. Never destroyed: ports may die after it otherwise.
base::Guarded<std::set<std::string>, base::Rank::noted>& refused_connections() {
  static auto& ids = *new base::Guarded<std::set<std::string>, base::Rank::noted>;
  return ids;
}

template <class Names>
std::unique_ptr<Sender> make_sender(CORBA::Object_ptr object, const Line& line) {
  typename Names::InStub::_var_type in_port = narrow<typename Names::InStub>(object, line);
  if (CORBA::is_nil(in_port)) return nullptr;
  return std::make_unique<CdrSender<Names>>(in_port._retn(), line);
}

template <class Names>
std::unique_ptr<Fetcher> make_fetcher(CORBA::Object_ptr object, const Line& line) {
  typename Names::OutStub::_var_type out_port = narrow<typename Names::OutStub>(object, line);
  if (CORBA::is_nil(out_port)) return nullptr;
  return std::make_unique<CdrFetcher<Names>>(out_port._retn(), line);
}

}  // namespace

CORBA::ORB_var orb() {
  int argc = 0;
  return CORBA::ORB_init(argc, nullptr);
}

bool take_refusal(const std::string& connector_id) { return refused_connections().lock()->erase(connector_id) > 0; }

rt::PortStatus status_of(const CORBA::SystemException& problem, const Line& line) {
  // The sample is to blame, not the peer: it exceeds the longest message of this ORB, or cannot be encoded.
  const bool is_about_the_sample = dynamic_cast<const CORBA::MARSHAL*>(&problem) || dynamic_cast<const CORBA::BAD_PARAM*>(&problem);
  const bool is_unreachable = dynamic_cast<const CORBA::COMM_FAILURE*>(&problem) || dynamic_cast<const CORBA::TRANSIENT*>(&problem) ||
                              dynamic_cast<const CORBA::TIMEOUT*>(&problem);
  const std::string why =
      std::string(problem._name()) + " (" + (problem.NP_minorString() ? problem.NP_minorString() : "no minor code") + ")";
  if (is_about_the_sample) {
    base::log(base::Level::warn, line.port, "connection {}: a sample cannot be sent: {}", line.connection, why);
  } else {
    base::log(base::Level::warn, line.port, "connection {}{}{} {}", line.connection, lost_mark,
              is_unreachable ? "the peer does not answer:" : "the peer throws", why);
    // A peer that has ended the connection rejects nothing: a sample may be on its way when it is told to.
    const bool is_ended = dynamic_cast<const CORBA::OBJECT_NOT_EXIST*>(&problem) != nullptr;
    if (!is_unreachable && !is_ended) refused_connections().lock()->insert(line.connector_id);
  }
  return is_about_the_sample ? rt::PortStatus::error : rt::PortStatus::connection_lost;
}

std::unique_ptr<Sender> make_cdr_sender(rt::Interface interface, CORBA::Object_ptr in_port, const Line& line) {
  return interface == rt::Interface::data_service ? make_sender<ServiceNames>(in_port, line) : make_sender<CdrNames>(in_port, line);
}

std::unique_ptr<Fetcher> make_cdr_fetcher(rt::Interface interface, CORBA::Object_ptr out_port, const Line& line) {
  return interface == rt::Interface::data_service ? make_fetcher<ServiceNames>(out_port, line) : make_fetcher<CdrNames>(out_port, line);
}

std::unique_ptr<Provider> make_cdr_in_provider(rt::Interface interface, std::shared_ptr<Receiver> receiver, const Line& line) {
  if (interface == rt::Interface::data_service) {
    return std::make_unique<ActiveServant<RTC::DataPushService>>(new InServant<ServiceNames>(std::move(receiver), line.order));
  }
  return std::make_unique<ActiveServant<OpenRTM::InPortCdr>>(new InServant<CdrNames>(std::move(receiver), line.order));
}

std::unique_ptr<Provider> make_cdr_out_provider(rt::Interface interface, std::shared_ptr<Source> source, const Line&) {
  if (interface == rt::Interface::data_service)
    return std::make_unique<ActiveServant<RTC::DataPullService>>(new OutServant<ServiceNames>(std::move(source)));
  return std::make_unique<ActiveServant<OpenRTM::OutPortCdr>>(new OutServant<CdrNames>(std::move(source)));
}

}  // namespace corba
