// The services of the RT Component interface guidelines that report the pose of a device. They reply at once from any thread, also while
// the simulation is paused: with the iface that was found last, and with zeros before the first.
#pragma once

#include <rtm/idl/InterfaceDataTypesSkel.h>

#include <base/guarded.h>

#include "conversions.h"

namespace iface {

// Skeleton: POA_RTC::X of an interface with GetGeometry().
template <class Skeleton, class Geometry = RTC::Geometry3D>
class GeometryService : public virtual Skeleton, public virtual PortableServer::RefCountServantBase {
 public:
  void describe(const Geometry& geometry) { *geometry_.lock() = geometry; }
  Geometry GetGeometry() override { return *geometry_.lock(); }

 private:
  base::Guarded<Geometry, base::Rank::details> geometry_{Geometry{}};
};

}  // namespace iface
