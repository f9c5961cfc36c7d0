#include "studio/open_page.h"

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <system_error>

#include "base/child_process.h"
#include "base/text.h"

namespace studio {

namespace fs = std::filesystem;
using base::Error;

base::Result<OpenPage> OpenPage::open(const std::string& url) {
  std::error_code problem;
  std::string name = (fs::temp_directory_path(problem) / "rtm-studio-XXXXXX").string();
  if (problem || mkdtemp(name.data()) == nullptr)
    return Error{"cannot make the folder " + base::in_quotes(name) + " for the browser's first page"};
  OpenPage page{fs::path(name)};  // of this account alone
  const fs::path file = page.folder_ / "open.html";
  std::ofstream(file) << "<!doctype html><meta charset=\"utf-8\"><title>rtm-studio</title><meta http-equiv=\"refresh\" content=\"0;url="
                      << url << "\"><p><a href=\"" << url << "\">rtm-studio</a></p>\n";
  if (!fs::exists(file, problem)) return Error{"cannot write " + base::in_quotes(file.string())};
  const char* wanted = std::getenv("BROWSER");
  const std::string browser = wanted != nullptr && *wanted != '\0' ? wanted : "xdg-open";
  // In a session of its own, which it is in before this call's process group ends: it is not ended with this process.
  const base::ProgramCall call{
      {"/bin/sh", "-c", R"(command -v "$0" >/dev/null || exit 127; setsid /bin/sh -c '"$0" "$1" >/dev/null 2>&1 &' "$0" "$1")", browser,
       "file://" + file.string()},
      {}};
  auto started = base::ChildProcess::start(call);
  if (!started) return started.error();
  if (!started->wait(std::chrono::seconds(10)) || started->exit_code() != 0)
    return Error{"cannot start the browser " + base::in_quotes(browser) + " (" + (started->exit_code() == 127 ? "not found" : "failed") +
                 "): set BROWSER to a program, or open the URL by hand"};
  return page;
}

OpenPage::~OpenPage() {
  std::error_code ignored;
  if (!folder_.empty()) fs::remove_all(folder_, ignored);
}

}  // namespace studio
