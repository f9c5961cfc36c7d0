#include "campaign/run/row_locks.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <thread>

#include "base/interrupt.h"

namespace campaign {
namespace {

using namespace std::chrono_literals;

// A byte of the file for each row; all of them when `row` is 0.
bool set_lock(int descriptor, short kind, std::size_t row) {
  struct flock lock {};
  lock.l_type = kind;
  lock.l_whence = SEEK_SET;
  lock.l_start = static_cast<off_t>(row);
  lock.l_len = row == 0 ? 0 : 1;
  return fcntl(descriptor, F_OFD_SETLK, &lock) == 0;
}

}  // namespace

RowLocks::RowLocks(const std::string& folder)
    : file_(folder + "/rows.lock"), descriptor_(open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600)) {}

RowLocks::~RowLocks() {
  if (descriptor_ < 0) return;
  if (set_lock(descriptor_, F_WRLCK, 0)) unlink(file_.c_str());  // nobody else runs a row
  close(descriptor_);
}

bool RowLocks::take(std::size_t row) const {
  if (descriptor_ < 0) return true;
  while (!set_lock(descriptor_, F_WRLCK, row)) {
    if (errno != EAGAIN && errno != EACCES && errno != EINTR) return true;
    if (base::is_interrupted()) return false;
    std::this_thread::sleep_for(50ms);  // a wait for a lock cannot be ended by an interrupt
  }
  return true;
}

void RowLocks::give_back(std::size_t row) const {
  if (descriptor_ >= 0) set_lock(descriptor_, F_UNLCK, row);
}

}  // namespace campaign
