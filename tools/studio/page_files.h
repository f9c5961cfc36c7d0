// The built page: index.html and the folder assets/, read once and cached, also compressed. Without a built page a plain page says so.
// Immutable after reading; any thread.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "base/result.h"

namespace studio {

struct PageFile {
  std::string type;  // Content-Type
  std::string octets;
  std::string compressed;  // gzip; empty: that would not be smaller
};

class PageFiles {
 public:
  // Fails when the folder has more, or larger, files than a page of ours can have.
  static base::Result<PageFiles> read(const std::string& folder);

  // By the path of a URL ("/", "/assets/page-1234.js"); nullptr: there is none.
  const PageFile* find(std::string_view path) const;

 private:
  std::map<std::string, PageFile, std::less<>> files_;
};

// The folder that belongs to this program: share/rtm-sim/studio beside its bin.
std::string default_page_folder();

}  // namespace studio
