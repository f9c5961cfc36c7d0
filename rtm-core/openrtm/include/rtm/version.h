// The version of the component author's API that this runtime offers: the numbers that sources of the 2.x series ask for. Any thread.
#pragma once

#define RTM_MAJOR_VERSION 2
#define RTM_MINOR_VERSION 1
#define RTM_REVISION_NUM 0
#define RTM_RELEASE_TYPE "RELEASE"

namespace RTC {
inline constexpr const char* openrtm_name = "OpenRTM-aist-2.1.0";
inline constexpr const char* openrtm_version = "2.1.0";
inline constexpr const char* corba_name = "omniORB";
}  // namespace RTC
