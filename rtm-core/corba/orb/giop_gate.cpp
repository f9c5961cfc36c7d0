#include "corba/orb/giop_gate.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace corba {
namespace {

constexpr std::size_t header_size = 12;
constexpr std::size_t least_room = 1024;      // of a buffer that is read into at once
constexpr std::size_t head_of_sample = 1024;  // [octets] in which the operation must stand
constexpr std::size_t small = 16 * 1024;      // messages up to this are collected whoever sends them
constexpr std::size_t step = 64 * 1024;       // memory grows by this, or by what has come already

enum MessageType : std::uint8_t { request = 0, cancel_request = 2, fragment = 7 };

}  // namespace

struct GiopGate::Header {
  std::uint8_t minor = 0;
  bool is_little = false;
  bool has_more = false;
  std::uint8_t type = 0;
  std::size_t size = 0;  // of the body
};

std::uint32_t GiopGate::number_at(std::span<const std::byte> octets, std::size_t at, bool is_little) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto octet = std::to_integer<std::uint32_t>(octets[at + (is_little ? 3 - i : i)]);
    number = number << 8 | octet;
  }
  return number;
}

bool GiopGate::parse(std::span<const std::byte> octets, Header& header) {
  if (std::memcmp(octets.data(), "GIOP\x01", 5) != 0) return false;
  const auto octet = [&](std::size_t i) { return std::to_integer<std::uint8_t>(octets[i]); };
  header.minor = octet(5);
  header.is_little = (octet(6) & 1) != 0;
  header.has_more = header.minor > 0 && (octet(6) & 2) != 0;
  header.type = octet(7);
  header.size = number_at(octets, 8, header.is_little);
  return header.minor <= 2 && header.type <= fragment;
}

// The operation of a request is put or push, and for which object; false when that cannot be said.
bool GiopGate::is_sample(std::span<const std::byte> message, const Header& header, std::span<const std::byte>& object_key) {
  if (header.type != request) return false;
  std::size_t at = header_size;
  const auto number = [&](std::uint32_t& value) {
    at = (at + 3) / 4 * 4;
    if (at + 4 > message.size()) return false;
    value = number_at(message, at, header.is_little);
    at += 4;
    return true;
  };
  const auto skip = [&](std::size_t octets) {
    if (octets > message.size() - at) return false;
    at += octets;
    return true;
  };
  std::uint32_t length = 0;
  const auto take_key = [&] {
    if (!number(length) || !skip(length)) return false;
    object_key = message.subspan(at - length, length);
    return true;
  };
  if (header.minor == 2) {
    std::uint32_t addressing = 0;
    at += 8;  // request id, flags
    if (!number(addressing) || !take_key()) return false;
    const bool is_by_key = (header.is_little ? addressing & 0xffff : addressing >> 16) == 0;
    if (!is_by_key) return false;
  } else {
    std::uint32_t contexts = 0, id = 0;
    if (!number(contexts) || contexts > 16) return false;
    for (; contexts > 0; --contexts) {
      if (!number(id) || !number(length) || !skip(length)) return false;
    }
    if (!number(id) || !skip(1) || !take_key()) return false;
  }
  if (!number(length) || length > message.size() - at) return false;
  const std::string_view operation(reinterpret_cast<const char*>(message.data()) + at, length);
  return operation == std::string_view("put", 4) || operation == std::string_view("push", 5);
}

// Of the message in held_, of which enough has come to know its operation.
GiopGate::Room GiopGate::room_for(const Header& header) const {
  std::span<const std::byte> key;
  if (!is_sample(held_, header, key)) return {limits_.request, false};
  const std::size_t wanted = limits_.room == nullptr ? limits_.sample : limits_.room(key);
  return {std::max(limits_.request, std::min(wanted, limits_.sample)), wanted > 0};
}

int GiopGate::receive(std::byte* to, std::size_t size, const Read& read) {
  if (delivered_ < whole_) return deliver(to, size);
  if (direct_left_ > 0) {
    const int got = read_on(read, to, std::min(size, direct_left_));
    if (got > 0) direct_left_ -= static_cast<std::size_t>(got);
    return got;
  }
  if (is_broken_ || !problem_.empty()) return -1;
  settle();
  if (limits_.reads_ahead && held_.empty() && ahead_.empty() && size >= least_room) {
    const int got = read(to, size);
    if (got <= 0) return got;
    const std::span<const std::byte> come(to, static_cast<std::size_t>(got));
    const std::size_t whole = whole_messages(come);
    if (whole == come.size()) return got;
    ahead_.assign(come.begin() + static_cast<std::ptrdiff_t>(whole), come.end());
    if (whole > 0) return static_cast<int>(whole);
  }
  while (delivered_ == whole_) {
    if (const int result = collect(read); result <= 0) return result;
  }
  return deliver(to, size);
}

// The length of the messages at the beginning that need nothing done.
std::size_t GiopGate::whole_messages(std::span<const std::byte> octets) {
  std::size_t end = 0;
  Header header;
  while (octets.size() - end >= header_size && parse(octets.subspan(end), header) && !header.has_more && header.type != fragment &&
         header.size <= octets.size() - end - header_size) {
    end += header_size + header.size;
    ++messages_;
  }
  return end;
}

// What was read ahead comes first.
int GiopGate::read_on(const Read& read, std::byte* to, std::size_t size) {
  if (ahead_.empty()) return read(to, size);
  const std::size_t count = std::min(size, ahead_.size());
  std::memcpy(to, ahead_.data(), count);
  ahead_.erase(ahead_.begin(), ahead_.begin() + static_cast<std::ptrdiff_t>(count));
  return static_cast<int>(count);
}

