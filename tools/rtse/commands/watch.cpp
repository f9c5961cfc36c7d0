// watch: a full-screen view of components, states, ports and rates. q ends it.
#include <ncurses.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <utility>

#include "base/text.h"
#include "rtse/command.h"
#include "rtse/commands/commands.h"

namespace tools {
namespace {

constexpr std::chrono::milliseconds refresh_period{500};

class Screen {
 public:
  Screen() {
    initscr();
    cbreak();
    noecho();
    curs_set(0);
    keypad(stdscr, TRUE);
    timeout(static_cast<int>(refresh_period.count()));
    if (has_colors()) {
      start_color();
      use_default_colors();
      init_pair(1, COLOR_GREEN, -1);
      init_pair(2, COLOR_RED, -1);
      init_pair(3, COLOR_YELLOW, -1);
    }
  }
  ~Screen() { endwin(); }
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;
};

int colour_of(const ComponentView& component) {
  if (!component.problem.empty()) return COLOR_PAIR(2) | A_BOLD;
  switch (component.state()) {
    case RTC::ACTIVE_STATE:
      return COLOR_PAIR(1);
    case RTC::ERROR_STATE:
      return COLOR_PAIR(2) | A_BOLD;
    default:
      return COLOR_PAIR(3);
  }
}

// Lines beyond the screen are left out; the view scrolls by `first`.
class Page {
 public:
  explicit Page(int first) : line_(-first) {}
  void write(const std::string& text, int attributes = 0) {
    if (line_ >= 0 && line_ + 1 < LINES) {
      attron(attributes);
      mvaddnstr(line_ + 1, 0, text.c_str(), COLS);
      attroff(attributes);
    }
    ++line_;
  }
  // So many lines are left below the first shown one.
  int rest() const { return line_; }

 private:
  int line_;
};

std::string peers_of(const PortView& port, const std::vector<ComponentView>& all) {
  std::vector<std::string> names;
  for (const auto& connector : port.connectors) {
    for (CORBA::ULong i = 0; i < connector.ports.length(); ++i) {
      if (connector.ports[i]->_is_equivalent(port.object)) continue;
      const auto owner = owner_of(connector.ports[i], all);
      names.push_back(owner.port ? owner.component->instance + ":" + owner.port->name : "?");
    }
  }
  return base::join(names, ", ");
}

double number(const Properties& properties, const std::string& key) { return base::parse_number(property(properties, key)).value_or(0); }

// What the contexts have really done between two looks.
class Rates {
 public:
  // "1000 Hz asked, 998.7 done, 0.02 ms each, 1.2 at most, 3 missed"; less where a runtime has no statistics. A component that waits in
  // onExecute, for data or for the simulator, runs as often as something comes, and what passes of its short periods meanwhile is no loss:
  // "at most 1000 Hz, 19.6 done, 0.05 ms each, 1.2 at most, waits for data". A stopped context does nothing: "stopped".
  std::string text(const ComponentView& component) {
    const auto* shown = component.shown_context();
    if (!shown) return "";
    const auto& context = *shown;
    if (!context.is_running) return "stopped";
    const auto rate = base::format_number(context.rate) + " Hz";
    if (!context.properties.contains("statistics.cycles")) return rate;
    const auto now = look(context.properties);
    const auto before = std::exchange(looks_[component.path], now);
    const auto passed = std::chrono::duration<double>(now.time - before.time).count();
    const bool has_both = before.time != Clock::time_point{} && now.cycles >= before.cycles && passed > 0;
    // Of the cycles between two looks: those of another state, long ago, say nothing. The first look, and one at a context that stands
    // still, has all that were; so has one after millions of cycles, because contexts tell their means in whole nanoseconds.
    const Look since = has_both && now.cycles > before.cycles && now.cycles < 1e7 ? before : Look();
    const auto mean = [&](double Look::*total) { return (now.*total - since.*total) / std::max(now.cycles - since.cycles, 1.0); };
    // Waiting that takes less than the period changes nothing.
    const bool waits = mean(&Look::waited) * context.rate >= 1;
    char more[120] = "";
    auto text = waits ? "at most " + rate : rate;
    if (has_both) std::snprintf(more, sizeof more, "%s, %.1f done", waits ? "" : " asked", (now.cycles - before.cycles) / passed);
    text += more;
    const double worked = std::max(mean(&Look::worked), 0.0);
    std::snprintf(more, sizeof more, ", %.3g ms each, %.3g at most", 1000 * worked,
                  1000 * number(context.properties, "statistics.max_execution_time"));
    text += more;
    if (worked * context.rate >= 1) return text + ", longer than its period";
    if (waits) return text + ", waits for data";
    std::snprintf(more, sizeof more, ", %.0f missed", number(context.properties, "statistics.missed_cycles"));
    return text + more;
  }

