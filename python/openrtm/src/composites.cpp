#include "composites.h"

#include <rtm/PeriodicECOrganization.h>

#include <string>

#include "calls.h"
#include "references.h"

namespace py = pybind11;

namespace python {
namespace {

SDOPackage::PeriodicECOrganization& organization_of(Component& component) {
  if (!component.organization()) throw std::runtime_error("the __init__ of the composite does not call that of its base");
  return *component.organization();
}

SDOPackage::SDOList sdos_of(const py::list& stubs) {
  SDOPackage::SDOList sdos;
  for (const auto& stub : stubs) {
    const auto object = reference_in(stub.ptr());
    if (!object) throw py::type_error("a reference of a component is expected, as of getObjRef()");
    const CORBA::ULong n = sdos.length();
    sdos.length(n + 1);
    sdos[n] = unlocked([&] { return SDOPackage::SDO::_narrow(*object); });
  }
  return sdos;
}

// Empty, or why they do not become members.
std::string add_members(Component& self, const py::list& stubs) {
  const SDOPackage::SDOList sdos = sdos_of(stubs);
  auto& organization = organization_of(self);
  return asked([&]() -> std::string {
    try {
      organization.add_members(sdos);
      return {};
    } catch (const SDOPackage::InvalidParameter& problem) {
      return problem.description.in();
    }
  });
}

void for_members(Component& self, const std::string& what) {
  auto& organization = organization_of(self);
  unlocked([&] {
    if (what == "activate") return organization.activate_members();
    if (what == "deactivate") return organization.deactivate_members();
    if (what == "reset") return organization.reset_members();
    organization.close();
  });
}

}  // namespace

void Component::organize() {
  if (organization_) return;
  organization_ = new SDOPackage::PeriodicECOrganization(*this);
  addOwnedOrganization(organization_);
}

Component::~Component() {
  if (organization_) organization_->_remove_ref();
}

void add_organization_of_components(py::class_<Component, std::shared_ptr<Component>>& cls) {
  cls.def("_rtm_organize", [](Component& self) { unlocked([&] { self.organize(); }); })
      .def("_rtm_export_ports",
           [](Component& self, const std::string& list) {
             auto& organization = organization_of(self);
             unlocked([&] { organization.export_ports(list); });
           })
      .def("_rtm_add_members", &add_members)
      .def("_rtm_members", &for_members);
}

}  // namespace python
