#include "access_policy.h"

#include <gtest/gtest.h>

namespace gateway {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

TEST(Door, only_the_whole_key_fits) {
  const AccessPolicy door{false, "open sesame"};
  EXPECT_TRUE(door.fits("open sesame"));
  for (const auto wrong : {"", "open", "open sesame ", "Open sesame", "xxxxxxxxxxx"}) EXPECT_FALSE(door.fits(wrong)) << wrong;
  EXPECT_FALSE(door.fits(std::string(1000, 'x')));
  EXPECT_FALSE(door.fits(std::string("open sesame\0", 12)));
}

TEST(Door, without_a_key_none_fits) {
  EXPECT_FALSE(AccessPolicy{}.fits(""));
  EXPECT_FALSE(AccessPolicy{}.fits("x"));
}

TEST(Door, no_socket_is_welcome_unless_it_is_open) {
  EXPECT_EQ(AccessPolicy{}.entry(-1), Entry::refused);
  EXPECT_EQ((AccessPolicy{false, "k"}).entry(-1), Entry::needs_key);
  EXPECT_EQ((AccessPolicy{true, ""}).entry(-1), Entry::welcome);
}

TEST(Door, says_what_is_open) {
  EXPECT_EQ(describe({}, "127.0.0.1"), "");
  EXPECT_EQ(describe({}, "127.9.9.9"), "");
  EXPECT_EQ(describe({}, "::1"), "");
  EXPECT_NE(describe({}, "0.0.0.0").find("are rejected"), std::string::npos);
  EXPECT_NE(describe({}, "::").find("are rejected"), std::string::npos);
  EXPECT_NE(describe({false, "k"}, "127.0.0.1").find("send the key"), std::string::npos);
  EXPECT_NE(describe({true, ""}, "127.0.0.1").find("every client"), std::string::npos);
}

TEST(ClientTimeouts, ends_with_those_who_ask_for_nothing) {
  const auto start = ClientTimeouts::Time();
  ClientTimeouts timeouts(start);
  EXPECT_FALSE(timeouts.expired(start + milliseconds(4999), false, false));
  EXPECT_TRUE(timeouts.expired(start + seconds(5), false, true));
  EXPECT_FALSE(timeouts.expired(start + seconds(5000), true, false));
}

TEST(ClientTimeouts, ends_with_those_who_do_not_end_a_message) {
  const auto start = ClientTimeouts::Time();
  ClientTimeouts timeouts(start);
  EXPECT_FALSE(timeouts.expired(start + seconds(100), true, true));
  EXPECT_FALSE(timeouts.expired(start + seconds(129), true, true));
  EXPECT_TRUE(timeouts.expired(start + seconds(130), true, true));
  // One message after another is no long message.
  ClientTimeouts other(start);
  EXPECT_FALSE(other.expired(start + seconds(1), true, true));
  EXPECT_FALSE(other.expired(start + seconds(20), true, false));
  EXPECT_FALSE(other.expired(start + seconds(40), true, true));
}

}  // namespace
}  // namespace gateway
