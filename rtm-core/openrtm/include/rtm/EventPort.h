// An InPort whose samples are events of a state machine (rtm/StaticFSM.h). A connection says with dataport.fsm_event_name which event its
// samples are; without that key the connection's own name counts. Events are queued as they arrive and handled by the machine's
// run_event(). bindEvent: before the port is used; receiving: any thread.
#pragma once

#include <functional>
#include <string>
#include <type_traits>

#include "rtm/ConnectorListener.h"
#include "rtm/InPortBase.h"
#include "rtm/Serializers.h"

namespace RTC {

namespace detail {

// None but CDR: an event may be of any type.
const Serializers& any_serializers();

// Whether samples of this connection are that event.
bool is_event(const ConnectorInfo& info, const std::string& event);

class EventListenerBase : public ConnectorDataListener {
 protected:
  explicit EventListenerBase(std::string event) : event_(std::move(event)) {}
  // False unless the sample is one of that event and fits the type.
  bool take(const ConnectorInfo& info, detail::SampleEvent& sample, const DataType& type, void* value) const;

  std::string event_;
};

template <class Value>
class EventListener final : public EventListenerBase {
 public:
  EventListener(std::string event, std::function<void(const Value&)> queue)
      : EventListenerBase(std::move(event)), queue_(std::move(queue)) {}
  ReturnCode notify(ConnectorInfo& info, detail::SampleEvent& sample) override {
    Value value{};
    if (take(info, sample, data_type<Value>(), &value)) queue_(value);
    return NO_CHANGE;
  }

 private:
  std::function<void(const Value&)> queue_;
};

class EventListener0 final : public EventListenerBase {
 public:
  EventListener0(std::string event, std::function<void()> queue) : EventListenerBase(std::move(event)), queue_(std::move(queue)) {}
  ReturnCode notify(ConnectorInfo& info, detail::SampleEvent&) override {
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
      : InPortBase(name, detail::DataType::any(), detail::any_serializers()), machine_(machine) {}
  ~EventInPort() override { retire(); }

  // Nothing: events go to the machine as they arrive.
  bool read(std::string = "") override { return true; }

  template <class Top, class Result, class Data>
  void bindEvent(const std::string& event, Result (Top::*handler)(Data)) {
    using Value = std::remove_cv_t<std::remove_reference_t<Data>>;
    addConnectorDataListener(
        ON_RECEIVED, new detail::EventListener<Value>(event, [this, handler](const Value& value) { machine_.push(handler, value); }));
    machine_.add_event_profile(event, detail::data_type<Value>().id());
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
