// Composite components: the organization of their members, which is that of RTC::PeriodicECSharedComposite.
//
// Rights: the component has one organization, made once, before anything else is called; it ends with _rtm_members("close").
#pragma once

#include <memory>

#include "component.h"

namespace python {

void add_organization_of_components(pybind11::class_<Component, std::shared_ptr<Component>>& cls);

}  // namespace python
