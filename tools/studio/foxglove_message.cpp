#include "studio/foxglove_message.h"

#include "studio/client_message.h"

namespace studio {
namespace {

using base::Error;
using base::Result;

constexpr char published_octet = 1, call_octet = 2;

Result<FoxgloveText> subscribe_of(const Json& json) {
  Subscribe message;
  const auto list = json.find("subscriptions");
  if (list == json.end() || !list->is_array() || list->size() > max_subscriptions)
    return Error{"subscribe: expected a list of at most 1024 subscriptions"};
  for (const Json& entry : *list) {
    const auto id = whole_number_of(entry, "id"), channel = whole_number_of(entry, "channelId");
    if (!id) return id.error();
    if (!channel) return channel.error();
    message.subscriptions.emplace_back(*id, *channel);
  }
  return FoxgloveText(std::move(message));
}

template <class Message>
Result<FoxgloveText> ids_of(const Json& json, const std::string& key) {
  auto ids = whole_numbers_of(json, key);
  if (!ids) return ids.error();
  return FoxgloveText(Message{std::move(*ids)});
}

Result<FoxgloveText> advertise_of(const Json& json) {
  Advertise message;
  const auto list = json.find("channels");
  if (list == json.end() || !list->is_array() || list->size() > max_subscriptions)
    return Error{"advertise: expected a list of at most 1024 channels"};
  for (const Json& entry : *list) {
    const auto id = whole_number_of(entry, "id");
    auto topic = text_of(entry, "topic"), encoding = text_of(entry, "encoding");
    if (!id) return id.error();
    if (!topic) return topic.error();
    if (!encoding) return encoding.error();
    message.channels.push_back({*id, std::move(*topic), std::move(*encoding), text_or(entry, "schemaName", "")});
  }
  return FoxgloveText(std::move(message));
}

std::optional<std::string> answer_id(const Json& json) {
  auto id = text_of(json, "id");
  return id ? std::optional(std::move(*id)) : std::nullopt;
}

Result<FoxgloveText> get_of(const Json& json) {
  auto names = texts_of(json, "parameterNames", 0, max_subscriptions);
  if (!names) return names.error();
  return FoxgloveText(GetParameters{std::move(*names), answer_id(json)});
}

Result<FoxgloveText> wish_of(const Json& json, bool is_wanted) {
  auto names = texts_of(json, "parameterNames", 0, max_subscriptions);
  if (!names) return names.error();
  return FoxgloveText(ParameterWish{std::move(*names), is_wanted});
}

Result<FoxgloveText> set_of(const Json& json) {
  SetParameters message;
  message.id = answer_id(json);
  const auto list = json.find("parameters");
  if (list == json.end() || !list->is_array() || list->size() > max_subscriptions)
    return Error{"setParameters: expected a list of at most 1024 parameters"};
  for (const Json& entry : *list) {
    auto name = text_of(entry, "name");
    if (!name) return name.error();
    const auto value = entry.find("value");
    message.values.emplace_back(std::move(*name), value == entry.end() ? Json() : *value);
  }
  return FoxgloveText(std::move(message));
}

std::uint32_t u32_at(std::string_view octets, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= static_cast<std::uint32_t>(static_cast<unsigned char>(octets[at + i])) << (8 * i);
  return value;
}

}  // namespace

Result<std::optional<FoxgloveText>> parse_foxglove(const std::string& op, const Json& message) {
  const auto wrapped = [](Result<FoxgloveText> parsed) -> Result<std::optional<FoxgloveText>> {
    if (!parsed) return parsed.error();
    return std::optional(std::move(*parsed));
  };
  if (op == "subscribe") return wrapped(subscribe_of(message));
  if (op == "unsubscribe") return wrapped(ids_of<Unsubscribe>(message, "subscriptionIds"));
  if (op == "subscribeConnectionGraph") return wrapped(FoxgloveText(GraphWish{true}));
  if (op == "unsubscribeConnectionGraph") return wrapped(FoxgloveText(GraphWish{false}));
  if (op == "advertise") return wrapped(advertise_of(message));
  if (op == "unadvertise") return wrapped(ids_of<Unadvertise>(message, "channelIds"));
  if (op == "getParameters") return wrapped(get_of(message));
  if (op == "setParameters") return wrapped(set_of(message));
  if (op == "subscribeParameterUpdates") return wrapped(wish_of(message, true));
  if (op == "unsubscribeParameterUpdates") return wrapped(wish_of(message, false));
  return std::optional<FoxgloveText>();
}

Result<FoxgloveFrame> parse_frame(std::string_view octets) {
  constexpr std::size_t data_head = 5, call_head = 13;
  if (octets.size() >= data_head && octets[0] == published_octet)
    return FoxgloveFrame(PublishedData{u32_at(octets, 1), octets.substr(data_head)});
  if (octets.size() < call_head || octets[0] != call_octet)
    return Error{"binary frame: expected message data (1) or a service call (2) of foxglove.websocket.v1"};
  const std::size_t length = u32_at(octets, 9);
  if (length > octets.size() - call_head) return Error{"service call: its encoding is longer than the frame"};
  return FoxgloveFrame(
      ServiceCall{u32_at(octets, 1), u32_at(octets, 5), octets.substr(call_head, length), octets.substr(call_head + length)});
}

}  // namespace studio
