// Who is let in to rtm-studio, and which requests are read at all.
#include "studio/access_policy.h"

#include <gtest/gtest.h>

#include "studio/http_head.h"

namespace {

using studio::AccessDecision;
using studio::AccessPolicy;
using studio::Caller;

AccessPolicy door() { return {"0123456789abcdef0123456789abcdef", {"robots.example"}, {"https://viewer.example"}}; }

AccessDecision judge(Caller caller) {
  if (caller.host.empty()) caller.host = "127.0.0.1:8700";
  return door().judge(caller);
}

constexpr const char* good_query = "token=0123456789abcdef0123456789abcdef";

TEST(Door, lets_in_by_header_by_subprotocol_and_by_the_url_of_a_socket) {
  EXPECT_EQ(judge({.query = good_query}), AccessDecision::granted);
  EXPECT_EQ(judge({.authorization = "Bearer 0123456789abcdef0123456789abcdef"}), AccessDecision::granted);
  EXPECT_EQ(judge({.protocols = "rtmsim.studio.v1, token.0123456789abcdef0123456789abcdef"}), AccessDecision::granted);
  EXPECT_EQ(judge({.protocols = "token.0123456789abcdef0123456789abcdef,rtmsim.studio.v1"}), AccessDecision::granted);
}

TEST(Door, keeps_out_without_a_token_and_with_a_wrong_one) {
  EXPECT_EQ(judge({}), AccessDecision::no_token);
  EXPECT_EQ(judge({.authorization = "Basic 0123456789abcdef0123456789abcdef"}), AccessDecision::no_token);
  EXPECT_EQ(judge({.protocols = "rtmsim.studio.v1, 0123456789abcdef0123456789abcdef"}), AccessDecision::no_token);
  EXPECT_EQ(judge({.query = "token=0123456789abcdef0123456789abcdee"}), AccessDecision::wrong_token);
  EXPECT_EQ(judge({.query = "token=0123"}), AccessDecision::wrong_token);
  EXPECT_EQ(judge({.protocols = "token.0123456789abcdef0123456789abcde"}), AccessDecision::wrong_token);
}

TEST(Door, each_token_that_is_brought_must_be_right) {
  EXPECT_EQ(judge({.authorization = "Bearer 0123456789abcdef0123456789abcdef", .query = "token=old"}), AccessDecision::wrong_token);
  EXPECT_EQ(judge({.authorization = "Bearer old", .query = good_query}), AccessDecision::wrong_token);
}

TEST(Door, the_page_itself_is_for_all_whose_host_and_origin_are_known) {
  EXPECT_EQ(door().judge_sender({.host = "127.0.0.1:8700"}), AccessDecision::granted);
  EXPECT_EQ(door().judge_sender({.host = "evil.example"}), AccessDecision::wrong_host);
  EXPECT_EQ(door().judge_sender({.host = "127.0.0.1:8700", .origin = "http://evil.example"}), AccessDecision::wrong_origin);
}

TEST(Door, knows_numbers_localhost_and_the_names_it_was_told) {
  for (const char* host : {"127.0.0.1:8700", "127.0.0.1", "[::1]:8700", "localhost:9000", "LOCALHOST", "10.0.0.7:1", "robots.example:8700"})
    EXPECT_EQ(judge({.host = host, .query = good_query}), AccessDecision::granted) << host;
  for (const char* host : {"evil.example", "evil.example:8700", "localhost.evil.example", "127.0.0.1.evil.example", "127.0.0.1:8700:1",
                           "[::1", "[evil]:1", "localhost:80x", "1.2.3.4@evil.example"})
    EXPECT_EQ(judge({.host = host, .query = good_query}), AccessDecision::wrong_host) << host;
  EXPECT_EQ(door().judge({.query = good_query}), AccessDecision::wrong_host);
}

TEST(Door, refuses_pages_of_other_origins_even_with_the_token) {
  EXPECT_EQ(judge({.origin = "http://127.0.0.1:8700", .query = good_query}), AccessDecision::granted);
  EXPECT_EQ(judge({.origin = "https://viewer.example", .query = good_query}), AccessDecision::granted);
  for (const char* origin : {"http://evil.example", "null", "http://127.0.0.1:8701", "http://127.0.0.1:8700.evil.example", "file://"})
    EXPECT_EQ(judge({.origin = origin, .query = good_query}), AccessDecision::wrong_origin) << origin;
}

TEST(Door, makes_secrets_of_128_bits_that_differ) {
  const auto one = AccessPolicy::make_secret(), other = AccessPolicy::make_secret();
  ASSERT_TRUE(one && other);
  EXPECT_EQ(one->size(), 32u);
  EXPECT_NE(*one, *other);
}

using HeadState = studio::HeadEnd::State;

unsigned status_of(const std::string& head) {
  const auto end = studio::find_head_end(head);
  if (end.state == HeadState::too_long) return 431;
  if (end.state != HeadState::complete) return end.state == HeadState::malformed ? 400 : 0;
  const auto problem = studio::check_head(std::string_view(head).substr(0, end.size));
  return problem ? problem->status : 200;
}

TEST(HttpHead, a_request_of_a_browser_is_good) {
  EXPECT_EQ(status_of("GET /world.glb?v=1 HTTP/1.1\r\nHost: 127.0.0.1:8700\r\nUser-Agent: a (b; c) d\r\nAccept:*/*\r\nX:\r\n\r\n"), 200u);
  EXPECT_EQ(status_of("GET / HTTP/1.0\r\n\r\n"), 200u);
  EXPECT_EQ(status_of("GET / HTTP/1.1\r\nhost: a\r\nContent-Length: 0\r\n\r\n"), 200u);
  EXPECT_EQ(
      status_of("GET / HTTP/1.1\r\nHost: a\r\nAccept: x\r\nAccept: y\r\nSec-WebSocket-Protocol: a\r\nSec-WebSocket-Protocol: b\r\n\r\n"),
      200u);
  EXPECT_EQ(status_of("GET / HTTP/1.1\r\nHost: a\r\n"), 0u);
  const std::string two = "GET / HTTP/1.1\r\nHost: a\r\n\r\n";
  EXPECT_EQ(studio::find_head_end(two + two).size, two.size());
}

TEST(HttpHead, what_two_programs_could_read_in_two_ways_is_refused) {
  const std::string host = "Host: a\r\n", get = "GET / HTTP/1.1\r\n";
  for (const std::string& head : {get + host + "Host: b\r\n\r\n",
                                  get + host + "hOST: a\r\n\r\n",
                                  get + "\r\n",
                                  get + "Host : a\r\n\r\n",
                                  get + host + " folded\r\n\r\n",
                                  get + " first\r\n" + host + "\r\n",
                                  get + host + "X: a\r\n\tb\r\n\r\n",
                                  get + host + "X: a\nY: b\r\n\r\n",
                                  get + host + "X: a\rY: b\r\n\r\n",
                                  std::string("GET / HTTP/1.1\nHost: a\n\n"),
                                  get + host + "X y: a\r\n\r\n",
                                  get + host + ": a\r\n\r\n",
                                  get + host + "no field\r\n\r\n",
                                  get + host + std::string("X: \0\r\n\r\n", 8),
                                  get + host + "X: \x1b\r\n\r\n",
                                  get + host + "Origin: http://a\r\nOrigin: http://a\r\n\r\n",
                                  get + host + "Authorization: Bearer a\r\nAuthorization: Bearer b\r\n\r\n",
                                  get + host + "Content-Length: 0\r\nContent-Length: 0\r\n\r\n",
                                  get + host + "Content-Length: 0\r\nTransfer-Encoding: chunked\r\n\r\n",
                                  get + host + "Transfer-Encoding: chunked\r\n\r\n",
                                  get + host + "Transfer-Encoding: identity\r\n\r\n",
                                  get + host + "Content-Length: 0, 0\r\n\r\n",
                                  get + host + "Content-Length: +0\r\n\r\n",
                                  get + host + "Content-Length:\r\n\r\n",
                                  std::string("GET  / HTTP/1.1\r\nHost: a\r\n\r\n"),
                                  std::string("GET / x HTTP/1.1\r\nHost: a\r\n\r\n"),
                                  std::string("GET / HTTP/2.0\r\nHost: a\r\n\r\n"),
                                  std::string("GET / HTTP/1.1 \r\nHost: a\r\n\r\n"),
                                  std::string("GET\t/\tHTTP/1.1\r\nHost: a\r\n\r\n"),
                                  std::string("G(T / HTTP/1.1\r\nHost: a\r\n\r\n"),
                                  std::string("GET x HTTP/1.1\r\nHost: a\r\n\r\n"),
                                  std::string("OPTIONS * HTTP/1.1\r\nHost: a\r\n\r\n"),
                                  std::string("CONNECT a:1 HTTP/1.1\r\nHost: a:1\r\n\r\n"),
                                  std::string("\r\n\r\n"),
                                  std::string("\x16\x03\x01\x02\x00\x01", 6)})
    EXPECT_EQ(status_of(head), 400u) << head;
  EXPECT_EQ(status_of(get + host + "Content-Length: 5\r\n\r\nhello"), 413u);
  EXPECT_EQ(status_of(get + host + "X: " + std::string(9000, 'x') + "\r\n\r\n"), 431u);
  EXPECT_EQ(status_of(get + host + "X: " + std::string(9000, 'x')), 431u);
}

TEST(HttpHead, an_absolute_target_names_the_same_host) {
  EXPECT_EQ(status_of("GET http://a:1/x HTTP/1.1\r\nHost: A:1\r\n\r\n"), 200u);
  for (const char* target : {"http://b/x", "http://a:2/", "http://a:1@b/", "http:///", "http://", "ftp://a:1/"})
    EXPECT_EQ(status_of("GET " + std::string(target) + " HTTP/1.1\r\nHost: a:1\r\n\r\n"), 400u) << target;
  EXPECT_EQ(studio::origin_form("http://a:1/x?y"), "/x?y");
  EXPECT_EQ(studio::origin_form("HTTP://a:1"), "/");
  EXPECT_EQ(studio::origin_form("/http://a/"), "/http://a/");
}

TEST(Query, values_are_found_and_decoded) {
  EXPECT_EQ(studio::query_value("a=1&b=two%20words+more&c=", "b"), "two words more");
  EXPECT_EQ(studio::query_value("ab=1&b=2", "b"), "2");
  EXPECT_EQ(studio::query_value("a=%zz%4", "a"), "%zz%4");
  EXPECT_EQ(studio::query_value("a", "a"), "");
}

}  // namespace
