#include "coil/Affinity.h"

#include <pthread.h>
#include <sched.h>
#include <unistd.h>

#include "coil/stringutil.h"

namespace coil {
namespace {

CpuMask to_mask(const cpu_set_t& set) {
  CpuMask mask;
  for (unsigned int i = 0; i < CPU_SETSIZE; ++i) {
    if (CPU_ISSET(i, &set)) mask.push_back(i);
  }
  return mask;
}

bool to_set(const CpuMask& mask, cpu_set_t& set) {
  CPU_ZERO(&set);
  for (unsigned int cpu : mask) {
    if (cpu >= CPU_SETSIZE) return false;
    CPU_SET(cpu, &set);
  }
  return !mask.empty();
}

bool parse(const std::string& text, CpuMask& mask) { return stringTo(mask, text.c_str()) && text.find('-') == std::string::npos; }

}  // namespace

bool getProcCpuAffinity(CpuMask& cpu_mask) {
  cpu_set_t set;
  if (::sched_getaffinity(::getpid(), sizeof(set), &set) != 0) return false;
  cpu_mask = to_mask(set);
  return true;
}

bool setProcCpuAffinity(const CpuMask& cpu_mask) {
  cpu_set_t set;
  return to_set(cpu_mask, set) && ::sched_setaffinity(::getpid(), sizeof(set), &set) == 0;
}

bool setProcCpuAffinity(const std::string& cpu_mask) {
  CpuMask mask;
  return parse(cpu_mask, mask) && setProcCpuAffinity(mask);
}

bool getThreadCpuAffinity(CpuMask& cpu_mask) {
  cpu_set_t set;
  if (::pthread_getaffinity_np(::pthread_self(), sizeof(set), &set) != 0) return false;
  cpu_mask = to_mask(set);
  return true;
}

bool setThreadCpuAffinity(const CpuMask& cpu_mask) {
  cpu_set_t set;
  return to_set(cpu_mask, set) && ::pthread_setaffinity_np(::pthread_self(), sizeof(set), &set) == 0;
}

bool setThreadCpuAffinity(const std::string& cpu_mask) {
  CpuMask mask;
  return parse(cpu_mask, mask) && setThreadCpuAffinity(mask);
}

}  // namespace coil
