#include "shm/access.h"

#include <grp.h>

#include <cstdlib>
#include <limits>

#include "base/text.h"

namespace shm {

base::Result<Access> parse_access(const std::string& mode, const std::string& group) {
  Access access;
  if (!mode.empty()) {
    const bool is_octal = mode.size() <= 4 && mode.find_first_not_of("01234567") == std::string::npos;
    const long value = is_octal ? std::strtol(mode.c_str(), nullptr, 8) : -1;
    if (value < 0 || value > 0777 || (value & 0600) != 0600) {
      return base::Error{"shared memory mode " + base::in_quotes(mode) + " must be octal and let the owner read and write, like 0660"};
    }
    access.mode = static_cast<mode_t>(value);
  }
  if (!group.empty()) {
    const struct group* entry = ::getgrnam(group.c_str());
    const auto number = base::parse_integer(group);
    if (entry == nullptr && (!number || *number < 0 || *number > std::numeric_limits<gid_t>::max())) {
      return base::Error{"group " + base::in_quotes(group) + " is not known"};
    }
    access.group = entry != nullptr ? entry->gr_gid : static_cast<gid_t>(*number);
  }
  return access;
}

}  // namespace shm
