// The macros that classic component sources use for symbols of shared libraries; nothing has to be marked here.
#pragma once

#if __cplusplus < 202002L
#error "these headers need C++20: link OpenRTM::openrtm, or add the --cflags of rtm-config and set no older standard after them"
#endif

#ifndef DLL_EXPORT
#define DLL_EXPORT __attribute__((visibility("default")))
#endif
#ifndef DLL_PLUGIN
#define DLL_PLUGIN
#endif
#ifndef COIL_DLL_PLUGIN
#define COIL_DLL_PLUGIN
#endif
#ifndef DLL_TEMPLATE_PLUGIN
#define DLL_TEMPLATE_PLUGIN
#endif
