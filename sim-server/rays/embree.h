// Owners of Embree's handles and what every use of Embree here needs. Only rays/ includes this. Values; any thread.
#pragma once

#include <embree3/rtcore.h>
#include <pmmintrin.h>
#include <xmmintrin.h>

#include <cmath>
#include <memory>
#include <new>

namespace sim::embree {

struct DeviceRelease {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneRelease {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
struct GeometryRelease {
  void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
using Device = std::unique_ptr<RTCDeviceTy, DeviceRelease>;
using Scene = std::unique_ptr<RTCSceneTy, SceneRelease>;
using Geometry = std::unique_ptr<RTCGeometryTy, GeometryRelease>;

// Embree gives nothing when there is no memory; the next call with it would end the process.
template <class Handle>
Handle made(Handle handle) {
  if (handle == nullptr) throw std::bad_alloc();
  return handle;
}

// Embree wants denormals off while it traces; the rest of the program keeps them.
class FlushDenormals {
 public:
  FlushDenormals() : before_(_mm_getcsr()) { _mm_setcsr(before_ | 0x8040U); }
  ~FlushDenormals() { _mm_setcsr(before_); }
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  unsigned before_;
};

// Embree takes a direction below 1e-18 for a positive one, but its coherent packets sort rays by the sign the direction had: a component
// of -2e-19, as of a robot that stands almost exactly along an axis, makes whole packets miss. So what is next to nothing becomes nothing;
// 1e-8 is a third of a micrometre at 30 m, and products of two such numbers stay above Embree's limit.
inline float without_dust(float v) { return std::abs(v) < 1e-8F ? 0.0F : v; }

}  // namespace sim::embree