// One message: 1 when it was dealt with.
int GiopGate::collect(const Read& read) {
  if (const int result = fill(read, header_size); result <= 0) return result;
  Header header;
  if (!parse(held_, header)) {
    is_broken_ = true;
    ahead_.clear();
    whole_ = held_.size();
    return 1;
  }
  if (header.type == fragment) return refuse("a fragment of no message");
  const bool may_be_long = header.size > small;
  if (may_be_long) {
    if (const int result = fill(read, header_size + std::min(header.size, head_of_sample)); result <= 0) return result;
  }
  const Room room = may_be_long ? room_for(header) : Room{header.has_more ? small : limits_.request, false};
  if (header.size > room.limit) {
    return refuse("a message of " + std::to_string(header.size) + " bytes, expected at most " + std::to_string(room.limit) +
                  (room.is_port ? " for this port" : " (corba.max_request_size)"));
  }
  ++messages_;
  if (room.is_port && !header.has_more && header.size <= limits_.direct && claim(header.size)) {
    whole_ = held_.size();
    direct_left_ = header_size + header.size - held_.size();
    return 1;
  }
  if (const int result = fill(read, header_size + header.size); result <= 0) return result;
  if (!header.has_more) {
    whole_ = header_size + header.size;
    return 1;
  }
  return collect_fragments(read, header, room_for(header).limit);
}

// The rest of a message that comes in pieces; nothing but its pieces may come before it is whole.
int GiopGate::collect_fragments(const Read& read, const Header& first, std::size_t limit) {
  const std::size_t id_size = first.minor == 2 ? 4 : 0;
  if (first.size < 4) return refuse("a fragmented message without an id");
  const std::uint32_t id = number_at(held_, header_size, first.is_little);
  for (bool has_more = true; has_more;) {
    if (first.minor == 2 && held_.size() % 8 != 0) return refuse("a fragment whose length is no multiple of 8");
    const std::size_t start = held_.size();
    if (const int result = fill(read, start + header_size); result <= 0) return result;
    Header next;
    if (!parse(std::span<const std::byte>(held_).subspan(start), next)) return refuse("something else than the rest of a message");
    const bool is_cancel = next.type == cancel_request && next.size == 4;
    const bool is_next = next.type == fragment && next.minor == first.minor && next.is_little == first.is_little && next.size >= id_size;
    if (!is_cancel && !is_next) return refuse("something else than the rest of a message");
    if (start - header_size + next.size > limit) {
      return refuse("a message in fragments of more than " + std::to_string(limit) + " bytes");
    }
    if (const int result = fill(read, start + header_size + next.size); result <= 0) return result;
    if ((is_cancel || id_size > 0) && number_at(held_, start + header_size, next.is_little) != id) {
      if (!is_cancel) return refuse("fragments of several messages at the same time");
      held_.resize(start);
      continue;
    }
    if (is_cancel) {
      held_.clear();
      return 1;
    }
    const auto piece = held_.begin() + static_cast<std::ptrdiff_t>(start);
    held_.erase(piece, piece + static_cast<std::ptrdiff_t>(header_size + id_size));
    has_more = next.has_more;
  }
  held_[6] &= ~std::byte{2};
  const auto size = static_cast<std::uint32_t>(held_.size() - header_size);
  for (std::size_t i = 0; i < 4; ++i) held_[8 + i] = static_cast<std::byte>(size >> 8 * (first.is_little ? i : 3 - i));
  whole_ = held_.size();
  return 1;
}

// Reads until held_ has `size` octets: 1, or what ended it.
int GiopGate::fill(const Read& read, std::size_t size) {
  while (held_.size() < size) {
    const std::size_t have = held_.size();
    const std::size_t wanted = std::min(size - have, std::max(step, have));
    const std::size_t needed = have + wanted;  // reads bring as little as they like: what was claimed for one counts for the next
    if (needed > small && needed > claimed_ && !claim(needed - claimed_))
      return refuse("too much is in progress on all connections together");
    held_.resize(needed);
    room_ = wanted;
    const int got = read_on(read, held_.data() + have, wanted);
    room_ = 0;
    held_.resize(have + static_cast<std::size_t>(std::max(got, 0)));
    if (got <= 0) return got;
  }
  return 1;
}

int GiopGate::deliver(std::byte* to, std::size_t size) {
  const std::size_t count = std::min(size, whole_ - delivered_);
  std::memcpy(to, held_.data() + delivered_, count);
  delivered_ += count;
  if (delivered_ == whole_) {
    held_.clear();
    if (held_.capacity() > step) held_.shrink_to_fit();
    delivered_ = whole_ = 0;
  }
  return static_cast<int>(count);
}

int GiopGate::refuse(std::string problem) {
  problem_ = std::move(problem);
  held_.clear();
  ahead_.clear();
  return -1;
}

bool GiopGate::claim(std::size_t size) {
  if (in_progress_.fetch_add(size, std::memory_order_relaxed) + size > limits_.total) {  // a count, it orders nothing
    in_progress_.fetch_sub(size, std::memory_order_relaxed);
    return false;
  }
  claimed_ += size;
  return true;
}

void GiopGate::settle() { in_progress_.fetch_sub(std::exchange(claimed_, 0), std::memory_order_relaxed); }

}  // namespace corba
