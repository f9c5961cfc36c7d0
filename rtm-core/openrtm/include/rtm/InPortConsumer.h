// The sending end of push connections of an author's transport. The port makes one per connection from the factory, calls init and
// subscribeInterface, then put for each sample, one at a time, and unsubscribeInterface before it is deleted.
#pragma once

#include <coil/Factory.h>
#include <coil/Properties.h>
#include <rtm/ByteData.h>
#include <rtm/DataPortStatus.h>
#include <rtm/idl/RTCStub.h>

namespace RTC {

class InPortConsumer {
 public:
  InPortConsumer() = default;
  virtual ~InPortConsumer() = default;
  InPortConsumer(const InPortConsumer&) = delete;
  InPortConsumer& operator=(const InPortConsumer&) = delete;

  // The properties of the connection, without "dataport.".
  virtual void init(coil::Properties& properties) = 0;
  // Anything but PORT_OK fails the write; CONNECTION_LOST ends the connection.
  virtual DataPortStatus put(ByteData& data) = 0;
  virtual void publishInterfaceProfile(SDOPackage::NVList& /*properties*/) {}
  // The whole properties of the connection, with what the provider has added; false refuses it.
  virtual bool subscribeInterface(const SDOPackage::NVList& properties) = 0;
  virtual void unsubscribeInterface(const SDOPackage::NVList& properties) = 0;
};

using InPortConsumerFactory = coil::GlobalFactory<InPortConsumer>;

}  // namespace RTC
