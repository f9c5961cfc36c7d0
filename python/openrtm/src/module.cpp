// The extension module _openrtm_core: the runtime for components of Python (packages/OpenRTM_aist) and the ORB (packages/omniORB).
#include <pybind11/pybind11.h>

#include "adapters.h"
#include "channel.h"
#include "complaint.h"
#include "component.h"
#include "contexts.h"
#include "manager.h"
#include "manager_listeners.h"
#include "orb.h"
#include "ports.h"
#include "properties.h"
#include "sdo.h"
#include "serializers.h"
#include "services.h"

PYBIND11_MODULE(_openrtm_core, module) {
  python::add_complaints(module);
  python::add_properties(module);
  python::add_ports(module);
  python::add_serializers(module);
  python::add_services(module);
  python::add_channels(module);
  python::add_components(module);
  python::add_adapters(module);
  python::add_orb(module);
  python::add_manager(module);
  python::add_manager_listeners(module);
  python::add_contexts(module);
  python::add_sdo(module);
}
