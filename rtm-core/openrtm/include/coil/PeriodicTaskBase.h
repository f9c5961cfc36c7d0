// The interface of coil::PeriodicTask, and the functions that it can run.
#pragma once

#include <functional>
#include <type_traits>
#include <utility>

#include "coil/TimeMeasure.h"
#include "coil/TimeValue.h"

namespace coil {

class TaskFuncBase {
 public:
  virtual ~TaskFuncBase() = default;
  virtual int operator()() = 0;
};

// Calls a member function, or a function of the object's address.
template <class T, class F = int (T::*)()>
class TaskFunc : public TaskFuncBase {
 public:
  TaskFunc(T* object, F function) : object_(object), function_(function) {}
  int operator()() override { return std::invoke(function_, object_); }

 private:
  T* object_;
  F function_;
};

class PeriodicTaskBase {
 public:
  virtual ~PeriodicTaskBase() = default;
  virtual void activate() = 0;
  virtual void finalize() = 0;
  virtual int suspend() = 0;
  virtual int resume() = 0;
  virtual void signal() = 0;
  virtual bool setTask(TaskFuncBase* func, bool delete_in_dtor = true) = 0;
  virtual bool setTask(std::function<void()> func) = 0;
  template <class O, class F, std::enable_if_t<std::is_invocable_v<F, O*>, int> = 0>
  bool setTask(O* object, F function) {
    return setTask(std::function<void()>([object, function] { std::invoke(function, object); }));
  }
  virtual void setPeriod(double period) = 0;
  virtual void setPeriod(TimeValue period) = 0;
  virtual void executionMeasure(bool value) = 0;
  virtual void executionMeasureCount(int n) = 0;
  virtual void periodicMeasure(bool value) = 0;
  virtual void periodicMeasureCount(int n) = 0;
  virtual TimeMeasure::Statistics getExecStat() = 0;
  virtual TimeMeasure::Statistics getPeriodStat() = 0;
};

}  // namespace coil
