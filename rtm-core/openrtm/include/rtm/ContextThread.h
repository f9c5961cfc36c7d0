// The thread of an execution context: starts and stops with the context, sleeps while no step is due, and steps the context once a period
// or once a tick. The step functions run on this thread; all other functions may be called from any thread.
#pragma once

#include <coil/Task.h>
#include <rtm/ExecutionContextServant.h>

#include <chrono>
#include <memory>
#include <string>

namespace RTC {

namespace detail {

class ContextThread : public coil::Task {
 public:
  int open(void* args) override;
  int svc() override;
  int close(unsigned long flags) override;

 protected:
  enum class Beat { period, tick };
  ContextThread(ExecutionContextBase& context, Beat beat);
  ~ContextThread() override;

  // One cycle: the time of its tick, transitions, onExecute and onStateUpdate.
  virtual void beginTick(std::chrono::nanoseconds /*time*/) {}
  virtual void stepTransitions() = 0;
  virtual void stepExecution() = 0;

  // Starts the thread, or lets that of an earlier start go on that stops in this cycle.
  void startThread();
  // Asks the thread to end. resumeThread() takes that back; false when the thread has left its loop.
  void haltThread();
  bool resumeThread();
  void wakeThread();
  // For destructors of classes whose members the thread uses: ends it and waits for that.
  void endThread();
  // True while the thread is to go on.
  bool threadRunning() const;
  // For a Beat::tick: a cycle more; returns at once. Ticks of a stopped context are forgotten.
  void addTick(std::chrono::nanoseconds time = {});
  // The same, and returns when the cycle is over; from within a cycle at once.
  void addTickAndWait(std::chrono::nanoseconds time);

 private:
  struct Body;
  const std::unique_ptr<Body> body_;
};

}  // namespace detail

template <class Skeleton>
class ThreadedExecutionContext : public ExecutionContextServant<Skeleton>, public detail::ContextThread {
 public:
  // Both bases have operations of these names; components call the context's.
  RTC::ReturnCode_t start() override { return this->ExecutionContextBase::start(); }
  RTC::ReturnCode_t stop() override { return this->ExecutionContextBase::stop(); }

 protected:
  ThreadedExecutionContext(const std::string& name, Beat beat) : ExecutionContextServant<Skeleton>(name), ContextThread(*this, beat) {
    this->setObjRef(RTC::ExecutionContextService_var(this->_this()));
    this->setKind(RTC::PERIODIC);
  }

  void stepTransitions() override { this->invokeWorkerPreDo(); }
  void stepExecution() override {
    this->invokeWorkerDo();
    this->invokeWorkerPostDo();
  }

  RTC::ReturnCode_t onStarted() override {
    if (!this->isSteppingThread()) coil::Task::wait();  // a callback that has stopped its context starts it again: the thread goes on
    startThread();
    return RTC::RTC_OK;
  }
  RTC::ReturnCode_t onStopping() override {
    haltThread();
    onWakeUp();  // also of derived classes, whose thread may wait for something else; from here on threadRunning() is false
    if (this->isSteppingThread()) return RTC::RTC_OK;  // the thread ends after this cycle
    if (!this->waitForCallbacks() && resumeThread()) return RTC::RTC_ERROR;
    coil::Task::wait();
    return RTC::RTC_OK;
  }
  void onWakeUp() override { wakeThread(); }
};

}  // namespace RTC
