// rtm-studio: a simulated world, a system of components and its signals in a browser. See --help.
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <new>
#include <optional>
#include <system_error>

#include "base/command_line.h"
#include "base/terminal.h"
#include "base/text.h"
#include "recording/ring.h"
#include "shm/request_board.h"
#include "studio/open_page.h"
#include "studio/recorded_studio.h"
#include "studio/session_hub.h"
#include "studio/start_hints.h"
#include "studio/started_run.h"
#include "studio/studio.h"
#include "system/naming_tree.h"
#include "system/orb.h"
#include "system/remote.h"

namespace {

struct Settings {
  studio::StudioOptions studio;
  studio::WebOptions web;
  std::string page = studio::default_page_folder();
  double call_limit_s = 1;
  studio::StartOptions start;
  bool opens = false;  // a browser, and what is missing
};

void add_options(base::Command& app, Settings& settings) {
  app.add_option("-w,--world", settings.start.world, "Start a simulator of this SDFormat world, paused")->check(base::existing_file());
  app.add_option("FILE", settings.start.system,
                 "RTSProfile: start its components and a simulator of --world, paused, as rtse run does. Recording (MCAP): show it")
      ->check(recorder::recording_absence_problem);
  app.add_flag("--open", settings.opens,
               "Open the page in the browser. Without FILE, also start what is missing: a simulator of --world (default: the obstacle "
               "course), and a name server with an empty component host. All of it ends with rtm-studio");
  app.add_option("--ns", settings.studio.name_server,
                 "Name server HOST[:PORT] of a running system (default: the first of $RTCTREE_NAMESERVERS, else localhost:2809). FILE gets "
                 "one of its own");
  app.add_option("-s,--server-id", settings.studio.server_id, "ID of the simulator of a running system. FILE gets one of its own")
      ->check(base::integer_between(0, 9999))
      ->envname("RTMSIM_SERVER_ID")
      ->capture_default_str();
  app.add_option("-p,--port", settings.web.port, "Port to listen on; 0: any free one")
      ->check(base::integer_between(0, 65535))
      ->capture_default_str();
  app.add_option("--bind", settings.web.address, "Address to listen on; 0.0.0.0: all")->capture_default_str();
  app.add_flag("--read-only", settings.studio.is_read_only, "Reject all changes by viewers");
  app.add_option("--host", settings.web.hosts, "Additional host name of this machine, for browsers")->allow_extra_args(false);
  app.add_option("--allow-origin", settings.web.origins, "Origin of another page that may connect: https://HOST[:PORT]")
      ->allow_extra_args(false);
  app.add_option("--page", settings.page, "Folder with the built page")->capture_default_str();
  app.add_option("--call-timeout", settings.call_limit_s, "Timeout of a call to a component [s]")
      ->check(base::number_between(0.01, 600.0))
      ->capture_default_str();
}

class ErrorStream final : public tools::Reporter {
 public:
  void warn(const std::string& text) override { std::cerr << base::for_terminal("rtm-studio: " + text + "\n"); }
};

int fail(const base::Error& error) {
  std::cerr << base::for_terminal("rtm-studio: " + error.message + "\n");
  return 1;
}

int reject(const base::Error& error) {
  fail(error);
  return 2;
}

// As a browser has to be given it. What follows a '#' stays in the browser: no server, proxy or log gets the token from there. Always a
// number: for "localhost" a browser asks ::1 and 127.0.0.1, and where only one of them is ours, another account may listen at the other
// with a page that reads the token.
std::string url_of(const studio::WebOptions& options, const studio::WebServer& server) {
  const std::string address = options.address == "0.0.0.0" ? "127.0.0.1" : options.address == "::" ? "::1" : options.address;
  const std::string host = address.find(':') != std::string::npos ? "[" + address + "]" : address;
  return "http://" + host + ":" + std::to_string(server.port()) + "/#token=" + server.access().token();
}

int serve(boost::asio::io_context& loop, const Settings& settings, const studio::PageFiles& page, studio::WebHandlers first,
          const std::string& recording = "") {
  std::error_code problem;  // a folder that is gone has no recordings
  studio::SessionHub hub(loop, std::move(first), {std::filesystem::current_path(problem), settings.studio.is_read_only, recording});
  const auto server = studio::WebServer::open(loop, settings.web, page, hub.handlers());
  if (!server) return fail(server.error());
  const std::string url = url_of(settings.web, **server);
  std::cout << url << std::endl;
  std::optional<studio::OpenPage> browser;
  if (settings.opens) {
    auto opened = studio::OpenPage::open(url);
    if (opened)
      browser.emplace(std::move(*opened));
    else
      std::cerr << "rtm-studio: --open: " << opened.error().message << '\n';
  }
  loop.run();
  return 0;
}

int show_recording(boost::asio::io_context& loop, const Settings& settings, const studio::PageFiles& page) {
  if (!settings.start.world.empty())
    return reject({"recording " + base::in_quotes(settings.start.system) + ": has its world itself; leave --world out"});
  const auto recording = studio::RecordedStudio::open(loop, settings.start.system);
  if (!recording) return reject(recording.error());
  return serve(loop, settings, page, (*recording)->handlers(), settings.start.system);
}

int show_run(boost::asio::io_context& loop, Settings settings, const studio::PageFiles& page) {
  if (!settings.start.system.empty() && settings.start.world.empty())
    return reject({"system " + base::in_quotes(settings.start.system) + ": needs --world WORLD.sdf"});
  const tools::Orb orb;
  ErrorStream errors;
  std::optional<base::ChildProcess> host;
  if (settings.opens && settings.start.system.empty()) {
    if (settings.start.world.empty() && !shm::Requester::open(settings.studio.server_id)) settings.start.world = studio::usual_world();
    if (!tools::NamingTree::read(orb.get(), settings.studio.name_server, settings.studio.call_limit)) {
      auto started = studio::start_host(settings.studio.name_server);
      if (!started) return fail(started.error());
      host.emplace(std::move(*started));
    }
  }
  std::unique_ptr<studio::StartedRun> started;
  if (!settings.start.world.empty()) {
    bool is_rejected = false;
    auto run = studio::StartedRun::start(orb.get(), settings.start, settings.studio.server_id, errors, is_rejected);
    if (!run) return is_rejected ? reject(run.error()) : fail(run.error());
    started = std::move(*run);
    settings.studio.server_id = started->server_id();
    if (!started->name_server().empty()) settings.studio.name_server = started->name_server();
  }
  studio::Studio hub(loop, orb.get(), settings.studio);
  return serve(loop, settings, page, hub.handlers());
}

int run(const Settings& settings) {
  const auto page = studio::PageFiles::read(settings.page);
  if (!page) return reject(page.error());
  boost::asio::io_context loop(1);
  boost::asio::signal_set signals(loop, SIGINT, SIGTERM);
  signals.async_wait([&](boost::system::error_code, int) { loop.stop(); });
  const bool is_past = !settings.start.system.empty() && studio::is_recording(settings.start.system);
  return is_past ? show_recording(loop, settings, *page) : show_run(loop, settings, *page);
}

int studio_of(int argc, char** argv) {
  base::Command app{
      "rtm-studio: a simulated world, a system of RT components and its signals in a browser, live or recorded\nPrints a URL with a "
      "token; without it nothing is shown or done."};
  base::add_standard_options(app, "rtm-studio", RTMSIM_VERSION);
  Settings settings;
  settings.studio.name_server = tools::default_server();
  add_options(app, settings);
  if (const auto end = base::parse_command_line(app, "rtm-studio", argc, argv)) return *end;
  settings.studio.call_limit = std::chrono::milliseconds(static_cast<int>(settings.call_limit_s * 1000));
  settings.web.may_move = app.count("--port") == 0;
  try {
    return run(settings);
  } catch (const CORBA::Exception& e) {
    return fail({tools::describe(e)});
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return studio_of(argc, argv);
  } catch (const std::system_error& e) {
    fail({std::string("out of system resources (threads or files): ") + e.what()});
  } catch (const std::bad_alloc&) {
    fail({"out of memory"});
  } catch (const std::exception& e) {
    fail({e.what()});
  }
  std::_Exit(1);  // what the ORB has started may not end in order
}
