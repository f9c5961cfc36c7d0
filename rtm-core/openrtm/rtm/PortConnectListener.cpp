#include "rtm/PortConnectListener.h"

#include "openrtm/type_names.h"

namespace RTC {

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
