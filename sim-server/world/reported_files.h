// Files that have been reported as unreadable. Physics, rays and images each find such a file; one log line about it is enough. Any thread;
// no data may be held.
#pragma once

#include <string>

namespace sim {

// True for the first report about the file in its current state since this process started. A changed file is reported again.
bool is_first_report(const std::string& path);

}  // namespace sim
