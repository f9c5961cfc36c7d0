// The C header in terms of the C++ API. No exception leaves.
#include <algorithm>
#include <cstring>
#include <exception>
#include <string>

#include "shm/client.h"
#include "shm/request_board.h"
#include "shm/rtmsim_iface.h"

struct rtmsim_iface {
  shm::Iface iface;
};
struct rtmsim_held {
  shm::HeldFrame frame;
};
struct rtmsim_requester {
  shm::Requester requester;
  std::string text;
};

namespace {

std::string& last_error() {
  thread_local std::string text;
  return text;
}

template <class T>
int outcome(const base::Result<T>& result) {
  if (result) return 0;
  last_error() = result.error().message;
  return -1;
}

// Runs a function of ours; memory may run out anywhere.
template <class Function, class Value>
Value guarded(Value on_failure, Function function) {
  try {
    return function();
  } catch (const std::exception& problem) {
    last_error() = problem.what();
    return on_failure;
  }
}

}  // namespace

extern "C" {

const char* rtmsim_last_error(void) { return last_error().c_str(); }

int rtmsim_list(int64_t server, int (*each)(void*, uint32_t, const char*, const char*), void* context) {
  return guarded(-1, [&] {
    int calls = 0;
    for (const auto& found : shm::find_segments()) {
      if (!found.is_alive || (server >= 0 && found.name.server_id != server)) continue;
      ++calls;
      if (each(context, found.name.server_id, std::string(shm::to_text(found.name.type)).c_str(), found.name.iface.c_str()) != 0) break;
    }
    return calls;
  });
}

const char* rtmsim_type_name(uint32_t type) {
  return shm::is_type(type) ? shm::row_of(static_cast<shm::IfaceType>(type)).name.data() : nullptr;
}

uint32_t rtmsim_type(const char* name) {
  const auto type = name != nullptr ? shm::parse_type(name) : std::nullopt;
  return type ? static_cast<uint32_t>(*type) : 0;
}

rtmsim_iface* rtmsim_open(uint32_t server, uint32_t type, const char* name) {
  return guarded(static_cast<rtmsim_iface*>(nullptr), [&]() -> rtmsim_iface* {
    if (!shm::is_type(type) || name == nullptr) {
      last_error() = "iface type must be one of rtmsim_layout.h and the name not null, got type " + std::to_string(type);
      return nullptr;
    }
    auto opened = shm::Iface::open(server, static_cast<shm::IfaceType>(type), name);
    if (outcome(opened) != 0) return nullptr;
    return std::make_unique<rtmsim_iface>(rtmsim_iface{std::move(*opened)}).release();
  });
}

void rtmsim_close(rtmsim_iface* iface) { std::unique_ptr<rtmsim_iface> owner(iface); }

const void* rtmsim_info(const rtmsim_iface* iface, size_t* size) {
  const auto bytes = iface->iface.segment().info();
  if (size != nullptr) *size = bytes.size();
  return bytes.data();
}

int rtmsim_subscribe(rtmsim_iface* iface) {
  return guarded(-1, [&] { return outcome(iface->iface.subscribe()); });
}

void rtmsim_unsubscribe(rtmsim_iface* iface) { iface->iface.unsubscribe(); }

const void* rtmsim_read(rtmsim_iface* iface, size_t* size) {
  if (!iface->iface.read()) return nullptr;
  const auto bytes = iface->iface.sample_data();
  if (size != nullptr) *size = bytes.size();
  return bytes.data();
}

int rtmsim_wait(rtmsim_iface* iface, uint64_t than, int64_t timeout) {
  switch (iface->iface.wait(than, std::chrono::nanoseconds(timeout))) {
    case shm::Wait::fresh:
      return RTMSIM_WAIT_FRESH;
    case shm::Wait::timed_out:
      return RTMSIM_WAIT_TIMED_OUT;
    case shm::Wait::closed:
      break;
  }
  return RTMSIM_WAIT_CLOSED;
}

uint64_t rtmsim_sequence(const rtmsim_iface* iface) { return iface->iface.sequence(); }

rtmsim_held* rtmsim_hold(rtmsim_iface* iface, const rtmsim_frame** head, const void** data) {
  return guarded(static_cast<rtmsim_held*>(nullptr), [&]() -> rtmsim_held* {
    auto frame = iface->iface.hold();
    if (!frame) return nullptr;
    auto held = std::make_unique<rtmsim_held>(rtmsim_held{std::move(*frame)});
    if (head != nullptr) *head = &held->frame.head();
    if (data != nullptr) *data = held->frame.data().data();
    return held.release();
  });
}

void rtmsim_release(rtmsim_held* held) { std::unique_ptr<rtmsim_held> owner(held); }

int rtmsim_command_iface(rtmsim_iface* iface, uint32_t kind, const double* values, size_t count) {
  return guarded(-1, [&] { return outcome(iface->iface.command(static_cast<shm::CommandKind>(kind), {values, count})); });
}

int rtmsim_is_live(const rtmsim_iface* iface) { return iface->iface.status() == shm::Status::live ? 1 : 0; }

int rtmsim_reopen(rtmsim_iface* iface) {
  return guarded(-1, [&] { return outcome(iface->iface.reopen()); });
}

rtmsim_requester* rtmsim_open_requester(uint32_t server) {
  return guarded(static_cast<rtmsim_requester*>(nullptr), [&]() -> rtmsim_requester* {
    auto opened = shm::Requester::open(server);
    if (outcome(opened) != 0) return nullptr;
    return std::make_unique<rtmsim_requester>(rtmsim_requester{std::move(*opened), {}}).release();
  });
}

void rtmsim_close_requester(rtmsim_requester* requester) { std::unique_ptr<rtmsim_requester> owner(requester); }

int rtmsim_request(rtmsim_requester* requester, uint32_t kind, const rtmsim_request_body* body, const char* text, size_t text_length,
                   rtmsim_reply_body* reply, const char** reply_text, int64_t timeout) {
  return guarded(-1, [&] {
    shm::RawRequest raw;
    raw.kind = kind;
    if (body != nullptr) raw.body = *body;
    if (text != nullptr) raw.text.assign(text, text_length);
    auto answer = requester->requester.ask_raw(raw, std::chrono::nanoseconds(timeout));
    if (outcome(answer) != 0) return -1;
    requester->text = std::move(answer->text);
    if (reply_text != nullptr) *reply_text = requester->text.c_str();
    if (reply != nullptr) {
      *reply = {};
      reply->sim_time_ns = answer->sim_time_ns;
      reply->steps = answer->steps;
      reply->hash = answer->hash;
      reply->count = answer->count;
      std::copy(std::begin(answer->values), std::end(answer->values), reply->values);
      shm::set_text(reply->message, answer->message);
    }
    return static_cast<int>(answer->status);
  });
}

}  // extern "C"
