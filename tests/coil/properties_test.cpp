// coil::Properties: the tree of named strings.
#include <coil/Properties.h>
#include <gtest/gtest.h>

#include <memory>
#include <sstream>

namespace {

coil::Properties loaded(const std::string& text) {
  coil::Properties p;
  std::istringstream in(text);
  p.load(in);
  return p;
}

TEST(Properties, are_made_from_a_spec_of_pairs_up_to_an_empty_key) {
  const char* spec[] = {"implementation_id", "X", " type_name ", " Y ", "conf.default.gain", "1.5", "", "ignored", "x"};
  coil::Properties p(spec);
  EXPECT_EQ(p.getProperty("implementation_id"), "X");
  EXPECT_EQ(p.getProperty("type_name"), "Y");
  EXPECT_EQ(p["conf.default.gain"], "1.5");
  EXPECT_EQ(p.size(), 3);
  static const char* const const_spec[] = {"a", "b", ""};
  EXPECT_EQ(coil::Properties(const_spec).getDefault("a"), "b");
}

TEST(Properties, keep_the_order_of_insertion) {
  coil::Properties p;
  for (const char* key : {"zebra", "a.x", "m", "a.b"}) p.setProperty(key, "1");
  EXPECT_EQ(p.propertyNames(), (std::vector<std::string>{"zebra", "a.x", "a.b", "m"}));
}

TEST(Properties, list_a_node_that_has_both_a_value_and_children) {
  coil::Properties p;
  p.setProperty("a", "1");
  p.setProperty("a.b", "2");
  EXPECT_EQ(p.propertyNames(), (std::vector<std::string>{"a", "a.b"}));
}

TEST(Properties, value_comes_before_default_and_default_before_nothing) {
  coil::Properties p;
  p.setDefault("k", "default");
  EXPECT_EQ(p.getProperty("k"), "default");
  EXPECT_EQ(p.getProperty("k", "other"), "other");
  EXPECT_EQ(p.setProperty("k", "value"), "");
  EXPECT_EQ(p.setProperty("k", "value2"), "value");
  EXPECT_EQ(p.getProperty("k", "other"), "value2");
  EXPECT_EQ(p.getDefault("k"), "default");
  EXPECT_EQ(p.getProperty("nowhere"), "");
  EXPECT_EQ(std::as_const(p)["nowhere"], "");
  EXPECT_EQ(p.findNode("nowhere"), nullptr);
}

TEST(Properties, index_makes_the_node_and_turns_a_default_into_a_value) {
  coil::Properties p;
  p.setDefault("k", "default");
  EXPECT_EQ(p["k"], "default");
  p["x.y"] = "1";
  EXPECT_EQ(p.getProperty("x.y"), "1");
  EXPECT_STREQ(p.getNode("k").getValue(), "default");
}

TEST(Properties, nodes_are_found_made_and_taken_out) {
  coil::Properties p;
  EXPECT_TRUE(p.createNode("a.b"));
  EXPECT_FALSE(p.createNode("a.b"));
  EXPECT_FALSE(p.createNode(""));
  EXPECT_EQ(&p.getNode(""), &p);
  EXPECT_EQ(p.findNode(""), nullptr);
  ASSERT_NE(p.findNode("a"), nullptr);
  EXPECT_NE(p.hasKey("a"), nullptr);
  EXPECT_EQ(p.hasKey("b"), nullptr);
  EXPECT_STREQ(p.getNode("a.b").getName(), "b");
  EXPECT_EQ(p.getNode("a.b").getRoot(), p.findNode("a"));
  EXPECT_EQ(p.getLeaf().size(), 1u);
  std::unique_ptr<coil::Properties> taken(p.removeNode("a"));
  ASSERT_NE(taken, nullptr);
  EXPECT_EQ(p.findNode("a"), nullptr);
  EXPECT_NE(taken->findNode("b"), nullptr);
  EXPECT_EQ(p.removeNode("a"), nullptr);
}

TEST(Properties, many_children_are_found_like_few) {
  coil::Properties p;
  std::vector<std::string> names;
  for (int i = 0; i < 100; ++i) {
    names.push_back("a.n" + std::to_string(i));
    p[names.back()] = std::to_string(i);
  }
  EXPECT_EQ(p.propertyNames(), names);
  std::unique_ptr<coil::Properties> taken(p.getNode("a").removeNode("n50"));
  EXPECT_EQ(p.findNode("a.n50"), nullptr);
  taken.reset();
  p["a.n50"] = "new";
  EXPECT_EQ(p.getNode("a").getLeaf().back()->getValue(), std::string("new"));
  coil::Properties copy(p);
  copy["a.n7"] = "mine";
  EXPECT_EQ(p["a.n7"], "7");
  EXPECT_EQ(copy["a.n7"], "mine");
  EXPECT_EQ(copy.findNode("a.n7")->getRoot(), copy.findNode("a"));
  const coil::Properties moved(std::move(copy));
  EXPECT_EQ(moved["a.n7"], "mine");
  EXPECT_EQ(copy.findNode("a.n7"), nullptr);
  p.getNode("a").clear();
  EXPECT_EQ(p.findNode("a.n7"), nullptr);
  p["a.n7"] = "again";
  EXPECT_EQ(p.size(), 1);
}

TEST(Properties, copies_are_independent_and_a_subtree_may_replace_its_tree) {
  coil::Properties p;
  p["a.b.c"] = "1";
  coil::Properties q(p);
  q["a.b.c"] = "2";
  EXPECT_EQ(p["a.b.c"], "1");
  p = p.getNode("a");
  EXPECT_EQ(p["b.c"], "1");
  q.getNode("x") = p;
  EXPECT_EQ(q["x.b.c"], "1");
  EXPECT_EQ(q["a.b.c"], "2");
  coil::Properties r(std::move(q));
  EXPECT_EQ(r.findNode("a")->getRoot(), &r);
}

TEST(Properties, merge_takes_over_every_value_of_the_other) {
  coil::Properties p, q;
  p["a"] = "1";
  p["b"] = "1";
  q["b"] = "2";
  q.setDefault("c", "3");
  p << q;
  EXPECT_EQ(p.propertyNames(), (std::vector<std::string>{"a", "b", "c"}));
  EXPECT_EQ(p["b"], "2");
  EXPECT_EQ(p["c"], "3");
}

TEST(Properties, load_reads_both_separators_comments_continuations_and_escapes) {
  auto p = loaded(
      "# comment\n"
      "! comment too\n"
      "  a.b: value with blanks  \r\n"
      "c=http\\://x\n"
      "url: http://host:80/x=1\n"
      "list: one, \\\n"
      "      two\n"
      "tab:a\\tb\n"
      "word rest of line\n"
      "empty:\n"
      "last: x");
  EXPECT_EQ(p.getProperty("a.b"), "value with blanks");
  EXPECT_EQ(p.getProperty("c"), "http://x");
  EXPECT_EQ(p.getProperty("url"), "http://host:80/x=1");
  EXPECT_EQ(p.getProperty("list"), "one, two");
  EXPECT_EQ(p.getProperty("tab"), "a\tb");
  EXPECT_EQ(p.getProperty("word"), "rest of line");
  EXPECT_NE(p.findNode("empty"), nullptr);
  EXPECT_EQ(p.getProperty("last"), "x");
}

TEST(Properties, store_writes_what_load_reads_back) {
  coil::Properties p;
  p["plain.key"] = "value";
  p["lines"] = " first\nsecond\\ \"quoted\" ";
  p["url"] = "a:b=c";
  std::ostringstream out;
  p.store(out, "header");
  EXPECT_EQ(out.str().substr(0, 9), "# header\n");
  auto q = loaded(out.str());
  for (const auto& name : p.propertyNames()) EXPECT_EQ(q.getProperty(name), p.getProperty(name)) << name;
}

TEST(Properties, print_as_an_indented_tree) {
  coil::Properties p;
  p["a.b"] = "1";
  std::ostringstream out;
  out << p;
  EXPECT_EQ(out.str(), "- a\n  - b: 1\n");
}

TEST(Properties, an_escaped_dot_belongs_to_the_name) {
  coil::Properties p;
  p["a\\.b"] = "1";
  EXPECT_EQ(p.getLeaf().size(), 1u);
  EXPECT_EQ(p.findNode("a"), nullptr);
}

std::string deep_name(std::size_t steps) {
  std::string name = "a";
  for (std::size_t i = 1; i < steps; ++i) name += ".a";
  return name;
}

TEST(Properties, as_deep_as_a_peer_likes_are_made_copied_listed_printed_and_gone_without_a_deep_stack) {
  const auto name = deep_name(200'000);
  coil::Properties p;
  p.setProperty(name, "1");
  p.setProperty(name + ".b", "2");
  coil::Properties copy(p);
  copy << p;
  EXPECT_EQ(copy.propertyNames(), (std::vector<std::string>{name, name + ".b"}));
  EXPECT_EQ(copy.getProperty(name), "1");
  std::ostringstream out;
  out << copy;
  EXPECT_LT(out.str().size(), name.size() * 100);
  copy = coil::Properties();
  EXPECT_EQ(copy.size(), 0);
}

TEST(Properties, list_names_below_nodes_without_a_name) {
  coil::Properties p;
  p.setProperty(".x", "1");
  p.setProperty("a..y", "2");
  for (const auto& name : p.propertyNames()) EXPECT_NE(p.getProperty(name), "") << name;
  EXPECT_EQ(p.size(), 2);
}

}  // namespace