 private:
  using Clock = std::chrono::steady_clock;
  struct Look {
    double cycles = 0;
    double worked = 0, waited = 0;  // [s] in all of them
    Clock::time_point time;
  };
  static Look look(const Properties& properties) {
    const double cycles = number(properties, "statistics.cycles");
    return {cycles, cycles * number(properties, "statistics.mean_execution_time"),
            cycles * number(properties, "statistics.mean_waiting_time"), Clock::now()};
  }
  std::map<std::string, Look> looks_;  // by the component's path
};

void draw_component(Page& page, const ComponentView& component, const std::vector<ComponentView>& all, Rates& rates) {
  const auto state = component.problem.empty() ? state_text(component.state()) : component.problem;
  char line[512];
  std::snprintf(line, sizeof line, "%-24s %-10s %s", component.instance.c_str(), state.c_str(), rates.text(component).c_str());
  page.write(line, colour_of(component));
  for (const auto& port : component.ports) {
    const auto mark = port.port_type() == "DataInPort" ? "->" : port.port_type() == "DataOutPort" ? "<-" : "<>";
    const auto peers = peers_of(port, all);
    std::snprintf(line, sizeof line, "   %s %-20s %s%s", mark, port.name.c_str(), port.data_type().c_str(),
                  peers.empty() ? "" : ("   " + peers).c_str());
    page.write(line, peers.empty() ? A_DIM : 0);
  }
}

void watch(const Session& session, Console& console, const std::string& path) {
  if (!isatty(1)) return console.fail({"watch: standard output is no terminal; use: rtse ls -l"});
  const Screen screen;
  Rates rates;
  int first = 0;
  for (int key = 0; key != 'q' && key != 'Q';) {
    const auto names = session.tree(path);
    erase();
    mvprintw(0, 0, "rtse watch  name server %s   (q: quit, arrows: scroll)", session.server().c_str());
    Page page(first);
    if (!names) {
      page.write(names.error().message, COLOR_PAIR(2));
    } else {
      const auto components = read_components(*names, {.contexts = true, .connectors = true}, session.call_timeout());
      for (const auto& component : components) draw_component(page, component, components, rates);
    }
    refresh();
    key = getch();
    const int before = first;
    if (key == KEY_DOWN) ++first;
    if (key == KEY_UP) first = std::max(0, first - 1);
    if (key == KEY_NPAGE) first += LINES - 2;
    if (key == KEY_DOWN || key == KEY_NPAGE) first = std::min(first, std::max(0, before + page.rest() - 1));  // the last line stays
    if (key == KEY_PPAGE) first = std::max(0, first - LINES + 2);
  }
}

}  // namespace

void add_watch(base::Command& app, Chosen& chosen) {
  auto* watch = app.add_subcommand("watch", "Full-screen view of components, states, ports and connections");
  auto watch_path = std::make_shared<std::string>();
  watch->add_option("PATH", *watch_path, "A name server, as /HOST:PORT");
  watch->callback([&chosen, watch_path] {
    chosen.work = [watch_path](const Session& session, Console& console) { tools::watch(session, console, *watch_path); };
  });
}

}  // namespace tools
