// An iface that one or several devices of a gateway show. It subscribes, which switches the sensor on, only while a client reads. One
// thread at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "base/result.h"
#include "common/alarm.h"
#include "shm/client.h"

namespace gateway {

class Source {
 public:
  // `server` counts the simulators that were met, for the timeline.
  static base::Result<std::shared_ptr<Source>> open(std::uint32_t server_id, shm::IfaceType type, const std::string& name,
                                                    std::uint64_t server);

  shm::Iface& iface() { return iface_; }
  std::uint64_t server() const { return server_; }
  // Its simulator has taken it away, or another has come. One load; a simulator that was killed says nothing.
  bool is_closed() const;

  // Each needs its end. Fails when the iface is gone or has no lease left.
  base::Result<void> add_reader();
  void remove_reader();
  bool is_read() const { return readers_ > 0; }
  // There was news since somebody reads.
  bool has_sample() const { return has_sample_; }
  // For the alarm; nothing when the iface has been replaced.
  SharedSegment segment();

  // True when there is a sample or frame that was not there before. A sample has been read then, and is valid.
  bool take_news();

 private:
  Source(shm::Iface iface, std::uint64_t server) : iface_(std::move(iface)), server_(server) {}

  shm::Iface iface_;
  std::uint64_t server_;
  int readers_ = 0;
  std::uint64_t seen_ = 0;  // sequence number
  bool has_sample_ = false;
  SharedSegment segment_;
};

}  // namespace gateway
