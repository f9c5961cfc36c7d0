#include "rtm/EventPort.h"

#include "component/runtime_access.h"
#include "corba/transport/cdr.h"
#include "openrtm/opaque_types.h"

namespace RTC::detail {
namespace {

class OnlyCdr final : public Serializers {
  std::vector<std::string> names() const override { return {"cdr"}; }
  ByteDataStreamBase* create(const std::string&) const override { return nullptr; }
  void destroy(ByteDataStreamBase*) const override {}
  bool serialize(ByteDataStreamBase&, const void*) const override { return false; }
  bool deserialize(ByteDataStreamBase&, void*) const override { return false; }
};

}  // namespace

const Serializers& any_serializers() {
  static const OnlyCdr all;
  return all;
}

bool is_event(const ConnectorInfo& info, const std::string& event) {
  const std::string& named = info.properties.getProperty("fsm_event_name");
  return named.empty() ? info.name == event : named == event;
}

bool EventListenerBase::take(const ConnectorInfo& info, SampleEvent& sample, const DataType& type, void* value) const {
  return is_event(info, event_) && corba::decode(RuntimeAccess::ops(type), value, sample.data.octets(), sample.data.order());
}

}  // namespace RTC::detail
