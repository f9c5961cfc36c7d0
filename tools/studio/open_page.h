// Opens the page in the browser of this desktop. The URL has the token, and a command line can be read by other accounts: the browser gets
// a file of this account alone that leads to the page. One thread.
#pragma once

#include <filesystem>
#include <string>

#include "base/result.h"

namespace studio {

class OpenPage {
 public:
  // By the program $BROWSER, else xdg-open. Fails when there is none or the file cannot be written. The browser outlives this process: it
  // may be one that was there before, with other pages.
  static base::Result<OpenPage> open(const std::string& url);
  ~OpenPage();  // deletes the file
  OpenPage(OpenPage&& other) noexcept : folder_(std::move(other.folder_)) { other.folder_.clear(); }
  OpenPage& operator=(OpenPage&&) = delete;

 private:
  explicit OpenPage(std::filesystem::path folder) : folder_(std::move(folder)) {}
  std::filesystem::path folder_;
};

}  // namespace studio
