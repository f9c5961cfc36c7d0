#include "recording/hash_channel.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "base/hash_log.h"

namespace recorder {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* schema_text =
    R"({"title":"rtmsim.Hashes","type":"object","properties":{"tick":{"type":"integer"},"resets":{"type":"integer"},)"
    R"("so_far":{"type":"string"},"leaves":{"type":"object","additionalProperties":{"type":"string"}}}})";

std::string text_of(std::uint64_t hash) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

}  // namespace

base::Result<void> put_hashes(channels::Exchange& exchange, const std::string& file) {
  auto log = base::HashLogReader::open(file);
  if (!log) return log.error();
  const auto channel = exchange.open({"/hashes", "json", {"rtmsim.Hashes", "jsonschema", schema_text}, {{"late", "yes"}}});
  if (!channel) return channel.error();
  base::HashTick tick;
  for (;;) {
    const auto number = log->ticks();
    const auto more = log->next(tick);
    if (!more) return more.error();
    if (!*more) break;
    Json leaves = Json::object();
    for (const auto& entry : tick.entries) leaves[log->keys()[entry.key].text()] = text_of(entry.hash);
    const std::string text = Json{{"tick", number}, {"resets", tick.run}, {"so_far", text_of(log->hash())}, {"leaves", leaves}}.dump(
        -1, ' ', false, Json::error_handler_t::replace);
    exchange.put(*channel, tick.time, {text.data(), text.size()});
  }
  exchange.close(*channel);
  return {};
}

}  // namespace recorder
