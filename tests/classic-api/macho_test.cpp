// Machines written against the Macho library, and what state machines of 2.x say besides.
#include <gtest/gtest.h>
#include <rtm/Macho.h>

#include <string>

namespace {

std::string told;

TOPSTATE(Door) {
  struct Box {
    int opened = 0;
  };
  STATE(Door);
  virtual void push() {}
  virtual void pull(int) {}

 private:
  void init() override;
};
SUBSTATE(Closed, Door) {
  STATE(Closed);
  void pull(int times) override;

 private:
  void entry() override { told += "close "; }
};
SUBSTATE(Open, Door) {
  STATE(Open);
  void push() override { setState<Closed>(); }

 private:
  void entry() override { told += "open "; }
  void exit() override { told += "leave "; }
};

void Door::init() { setState<Closed>(); }
void Closed::pull(int times) {
  TOP::box().opened += times;
  setState<Open>();
}

FSM_INIT_VALUE(Door)
FSM_INIT_VALUE(Closed)
FSM_INIT_VALUE(Open)

TEST(Macho, states_are_entered_and_left_with_the_names_of_the_library) {
  told.clear();
  Macho::Machine<Door> machine;
  EXPECT_STREQ(machine.currentState().name(), "Closed");
  machine->pull(2);
  EXPECT_STREQ(machine.currentState().name(), "Open");
  machine.dispatch(Macho::Event(&Door::push));
  EXPECT_EQ(told, "close open leave close ");
  EXPECT_EQ(machine.box().opened, 2);
}

}  // namespace
