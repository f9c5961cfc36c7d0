#include "coil/Task.h"

namespace coil {

Task::Task() = default;

Task::~Task() {
  if (thread_.joinable()) thread_.detach();
}

int Task::open(void* /*args*/) { return 0; }
int Task::close(unsigned long /*flags*/) { return 0; }
int Task::svc() { return 0; }

void Task::activate() {
  if (is_running_.exchange(true)) return;
  if (thread_.joinable()) thread_.join();  // The thread of an earlier activation has ended.
  thread_ = std::thread([this] {
    svc();
    finalize();
  });
}

int Task::wait() {
  if (!thread_.joinable() || thread_.get_id() == std::this_thread::get_id()) return 0;
  thread_.join();
  return 0;
}

int Task::suspend() { return 0; }
int Task::resume() { return 0; }
void Task::reset() { is_running_ = false; }
void Task::finalize() { reset(); }

}  // namespace coil
