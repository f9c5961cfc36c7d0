// Throws mutated text at everything a manager parses: rtc.conf, creation arguments, connections, names, command lines. Deterministic: the
// seed is printed. Run by hand for longer: manager_fuzz RUNS [SEED].
// Built with clang, -fsanitize=fuzzer and RTMSIM_LIBFUZZER it is a target of libFuzzer.
#include <cstdlib>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include "base/text.h"
#include "corba/orb/naming.h"
#include "core/component_argument.h"
#include "core/config_file.h"
#include "core/config_keys.h"
#include "core/manager_arguments.h"
#include "core/name_format.h"
#include "core/preconnect.h"
#include "support/usage.h"

namespace {

const std::vector<std::string> seeds = {
    "corba.nameservers: localhost:2809\nnaming.formats: %h.host_cxt/%n.rtc\nmanager.components.precreate: \\\n  A, B?x=1\n",
    "RTC:vendor:category:Type:C++:1.0?instance_name=a&conf.default.p=1",
    "A0.out?port=B0.in&port1=rtcname://h:1/c.cxt/C0.in&dataflow_type=push",
    "my\\.host.host_cxt/a\\/b.rtc",
    "-f a.conf -o key:value -adp 2810 -ORBendPoint giop:tcp::1 --x Module.so",
    "${HOME}/$(PATH)/%n%h%%%p",
    "exec_cxt.periodic.rate: 1e308\nlogger.log_level: DEBUG\n!x\n#y\na=b\\\\\n",
};

[[maybe_unused]] std::string mutate(std::string text, std::mt19937_64& random) {
  const auto pick = [&](std::size_t n) { return n == 0 ? 0 : random() % n; };
  static const std::string special = "\\:=.,/?&%${}()# \t\n\r\0\xff\x80";
  for (auto changes = 1 + pick(8); changes > 0; --changes) {
    const auto at = pick(text.size() + 1);
    switch (pick(5)) {
      case 0:
        text.insert(at, 1, static_cast<char>(random()));
        break;
      case 1:
        text.insert(at, 1, special[pick(special.size())]);
        break;
      case 2:
        text.erase(at, pick(8));
        break;
      case 3: {
        const auto& other = seeds[pick(seeds.size())];
        text.insert(at, other.substr(pick(other.size()), pick(40)));
        break;
      }
      default:
        text.insert(at, text.substr(pick(text.size() + 1), pick(200)));
    }
  }
  return text;
}

void demand(bool holds, const char* what, const std::string& input) {
  if (holds) return;
  std::cerr << what << ": " << base::in_quotes(input) << '\n';
  std::abort();
}

void parse_everything(const std::string& text) {
  const auto config = rt::parse_config(text);
  for (const auto& entry : config.entries) {
    demand(!entry.key.empty() && entry.line > 0, "an entry without key or line", text);
    (void)rt::complain_about(entry.key, entry.value);
  }
  if (const auto argument = rt::parse_component_argument(text)) {
    demand(!argument->id.implementation_id.empty(), "a component without type", text);
    demand(rt::is_match(argument->id, argument->id), "an id that does not match itself", text);
  }
  if (const auto connection = rt::parse_connection(text)) {
    demand(!connection->port.port.empty() && !connection->others.empty(), "a connection without ports", text);
  }
  if (const auto name = corba::parse_name(text)) {
    const auto again = corba::parse_name(corba::to_text(*name));
    demand(again.ok() && corba::to_text(*again) == corba::to_text(*name), "a name that changes in a round trip", text);
  }
  (void)rt::parse_manager_arguments(base::split_list(text, ' '));
  (void)rt::expand_format(text, [](char c) { return c == 'n' ? std::optional<std::string>("N") : std::nullopt; });
  (void)rt::check_instance_name(text);
}

}  // namespace

#ifdef RTMSIM_LIBFUZZER
extern "C" int LLVMFuzzerTestOneInput(const char* data, std::size_t size) {
  parse_everything(std::string(data, size));
  return 0;
}
#else
int main(int argc, char** argv) {
  ::test::answer_help(
      argc, argv, "manager_fuzz [RUNS [SEED]]\nReads damaged rtc.conf, command lines and component addresses; it must not crash or hang.");
  const long runs = argc > 1 ? std::atol(argv[1]) : 20'000;
  const unsigned long seed = argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 1;
  std::cout << "seed " << seed << ", " << runs << " runs\n";
  std::mt19937_64 random(seed);
  for (const auto& text : seeds) parse_everything(text);
  for (long i = 0; i < runs; ++i) parse_everything(mutate(seeds[random() % seeds.size()], random));
  return 0;
}
#endif
