#include "rtm/EventPort.h"

namespace RTC::detail {
namespace {

struct Nothing {};

class OnlyCdr final : public Serializers {
  std::vector<std::string> names() const override { return {"cdr"}; }
  std::shared_ptr<corba::Codec> make(const std::string&, const coil::Properties&) const override { return nullptr; }
};

}  // namespace

const corba::TypeOps& any_type_ops() {
  static const corba::TypeOps ops{
      .type_id = "Any",
      .type = &typeid(Nothing),
      .make = []() -> std::shared_ptr<rt::Value> { return std::make_shared<corba::ValueOf<Nothing>>(); },
      .copy = [](const void*) -> std::shared_ptr<rt::Value> { return std::make_shared<corba::ValueOf<Nothing>>(); },
      .assign = [](void*, const void*) {},
      .encode = [](const void*, cdrStream&) {},
      .decode = [](void*, cdrStream&) {},
      .stamp = nullptr,
      .is_stamp_first = false,
      .has_wide_text = false,
  };
  return ops;
}

const Serializers& any_serializers() {
  static const OnlyCdr all;
  return all;
}

bool is_event(const ConnectorInfo& info, const std::string& event) {
  const std::string& named = info.properties.getProperty("fsm_event_name");
  return named.empty() ? info.name == event : named == event;
}

}  // namespace RTC::detail
