// See coil/Properties.h. As there, it brings nothing along and stands only after the component's base.
#pragma once

namespace RTC {

class CorbaConsumerBase {
 public:
  virtual ~CorbaConsumerBase();
  virtual bool setObject(CORBA::Object_ptr object);
  virtual void releaseObject();
};

template <class Interface, typename InterfacePtr = typename Interface::_ptr_type, typename InterfaceVar = typename Interface::_var_type>
class CorbaConsumer : public CorbaConsumerBase {
 public:
  InterfacePtr _ptr();
  InterfacePtr operator->() { return _ptr(); }
};

}  // namespace RTC
