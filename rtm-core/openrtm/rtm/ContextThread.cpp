#include "rtm/ContextThread.h"

#include "component/runtime_access.h"
#include "core/workers.h"

namespace RTC::detail {

struct ContextThread::Body final : rt::Steppable {
  Body(ContextThread& owner, ExecutionContextBase& context, Beat beat) : owner(owner) {
    auto& core = RuntimeAccess::context(context);
    if (beat == Beat::period) {
      worker = std::make_unique<rt::PeriodicWorker>(core, *this);
    } else {
      auto made = std::make_unique<rt::TriggeredWorker>(core, *this);
      triggered = made.get();
      worker = std::move(made);
    }
  }
  void begin_tick(std::chrono::nanoseconds time) override { owner.beginTick(time); }
  void transit() override { owner.stepTransitions(); }
  void execute_and_update() override { owner.stepExecution(); }

  ContextThread& owner;
  std::unique_ptr<rt::Worker> worker;
  rt::TriggeredWorker* triggered = nullptr;
};

ContextThread::ContextThread(ExecutionContextBase& context, Beat beat) : body_(std::make_unique<Body>(*this, context, beat)) {
  keepThread();  // what components keep for their thread outlasts stop() and start()
}

ContextThread::~ContextThread() = default;

int ContextThread::open(void*) {
  coil::Task::activate();
  return 0;
}

int ContextThread::svc() {
  body_->worker->run();
  return 0;
}

int ContextThread::close(unsigned long) { return 0; }

void ContextThread::startThread() {
  body_->worker->reset();
  open(nullptr);
}

void ContextThread::haltThread() { body_->worker->stop(); }
bool ContextThread::resumeThread() { return body_->worker->resume(); }
void ContextThread::wakeThread() { body_->worker->wake(); }

void ContextThread::endThread() {
  body_->worker->stop();
  coil::Task::wait();
}

bool ContextThread::threadRunning() const { return !body_->worker->is_stopping(); }

void ContextThread::addTick(std::chrono::nanoseconds time) {
  if (body_->triggered != nullptr) body_->triggered->tick(time);
}

void ContextThread::addTickAndWait(std::chrono::nanoseconds time) {
  if (body_->triggered != nullptr) body_->triggered->tick_and_wait(time);
}

}  // namespace RTC::detail
