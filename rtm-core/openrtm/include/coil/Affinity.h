// On which processors this process or this thread may run. Any thread. All return false if the system refuses.
#pragma once

#include <string>
#include <vector>

namespace coil {

using CpuMask = std::vector<unsigned int>;

// Masks are the numbers of processors; as text separated by commas. Those of a process concern its calling thread and the threads made
// after it.
bool getProcCpuAffinity(CpuMask& cpu_mask);
bool setProcCpuAffinity(const CpuMask& cpu_mask);
bool setProcCpuAffinity(const std::string& cpu_mask);
bool getThreadCpuAffinity(CpuMask& cpu_mask);
bool setThreadCpuAffinity(const CpuMask& cpu_mask);
bool setThreadCpuAffinity(const std::string& cpu_mask);

}  // namespace coil
