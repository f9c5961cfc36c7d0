#include "served.h"

#include <algorithm>
#include <initializer_list>

namespace gateway {
namespace {

using Subtypes = std::initializer_list<std::uint32_t>;

bool is_among(const Subtypes& all, std::uint32_t subtype) { return std::ranges::find(all, subtype) != all.end(); }

}  // namespace

bool is_served(player::Interface interface, std::uint32_t type, std::uint32_t subtype) {
  using enum player::Interface;
  if (type > 255 || subtype > 255) return false;
  const auto kind = static_cast<player::Type>(type);
  if (kind == player::Type::request && player::universal_request::is_one(static_cast<std::uint8_t>(subtype))) return interface != player;
  const auto has = [kind, subtype](const Subtypes& data, const Subtypes& commands, const Subtypes& requests) {
    return (kind == player::Type::data && is_among(data, subtype)) || (kind == player::Type::command && is_among(commands, subtype)) ||
           (kind == player::Type::request && is_among(requests, subtype));
  };
  switch (interface) {
    case position2d:
      return has({1}, {1, 2, 4}, {1, 2, 3, 4, 5, 6, 7, 8, 9});
    case position3d:
      return has({1}, {1, 2}, {1, 2, 3, 4, 5, 6});
    case laser:
      return has({1}, {}, {1, 2, 3, 4, 5});
    case sonar:
      return has({1}, {}, {1, 2});
    case ranger:
      return has({1, 3}, {}, {1, 2, 3, 4, 5});
    case camera:
      return has({1}, {}, {1, 3});
    case gps:
      return has({1}, {}, {});
    case imu:
      return has({1, 2, 3, 4, 5}, {}, {1});
    case bumper:
      return has({1}, {}, {1});
    case simulation:
      return has({}, {1, 2}, {1, 2, 3, 4, 5});
    case player:
      break;
  }
  return false;
}

}  // namespace gateway
