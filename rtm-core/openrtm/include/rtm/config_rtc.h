// Macros for sources and headers that older tools generated: the ORB and the system of the build. No code.
#pragma once

#include <coil/config_coil.h>

#ifndef ORB_IS_OMNIORB
#define ORB_IS_OMNIORB
#endif
#if defined(__linux__) && !defined(RTM_OS_LINUX)
#define RTM_OS_LINUX
#endif
