// Results of campaigns for the page, and replays of recorded components: by the programs that do the same in a terminal. On workers.
#pragma once

#include <filesystem>
#include <string>

#include "studio/client_message.h"

namespace studio {

// A results file of `rtse sweep` in `folder`: {csv, recordings:[{row, file}]}, the rows as `rtse results --csv` prints them and what was
// recorded of them, relative to the folder. Fails for more than 4 MiB of rows.
base::Result<Json> campaign_results(const std::filesystem::path& folder, const std::filesystem::path& file);

// `rtse replay FILE --into INSTANCE --compare`: {text}, what it printed. An error when the outputs differ or cannot be made. At most a
// minute.
base::Result<Json> replay_component(const std::string& file, const std::string& instance);
std::string replay_line(const std::string& file, const std::string& instance);

}  // namespace studio
