// The processes that rtm-studio started: a saved system with its simulator and name server, as `rtse run` starts it, paused; or a simulator
// alone. The destructor ends them. One thread at a time.
#pragma once

#include <omniORB4/CORBA.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/child_process.h"
#include "base/result.h"
#include "system/reporter.h"

namespace studio {

struct StartOptions {
  std::string system;                         // RTSProfile; empty: the simulator alone
  std::string world;                          // SDFormat
  std::vector<std::string> resource_paths{};  // further folders with models of the world; only without a system
};

// An empty component host with a name server at `name_server`. Ends both with this object.
base::Result<base::ChildProcess> start_host(const std::string& name_server);

class StartedRun {
 public:
  // Returns when all processes are ready, or an Error. `is_rejected`: a file of the options is wrong. Without a system, the simulator gets
  // this ID. `reporter` must outlive the run.
  static base::Result<std::unique_ptr<StartedRun>> start(CORBA::ORB_ptr orb, const StartOptions& options, std::uint32_t server_id,
                                                         tools::Reporter& reporter, bool& is_rejected);
  virtual ~StartedRun() = default;
  virtual std::string name_server() const = 0;  // empty: none of ours
  virtual std::uint32_t server_id() const = 0;
};

}  // namespace studio
