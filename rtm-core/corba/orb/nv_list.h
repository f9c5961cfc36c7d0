// Converts name-value lists of the wire to texts, and reads single entries. Any thread; the lists are values.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/result.h"
#include "core/connector_settings.h"
#include "rtm/idl/SDOPackageStub.h"

namespace corba {

// String values only; of entries of the same name the last counts.
rt::KeyValues to_key_values(const SDOPackage::NVList& list);
// nullptr if there is none of that name.
const CORBA::Any* find_value(const SDOPackage::NVList& list, std::string_view name);
// Nothing if there is none of that name or it is no string.
std::optional<std::string> find_text(const SDOPackage::NVList& list, std::string_view name);
// Fails with one line that begins with `what` when the names are more, longer or deeper than core/key_limits.h allows.
base::Result<void> check_keys(std::string_view what, const SDOPackage::NVList& list);
// Replaces the entry of that name or adds one.
void set_text(SDOPackage::NVList& list, std::string_view name, std::string_view value);
void set_value(SDOPackage::NVList& list, std::string_view name, const CORBA::Any& value);

}  // namespace corba
