// Acts through managers, and those on whole systems: done by rtse itself, which each of them starts.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>

#include "base/child_process.h"
#include "base/shell_word.h"
#include "base/text.h"
#include "run/time_members.h"
#include "studio/acts.h"
#include "system/profile/rts_profile.h"

namespace studio {
namespace {

using base::Error;
using base::Result;
using Touches = Plan::Touches;

constexpr std::chrono::seconds program_limit{30};
constexpr std::size_t max_places = 10000;
using tools::highest_phase;
using tools::highest_turn;

std::vector<std::string> rtse_words(const ActContext& context, const std::vector<std::string>& words, bool json) {
  std::vector<std::string> all{base::own_program("rtse"), "--ns", context.name_server};
  if (json) all.emplace_back("--json");
  all.insert(all.end(), words.begin(), words.end());
  return all;
}

std::string rtse_line(const ActContext& context, const std::vector<std::string>& words) {
  std::vector<std::string> line{"rtse"};
  if (context.name_server != "localhost:2809" && context.name_server != "localhost") line.insert(line.end(), {"--ns", context.name_server});
  line.insert(line.end(), words.begin(), words.end());
  return base::shell_line(line);
}

// What it wrote, or the last line that it wrote, without its own name before it.
Result<std::string> rtse(const ActContext& context, const std::vector<std::string>& words, bool json = false) {
  auto said = base::output_of({rtse_words(context, words, json), {}, ""}, program_limit);
  if (said) return said;
  auto message = said.error().message;
  if (const auto own = message.find("rtse: "); own != std::string::npos) message.erase(0, own + 6);
  return Error{message};
}

Plan plan(const ActContext& context, const std::vector<std::string>& words, Touches touches = Touches::system) {
  return {rtse_line(context, words),
          [context, words]() -> Result<Json> {
            const auto said = rtse(context, words);
            if (!said) return said.error();
            return Json::object();
          },
          touches};
}

Json names_of(const Json& list, std::initializer_list<const char*> keys) {
  Json names = Json::array();
  for (const Json& entry : list.is_array() ? list : Json::array()) {
    for (const char* key : keys) {
      if (entry.contains(key)) {
        names.push_back(entry[key]);
        break;
      }
    }
  }
  return names;
}

Result<Plan> manager(const ActContext& context, const Json& args) {
  const auto path = text_of(args, "path");
  if (!path) return path.error();
  const std::vector<std::string> words = base::command_words({"mgr", "list"}, {}, base::option_words("-m", *path));
  return Plan{rtse_line(context, words), [context, words]() -> Result<Json> {
                const auto said = rtse(context, words, true);
                if (!said) return said.error();
                const Json list = Json::parse(*said, nullptr, false);
                if (!list.is_object()) return Error{"manager: the output of rtse is not JSON"};
                Json loadable = Json::array();
                for (const Json& module : list.value("loadable_modules", Json::array())) {
                  const auto file = module.value("module_file_path", module.value("module_file_name", ""));
                  loadable.push_back({{"file", file}, {"type", module.value("implementation_id", "")}});
                }
                Json factories = Json::array();
                for (const Json& factory : list.value("factories", Json::array()))
                  factories.push_back({{"type", factory.value("implementation_id", "")}});
                return Json{{"components", list.value("components", Json::array())},
                            {"loaded", names_of(list.value("loaded_modules", Json::array()), {"file_path", "module_file_path"})},
                            {"loadable", std::move(loadable)},
                            {"factories", std::move(factories)}};
              }};
}

Result<Plan> load_module(const ActContext& context, const Json& args) {
  const auto path = text_of(args, "manager"), file = text_of(args, "file");
  if (!path) return path.error();
  if (!file) return file.error();
  const auto init = text_or(args, "init", "");
  if (file->starts_with('-') || init.starts_with('-'))
    return Error{"file " + base::in_quotes(*file) + ": expected the name of a module, and perhaps that of its function"};
  std::vector<std::string> operands{*file};
  if (!init.empty()) operands.push_back(init);
  return plan(context, base::command_words({"mgr", "load"}, operands, base::option_words("-m", *path)));
}

// "Type?instance_name=...&key=value"
Result<std::string> creation(const Json& args) {
  const auto type = text_of(args, "type");
  if (!type) return type.error();
  auto values = values_of(args, "properties");
  if (!values) return values.error();
  if (const auto name = text_or(args, "name", ""); !name.empty()) values->emplace_back("instance_name", name);
  std::string text = *type;
  for (const auto& [key, value] : *values) {
    if ((key + value).find_first_of("&?") != std::string::npos) return Error{"properties: expected texts without '&' and '?'"};
    text += (text == *type ? "?" : "&") + key + "=" + value;
  }
  if (text.starts_with('-') || type->empty()) return Error{"type " + base::in_quotes(*type) + ": expected the type of a component"};
  return text;
}

Result<Plan> create(const ActContext& context, const Json& args) {
  const auto path = text_of(args, "manager");
  if (!path) return path.error();
  const auto text = creation(args);
  if (!text) return text.error();
  const auto words = base::command_words({"mgr", "create"}, {*text}, base::option_words("-m", *path));
  return Plan{rtse_line(context, words),
              [context, words]() -> Result<Json> {
                const auto said = rtse(context, words);
                if (!said) return said.error();
                return Json{{"instance", std::string(base::trim(*said))}};
              },
              Touches::system};
}

Result<Plan> delete_component(const ActContext& context, const Json& args) {
  const auto path = text_of(args, "manager"), instance = text_of(args, "instance");
  if (!path) return path.error();
  if (!instance) return instance.error();
  if (instance->starts_with('-')) return Error{"instance " + base::in_quotes(*instance) + ": expected the name of a component"};
  return plan(context, base::command_words({"mgr", "delete"}, {*instance}, base::option_words("-m", *path)));
}

Result<Plan> unload_module(const ActContext& context, const Json& args) {
  const auto path = text_of(args, "manager"), file = text_of(args, "file");
  if (!path) return path.error();
  if (!file) return file.error();
  if (file->starts_with('-')) return Error{"file " + base::in_quotes(*file) + ": expected the name of a module"};
  return plan(context, base::command_words({"mgr", "unload"}, {*file}, base::option_words("-m", *path)));
}

// ---- components, by what only rtse does

// All connections of a component, or of a port.
Result<Plan> disconnect_all(const ActContext& context, const Json& args) {
  const auto path = text_of(args, "path");
  if (!path) return path.error();
  return plan(context, base::command_words({"dis"}, {*path}));
}

Result<Plan> inject(const ActContext& context, const Json& args) {
  const auto port = text_of(args, "port"), value = text_of(args, "value");
  if (!port) return port.error();
  if (!value) return value.error();
  if (value->empty() || value->starts_with('-')) return Error{"value: expected JSON, or RTC.TYPE({time}, ...)"};
  return plan(context, base::command_words({"inject"}, {*port, *value}), Touches::nothing);
}

// A component that runs takes part in the time of this studio's simulator.
Result<Plan> join_time(const ActContext& context, const Json& args) {
  const auto path = text_of(args, "path");
  if (!path) return path.error();
  const double phase = number_or(args, "phase", 1), turn = number_or(args, "turn", 0), rate = number_or(args, "rate", 0);
  if (phase < 0 || phase > highest_phase || phase != std::floor(phase))
    return Error{"phase: expected a whole number from 0 to " + std::to_string(highest_phase)};
  std::vector<std::string> options{"-s", std::to_string(context.server_id), "-p", base::format_number(phase)};
  if (turn < 0 || turn > highest_turn || turn != std::floor(turn))
    return Error{"turn: expected a whole number from 0 to " + std::to_string(highest_turn)};
  if (turn > 0) options.insert(options.end(), {"--turn", base::format_number(turn)});
  if (args.contains("rate")) {
    if (!(rate >= 1e-6 && rate <= 1e6)) return Error{"rate: expected 1e-6 to 1e6 Hz"};
    options.insert(options.end(), {"-r", base::format_number(rate)});
  }
  if (flag_of(args, "tick")) options.emplace_back("--tick");
  return plan(context, base::command_words({"join"}, {*path}, options));
}

Result<Plan> leave_time(const ActContext& context, const Json& args) {
  const auto path = text_of(args, "path");
  if (!path) return path.error();
  return plan(context, base::command_words({"leave"}, {*path}));
}

Result<Plan> forget(const ActContext& context, const Json& args) {
  const auto path = text_of(args, "path");
  if (!path) return path.error();
  return plan(context, base::command_words({"del"}, {*path}));
}

// All names whose objects are gone.
Result<Plan> forget_dead(const ActContext& context, const Json&) { return plan(context, {"del", "-z"}); }

// ---- whole systems

// A file of a profile that lasts as long as this object.
class ScratchFile {
 public:
  static Result<ScratchFile> with(const std::string& text) {
    std::error_code error;
    auto name = (std::filesystem::temp_directory_path(error) / "rtm-studio-XXXXXX").string();
    const int file = mkstemp(name.data());
    if (file < 0) return Error{"temporary file " + name + ": cannot be made"};
    ScratchFile scratch(name);
    std::ofstream out(name, std::ios::binary);
    out << text;
    out.close();
    ::close(file);
    if (!out) return Error{"temporary file " + name + ": cannot be written"};
    return scratch;
  }
  ScratchFile(ScratchFile&& other) noexcept : name_(std::exchange(other.name_, {})) {}
  ScratchFile& operator=(ScratchFile&&) = delete;
  ~ScratchFile() {
    std::error_code ignored;  // a file in the folder for temporary ones
    if (!name_.empty()) std::filesystem::remove(name_, ignored);
  }
  const std::string& name() const { return name_; }
  std::string text() const {
    std::ifstream in(name_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

 private:
  explicit ScratchFile(std::string name) : name_(std::move(name)) {}
  std::string name_;
};

// "127.0.0.1:2809/PC.host_cxt/Laser0.rtc" as "PC.host_cxt/Laser0.rtc": a naming service has several names.
std::string below_name_server(std::string_view path) {
  if (path.starts_with('/')) path.remove_prefix(1);
  return std::string(path.substr(std::min(path.find('/'), path.size() - 1) + 1));
}

using Places = std::map<std::string, tools::SavedPlace>;  // by the path below the naming service

// {"/localhost:2809/PC.host_cxt/Laser0.rtc":[x,y,width,height], ...}
Result<Places> places_of(const Json& args) {
  Places places;
  const auto all = args.find("positions");
  if (all == args.end()) return places;
  if (!all->is_object() || all->size() > max_places) return Error{"positions: expected an object of at most 10000 places"};
  for (const auto& [path, numbers] : all->items()) {
    const auto is_number = [](const Json& number) { return number.is_number() && std::abs(number.get<double>()) < 1e6; };
    if (path.empty() || !numbers.is_array() || numbers.size() != 4 || !std::all_of(numbers.begin(), numbers.end(), is_number))
      return Error{"positions: expected [x, y, width, height] for each component"};
    const auto pixels = [&](std::size_t i) { return static_cast<int>(std::lround(numbers[i].get<double>())); };
    places[below_name_server(path)] = {pixels(0), pixels(1), pixels(2), pixels(3), "right"};
  }
  return places;
}

// As rtse says it, with the boxes where the page has them.
Result<std::string> save_with(const std::string& xml, const Places& places) {
  if (places.empty()) return xml;
  auto system = tools::parse_xml(xml, "the saved system");
  if (!system) return system.error();
  for (auto& component : system->components) {
    if (const auto place = places.find(below_name_server(component.path_uri)); place != places.end()) component.place = place->second;
  }
  return tools::to_xml(*system);
}

Result<Plan> save_profile(const ActContext& context, const Json& args) {
  std::vector<std::string> words{"save", "-"};
  const auto name = text_or(args, "name", "");
  if (!name.empty()) words.insert(words.end(), {"--name=" + name});
  const auto places = places_of(args);
  if (!places) return places.error();
  auto line = rtse_line(context, words);
  return Plan{std::move(line), [context, words = std::move(words), places = *places]() mutable -> Result<Json> {
                const auto file = ScratchFile::with("");
                if (!file) return file.error();
                words[1] = file->name();
                const auto said = rtse(context, words);
                const auto xml = file->text();
                if (!said && xml.empty()) return said.error();
                const auto saved = save_with(xml, places);
                if (!saved) return saved.error();
                // What the format cannot hold, or whose component is not there, is left out, and rtse says so.
                return Json{{"xml", *saved}, {"left_out", said ? "" : said.error().message}};
              }};
}

// {"PC.host_cxt/Laser0.rtc":[x,y], ...} of those that somebody has placed.
Json positions_in(const std::string& file) {
  Json positions = Json::object();
  const auto system = tools::read_system(file);
  if (!system) return positions;
  for (const auto& component : system->components) {
    if (component.place.is_placed()) positions[below_name_server(component.path_uri)] = {component.place.x, component.place.y};
  }
  return positions;
}

Result<Plan> with_profile(const ActContext& context, const Json& args, std::vector<std::string> words) {
  const auto xml = text_of(args, "xml");
  if (!xml) return xml.error();
  auto line = words;
  line.emplace_back("system.xml");
  return Plan{rtse_line(context, line),
              [context, words = std::move(words), xml = *xml]() mutable -> Result<Json> {
                const auto file = ScratchFile::with(xml);
                if (!file) return file.error();
                words.push_back(file->name());
                const auto said = rtse(context, words);
                if (!said) return said.error();
                return Json{{"positions", positions_in(file->name())}};
              },
              Touches::system};
}

Result<Plan> open_profile(const ActContext& context, const Json& args) {
  std::vector<std::string> words{"load"};
  if (flag_of(args, "states")) words.emplace_back("--states");
  if (flag_of(args, "force")) words.emplace_back("--force");
  return with_profile(context, args, words);
}

// A line for each difference of what runs to what was saved; none: it is the same.
Result<Plan> check_profile(const ActContext& context, const Json& args) {
  const auto xml = text_of(args, "xml");
  if (!xml) return xml.error();
  return Plan{rtse_line(context, {"check", "system.xml"}), [context, xml = *xml]() -> Result<Json> {
                const auto file = ScratchFile::with(xml);
                if (!file) return file.error();
                auto check = base::ChildProcess::start({rtse_words(context, {"check", file->name()}, false), {}, ""});
                if (!check) return check.error();
                if (!check->wait(program_limit)) return Error{"rtse check: has not ended after 30 s"};
                Json lines = Json::array();
                for (const auto& line : base::split_list(check->said(), '\n'))
                  lines.push_back(line.starts_with("rtse: ") ? line.substr(6) : line);
                if (check->exit_code() != 0 && lines.empty()) return Error{"rtse check: " + check->how_it_ended()};
                return Json{{"differences", check->exit_code() == 0 ? Json::array() : std::move(lines)}};
              }};
}

Result<Plan> teardown(const ActContext& context, const Json& args) { return with_profile(context, args, {"teardown"}); }
Result<Plan> start_system(const ActContext& context, const Json& args) { return with_profile(context, args, {"start"}); }
Result<Plan> stop_system(const ActContext& context, const Json& args) { return with_profile(context, args, {"stop"}); }

}  // namespace

std::vector<Act> manager_acts() {
  return {{"manager", true, manager},
          {"load_module", false, load_module},
          {"create", false, create},
          {"delete_component", false, delete_component},
          {"unload_module", false, unload_module},
          {"disconnect_all", false, disconnect_all},
          {"inject", false, inject},
          {"join_time", false, join_time},
          {"leave_time", false, leave_time},
          {"forget", false, forget},
          {"forget_dead", false, forget_dead},
          {"check_profile", true, check_profile},
          {"save_profile", true, save_profile},
          {"open_profile", false, open_profile},
          {"teardown", false, teardown},
          {"start_system", false, start_system},
          {"stop_system", false, stop_system}};
}

}  // namespace studio
