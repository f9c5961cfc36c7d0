#include "rtm/PortConnectListener.h"

namespace RTC {
namespace {

template <std::size_t size>
const char* name_of(const char* const (&names)[size], int type) {
  return type >= 0 && static_cast<std::size_t>(type) < size ? names[type] : "";
}

}  // namespace

const char* PortConnectListener::toString(PortConnectListenerType type) {
  static const char* const names[] = {"ON_NOTIFY_CONNECT", "ON_NOTIFY_DISCONNECT", "ON_UNSUBSCRIBE_INTERFACES"};
  return name_of(names, type);
}

const char* PortConnectRetListener::toString(PortConnectRetListenerType type) {
  static const char* const names[] = {"ON_PUBLISH_INTERFACES", "ON_CONNECT_NEXTPORT", "ON_SUBSCRIBE_INTERFACES",
                                      "ON_CONNECTED",          "ON_DISCONNECT_NEXT",  "ON_DISCONNECTED"};
  return name_of(names, type);
}

}  // namespace RTC
