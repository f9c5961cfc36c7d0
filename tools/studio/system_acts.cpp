// Acts on components, their ports, contexts and configuration, by the same functions that rtse uses.
#include <algorithm>
#include <set>

#include "base/id.h"
#include "base/shell_word.h"
#include "base/text.h"
#include "studio/acts.h"
#include "studio/system_json.h"
#include "system/configuration.h"
#include "system/connections.h"
#include "system/session.h"
#include "system/transitions.h"

namespace studio {
namespace {

using base::Error;
using base::Result;
using tools::ComponentView;
using tools::Session;
using tools::Transition;
using Touches = Plan::Touches;

constexpr std::chrono::seconds exit_limit{10};
constexpr std::size_t max_ports = 64;

Session session_of(const ActContext& context) { return {context.orb, context.name_server, context.call_limit}; }

std::string rtse_line(const ActContext& context, std::vector<std::string> words) {
  std::vector<std::string> line{"rtse"};
  if (context.name_server != "localhost:2809" && context.name_server != "localhost") line.insert(line.end(), {"--ns", context.name_server});
  line.insert(line.end(), words.begin(), words.end());
  return base::shell_line(line);
}

Result<Json> done(const Result<void>& result) {
  if (!result) return result.error();
  return Json::object();
}

Result<Plan> component(const ActContext& context, const Json& args) {
  const auto path = text_of(args, "path");
  if (!path) return path.error();
  return Plan{rtse_line(context, base::command_words({"cat"}, {*path})), [context, path = *path]() -> Result<Json> {
                const auto view =
                    session_of(context).component(path, {.contexts = true, .connectors = true, .configuration = true, .members = true});
                if (!view) return view.error();
                return details_json(*view);
              }};
}

template <Transition transition>
Result<Plan> change(const ActContext& context, const Json& args) {
  const auto path = text_of(args, "path");
  if (!path) return path.error();
  const int index = static_cast<int>(std::clamp(number_or(args, "context", -1), -1.0, 1000.0));
  const char* verb = transition == Transition::activate ? "act" : transition == Transition::deactivate ? "deact" : "reset";
  std::vector<std::string> options;
  if (index > 0) options = {"-e", std::to_string(index)};
  return Plan{rtse_line(context, base::command_words({verb}, {*path}, options)),
              [context, path = *path, index]() -> Result<Json> {
                const auto view = session_of(context).component(path, {.contexts = true});
                if (!view) return view.error();
                return done(tools::change_state(*view, transition, index));
              },
              Touches::system};
}

Result<Json> exit_component(const ActContext& context, const std::string& path) {
  const auto view = session_of(context).component(path, {});
  if (!view) return view.error();
  RTC::ReturnCode_t code = RTC::RTC_OK;
  const tools::CallLimit limited(exit_limit);
  const auto called = tools::remote("exit of " + view->path + ":", [&] { code = view->object->exit(); });
  if (!called) return called.error();
  return done(tools::check("exit of " + view->path, code));
}

Result<Plan> exit(const ActContext& context, const Json& args) {
  const auto path = text_of(args, "path");
  if (!path) return path.error();
  return Plan{rtse_line(context, base::command_words({"exit"}, {*path})), [context, path = *path] { return exit_component(context, path); },
              Touches::system};
}

// ---- connections

struct Ends {
  std::vector<Session::Port> found;
  std::vector<const tools::PortView*> ports;
};

Result<Ends> find_ends(const ActContext& context, const std::vector<std::string>& paths) {
  Ends ends;
  for (const auto& path : paths) {
    auto port = session_of(context).port(path);
    if (!port) return port.error();
    ends.found.push_back(std::move(*port));
  }
  for (const auto& port : ends.found) ends.ports.push_back(&port.port);
  return ends;
}

Result<Plan> connect(const ActContext& context, const Json& args) {
  const auto paths = texts_of(args, "ports", 2, max_ports);
  if (!paths) return paths.error();
  const auto values = values_of(args, "properties");
  if (!values) return values.error();
  const auto name = text_or(args, "name", "");
  auto id = text_or(args, "id", "");
  std::vector<std::string> options;
  const auto add_option = [&](const std::string& option, const std::string& value) {
    for (auto& word : base::option_words(option, value)) options.push_back(std::move(word));
  };
  if (!name.empty()) add_option("-n", name);
  if (!id.empty()) add_option("-i", id);
  tools::Properties properties;
  for (const auto& [key, value] : *values) {
    properties[key] = value;
    add_option("-p", key + "=" + value);
  }
  if (id.empty()) id = base::make_uuid();
  return Plan{rtse_line(context, base::command_words({"con"}, *paths, options)),
              [context, paths = *paths, name, id, properties]() -> Result<Json> {
                const auto ends = find_ends(context, paths);
                if (!ends) return ends.error();
                const auto connected = tools::connect_ports(ends->ports, id, name, properties);
                if (!connected) return connected.error();
                return Json{{"id", id}};
              },
              Touches::system};
}

// What `connect` needs to make it again.
Json undo_of(const ActContext& context, const tools::ConnectorView& connector) {
  Json properties = Json::object();
  for (const auto& [key, value] : connector.properties) {
    const bool is_of_this_run = value.starts_with("IOR:") || value.starts_with("corbaloc:") ||
                                key.find("inport_ior") != std::string::npos || key.find("inport_ref") != std::string::npos ||
                                key.find("outport_ior") != std::string::npos || key.find("outport_ref") != std::string::npos;
    if (!is_of_this_run) properties[key] = value;
  }
  Json ports = Json::array();
  const auto tree = session_of(context).tree();
  if (tree) {
    const auto components = tools::read_components(*tree, {}, context.call_limit);
    for (CORBA::ULong i = 0; i < connector.ports.length(); ++i) {
      const auto owner = tools::owner_of(connector.ports[i], components);
      if (owner.port) ports.push_back(owner.component->path + ":" + owner.port->name);
    }
  }
  return {{"name", connector.name}, {"ports", ports}, {"properties", properties}};
}

Result<Json> disconnect_port(const ActContext& context, const std::string& path, const std::string& id) {
  const auto port = session_of(context).port(path, true);
  if (!port) return port.error();
  const auto& connectors = port->port.connectors;
  const auto found = std::find_if(connectors.begin(), connectors.end(), [&](const auto& connector) { return connector.id == id; });
  if (found == connectors.end()) return Error{"port " + path + ": has no connection " + base::in_quotes(id)};
  Json undo = undo_of(context, *found);
  const auto gone = tools::disconnect_connector(port->port, id);
  if (!gone) return gone.error();
  return undo;
}

Result<Plan> disconnect(const ActContext& context, const Json& args) {
  const auto path = text_of(args, "port"), id = text_of(args, "id");
  if (!path) return path.error();
  if (!id) return id.error();
  return Plan{rtse_line(context, base::command_words({"dis"}, {}, base::option_words("-i", *id))),
              [context, path = *path, id = *id] { return disconnect_port(context, path, id); }, Touches::system};
}

// What both ports offer of a property; "any" offers everything that the other has.
std::vector<std::string> common(const std::vector<const tools::PortView*>& ports, const std::string& key) {
  std::vector<std::string> result;
  bool is_first = true;
  for (const auto* port : ports) {
    auto offered = base::split_list(tools::property(port->properties, key));
    const bool is_any = offered.empty() || std::any_of(offered.begin(), offered.end(),
                                                       [](const std::string& one) { return base::equal_ignoring_case(one, "any"); });
    if (is_any) continue;
    if (is_first) {
      result = std::move(offered);
      is_first = false;
      continue;
    }
    std::erase_if(result, [&](const std::string& one) {
      return std::none_of(offered.begin(), offered.end(), [&](const std::string& other) { return base::equal_ignoring_case(one, other); });
    });
  }
  return result;
}

struct Option {
  const char* key;
  std::vector<std::string> values;  // empty: any text
  const char* otherwise;
  const char* meaning;
};

Json option_json(const Option& option) {
  Json json{{"key", option.key}, {"default", option.otherwise}, {"meaning", option.meaning}};
  if (!option.values.empty()) json["values"] = option.values;
  return json;
}

const std::vector<std::string> truth{"YES", "NO"};
const std::vector<std::string> full_policies{"overwrite", "do_nothing", "block"}, empty_policies{"readback", "do_nothing", "block"};

// The buffer of one end, e.g. "dataport.outport.buffer.length".
void add_buffer(Json& list, const std::string& end) {
  for (const Option& option : {Option{"length", {}, "8", "samples that it holds"},
                               Option{"write.full_policy", full_policies, "overwrite", "what a write to a full one does"},
                               Option{"write.timeout", {}, "1.0", "seconds that a write waits with block"},
                               Option{"read.empty_policy", empty_policies, "readback", "what a read of an empty one does"},
                               Option{"read.timeout", {}, "1.0", "seconds that a read waits with block"}}) {
    Json json = option_json(option);
    json["key"] = "dataport." + end + ".buffer." + option.key;
    list.push_back(std::move(json));
  }
}

Json data_options(const std::vector<const tools::PortView*>& ports) {
  Json list = Json::array();
  for (const Option& option :
       {Option{"dataport.interface_type", common(ports, "dataport.interface_type"), "corba_cdr", "how samples travel"},
        Option{"dataport.dataflow_type", common(ports, "dataport.dataflow_type"), "push",
               "who moves them: the writer pushes or the reader pulls"},
        Option{"dataport.subscription_type", common(ports, "dataport.subscription_type"), "flush",
               "flush: write waits for the reader; new: a thread sends what is new; periodic: at a rate"},
        Option{"dataport.publisher.push_policy",
               {"new", "all", "fifo", "skip"},
               "new",
               "which samples of the buffer are sent (new, periodic)"},
        Option{"dataport.publisher.push_rate", {}, "1000.0", "rate of periodic [Hz]"},
        Option{"dataport.publisher.skip_count", {}, "0", "samples left out between two with skip"},
        Option{"dataport.serializer.cdr.endian", {"little", "big", "little,big"}, "little,big", "byte order on the wire"},
        Option{"dataport.timestamp_policy", {"on_send", "on_received", "N/A"}, "N/A", "who stamps the samples"},
        Option{"dataport.marshaling_type", {}, "cdr", "encoding"}})
    list.push_back(option_json(option));
  add_buffer(list, "outport");
  add_buffer(list, "inport");
  return list;
}

Json service_options() {
  return Json::array({option_json(
      {"port.connection.strictness", {"best_effort", "strict"}, "best_effort", "whether interfaces without a partner are an error"})});
}

std::string misfit(const std::vector<const tools::PortView*>& ports) {
  const auto& a = *ports.front();
  for (const auto* port : ports) {
    if (port->is_data_port() != a.is_data_port()) return "a data port and a service port cannot be connected";
  }
  if (!a.is_data_port()) return "";
  const auto& b = *ports.back();
  if (a.port_type() == b.port_type()) return "both are " + a.port_type() + ", expected an OutPort and an InPort";
  if (tools::carry_different_types(a, b)) return "they carry different types, " + a.data_type() + " and " + b.data_type();
  return "";
}

Result<Plan> connection_options(const ActContext& context, const Json& args) {
  const auto paths = texts_of(args, "ports", 2, max_ports);
  if (!paths) return paths.error();
  return Plan{"", [context, paths = *paths]() -> Result<Json> {
                const auto ends = find_ends(context, paths);
                if (!ends) return ends.error();
                Json json{{"problem", misfit(ends->ports)}};
                json["properties"] = ends->ports.front()->is_data_port() ? data_options(ends->ports) : service_options();
                return json;
              }};
}

// ---- configuration

using Values = std::vector<std::pair<std::string, std::string>>;

// `is_forced`: also what the component's own types and constraints forbid.
Result<void> merge(const ComponentView& component, const std::string& set_id, const Values& values, bool is_forced, Values& all) {
  for (const auto& [name, value] : values) {
    const auto problem = is_forced ? std::string() : tools::value_problem(component, name, value);
    if (!problem.empty())
      return Error{"component " + component.path + ": parameter " + name + " cannot be " + base::in_quotes(value) + ", expected " +
                   problem};
    const auto known = std::find_if(all.begin(), all.end(), [&, name = name](const auto& pair) { return pair.first == name; });
    if (known == all.end()) return Error{"component " + component.path + ": set " + set_id + " has no parameter " + base::in_quotes(name)};
    known->second = value;
  }
  return {};
}

struct Wish {
  std::string path, set;
  Values values;
  bool is_used = false, is_forced = false;
};

Result<Json> configure(const ActContext& context, const Wish& wish) {
  const auto& [path, set_id, values, is_used, is_forced] = wish;
  const auto view = session_of(context).component(path, {.configuration = true});
  if (!view) return view.error();
  const auto* set = find_set(*view, set_id);
  if (!set || set->is_hidden()) return Error{"component " + view->path + ": has no configuration set " + base::in_quotes(set_id)};
  auto all = set->values;
  if (const auto merged = merge(*view, set_id, values, is_forced, all); !merged) return merged.error();
  const tools::CallLimit limited(context.call_limit);
  if (const auto kept = tools::set_values(*view, set_id, all); !kept) return kept.error();
  // Values reach the component when its active set is activated once more.
  const auto active = is_used || view->active_set.empty() ? set_id : view->active_set;
  return done(tools::use_set(*view, active));
}

Result<Plan> set_configuration(const ActContext& context, const Json& args) {
  const auto path = text_of(args, "path"), set = text_of(args, "set");
  if (!path) return path.error();
  if (!set) return set.error();
  const auto values = values_of(args, "values");
  if (!values) return values.error();
  if (values->empty()) return Error{"values: expected at least one"};
  const Wish wish{*path, *set, *values, flag_of(args, "use"), flag_of(args, "force")};
  std::string command;
  for (const auto& [name, value] : *values) {
    auto options = base::option_words("-s", *set);
    if (wish.is_forced) options.emplace_back("--force");
    command += (command.empty() ? "" : " && ") + rtse_line(context, base::command_words({"conf"}, {*path, "set", name, value}, options));
  }
  if (wish.is_used) command += " && " + rtse_line(context, base::command_words({"conf"}, {*path, "use", *set}));
  return Plan{command, [context, wish] { return configure(context, wish); }, Touches::system};
}

Result<Plan> use_set(const ActContext& context, const Json& args) {
  const auto path = text_of(args, "path"), set = text_of(args, "set");
  if (!path) return path.error();
  if (!set) return set.error();
  return Plan{rtse_line(context, base::command_words({"conf"}, {*path, "use", *set})),
              [context, path = *path, set = *set]() -> Result<Json> {
                const auto view = session_of(context).component(path, {.configuration = true});
                if (!view) return view.error();
                const tools::CallLimit limited(context.call_limit);
                return done(tools::use_set(*view, set));
              },
              Touches::system};
}

// ---- contexts

using ContextCall = std::function<RTC::ReturnCode_t(RTC::ExecutionContext_ptr)>;

Result<Json> call_context(const ActContext& context, const std::string& path, std::size_t index, const std::string& what,
                          const ContextCall& call) {
  const auto view = session_of(context).component(path, {.contexts = true});
  if (!view) return view.error();
  if (index >= view->contexts.size())
    return Error{"component " + view->path + ": has no execution context number " + std::to_string(index)};
  RTC::ReturnCode_t code = RTC::RTC_ERROR;
  const tools::CallLimit limited(context.call_limit);
  const auto line = what + " of " + view->path;
  const auto called = tools::remote(line + ":", [&] { code = call(view->contexts[index].object); });
  if (!called) return called.error();
  return done(tools::check(line, code));
}

// `words`: of rtse ec, after the path.
Result<Plan> plan_context(const ActContext& context, const Json& args, const std::string& what, const std::vector<std::string>& words,
                          ContextCall call) {
  const auto path = text_of(args, "path");
  if (!path) return path.error();
  const double index = number_or(args, "context", 0);
  if (index < 0 || index > 1000) return Error{"context: expected its number, from 0"};
  std::vector<std::string> operands{*path}, options;
  operands.insert(operands.end(), words.begin(), words.end());
  if (index >= 1) options = {"-e", std::to_string(static_cast<std::size_t>(index))};
  return Plan{rtse_line(context, base::command_words({"ec"}, operands, options)),
              [context, path = *path, index = static_cast<std::size_t>(index), what, call = std::move(call)] {
                return call_context(context, path, index, what, call);
              },
              Touches::system};
}

Result<Plan> set_rate(const ActContext& context, const Json& args) {
  const auto rate = number_of(args, "rate");
  if (!rate) return rate.error();
  if (*rate <= 0 || *rate > 1e6) return Error{"rate: expected more than 0 and at most 1e6 Hz"};
  return plan_context(context, args, "setting the rate", {"rate", base::format_number(*rate)},
                      [rate = *rate](RTC::ExecutionContext_ptr one) { return one->set_rate(rate); });
}

Result<Plan> start_context(const ActContext& context, const Json& args) {
  return plan_context(context, args, "starting a context", {"start"}, [](RTC::ExecutionContext_ptr one) { return one->start(); });
}

Result<Plan> stop_context(const ActContext& context, const Json& args) {
  return plan_context(context, args, "stopping a context", {"stop"}, [](RTC::ExecutionContext_ptr one) { return one->stop(); });
}

}  // namespace

std::vector<Act> system_acts() {
  return {{"component", true, component},
          {"activate", false, change<Transition::activate>},
          {"deactivate", false, change<Transition::deactivate>},
          {"reset", false, change<Transition::reset>},
          {"exit", false, exit},
          {"connect", false, connect},
          {"disconnect", false, disconnect},
          {"connection_options", true, connection_options},
          {"set_configuration", false, set_configuration},
          {"use_set", false, use_set},
          {"set_rate", false, set_rate},
          {"start_context", false, start_context},
          {"stop_context", false, stop_context}};
}

}  // namespace studio
