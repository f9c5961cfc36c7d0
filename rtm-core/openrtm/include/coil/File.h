// Names of files and folders. Any thread.
#pragma once

#include <string>
#include <vector>

namespace coil {

// "/usr/lib/x.so" -> "/usr/lib/"; nothing before the last slash gives "./".
std::string dirname(const std::string& path);
// "/usr/lib/x.so" -> "x.so".
std::string basename(const std::string& path);

// The names of the entries of a folder, sorted; only those that match the pattern (* ? []), if there is one. Empty if the folder can't be
// read.
std::vector<std::string> filelist(const std::string& path, const std::string& glob_str = "");
inline std::vector<std::string> filelist(const char* path, const char* glob_str = "") {
  return filelist(std::string(path), std::string(glob_str));
}
// The paths of the files of that name / with that extension ("so") in a folder and all below it; appended to the list.
void findFile(const std::string& dir, const std::string& filename, std::vector<std::string>& filelist);
void getFileList(const std::string& dir, const std::string& ext, std::vector<std::string>& filelist);

}  // namespace coil
