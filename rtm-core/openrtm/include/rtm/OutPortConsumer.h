// The receiving end of pull connections of an author's transport. The port makes one per connection from the factory, calls init,
// setBuffer, setListener and subscribeInterface, then get when somebody reads, one at a time, and unsubscribeInterface before it is
// deleted.
#pragma once

#include <coil/Factory.h>
#include <coil/Properties.h>
#include <rtm/BufferBase.h>
#include <rtm/ByteData.h>
#include <rtm/ConnectorListener.h>
#include <rtm/DataPortStatus.h>
#include <rtm/idl/RTCStub.h>

namespace RTC {

class OutPortConsumer {
 public:
  OutPortConsumer() = default;
  virtual ~OutPortConsumer() = default;
  OutPortConsumer(const OutPortConsumer&) = delete;
  OutPortConsumer& operator=(const OutPortConsumer&) = delete;

  // The properties of the connection, without "dataport.".
  virtual void init(coil::Properties& properties) = 0;
  virtual void setBuffer(CdrBufferBase* /*buffer*/) {}
  virtual void setListener(ConnectorInfo& /*info*/, ConnectorListenersBase* /*listeners*/) {}
  // BUFFER_EMPTY when there is nothing; CONNECTION_LOST ends the connection.
  virtual DataPortStatus get(ByteData& data) = 0;
  // The whole properties of the connection, with what the provider has added; false refuses it.
  virtual bool subscribeInterface(const SDOPackage::NVList& properties) = 0;
  virtual void unsubscribeInterface(const SDOPackage::NVList& properties) = 0;
};

using OutPortConsumerFactory = coil::GlobalFactory<OutPortConsumer>;

}  // namespace RTC
