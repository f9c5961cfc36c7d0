// Locks of rows that are being run, among all processes that sweep into the same folder. A killed process holds no lock. Any
// thread.
#pragma once

#include <cstddef>
#include <string>

namespace campaign {

class RowLocks {
 public:
  // Without the folder, or on a disk that knows no locks, everybody may go on.
  explicit RowLocks(const std::string& folder);
  ~RowLocks();
  RowLocks(const RowLocks&) = delete;
  RowLocks& operator=(const RowLocks&) = delete;

  // Waits until no other process runs the row. False: interrupted.
  bool take(std::size_t row) const;
  void give_back(std::size_t row) const;

 private:
  std::string file_;
  int descriptor_;
};

}  // namespace campaign
