// rtm-asset-reader: reads meshes and pictures for sim-server, which starts it.
#include <cstdio>

#include "asset-reader/serve.h"
#include "base/command_line.h"

int main(int argc, char** argv) {
  base::Command app("Reads meshes and images for sim-server, which starts it. Not for use by hand.", "rtm-asset-reader");
  base::add_standard_options(app, "rtm-asset-reader", RTMSIM_VERSION);
  bool has_socket = false;
  app.add_flag("--socket", has_socket, "requests come over descriptor 3");
  if (const auto end = base::parse_command_line(app, "rtm-asset-reader", argc, argv)) return *end;
  if (!has_socket) {
    std::fprintf(stderr, "rtm-asset-reader: is started by sim-server, when a world has meshes or pictures\n");
    return 2;
  }
  return sim::serve_assets();
}
