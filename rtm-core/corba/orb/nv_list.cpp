#include "corba/orb/nv_list.h"

#include "core/key_limits.h"

namespace corba {
namespace {

CORBA::Any& value_of(SDOPackage::NVList& list, std::string_view name) {
  for (CORBA::ULong i = 0; i < list.length(); ++i) {
    if (name == list[i].name.in()) return list[i].value;
  }
  const CORBA::ULong length = list.length();
  list.length(length + 1);
  list[length].name = CORBA::string_dup(std::string(name).c_str());
  return list[length].value;
}

}  // namespace

rt::KeyValues to_key_values(const SDOPackage::NVList& list) {
  rt::KeyValues values;
  for (CORBA::ULong i = 0; i < list.length(); ++i) {
    const char* text = nullptr;
    if (list[i].value >>= text) values[list[i].name.in()] = text;
  }
  return values;
}

const CORBA::Any* find_value(const SDOPackage::NVList& list, std::string_view name) {
  for (CORBA::ULong i = 0; i < list.length(); ++i) {
    if (name == list[i].name.in()) return &list[i].value;
  }
  return nullptr;
}

std::optional<std::string> find_text(const SDOPackage::NVList& list, std::string_view name) {
  const CORBA::Any* value = find_value(list, name);
  const char* text = nullptr;
  if (!value || !(*value >>= text)) return std::nullopt;
  return text;
}

base::Result<void> check_keys(std::string_view what, const SDOPackage::NVList& list) {
  rt::KeyCounter counter(what);
  for (CORBA::ULong i = 0; i < list.length(); ++i) {
    if (auto checked = counter.add(list[i].name.in()); !checked) return checked;
  }
  return {};
}

void set_text(SDOPackage::NVList& list, std::string_view name, std::string_view value) {
  value_of(list, name) <<= std::string(value).c_str();
}

void set_value(SDOPackage::NVList& list, std::string_view name, const CORBA::Any& value) { value_of(list, name) = value; }

}  // namespace corba
