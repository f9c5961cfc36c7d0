// The macros that classic component sources use for symbols of shared libraries; nothing has to be marked here.
#pragma once

#if __cplusplus < 201703L
#error "these headers need C++17: link OpenRTM::openrtm, or add the --cflags of rtm-config and set no older standard after them"
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
