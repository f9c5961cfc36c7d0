// What comes as an `any` from the wire: all that peers send arrives as it was, and nothing hostile gets further than an exception.
#include <gtest/gtest.h>
#include <rtm/idl/BasicDataTypeSkel.h>
#include <rtm/idl/DataPort_OpenRTMSkel.h>
#include <rtm/idl/SDOPackageSkel.h>

#include <cstring>
#include <functional>
#include <random>
#include <utility>
#include <vector>

namespace {

class AnyCheck : public testing::Test {
 protected:
  void SetUp() override {
    int argc = 0;
    orb_ = CORBA::ORB_init(argc, nullptr);  // brings the code sets of strings
  }

  // As a peer encodes it.
  static CORBA::Any sent(const CORBA::Any& value) {
    SDOPackage::NameValue pair;
    pair.name = "a property";
    pair.value = value;
    cdrMemoryStream stream;
    pair >>= stream;
    SDOPackage::NameValue arrived;
    arrived <<= stream;
    EXPECT_STREQ(arrived.name, "a property");
    return arrived.value;
  }

  static void expect_refused(const std::function<void(cdrMemoryStream&)>& write, const char* what) {
    cdrMemoryStream stream;
    stream.marshalString("a property");
    write(stream);
    SDOPackage::NameValue arrived;
    EXPECT_THROW(arrived <<= stream, CORBA::MARSHAL) << what;
  }

