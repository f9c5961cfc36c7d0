#include "player_cfg.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <utility>

#include "base/text.h"
#include "device_kinds.h"

namespace gateway {
namespace {

constexpr std::uint16_t usual_port = 6665;
constexpr int deepest_include = 16;
constexpr std::size_t largest_file = 1 << 22;  // [bytes]

struct Token {
  enum class Kind { word, text, mark } kind = Kind::word;  // a mark is one of ( ) [ ]
  std::string value;
  std::string place;  // "file:line"
  bool is(char mark) const { return kind == Kind::mark && value[0] == mark; }
};

// Thrown by the readers below, caught in read_player_config.
struct CfgError {
  std::string place, what;
};

struct Driver {
  std::string place;
  std::map<std::string, std::vector<std::string>> keys;
  const std::vector<std::string>& list(const std::string& key) const {
    static const std::vector<std::string> none;
    const auto found = keys.find(key);
    return found == keys.end() ? none : found->second;
  }
  std::string text(const std::string& key) const { return list(key).empty() ? std::string() : list(key).front(); }
};

std::vector<Token> tokens_of(const std::string& text, const std::string& file) {
  std::vector<Token> tokens;
  int line = 1;
  const auto place = [&] { return file + ":" + std::to_string(line); };
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (c == '#') {
      i = std::min(text.find('\n', i), text.size());
    } else if (std::string_view("()[]").find(c) != std::string_view::npos) {
      tokens.push_back({Token::Kind::mark, std::string(1, c), place()});
      ++i;
    } else if (c == '"') {
      const auto end = text.find_first_of("\"\n", i + 1);
      if (end == std::string::npos || text[end] == '\n') throw CfgError{place(), "a text has no closing quote"};
      tokens.push_back({Token::Kind::text, text.substr(i + 1, end - i - 1), place()});
      i = end + 1;
    } else if (std::string_view(" \t\r\n").find(c) != std::string_view::npos) {
      line += c == '\n' ? 1 : 0;
      ++i;
    } else {
      const auto end = std::min(text.find_first_of(" \t\r\n()[]\"#", i), text.size());
      tokens.push_back({Token::Kind::word, text.substr(i, end - i), place()});
      i = end;
    }
  }
  return tokens;
}

class Reader {
 public:
  std::vector<Driver> read(const std::filesystem::path& path) {
    read_file(path, 0);
    return std::move(drivers_);
  }

 private:
  void read_file(const std::filesystem::path& path, int depth) {
    std::ifstream file(path);
    if (!file) throw CfgError{path.string(), "can't be read"};
    std::stringstream text;
    text << file.rdbuf();
    if (text.str().size() > largest_file) throw CfgError{path.string(), "is larger than 4 MiB"};
    auto tokens = tokens_of(text.str(), path.string());
    std::size_t at = 0;
    while (at < tokens.size()) read_statement(tokens, at, path, depth);
  }

  void read_statement(const std::vector<Token>& tokens, std::size_t& at, const std::filesystem::path& path, int depth) {
    const Token& first = tokens[at];
    if (first.kind != Token::Kind::word)
      throw CfgError{first.place, "expected a section as in driver ( ... ), got " + base::in_quotes(first.value)};
    if (first.value == "include") {
      if (at + 1 >= tokens.size() || tokens[at + 1].kind != Token::Kind::text)
        throw CfgError{first.place, "include: expected a file in quotes"};
      if (depth >= deepest_include) throw CfgError{first.place, "include: files include each other"};
      const std::string name = tokens[at + 1].value;
      at += 2;
      return read_file(path.parent_path() / name, depth + 1);
    }
    if (first.value == "define") return read_definition(tokens, at);
    if (at + 1 < tokens.size() && tokens[at + 1].is('(')) return read_section(tokens, at);
    ++at;  // a value for the whole file, as unit_angle "degrees"
    (void)read_value(tokens, at, first);
  }

