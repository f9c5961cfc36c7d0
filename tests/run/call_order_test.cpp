#include "run/call_order.h"

#include <gtest/gtest.h>

namespace tools::test {
namespace {

using Turns = std::map<std::string, int>;

SavedConnector link(const std::string& from, const std::string& to, const std::string& dataflow = "push") {
  SavedConnector connector;
  connector.dataflow_type = dataflow;
  connector.source.instance = from;
  connector.source.port_name = from + ".out";
  connector.target.instance = to;
  connector.target.port_name = to + ".in";
  return connector;
}

// Those whose names begin with F are of others. "F2" is of phase 2, all else of phase 1; U's phase is not known.
CallOrder order_of(const std::vector<SavedConnector>& connectors) {
  SavedSystem system;
  system.connectors = connectors;
  return call_order(system, [](const std::string& name) {
    CalledComponent about{name.starts_with("F"), 1};
    if (name == "F2") about.phase = 2;
    if (name == "U") about.phase.reset();
    return about;
  });
}

TEST(CallOrder, our_own_need_no_turns) { EXPECT_EQ(order_of({link("A", "B"), link("B", "A"), link("Fa", "B")}).turns, Turns()); }

TEST(CallOrder, who_reads_as_one_of_others_comes_before_who_sends) {
  EXPECT_EQ(order_of({link("A", "Fa"), link("Fa", "Fb")}).turns, (Turns{{"Fb", 0}, {"Fa", 1}, {"A", 2}}));
  EXPECT_EQ(order_of({link("U", "Fa")}).turns, (Turns{{"Fa", 0}, {"U", 1}}));
  EXPECT_EQ(order_of({link("A", "F2")}).turns, Turns());
}

TEST(CallOrder, who_fetches_from_one_of_others_comes_before_it) {
  EXPECT_EQ(order_of({link("Fa", "B", "pull")}).turns, (Turns{{"B", 0}, {"Fa", 1}}));
}

TEST(CallOrder, several_who_send_to_one_port_of_others_come_by_name) {
  EXPECT_EQ(order_of({link("C", "F2"), link("B", "F2"), link("Fa", "F2")}).turns, (Turns{{"B", 0}, {"C", 1}, {"Fa", 2}}));
  // One of them is asked to come late for another reason: it comes last.
  EXPECT_EQ(order_of({link("B", "F2"), link("C", "F2"), link("B", "Fa")}).turns, (Turns{{"C", 0}, {"Fa", 0}, {"B", 1}}));
}

TEST(CallOrder, a_circle_is_told_and_has_an_order_all_the_same) {
  const auto order = order_of({link("Fa", "Fb"), link("Fb", "Fa"), link("Fa", "Fa")});
  EXPECT_EQ(order.in_a_circle, std::vector<std::string>{"Fb.out to Fa.in"});
  EXPECT_EQ(order.turns, (Turns{{"Fb", 0}, {"Fa", 1}}));
  EXPECT_EQ(order.turn_of("A"), 0);
}

}  // namespace
}  // namespace tools::test
