// Files that have been reported as unreadable. Physics, rays and images each find such a file; one log line about it is enough. Any thread;
// no data may be held.
#pragma once

#include <string>

namespace sim {

// True for the first fault of the file, as it is now, since this process started. Faults of a file that has changed are new.
bool is_first_fault(const std::string& path);

}  // namespace sim
