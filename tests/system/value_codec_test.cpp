#include "system/value_codec.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "support/paths.h"
#include "system/typed_value.h"

namespace tools {
namespace {

using Json = nlohmann::ordered_json;

std::vector<unsigned char> bytes_of(const std::string& hex) {
  std::vector<unsigned char> bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2) bytes.push_back(static_cast<unsigned char>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  return bytes;
}

Json golden() {
  std::ifstream in(std::string(paths::source_dir) + "/tests/golden/cdr_payloads.json");
  return Json::parse(in);
}

const CORBA::TypeCode_ptr timed_long = type_code_of("IDL:RTC/TimedLong:1.0");

TEST(ValueCodec, every_recorded_payload_is_read_in_both_byte_orders) {
  int types = 0;
  for (const auto& entry : golden()) {
    const auto type = type_code_of(entry["type"].get<std::string>());
    ASSERT_FALSE(CORBA::is_nil(type)) << entry["type"];
    for (const bool little : {true, false}) {
      const auto value = decode(type, bytes_of(entry[little ? "little_endian" : "big_endian"].get<std::string>()), little);
      ASSERT_TRUE(value.ok()) << value.error().message;
      EXPECT_EQ(*value, entry["value"]) << entry["type"];
    }
    ++types;
  }
  EXPECT_EQ(types, 126);
}

TEST(ValueCodec, what_is_encoded_reads_back_the_same) {
  for (const auto& entry : golden()) {
    const auto type = type_code_of(entry["type"].get<std::string>());
    for (const bool little : {true, false}) {
      const auto payload = encode(type, entry["value"], little);
      ASSERT_TRUE(payload.ok()) << payload.error().message;
      EXPECT_EQ(payload->size(), bytes_of(entry["little_endian"].get<std::string>()).size()) << entry["type"];
      const auto value = decode(type, *payload, little);
      ASSERT_TRUE(value.ok()) << value.error().message;
      EXPECT_EQ(*value, entry["value"]) << entry["type"];
    }
  }
}

TEST(ValueCodec, every_type_of_ports_has_a_default_that_reads_back_the_same) {
  const auto ids = known_data_types();
  EXPECT_GE(ids.size(), 126u);
  for (const auto& id : ids) {
    for (const bool little : {true, false}) {
      const auto payload = encode(type_code_of(id), Json(), little);
      ASSERT_TRUE(payload.ok()) << payload.error().message;
      const auto value = decode(type_code_of(id), *payload, little);
      ASSERT_TRUE(value.ok()) << value.error().message;
      EXPECT_EQ(*encode(type_code_of(id), *value, little), *payload) << id;
      // What print writes is what inject takes.
      EXPECT_EQ(*parse_value(type_code_of(id), value->dump(), 0), *value) << id;
    }
  }
}

TEST(ValueCodec, payloads_cut_anywhere_are_refused) {
  for (const auto& entry : golden()) {
    const auto type = type_code_of(entry["type"].get<std::string>());
    const auto whole = bytes_of(entry["little_endian"].get<std::string>());
    for (std::size_t length = 0; length < whole.size(); ++length) {
      const auto value = decode(type, std::span(whole).first(length));
      EXPECT_FALSE(value.ok()) << entry["type"] << " cut to " << length;
    }
  }
}

TEST(ValueCodec, wild_lengths_are_refused) {
  const auto type = type_code_of("IDL:RTC/TimedDoubleSeq:1.0");
  const auto value = decode(type, bytes_of("0100000002000000ffffffff0000000000000000"));
  ASSERT_FALSE(value.ok());
  EXPECT_NE(value.error().message.find("4294967295"), std::string::npos) << value.error().message;
}

TEST(ValueCodec, a_bare_number_is_the_data_of_a_timed_type) {
  const auto value = parse_value(timed_long, "42", 5'000'000'007);
  ASSERT_TRUE(value.ok());
  EXPECT_EQ(*value, Json::parse(R"({"data": 42, "tm": {"sec": 5, "nsec": 7}})"));
}

TEST(ValueCodec, the_data_members_may_stand_alone) {
  const auto value = parse_value(type_code_of("IDL:RTC/TimedVelocity2D:1.0"), R"({"vx": 0.2})", 0);
  ASSERT_TRUE(value.ok());
  EXPECT_EQ((*value)["data"], Json::parse(R"({"vx": 0.2})"));
}

TEST(ValueCodec, the_form_of_rtinject_is_understood) {
  const auto value =
      parse_value(type_code_of("IDL:RTC/TimedVelocity2D:1.0"), "RTC.TimedVelocity2D({time}, RTC.Velocity2D(0.25, 0, -1))", 3'000'000'000);
  ASSERT_TRUE(value.ok()) << value.error().message;
  EXPECT_EQ((*value)["tm"]["sec"], 3);
  EXPECT_EQ((*value)["data"]["vx"], 0.25);
  EXPECT_EQ((*value)["data"]["va"], -1);
  const auto sequence = parse_value(type_code_of("IDL:RTC/TimedStringSeq:1.0"), "RTC.TimedStringSeq(RTC.Time(1, 2), ['a', \"b\\'\"])", 0);
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  EXPECT_EQ((*sequence)["data"], (Json{"a", "b'"}));
}

TEST(ValueCodec, wrong_values_are_refused_by_name) {
  const auto refused = [](const char* type, const char* text, const char* word) {
    const auto code = type_code_of(type);
    const auto value = parse_value(code, text, 0);
    const auto payload = value ? encode(code, *value) : base::Result<std::vector<unsigned char>>(value.error());
    ASSERT_FALSE(payload.ok()) << text;
    EXPECT_NE(payload.error().message.find(word), std::string::npos) << payload.error().message;
  };
  refused("IDL:RTC/TimedShort:1.0", "70000", "32767");
  refused("IDL:RTC/TimedOctet:1.0", "-1", "255");
  refused("IDL:RTC/TimedLong:1.0", R"({"dato": 1})", "dato");
  refused("IDL:RTC/TimedLong:1.0", "RTC.TimedLong({time}, 1, 2)", "members");
  refused("IDL:RTC/TimedLong:1.0", "RTC.TimedLong({time}", "expected");
  refused("IDL:RTC/TimedDouble:1.0", "\"x\"", "number");
  refused("IDL:RTC/GPSData:1.0", R"({"fixType": "GPS_FIX_MAYBE"})", "GPS_FIX_NONE");
}

TEST(ValueCodec, unknown_types_are_nil) { EXPECT_TRUE(CORBA::is_nil(type_code_of("IDL:RTC/Nothing:1.0"))); }

TEST(Members, are_looked_up_in_the_type) {
  const auto problem = [](const char* type, std::vector<std::string> path) {
    return member_problem("IDL:RTC/" + std::string(type) + ":1.0", path);
  };
  EXPECT_EQ(problem("TimedVelocity2D", {"data", "vx"}), "");
  EXPECT_EQ(problem("TimedVelocity2D", {"tm", "sec"}), "");
  EXPECT_EQ(problem("TimedVelocity2D", {"data", "nope"}), "data.vx, data.vy, data.va");
  EXPECT_EQ(problem("TimedVelocity2D", {"data"}), "data.vx, data.vy, data.va");
  EXPECT_EQ(problem("TimedVelocity2D", {"data", "vx", "0"}), "no more");
  EXPECT_EQ(problem("TimedDoubleSeq", {"data", "1000"}), "");
  EXPECT_EQ(problem("TimedDoubleSeq", {"data", "x"}), "data[0]");
  EXPECT_EQ(problem("TimedDoubleSeq", {"data"}), "data[0]");
  EXPECT_EQ(problem("TimedString", {"data"}), "no more");
  EXPECT_EQ(problem("NobodyKnows", {"data"}), "");
}

}  // namespace
}  // namespace tools
