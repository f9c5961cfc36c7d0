// All of an InPort that does not depend on its type. connect, disconnect, reading and receiving: any thread; one reader at a time.
#pragma once

#include <string>

#include "rtm/DataPortBase.h"

namespace RTC {

class InPortBase : public DataPortBase<InPortConnector> {
 public:
  InPortBase(const char* name, const detail::DataType& type, const detail::Serializers& serializers);
  ~InPortBase() override;

  // False if there was nothing to read; the statuses tell why.
  virtual bool read(std::string name = "") = 0;

  // Something has come that was not read yet, on any connection, or on the one of that name. A pull connection asks its peer.
  bool isNew();
  bool isNew(const std::string& connector_name);
  // Also says on which connections.
  bool isNew(coil::vstring& connector_names);
  // Waits until something unread has come over a push connection, at most `seconds`; true if so. Lets onExecute react when data arrives,
  // not when its context looks next; the context's statistics count it as waiting. On a context in simulated time it does not wait: the
  // tick has brought all that can be read. OpenRTM-aist has no such function.
  bool waitNew(double seconds);
  bool isEmpty() { return !isNew(); }
  bool isEmpty(const std::string& connector_name) { return !isNew(connector_name); }

 protected:
  // Returns when no other thread is in the port any more. The destructor of the last class in line calls it first.
  void retire();
  // Decodes the oldest unread sample (of that connection) into `value`, or the last one again.
  bool readValue(const std::string& connector_name, void* value);
};

}  // namespace RTC