  CORBA::ORB_var orb_;
};

TEST_F(AnyCheck, texts_and_numbers_arrive_as_they_were) {
  CORBA::Any any;
  any <<= "a text";
  const char* text = nullptr;
  CORBA::Any got = sent(any);
  ASSERT_TRUE(got >>= text);
  EXPECT_STREQ(text, "a text");
  any <<= CORBA::Any::from_string("short", 10);
  got = sent(any);
  ASSERT_TRUE(got >>= CORBA::Any::to_string(text, 10));
  EXPECT_STREQ(text, "short");
  any <<= L"weit";
  const CORBA::WChar* wide = nullptr;
  got = sent(any);
  ASSERT_TRUE(got >>= wide);
  EXPECT_EQ(std::wstring(wide), L"weit");
  any <<= CORBA::Double{-0.5};
  CORBA::Double real = 0;
  got = sent(any);
  ASSERT_TRUE(got >>= real);
  EXPECT_EQ(real, -0.5);
  any <<= CORBA::LongLong{-(1LL << 40)};
  CORBA::LongLong large = 0;
  got = sent(any);
  ASSERT_TRUE(got >>= large);
  EXPECT_EQ(large, -(1LL << 40));
  any <<= CORBA::Any::from_boolean(true);
  CORBA::Boolean yes = false;
  got = sent(any);
  ASSERT_TRUE(got >>= CORBA::Any::to_boolean(yes));
  EXPECT_TRUE(yes);
  got = sent(CORBA::Any());
  const CORBA::TypeCode_var nothing = got.type();
  EXPECT_EQ(nothing->kind(), CORBA::tk_null);
}

TEST_F(AnyCheck, structures_references_and_anys_arrive_as_they_were) {
  CORBA::Any any;
  RTC::TimedStringSeq strings{};
  strings.tm.nsec = 7;
  strings.data.length(2);
  strings.data[0u] = "one";
  strings.data[1u] = "two";
  any <<= strings;
  CORBA::Any got = sent(any);
  const RTC::TimedStringSeq* strings_got = nullptr;
  ASSERT_TRUE(got >>= strings_got);
  EXPECT_EQ(strings_got->tm.nsec, 7u);
  EXPECT_STREQ(strings_got->data[1u], "two");

  any <<= OpenRTM::BUFFER_FULL;
  OpenRTM::PortStatus status = OpenRTM::PORT_OK;
  got = sent(any);
  ASSERT_TRUE(got >>= status);
  EXPECT_EQ(status, OpenRTM::BUFFER_FULL);

  const CORBA::Object_var object = orb_->string_to_object("corbaloc:iiop:127.0.0.1:1/nobody");
  any <<= object.in();
  CORBA::Object_var object_got;
  got = sent(any);
  ASSERT_TRUE(got >>= CORBA::Any::to_object(object_got.out()));
  EXPECT_TRUE(object->_is_equivalent(object_got));

  CORBA::Any inner;
  inner <<= "inside";
  SDOPackage::NVList list;
  list.length(1);
  list[0u].name = "key";
  list[0u].value <<= inner;
  any <<= list;
  got = sent(any);
  const SDOPackage::NVList* list_got = nullptr;
  ASSERT_TRUE(got >>= list_got);
  const CORBA::Any* inner_got = nullptr;
  ASSERT_TRUE((*list_got)[0u].value >>= inner_got);
  const char* text = nullptr;
  ASSERT_TRUE(*inner_got >>= text);
  EXPECT_STREQ(text, "inside");
}

TEST_F(AnyCheck, lengths_without_the_octets_are_refused) {
  for (const CORBA::ULong length : {100u, 0x10000000u, 0x7fffffffu, 0x80000000u, 0xfffffffeu, 0xffffffffu}) {
    expect_refused(
        [length](cdrMemoryStream& stream) {
          stream.marshalULong(CORBA::tk_string);
          stream.marshalULong(0);
          stream.marshalULong(length);
          for (int i = 0; i < 15; ++i) stream.marshalULong(0);
        },
        "a text");
    // sequence<octet> and octet[length]
    for (const CORBA::ULong kind : std::initializer_list<CORBA::ULong>{CORBA::tk_sequence, CORBA::tk_array}) {
      expect_refused(
          [length, kind](cdrMemoryStream& stream) {
            stream.marshalULong(kind);
            stream.marshalULong(12);
            stream.marshalULong(omni::myByteOrder);
            stream.marshalULong(CORBA::tk_octet);
            stream.marshalULong(kind == CORBA::tk_array ? length : 0);
            if (kind == CORBA::tk_sequence) stream.marshalULong(length);
            for (int i = 0; i < 15; ++i) stream.marshalULong(0);
          },
          "octets");
    }
    expect_refused(
        [length](cdrMemoryStream& stream) {
          stream.marshalULong(CORBA::tk_struct);
          stream.marshalULong(length);
          for (int i = 0; i < 15; ++i) stream.marshalULong(0);
        },
        "a type code");
  }
}

TEST_F(AnyCheck, types_that_nobody_sends_are_refused) {
  for (const CORBA::ULong kind :
       std::initializer_list<CORBA::ULong>{CORBA::tk_value, CORBA::tk_value_box, CORBA::tk_union, CORBA::tk_fixed, CORBA::tk_except,
                                           CORBA::tk_abstract_interface, CORBA::tk_longdouble, CORBA::tk_Principal, 77, 0xffffffff}) {
    expect_refused(
        [kind](cdrMemoryStream& stream) {
          stream.marshalULong(kind);
          for (int i = 0; i < 15; ++i) stream.marshalULong(4);
        },
        "an unknown kind");
  }
}

TEST_F(AnyCheck, what_is_nested_beyond_reason_is_refused_at_once) {
  for (const int levels : {9, 40, 200'000}) {
    expect_refused(
        [levels](cdrMemoryStream& stream) {
          for (int i = 0; i < levels; ++i) stream.marshalULong(CORBA::tk_any);
          stream.marshalULong(CORBA::tk_null);
        },
        "an any in an any");
  }
  // sequence<sequence<...<octet>>>
  std::vector<CORBA::ULong> code{CORBA::tk_octet};
  for (int i = 0; i < 1000; ++i) {
    const auto size = static_cast<CORBA::ULong>(4 * code.size() + 8);
    code.insert(code.begin(), {CORBA::tk_sequence, size, CORBA::ULong{omni::myByteOrder}});
    code.push_back(0);
  }
  expect_refused(
      [&code](cdrMemoryStream& stream) {
        for (const CORBA::ULong word : code) stream.marshalULong(word);
      },
      "a sequence of sequences");
}

TEST_F(AnyCheck, changed_octets_end_in_a_value_or_an_exception) {
  SDOPackage::NVList list;
  list.length(4);
  RTC::TimedDoubleSeq numbers{};
  numbers.data.length(5);
  list[0u].value <<= numbers;
  list[1u].value <<= "a text";
  list[2u].value <<= OpenRTM::PORT_ERROR;
  CORBA::Any inner;
  inner <<= RTC::TimedWString{};
  list[3u].value <<= inner;
  cdrMemoryStream whole;
  list >>= whole;
  std::vector<CORBA::Octet> good(whole.bufSize());
  std::memcpy(good.data(), whole.bufPtr(), good.size());
  const auto trace = std::exchange(omniORB::traceLevel, 0);
  std::mt19937 random(20261121);
  int values = 0;
  for (int run = 0; run < 20'000; ++run) {
    std::vector<CORBA::Octet> octets = good;
    for (unsigned n = random() % 3 + 1; n > 0; --n) {
      const auto at = random() % octets.size();
      if (random() % 2) {
        octets[at] = static_cast<CORBA::Octet>(random());
      } else if (at + 4 <= octets.size()) {
        const CORBA::ULong lengths[] = {0, 1, 0x7fffffff, 0x80000000, 0xffffffff, 0xfffffffc};
        std::memcpy(&octets[at / 4 * 4], &lengths[random() % 6], 4);
      }
    }
    octets.resize(octets.size() - random() % 8 / 7 * (random() % octets.size()));
    std::vector<double> aligned(octets.size() / 8 + 1);
    std::memcpy(aligned.data(), octets.data(), octets.size());
    cdrMemoryStream stream(aligned.data(), octets.size());
    SDOPackage::NVList arrived;
    try {
      arrived <<= stream;
      ++values;
    } catch (const CORBA::SystemException&) {
    }
  }
  omniORB::traceLevel = trace;
  EXPECT_GT(values, 1000);
  EXPECT_LT(values, 19'000);
}

}  // namespace
