#include "rtm/DataType.h"

#include "base/clock.h"
#include "component/runtime_access.h"
#include "corba/transport/type_ops.h"
#include "rtm/Timestamp.h"

namespace RTC {

struct detail::DataType::Ops : corba::TypeOps {};

const corba::TypeOps& RuntimeAccess::ops(const detail::DataType& type) { return *type.ops_; }

namespace detail {

DataType::DataType(std::unique_ptr<Ops> ops) : ops_(std::move(ops)) {}

DataType::DataType(const TypeTable& table) : DataType(std::make_unique<Ops>()) {
  const CORBA::TypeCode_var code = table.code();
  ops_->type_id = code->id();
  ops_->type = table.type;
  ops_->make = table.make;
  ops_->copy = table.copy;
  ops_->assign = table.assign;
  ops_->encode = table.encode;
  ops_->decode = table.decode;
  ops_->stamp = table.stamp;
  ops_->has_wide_text = corba::has_wide_text(code);
  ops_->shape = corba::Shape(code);
}

DataType::~DataType() = default;

const char* DataType::id() const { return ops_->type_id.c_str(); }

const DataType& DataType::any() {
  struct Nothing {};
  static const DataType type = [] {
    Ops ops{};
    ops.type_id = "Any";
    ops.type = &typeid(Nothing);
    ops.make = []() -> std::shared_ptr<void> { return std::make_shared<Nothing>(); };
    ops.copy = [](const void*) -> std::shared_ptr<void> { return std::make_shared<Nothing>(); };
    ops.assign = [](void*, const void*) {};
    ops.encode = [](const void*, cdrStream&) {};
    ops.decode = [](void*, cdrStream&) {};
    return DataType(std::make_unique<Ops>(std::move(ops)));
  }();
  return type;
}

Stamp current_stamp() {
  const auto now = base::current_clock().now().count();
  return {static_cast<CORBA::ULong>(now / 1'000'000'000), static_cast<CORBA::ULong>(now % 1'000'000'000)};
}

}  // namespace detail
}  // namespace RTC

bool RTC::inSimulatedTime() { return base::current_clock().is_simulated(); }
