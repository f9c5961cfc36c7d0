// A page while it is written: a file without a name if the file system supports that, otherwise one beside the page. It gets the page's
// name when it is complete. A killed process leaves an older page as it is. One thread at a time.
#pragma once

#include <cstdint>
#include <cstdio>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>

#include "base/result.h"

namespace page {

class PageFile {
 public:
  // `limit` [bytes]
  PageFile(std::string path, std::uint64_t limit) : path_(std::move(path)), limit_(limit) {}
  PageFile(const PageFile&) = delete;
  PageFile& operator=(const PageFile&) = delete;
  ~PageFile();

  base::Result<void> open();
  // finish() tells of what could not be written.
  void put(std::string_view text);
  // put() will write so much more, for which put_data() leaves room.
  void reserve(std::uint64_t bytes) { reserved_ = bytes; }
  struct Block {
    std::string id;
    std::string_view bytes;
  };
  // Zlib data in base64, in an element for each id. False: the page would exceed its limit, and none was written.
  bool put_data(std::initializer_list<Block> blocks);
  std::uint64_t size() const { return size_; }
  // Removes what was written beyond this size.
  base::Result<void> cut(std::uint64_t size);
  base::Result<void> finish();

 private:
  base::Result<void> fail(int error) const;

  const std::string path_;
  std::string target_;  // behind symbolic links
  const std::uint64_t limit_;
  std::uint64_t reserved_ = 0;
  std::string part_path_;  // empty: it has no name
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> out_{nullptr, std::fclose};
  std::uint64_t size_ = 0;
};

}  // namespace page
