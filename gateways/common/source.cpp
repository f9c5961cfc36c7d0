#include "common/source.h"

#include <utility>

#include "shm/words.h"

namespace gateway {

base::Result<std::shared_ptr<Source>> Source::open(std::uint32_t server_id, shm::IfaceType type, const std::string& name,
                                                   std::uint64_t server) {
  auto iface = shm::Iface::open(server_id, type, name);
  if (!iface) return iface.error();
  return std::shared_ptr<Source>(new Source(std::move(*iface), server));
}

bool Source::is_closed() const { return shm::load(iface_.segment().header().state) != RTMSIM_STATE_LIVE; }

base::Result<void> Source::add_reader() {
  if (readers_ == 0) {
    // What was published before is old: a sensor that nobody used has stopped long ago.
    seen_ = iface_.sequence();
    has_sample_ = false;
    if (auto good = iface_.subscribe(); !good) return good;
  }
  ++readers_;
  return {};
}

void Source::remove_reader() {
  if (--readers_ == 0) iface_.unsubscribe();
}

SharedSegment Source::segment() {
  if (!segment_) {
    auto segment = shm::Segment::open(iface_.segment().name());
    if (segment) segment_ = std::make_shared<const shm::Segment>(std::move(*segment));
  }
  return segment_;
}

bool Source::take_news() {
  const std::uint64_t sequence = iface_.sequence();
  if (sequence <= seen_) return false;
  if (shm::has_frames(iface_.type())) {
    seen_ = sequence;
    has_sample_ = true;
    return true;
  }
  if (!iface_.read()) return false;
  const auto& stamp = iface_.sample<shm::Stamp>();
  seen_ = stamp.sequence;
  has_sample_ = stamp.valid != 0;
  return has_sample_;
}

}  // namespace gateway