  void read_definition(const std::vector<Token>& tokens, std::size_t& at) {
    const Token& first = tokens[at];
    if (at + 3 >= tokens.size() || !tokens[at + 3].is('(')) throw CfgError{first.place, "expected define NAME driver ( ... )"};
    const std::string name = tokens[at + 1].value, base = tokens[at + 2].value;
    at += 3;
    Driver macro = base == "driver" ? Driver{} : defined_[base];
    read_keys(tokens, at, macro);
    defined_[name] = std::move(macro);
  }

  void read_section(const std::vector<Token>& tokens, std::size_t& at) {
    const Token& first = tokens[at];
    const bool is_driver = first.value == "driver" || defined_.contains(first.value);
    Driver driver = first.value == "driver" || !is_driver ? Driver{} : defined_[first.value];
    driver.place = first.place;
    ++at;
    read_keys(tokens, at, driver);
    if (is_driver) drivers_.push_back(std::move(driver));
  }

  // From the opening bracket to behind the closing one.
  void read_keys(const std::vector<Token>& tokens, std::size_t& at, Driver& driver) {
    const Token& open = tokens[at++];
    while (at < tokens.size() && !tokens[at].is(')')) {
      const Token& key = tokens[at++];
      if (key.kind != Token::Kind::word) throw CfgError{key.place, "expected a key, got " + base::in_quotes(key.value)};
      driver.keys[key.value] = read_value(tokens, at, key);
    }
    if (at >= tokens.size()) throw CfgError{open.place, "a bracket ( is not closed"};
    ++at;
  }

  std::vector<std::string> read_value(const std::vector<Token>& tokens, std::size_t& at, const Token& key) {
    if (at >= tokens.size() || tokens[at].is(')') || tokens[at].is(']'))
      throw CfgError{key.place, "key " + base::in_quotes(key.value) + " has no value"};
    if (tokens[at].is('(')) {  // a section inside: nothing that is served has one
      Driver inner;
      read_keys(tokens, at, inner);
      return {};
    }
    if (!tokens[at].is('[')) return {tokens[at++].value};
    std::vector<std::string> list;
    for (++at; at < tokens.size() && !tokens[at].is(']'); ++at) {
      if (tokens[at].kind == Token::Kind::mark) throw CfgError{tokens[at].place, "a list [ is not closed"};
      list.push_back(tokens[at].value);
    }
    if (at >= tokens.size()) throw CfgError{key.place, "a list [ is not closed"};
    ++at;
    return list;
  }

  std::vector<Driver> drivers_;
  std::map<std::string, Driver> defined_;
};

// KEY:HOST:PORT:INTERFACE:INDEX, of which the last two are always there.
struct CfgAddress {
  std::uint16_t port = usual_port;
  std::string interface;
  std::uint16_t index = 0;
};
CfgAddress cfg_address_of(const std::string& text, const std::string& place) {
  std::vector<std::string> parts;
  std::stringstream in(text);
  for (std::string part; std::getline(in, part, ':');) parts.push_back(part);
  const auto number = [](const std::string& part) {
    const auto value = base::parse_integer(part);
    return value && *value >= 0 && *value <= 65535 ? std::optional(static_cast<std::uint16_t>(*value)) : std::nullopt;
  };
  const auto size = parts.size();
  const auto index = size >= 2 ? number(parts[size - 1]) : std::nullopt;
  const auto port = size >= 3 && !parts[size - 3].empty() ? number(parts[size - 3]) : std::optional(usual_port);
  if (!index || !port || size > 5) throw CfgError{place, "expected an address as in laser:0 or 6665:laser:0, got " + base::in_quotes(text)};
  return {*port, parts[size - 2], *index};
}

bool is_of_simulator(const Driver& driver) {
  const std::string name = driver.text("name");
  return name == "stage" || name == "gazebo" || name == "rtm-sim" || name.starts_with("gz_") || !driver.text("model").empty() ||
         !driver.text("gz_id").empty();
}

class Ports {
 public:
  explicit Ports(std::vector<std::string>& notes) : notes_(notes) {}

