#include "rtc_bounding_boxes.h"

#include <string>
#include <vector>

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCBoundingBoxes",
    .description = "Bounding box camera of a simulated robot: boxes around labelled objects",
    .phase = iface::sensor_phase,
    .device = "pioneer2dx::boxes",
};

namespace {

std::vector<double> numbers_of(const shm::Box& box, bool is_oriented) {
  const auto label = static_cast<double>(box.label);
  if (!is_oriented) return {label, box.center[0], box.center[1], box.size[0], box.size[1]};
  const RTC::Orientation3D turn = iface::to_orientation(box.pose);
  return {label, box.pose.x, box.pose.y, box.pose.z, turn.r, turn.p, turn.y, box.extent[0], box.extent[1], box.extent[2]};
}

}  // namespace

RTCBoundingBoxes::RTCBoundingBoxes(RTC::Manager* manager)
    : IfaceComponent(manager, specification, shm::IfaceType::boxes, true), labels_out_("labels", labels_), boxes_out_("boxes", boxes_) {}

RTC::ReturnCode_t RTCBoundingBoxes::onInitialize() {
  addOutPort("labels", labels_out_);
  addOutPort("boxes", boxes_out_);
  bindDevice();
  return RTC::RTC_OK;
}

void RTCBoundingBoxes::publish(const shm::Iface& boxes) {
  const auto* first = reinterpret_cast<const shm::Box*>(boxes.sample_followers(0));
  const bool is_oriented = boxes.info<shm::BoxesInfo>().kind == RTMSIM_BOX_ORIENTED;
  labels_.tm = boxes_.tm = iface::to_time(boxes.sample<shm::BoxesSample>().stamp.sim_time_ns);
  labels_.data.length(static_cast<CORBA::ULong>(boxes.filled()));
  boxes_.data.length(0);
  for (std::size_t i = 0; i < boxes.filled(); ++i) {
    labels_.data[static_cast<CORBA::ULong>(i)] = CORBA::string_dup((std::to_string(first[i].label) + " " + first[i].name).c_str());
    for (const double number : numbers_of(first[i], is_oriented)) {
      boxes_.data.length(boxes_.data.length() + 1);
      boxes_.data[boxes_.data.length() - 1] = number;
    }
  }
  labels_out_.write();
  boxes_out_.write();
}

extern "C" {
void RTCBoundingBoxesInit(RTC::Manager* manager) { iface::register_type<RTCBoundingBoxes>(manager, specification); }
}
