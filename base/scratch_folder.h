// A folder among the temporary ones for the files of one process and of those that it starts: for its account alone, with a random name,
// and removed with this object. What a killed process left is removed by the next one that makes a folder of the same prefix: the owner
// holds a lock on the file "lock" in it. Folders of other accounts are never touched, whatever their name. One thread at a time.
#pragma once

#include <string>

#include "base/result.h"

namespace base {

class ScratchFolder {
 public:
  // In `where`; empty: the temporary folder.
  static Result<ScratchFolder> make(const std::string& prefix, const std::string& where = {});
  // Removes it, unless it was given away.
  ~ScratchFolder();
  ScratchFolder(ScratchFolder&& other) noexcept;
  ScratchFolder& operator=(ScratchFolder&& other) noexcept;

  const std::string& path() const { return path_; }
  // It stays: a child that was forked has it now, and its lock.
  void give_away();

 private:
  ScratchFolder(std::string path, int lock) : path_(std::move(path)), lock_(lock) {}
  std::string path_;  // empty: it was given away
  int lock_ = -1;
};

}  // namespace base
