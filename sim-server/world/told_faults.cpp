#include "world/told_faults.h"

#include <set>
#include <tuple>

#include "base/guarded.h"
#include "reader/protocol.h"

namespace sim {
namespace {

using State = std::tuple<std::string, std::uint64_t, std::int64_t>;

base::Guarded<std::set<State>, base::Rank::objects>& told() {
  static auto& states = *new base::Guarded<std::set<State>, base::Rank::objects>;  // never destroyed: as the reader
  return states;
}

}  // namespace

bool is_first_fault(const std::string& path) {
  const FileStamp now = stamp_of(path);
  auto states = told().lock();
  if (states->size() >= most_stamps) states->clear();
  return states->emplace(path, now.inode, now.changed_ns).second;
}

}  // namespace sim
