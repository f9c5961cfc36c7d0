// The sending end of pull connections of an author's transport. The port makes one per connection from the factory, calls init,
// publishInterface, setBuffer, setListener and setConnector in this order on one thread, and deletes it when the connection ends. What the
// peer asks for comes from the connector's read(), on any thread.
#pragma once

#include <coil/Factory.h>
#include <coil/Properties.h>
#include <rtm/BufferBase.h>
#include <rtm/ByteData.h>
#include <rtm/ConnectorListener.h>
#include <rtm/DataPortStatus.h>
#include <rtm/InterfaceProvider.h>
#include <rtm/NVUtil.h>
#include <rtm/OutPortConnector.h>
#include <rtm/SystemLogger.h>

namespace RTC {

class OutPortProvider : public InterfaceProvider {
 public:
  // The properties of the connection, without "dataport.".
  virtual void init(coil::Properties& properties) = 0;
  virtual void setBuffer(CdrBufferBase* /*buffer*/) {}
  virtual void setListener(ConnectorInfo& /*info*/, ConnectorListenersBase* /*listeners*/) {}
  // Good until this is deleted.
  virtual void setConnector(OutPortConnector* connector) = 0;
};

using OutPortProviderFactory = coil::GlobalFactory<OutPortProvider>;

}  // namespace RTC
