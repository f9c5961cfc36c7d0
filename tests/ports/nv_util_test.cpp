#include <gtest/gtest.h>
#include <rtm/CORBA_IORUtil.h>
#include <rtm/CORBA_SeqUtil.h>
#include <rtm/EventPort.h>
#include <rtm/NVUtil.h>
#include <rtm/StaticFSM.h>

#include "ports/support.h"

namespace {

TEST(NVUtil, lists_and_properties_are_the_same_strings) {
  const auto orb = ports::start_orb();  // values of `any` need one
  coil::Properties properties;
  properties.setProperty("a.b", "1");
  properties.setProperty("c", "2");
  SDOPackage::NVList list;
  NVUtil::copyFromProperties(list, properties);
  EXPECT_EQ(NVUtil::toString(list, "a.b"), "1");
  EXPECT_EQ(NVUtil::toProperties(list).getProperty("c"), "2");
}

TEST(NVUtil, values_that_are_no_strings_are_left_out) {
  const auto orb = ports::start_orb();  // values of `any` need one
  SDOPackage::NVList list;
  CORBA_SeqUtil::push_back(list, NVUtil::newNV("number", CORBA::Long(5)));
  EXPECT_FALSE(NVUtil::isString(list, "number"));
  EXPECT_EQ(NVUtil::toProperties(list).size(), 0);
  EXPECT_EQ(NVUtil::toString(list, "number"), "");
  EXPECT_EQ(NVUtil::find_index(list, "number"), 0);
  EXPECT_EQ(NVUtil::find_index(list, "absent"), -1);
  EXPECT_ANY_THROW(NVUtil::find(list, "absent"));
}

TEST(NVUtil, a_comma_list_has_each_value_once) {
  const auto orb = ports::start_orb();  // values of `any` need one
  SDOPackage::NVList list;
  NVUtil::appendStringValue(list, "types", "a");
  NVUtil::appendStringValue(list, "types", "b");
  NVUtil::appendStringValue(list, "types", "a");
  EXPECT_TRUE(NVUtil::isStringValue(list, "types", "a,b"));
}

TEST(SeqUtil, sequences_work_like_containers) {
  CORBA::ULongSeq numbers;
  for (CORBA::ULong i = 0; i < 4; ++i) CORBA_SeqUtil::push_back(numbers, i);
  CORBA::ULong ten = 10;
  CORBA_SeqUtil::insert(numbers, ten, 1);
  CORBA_SeqUtil::erase(numbers, 0);
  CORBA_SeqUtil::erase_if(numbers, [](CORBA::ULong n) { return n == 2; });
  ASSERT_EQ(numbers.length(), 3u);
  EXPECT_EQ(numbers[0], 10u);
  EXPECT_EQ((CORBA_SeqUtil::front<CORBA::ULong>(numbers)), 10u);
  EXPECT_EQ((CORBA_SeqUtil::back<CORBA::ULong>(numbers)), 3u);
  EXPECT_EQ(CORBA_SeqUtil::find(numbers, [](CORBA::ULong n) { return n == 3; }), 2);
  CORBA_SeqUtil::erase(numbers, 99);
  CORBA_SeqUtil::clear(numbers);
  EXPECT_EQ(numbers.length(), 0u);
}

TEST(IORUtil, references_are_taken_apart_and_put_together) {
  const auto orb = ports::start_orb();
  RTC::TimedLong value{};
  RTC::InPort<RTC::TimedLong> in("A0.in", value);
  const CORBA::String_var made = orb->orb()->object_to_string(in.getPortRef());
  std::string text = made.in();
  IOP::IOR ior;
  ASSERT_TRUE(CORBA_IORUtil::toIOR(text.c_str(), ior));
  EXPECT_STREQ(ior.type_id, "IDL:omg.org/RTC/PortService:1.0");
  EXPECT_EQ(CORBA_IORUtil::toString(ior), text);
  ASSERT_FALSE(CORBA_IORUtil::getEndpoints(ior).empty());
  EXPECT_TRUE(CORBA_IORUtil::replaceEndpoint(text, "192.0.2.1:99"));
  ASSERT_TRUE(CORBA_IORUtil::toIOR(text.c_str(), ior));
  EXPECT_STREQ(CORBA_IORUtil::getEndpoints(ior)[0].host, "192.0.2.1");
  EXPECT_EQ(CORBA_IORUtil::getEndpoints(ior)[0].port, 99);
  EXPECT_NE(CORBA_IORUtil::formatIORinfo(text.c_str()).find("192.0.2.1:99"), std::string::npos);
  for (const char* wrong : {"", "IOR:", "IOR:0", "IOR:zz", "IOR:01000000ffffffff"}) EXPECT_FALSE(CORBA_IORUtil::toIOR(wrong, ior)) << wrong;
}

FSM_TOPSTATE(Door) {
  FSM_STATE(Door);
  virtual void open() { ++opened; }
  virtual void turn(RTC::TimedLong angle) { turned = angle.data; }
  static inline int opened = 0;
  static inline CORBA::Long turned = 0;
};

TEST(EventPort, samples_are_events_of_the_machine) {
  const auto orb = ports::start_orb();
  RTC::Machine<Door> machine;
  RTC::EventInPort<RTC::Machine<Door>> in("A0.event", machine);
  in.bindEvent("open", &Door::open);
  in.bindEvent("turn", &Door::turn);
  RTC::TimedLong value{};
  value.data = 45;
  RTC::OutPort<RTC::TimedLong> opens("B0.open", value);
  RTC::OutPort<RTC::TimedLong> turns("B0.turn", value);
  auto first = ports::profile({opens.getPortRef(), in.getPortRef()}, {{"fsm_event_name", "open"}});
  auto second = ports::profile({turns.getPortRef(), in.getPortRef()}, {{"fsm_event_name", "turn"}});
  ASSERT_EQ(opens.connect(first), RTC::RTC_OK);
  ASSERT_EQ(turns.connect(second), RTC::RTC_OK);
  opens.write();
  turns.write();
  EXPECT_EQ(Door::opened, 0) << "not before the machine runs";
  machine.run_event();
  EXPECT_EQ(Door::opened, 1);
  EXPECT_EQ(Door::turned, 45);
}

}  // namespace
