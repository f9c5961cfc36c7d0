// The name server of `rtcd --with-naming`: omniNames with data of its own, started if none responds. One thread.
#pragma once

#include <sys/types.h>

#include <memory>
#include <string>
#include <thread>

#include "base/result.h"

class NameService {
 public:
  // `address`: host, host:port; the port is 2809 if missing. Only processes of this account are served unless `is_open`. Returns nothing
  // when one answers there already. The child ends with this object and with this process, however that ends; its folder is removed.
  static base::Result<std::unique_ptr<NameService>> start_if_none(const std::string& address, bool is_open);
  ~NameService();
  NameService(const NameService&) = delete;
  NameService& operator=(const NameService&) = delete;

 private:
  NameService() = default;
  pid_t keeper_ = -1;  // the process that starts omniNames, waits for our end and tidies up
  int alive_ = -1;     // closed by our end, however it comes
  std::thread log_;    // logs who was rejected; ends with the keeper and omniNames
};
