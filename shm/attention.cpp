#include "shm/attention.h"

#include "shm/futex.h"
#include "shm/participant_slots.h"
#include "shm/words.h"

namespace shm {

void call_attention(const Segment& simulation) {
  auto& control = simulation.as<Control>(AreaIndex::control);
  word(control.attention).fetch_add(1, std::memory_order_seq_cst);
  ring(control.attention, control.attention_waiting);
  wake_server(control);  // who may be waiting for participants
}

void call_server_of(const SegmentName& iface) {
  const auto simulation = Segment::open({iface.uid, iface.server_id, IfaceType::simulation, "world"});
  if (simulation && simulation->area(AreaIndex::control).count > 0) call_attention(*simulation);
}

}  // namespace shm
