#include "world/reported_files.h"

#include <set>
#include <tuple>
#include <utility>

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

bool is_first_report(const std::string& path) {
  const FileStamp now = stamp_of(path);
  State state{path, now.inode, now.changed_ns};
  auto states = told().lock();
  if (states->contains(state)) return false;
  if (states->size() >= max_stamps) states->clear();
  states->insert(std::move(state));
  return true;
}

}  // namespace sim
