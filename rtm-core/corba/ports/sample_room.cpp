#include "corba/ports/sample_room.h"

#include <map>
#include <string>
#include <string_view>

#include "base/guarded.h"
#include "corba/orb/object_names.h"

namespace corba {
namespace {

using Rooms = std::map<std::string, std::size_t, std::less<>>;

// Of the process, as its end points are; never destroyed, since connections may go after it otherwise.
base::Guarded<Rooms, base::Rank::memory>& rooms() {
  static auto& all = *new base::Guarded<Rooms, base::Rank::memory>;
  return all;
}

}  // namespace

struct SampleRoom::Key {
  std::string octets;
};

SampleRoom::SampleRoom(CORBA::Object_ptr object, std::size_t octets) : key_(std::make_unique<Key>(object_key(object))) {
  rooms().lock()->insert_or_assign(key_->octets, octets);
}

SampleRoom::~SampleRoom() { rooms().lock()->erase(key_->octets); }

std::size_t room_for_samples(std::span<const std::byte> object_key) {
  const std::string_view key(reinterpret_cast<const char*>(object_key.data()), object_key.size());
  auto known = rooms().lock();
  const auto found = known->find(key);
  return found != known->end() ? found->second : 0;
}

}  // namespace corba
