// ec: the execution contexts of a component: shown, started, stopped, and how fast they run.
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/command_line.h"
#include "base/text.h"
#include "rtse/command.h"
#include "rtse/commands/commands.h"

namespace tools {
namespace {

struct ContextOptions {
  std::string path, action = "list";
  double rate = 0;  // [Hz]
  int index = 0;
};

void list_contexts(Console& console, const ComponentView& component) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < component.contexts.size(); ++i) {
    const auto& context = component.contexts[i];
    const auto owner = context.is_owned ? "own" : "joined";
    if (console.json()) {
      all.push_back({{"index", i},
                     {"owned", context.is_owned},
                     {"kind", kind_text(context.kind)},
                     {"rate", context.rate},
                     {"running", context.is_running},
                     {"state", state_text(context.state)},
                     {"problem", context.problem}});
    } else if (context.is_gone()) {
      std::printf("%zu  %-6s  %s\n", i, owner, base::printable(context.problem).c_str());
    } else {
      std::printf("%zu  %-6s  %-12s %10s Hz  %-8s %s\n", i, owner, kind_text(context.kind).c_str(),
                  base::format_number(context.rate).c_str(), context.is_running ? "runs" : "stopped", state_text(context.state).c_str());
    }
  }
  if (console.json()) console.print(all);
}

void work_on_context(const Session& session, Console& console, const ContextOptions& options) {
  const auto component = session.component(options.path, {.contexts = true});
  if (!component) return console.fail(component.error());
  if (options.action == "list") return list_contexts(console, *component);
  const auto index = static_cast<std::size_t>(options.index);
  if (index >= component->contexts.size()) {
    return console.fail({"component " + component->path + ": has no execution context number " + std::to_string(index) + ", it has " +
                         std::to_string(component->contexts.size())});
  }
  const auto& context = component->contexts[index].object;
  const auto what = options.action + " of context " + std::to_string(index) + " of " + component->path;
  RTC::ReturnCode_t code = RTC::RTC_ERROR;
  const auto called = remote(what + ":", [&] {
    code = options.action == "rate" ? context->set_rate(options.rate) : options.action == "start" ? context->start() : context->stop();
  });
  if (!called) return console.fail(called.error());
  if (const auto checked = check(what, code); !checked) console.fail(checked.error());
}

}  // namespace

void add_context(base::Command& app, Chosen& chosen) {
  auto* command = app.add_subcommand("ec", "Show and change execution contexts: ec PATH [list | rate HZ | start | stop]");
  auto options = std::make_shared<ContextOptions>();
  auto rate = std::make_shared<std::vector<double>>();
  command->add_option("PATH", options->path, "Component")->required();
  command->add_option("ACTION", options->action, "list, rate, start or stop")->check(base::one_of({"list", "rate", "start", "stop"}));
  command->add_option("HZ", *rate, "With rate: ticks per second")->check(base::number_between(1e-6, 1e6));
  command->add_option("-e,--context", options->index, "Index of the execution context")
      ->capture_default_str()
      ->check(base::number_between(0, 1000));
  command->callback([&chosen, options, rate] {
    require(rate->size() == (options->action == "rate" ? 1u : 0u), "ec " + options->action,
            options->action == "rate" ? "expected one rate" : "expected no further argument");
    if (!rate->empty()) options->rate = rate->front();
    chosen.work = [options](const Session& session, Console& console) { work_on_context(session, console, *options); };
  });
}

}  // namespace tools
