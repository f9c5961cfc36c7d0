// GiopGate: messages reach the ORB whole, whatever comes.
#include "corba/orb/giop_gate.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

namespace {

using Octets = std::vector<std::byte>;

Octets bytes(std::string_view text) {
  const auto* begin = reinterpret_cast<const std::byte*>(text.data());
  return {begin, begin + text.size()};
}

void append_number(Octets& octets, std::uint32_t number) {
  for (int i = 0; i < 4; ++i) octets.push_back(static_cast<std::byte>(number >> 8 * i));  // little-endian
}

Octets operator+(Octets a, const Octets& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

constexpr int request = 0, cancel_request = 2, locate_request = 3, fragment = 7;

Octets message(int type, const Octets& body, bool has_more = false, int minor = 2) {
  Octets octets = bytes("GIOP");
  for (const int octet : {1, minor, has_more ? 3 : 1, type}) octets.push_back(static_cast<std::byte>(octet));
  append_number(octets, static_cast<std::uint32_t>(body.size()));
  return octets + body;
}

// The head of a request of GIOP 1.2 for that operation, a multiple of 8 long with the header of the message.
Octets request_head(std::uint32_t id, const std::string& operation, const std::string& key = "KEY!") {
  Octets body;
  append_number(body, id);
  append_number(body, 3);
  append_number(body, 0);  // by key
  append_number(body, static_cast<std::uint32_t>(key.size()));
  body = body + bytes(key);
  body.resize((body.size() + 3) / 4 * 4);
  append_number(body, static_cast<std::uint32_t>(operation.size() + 1));
  body = body + bytes(operation);
  body.push_back(std::byte{0});
  while ((body.size() + 12) % 8 != 0) body.push_back(std::byte{0});
  return body;
}

Octets numbered(std::uint32_t id, std::size_t size) {
  Octets body;
  append_number(body, id);
  body.resize(size, std::byte{'x'});
  return body;
}

// A peer that has sent these octets, of which each read gets so many, and has gone.
struct Peer {
  Octets sent;
  std::size_t most = 1 << 20;
  std::size_t at = 0;
  std::size_t asked_beyond = 0;  // reads when there was nothing left
  corba::GiopGate::Read reader() {
    return [this](std::byte* to, std::size_t size) {
      const std::size_t count = std::min({size, most, sent.size() - at});
      if (count == 0) ++asked_beyond;
      std::memcpy(to, sent.data() + at, count);
      at += count;
      return static_cast<int>(count);
    };
  }
};

struct Gate {
  explicit Gate(corba::GiopLimits limits = {}) : gate(limits, in_progress) {}
  std::atomic<std::size_t> in_progress{0};
  corba::GiopGate gate;

  // All that comes out until the peer has gone or is refused.
  Octets drain(Peer& peer, std::size_t room = 8192) {
    Octets all, buffer(room);
    for (;;) {
      const int got = gate.receive(buffer.data(), buffer.size(), peer.reader());
      if (got <= 0) return all;
      all.insert(all.end(), buffer.begin(), buffer.begin() + got);
    }
  }
};

const Octets small_ones =
    message(request, request_head(1, "ping")) + message(locate_request, numbered(2, 40)) + message(request, request_head(3, "x"));

TEST(GiopGate, messages_in_one_piece_pass_as_they_are_however_they_come) {
  for (const std::size_t most : {1u, 3u, 12u, 13u, 100u, 100000u}) {
    for (const std::size_t room : {16u, 64u, 1024u, 8192u}) {
      Gate f;
      Peer peer{small_ones, most};
      EXPECT_EQ(f.drain(peer, room), small_ones) << most << " " << room;
      EXPECT_EQ(f.gate.messages(), 3u);
      EXPECT_FALSE(f.gate.is_in_message());
      EXPECT_EQ(f.in_progress, 0u);
    }
  }
}

TEST(GiopGate, no_octet_is_read_that_the_orb_does_not_hear_of) {
  Gate f;
  Peer peer{small_ones, 1 << 20};
  Octets buffer(8192);
  EXPECT_EQ(f.gate.receive(buffer.data(), buffer.size(), peer.reader()), static_cast<int>(small_ones.size()));
  EXPECT_EQ(peer.asked_beyond, 0u);
  EXPECT_FALSE(f.gate.has_more());
}

// For who looks at the connection itself, and has to know whether it may wait long.
TEST(GiopGate, that_does_not_read_ahead_takes_one_message_and_is_in_it_from_its_first_octet_to_its_last) {
  const Octets longer = message(request, request_head(1, "ping") + Octets(20'000, std::byte{'x'}));
  const Octets pieces = message(request, request_head(2, "ping"), true) + message(fragment, numbered(2, 100), false);
  for (const Octets& one : {small_ones, longer, pieces}) {
    for (const std::size_t most : {1u, 5u, 100000u}) {
      corba::GiopLimits limits;
      limits.reads_ahead = false;
      Gate f(limits);
      Peer peer{one + small_ones, most};
      const auto ask = peer.reader();
      const corba::GiopGate::Read reader = [&](std::byte* to, std::size_t size) {
        EXPECT_EQ(f.gate.is_in_message(), peer.at != 0) << most;
        return ask(to, size);
      };
      Octets buffer(8192);
      std::size_t come = 0;
      do come += static_cast<std::size_t>(std::max(f.gate.receive(buffer.data(), buffer.size(), reader), 0));
      while (f.gate.has_more() && !HasFailure());
      EXPECT_FALSE(f.gate.is_in_message());
      EXPECT_EQ(f.gate.messages(), 1u);
      EXPECT_LE(peer.at, one.size());
      EXPECT_GT(come, 12u);
    }
  }
}

TEST(GiopGate, fragments_become_one_message) {
  for (const std::size_t most : {7u, 1u << 20}) {
    const Octets head = request_head(5, "anything");
    Octets pieces = message(request, head, true);
    Octets whole = head;
    for (int i = 0; i < 4; ++i) {
      const Octets piece = numbered(5, 4 + 16);
      pieces = pieces + message(fragment, piece, i < 3);
      whole.insert(whole.end(), piece.begin() + 4, piece.end());
    }
    Gate f;
    Peer peer{small_ones + pieces + small_ones, most};
    EXPECT_EQ(f.drain(peer), small_ones + message(request, whole) + small_ones) << most;
    EXPECT_EQ(f.gate.problem(), "");
  }
}

TEST(GiopGate, a_cancelled_message_in_fragments_is_dropped_and_other_cancels_too) {
  const Octets pieces = message(request, request_head(5, "anything"), true);
  Octets id;
  append_number(id, 5);
  Octets other;
  append_number(other, 77);
  Gate f;
  Peer peer{pieces + message(cancel_request, other) + message(cancel_request, id) + small_ones};
  EXPECT_EQ(f.drain(peer), small_ones);
  EXPECT_EQ(f.gate.problem(), "");
}

TEST(GiopGate, fragments_that_no_peer_sends_are_refused) {
  const Octets first = message(request, request_head(5, "anything"), true);
  const std::pair<Octets, const char*> attacks[] = {
      {message(fragment, numbered(1, 20)), "a fragment of no message"},
      {first + message(request, request_head(6, "x")), "something else"},
      {first + message(fragment, numbered(6, 20)), "fragments of several messages"},
      {first + message(fragment, numbered(5, 20), false, 1), "something else"},
      {first + message(fragment, Octets(2)), "something else"},
      {message(request, numbered(5, 13), true) + message(fragment, numbered(5, 20)), "multiple of 8"},
      {message(request, Octets(), true), "without an id"},
      {first + bytes("nonsense of any kind"), "something else"}};
  for (const auto& [octets, problem] : attacks) {
    Gate f;
    Peer peer{small_ones + octets};
    EXPECT_EQ(f.drain(peer), small_ones);
    EXPECT_NE(f.gate.problem().find(problem), std::string::npos) << f.gate.problem();
    EXPECT_EQ(f.gate.receive(octets.size() ? Octets(100).data() : nullptr, 100, peer.reader()), -1) << "for ever";
  }
}

TEST(GiopGate, what_a_message_claims_takes_no_memory_before_it_has_come) {
  Octets claims = request_head(1, "connect");
  claims.resize(1'000'000);
  Octets claiming = message(request, claims);
  claiming.resize(48);
  Gate f;
  Peer peer{claiming};
  EXPECT_TRUE(f.drain(peer).empty()) << "the ORB hears nothing";
  EXPECT_LT(f.in_progress, 200'000u);
  EXPECT_TRUE(f.gate.is_in_message());
}

TEST(GiopGate, messages_longer_than_allowed_are_refused_at_their_header) {
  corba::GiopLimits limits;
  limits.request = 100'000;
  limits.sample = 1'000'000;
  const auto result = [&](const std::string& operation, std::size_t size, bool in_fragments) {
    Octets body = request_head(1, operation);
    Octets octets;
    if (in_fragments) {
      octets = message(request, body, true) + message(fragment, numbered(1, size));
    } else {
      body.resize(size);
      octets = message(request, body);
    }
    Gate f(limits);
    Peer peer{octets};
    const bool is_through = !f.drain(peer).empty();
    EXPECT_EQ(is_through, f.gate.problem().empty()) << f.gate.problem();
    return is_through;
  };
  for (const bool in_fragments : {false, true}) {
    EXPECT_TRUE(result("connect", 99'000, in_fragments));
    EXPECT_FALSE(result("connect", 101'000, in_fragments));
    EXPECT_TRUE(result("put", 999'000, in_fragments));
    EXPECT_TRUE(result("push", 999'000, in_fragments));
    EXPECT_FALSE(result("put", 1'001'000, in_fragments));
    EXPECT_FALSE(result("putt", 999'000, in_fragments));
  }
}

// Ports of images are told apart from others by the key of their object.
std::size_t room_of_test(std::span<const std::byte> key) {
  const std::string_view text(reinterpret_cast<const char*>(key.data()), key.size());
  return text == "pictures" ? ~std::size_t{0} : text == "numbers" ? 150'000 : text == "bits" ? 100 : 0;
}

TEST(GiopGate, a_sample_may_be_as_long_as_its_port_needs) {
  corba::GiopLimits limits;
  limits.request = 100'000;
  limits.sample = 1'000'000;
  limits.room = &room_of_test;
  const auto is_through = [&](const std::string& key, std::size_t size, bool in_fragments) {
    Octets body = request_head(1, "put", key);
    const Octets head = message(request, body, true);
    body.resize(size);
    Gate f(limits);
    Peer peer{in_fragments ? head + message(fragment, numbered(1, size)) : message(request, body)};
    return !f.drain(peer).empty();
  };
  for (const bool in_fragments : {false, true}) {
    EXPECT_TRUE(is_through("pictures", 990'000, in_fragments));
    EXPECT_FALSE(is_through("pictures", 1'001'000, in_fragments)) << "never more than the process takes";
    EXPECT_TRUE(is_through("numbers", 149'000, in_fragments));
    EXPECT_FALSE(is_through("numbers", 151'000, in_fragments));
    EXPECT_TRUE(is_through("bits", 99'000, in_fragments)) << "never less than any request may have";
    EXPECT_FALSE(is_through("bits", 101'000, in_fragments));
    EXPECT_FALSE(is_through("no such port", 101'000, in_fragments));
  }
}

TEST(GiopGate, what_no_port_has_asked_for_is_collected_whatever_its_operation_is_called) {
  corba::GiopLimits limits;
  limits.room = &room_of_test;
  for (const auto& [key, is_collected] : {std::pair("pictures", false), std::pair("a service", true)}) {
    Octets body = request_head(1, "put", key);
    body.resize(1'000'000);
    Gate f(limits);
    Peer peer{message(request, body), 8192};
    Octets buffer(8192);
    ASSERT_GT(f.gate.receive(buffer.data(), buffer.size(), peer.reader()), 0);
    EXPECT_EQ(peer.at == peer.sent.size(), is_collected) << key;
  }
}

TEST(GiopGate, samples_pass_while_they_come) {
  Octets body = request_head(1, "put");
  body.resize(3'000'000, std::byte{'y'});
  const Octets sample = message(request, body);
  Gate f;
  Peer peer{sample + small_ones};
  Octets buffer(1 << 16);
  Octets all;
  const int first = f.gate.receive(buffer.data(), 8192, peer.reader());
  ASSERT_GT(first, 0);
  EXPECT_LE(peer.at, std::size_t{8192}) << "it was not collected";
  all.insert(all.end(), buffer.begin(), buffer.begin() + first);
  EXPECT_TRUE(f.gate.is_in_message());
  EXPECT_EQ(all + f.drain(peer), sample + small_ones);
}

TEST(GiopGate, a_long_message_counts_once_however_small_the_pieces_are_that_it_comes_in) {
  corba::GiopLimits limits;
  limits.direct = 100'000;
  limits.total = 6'000'000;
  Octets body = request_head(1, "put");
  body.resize(5'000'000, std::byte{'y'});
  const Octets sample = message(request, body);
  Gate f(limits);
  Peer peer{sample + small_ones, 4096};
  EXPECT_EQ(f.drain(peer), sample + small_ones) << f.gate.problem();
  EXPECT_EQ(f.in_progress, 0u);
}

TEST(GiopGate, all_connections_together_hold_no_more_than_allowed) {
  corba::GiopLimits limits;
  limits.total = 300'000;
  Gate f(limits);
  Octets body = request_head(1, "connect");
  body.resize(250'000);
  Peer peer{message(request, body)};
  peer.sent.resize(200'000);
  EXPECT_TRUE(f.drain(peer).empty());
  corba::GiopGate second(limits, f.in_progress);
  Peer other{message(request, body)};
  Octets buffer(8192);
  EXPECT_EQ(second.receive(buffer.data(), buffer.size(), other.reader()), -1);
  EXPECT_NE(second.problem().find("too much"), std::string::npos);
}

TEST(GiopGate, what_is_no_giop_is_handed_on_once_and_then_ends) {
  Gate f;
  Peer peer{bytes("GET / HTTP/1.1\r\n\r\n") + small_ones};
  const Octets out = f.drain(peer);
  EXPECT_FALSE(out.empty()) << "the ORB answers it";
  EXPECT_LT(out.size(), peer.sent.size());
}

// Any octets in any pieces end in whole messages or a refusal, and what comes out never has a fragment in it.
TEST(GiopGate, random_octets_never_bring_a_fragment_to_the_orb) {
  const auto seed = std::random_device()();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  for (int run = 0; run < 3000; ++run) {
    Octets octets;
    for (unsigned n = random() % 8; n > 0; --n) {
      const int type = static_cast<int>(random() % 9);
      octets = octets + message(type == 8 ? fragment : type, numbered(random() % 3, 4 + random() % 5 * 8), random() % 2,
                                static_cast<int>(random() % 4));
    }
    for (unsigned n = random() % 3; n > 0 && !octets.empty(); --n) octets[random() % octets.size()] = static_cast<std::byte>(random());
    Gate f;
    Peer peer{octets, random() % 64 + 1};
    const Octets out = f.drain(peer, random() % 2 ? 8192 : 20);
    for (std::size_t at = 0; at + 12 <= out.size();) {
      if (std::memcmp(&out[at], "GIOP\x01", 5) != 0 || std::to_integer<int>(out[at + 5]) > 2 || std::to_integer<int>(out[at + 7]) > 7)
        break;
      ASSERT_NE(std::to_integer<int>(out[at + 7]), fragment);
      ASSERT_TRUE(std::to_integer<int>(out[at + 5]) == 0 || (std::to_integer<int>(out[at + 6]) & 2) == 0);
      const bool is_little = (std::to_integer<int>(out[at + 6]) & 1) != 0;
      std::uint32_t size = 0;
      for (std::size_t i = 0; i < 4; ++i) size |= std::to_integer<std::uint32_t>(out[at + 8 + i]) << 8 * (is_little ? i : 3 - i);
      ASSERT_LE(at + 12 + size, out.size());
      at += 12 + size;
    }
  }
}

}  // namespace
