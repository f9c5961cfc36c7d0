#include <gtest/gtest.h>
#include <rtm/CORBA_SeqUtil.h>
#include <rtm/NVUtil.h>

namespace {

TEST(NVUtil, lists_and_properties_are_the_same_strings) {
  coil::Properties properties;
  properties.setProperty("a.b", "1");
  properties.setProperty("c", "2");
  SDOPackage::NVList list;
  NVUtil::copyFromProperties(list, properties);
  EXPECT_EQ(NVUtil::toString(list, "a.b"), "1");
  EXPECT_EQ(NVUtil::toProperties(list).getProperty("c"), "2");
}

TEST(NVUtil, values_that_are_no_strings_are_left_out) {
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

}  // namespace
