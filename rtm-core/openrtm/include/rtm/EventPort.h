// An InPort whose samples are events of a state machine (rtm/StaticFSM.h). A connection says with dataport.fsm_event_name which event its
// samples are; without that key the connection's own name counts. Events are queued as they arrive and handled by the machine's
// run_event(). bindEvent: before the port is used; receiving: any thread.
#pragma once

#include <functional>
#include <string>

#include "rtm/ConnectorListener.h"
#include "rtm/InPortBase.h"
#include "rtm/Serializers.h"

namespace RTC {

namespace detail {

// A port that takes every type and keeps nothing.
const corba::TypeOps& any_type_ops();
// None but CDR: an event may be of any type.
const Serializers& any_serializers();

// Whether samples of this connection are that event.
bool is_event(const ConnectorInfo& info, const std::string& event);

class EventListenerBase : public ConnectorDataListener {
 public:
  explicit EventListenerBase(std::string event) : event_(std::move(event)) {}

 protected:
  std::string event_;
};

template <class DataType>
class EventListener final : public EventListenerBase {
 public:
  EventListener(std::string event, std::function<void(const DataType&)> queue)
      : EventListenerBase(std::move(event)), queue_(std::move(queue)) {}
  ReturnCode notify(ConnectorInfo& info, corba::EventData& data) override {
    DataType value{};
    if (is_event(info, event_) && corba::decode(corba::type_ops<DataType>(), &value, data.octets(), data.order())) queue_(value);
    return NO_CHANGE;
  }

 private:
  std::function<void(const DataType&)> queue_;
};

class EventListener0 final : public EventListenerBase {
 public:
  EventListener0(std::string event, std::function<void()> queue) : EventListenerBase(std::move(event)), queue_(std::move(queue)) {}
  ReturnCode notify(ConnectorInfo& info, corba::EventData&) override {
    if (is_event(info, event_)) queue_();
    return NO_CHANGE;
  }

 private:
  std::function<void()> queue_;
};

}  // namespace detail

// FsmType: RTC::Machine<Top>, or anything with push() and add_event_profile() like it.
template <class FsmType>
class EventInPort : public InPortBase {
 public:
  EventInPort(const char* name, FsmType& machine, int = 64, bool = false, bool = false, int = 0, int = 0)
      : InPortBase(name, detail::any_type_ops(), detail::any_serializers()), machine_(machine) {}
  ~EventInPort() override { retire(); }

  // Nothing: events go to the machine as they arrive.
  bool read(std::string = "") override { return true; }

  template <class Top, class Result, class Data>
  void bindEvent(const std::string& event, Result (Top::*handler)(Data)) {
    using Value = std::remove_cvref_t<Data>;
    addConnectorDataListener(
        ON_RECEIVED, new detail::EventListener<Value>(event, [this, handler](const Value& value) { machine_.push(handler, value); }));
    machine_.add_event_profile(event, corba::type_ops<Value>().type_id);
  }
  template <class Top, class Result>
  void bindEvent(const std::string& event, Result (Top::*handler)()) {
    addConnectorDataListener(ON_RECEIVED, new detail::EventListener0(event, [this, handler] { machine_.push(handler); }));
    machine_.add_event_profile(event, "");
  }

 private:
  FsmType& machine_;
};

}  // namespace RTC