  void add(const Driver& driver) {
    const auto& provided = driver.list("provides");
    if (driver.text("name") == "mapfile") return add_maps(driver);
    if (!is_of_simulator(driver)) {
      notes_.push_back(driver.place + ": driver " + base::in_quotes(driver.text("name")) + " is not started here; " +
                       (provided.empty() ? "it is left out" : "not served: " + base::join(provided, " ")));
      return;
    }
    for (const std::string& text : provided) add_device(driver, text);
  }
  std::vector<ConfiguredPort> take() { return std::move(ports_); }

 private:
  // In place of the picture that the driver would read.
  void add_maps(const Driver& driver) {
    for (const std::string& text : driver.list("provides")) {
      const CfgAddress address = cfg_address_of(text, driver.place);
      if (address.interface != player::to_text(player::Interface::map)) continue;
      ConfiguredDevice device;
      device.address = {player::Interface::map, address.index};
      device.iface = "world";
      add_to_port(address.port, std::move(device), driver.place);
      notes_.push_back(driver.place + ": " + text + " is the map of the simulated world, not " + base::in_quotes(driver.text("filename")));
    }
  }

  void add_device(const Driver& driver, const std::string& text) {
    const CfgAddress address = cfg_address_of(text, driver.place);
    const auto interface = player::parse_interface(address.interface);
    if (!interface || find_kind(*interface) == nullptr) {
      const bool is_known = player::is_interface_name(address.interface);
      if (!is_known) throw CfgError{driver.place, base::in_quotes(address.interface) + " is no interface of Player"};
      notes_.push_back(driver.place + ": interface " + address.interface + " is not served");
      return;
    }
    ConfiguredDevice device;
    device.address = {*interface, address.index};
    const std::string id = driver.text("gz_id");
    device.iface = id;
    device.model = id.empty() ? driver.text("model") : id.substr(0, id.find("::"));
    if (*interface != player::Interface::simulation) {
      if (device.model.empty()) throw CfgError{driver.place, text + ": the driver has no model (or gz_id)"};
      device.which = used_[{device.model, *interface}]++;
    }
    add_to_port(address.port, std::move(device), driver.place);
  }

  void add_to_port(std::uint16_t number, ConfiguredDevice device, const std::string& place) {
    ConfiguredPort& port = port_of(number);
    const bool is_twice =
        std::any_of(port.devices.begin(), port.devices.end(), [&](const auto& one) { return one.address == device.address; });
    if (is_twice) throw CfgError{place, player::to_text(device.address) + " of port " + std::to_string(port.port) + " appears twice"};
    port.devices.push_back(std::move(device));
  }

  ConfiguredPort& port_of(std::uint16_t number) {
    const auto known = std::find_if(ports_.begin(), ports_.end(), [&](const ConfiguredPort& port) { return port.port == number; });
    if (known != ports_.end()) return *known;
    ports_.push_back({number, {}, {}});
    return ports_.back();
  }

  std::vector<std::string>& notes_;
  std::vector<ConfiguredPort> ports_;
  std::map<std::pair<std::string, player::Interface>, std::size_t> used_;
};

}  // namespace

bool is_of_player(const std::string& path) {
  constexpr int max_lines = 1000;
  std::ifstream file(path);
  std::string line;
  bool is_after_driver = false;
  for (int i = 0; i < max_lines && std::getline(file, line); ++i) {
    std::string_view text = base::trim(line);
    if (text.empty() || text.starts_with('#')) continue;
    if (text.starts_with("include ") || text.starts_with("define ")) return true;
    if (is_after_driver && text.starts_with('(')) return true;
    is_after_driver = text == "driver";
    if (text.starts_with("driver") && base::trim(text.substr(6)).starts_with('(')) return true;
  }
  return false;
}

base::Result<std::vector<ConfiguredPort>> read_player_config(const std::string& path, std::vector<std::string>& notes) {
  try {
    Ports ports(notes);
    for (const Driver& driver : Reader().read(path)) ports.add(driver);
    auto found = ports.take();
    if (found.empty())
      return base::Error{path + ": no driver provides a device of a simulator (name \"stage\" or \"gazebo\", model or gz_id)"};
    return found;
  } catch (const CfgError& wrong) {
    return base::Error{wrong.place + ": " + wrong.what};
  }
}

}  // namespace gateway
