#include "core/connector_settings.h"

#include <gtest/gtest.h>

namespace rt {
namespace {

ConnectorSettingsOutcome read(KeyValues values, Side side = Side::in) {
  values.try_emplace("dataport.interface_type", "corba_cdr");
  values.try_emplace("dataport.dataflow_type", "push");
  return read_connector_settings(values, side);
}

TEST(ConnectorSettings, defaults_are_those_of_the_wire) {
  const auto outcome = read({});
  EXPECT_EQ(outcome.refusal.code, ReturnCode::ok);
  EXPECT_EQ(outcome.settings.subscription, Subscription::flush);
  EXPECT_EQ(outcome.settings.buffer.length, 8u);
  EXPECT_EQ(outcome.settings.buffer.full, FullPolicy::overwrite);
  EXPECT_EQ(outcome.settings.buffer.empty, EmptyPolicy::readback);
  EXPECT_EQ(outcome.settings.publisher.policy, PushPolicy::newest);
  EXPECT_EQ(outcome.settings.order, ByteOrder::little);
  EXPECT_FALSE(outcome.settings.allows_duplicate);
}

TEST(ConnectorSettings, transports_of_authors_are_known_by_their_names) {
  const KeyValues values = {{"dataport.interface_type", "pigeon"}, {"dataport.dataflow_type", "pull"}};
  const auto known = read_connector_settings(values, Side::out, {"owl", "pigeon"});
  EXPECT_EQ(known.refusal.code, ReturnCode::ok);
  EXPECT_EQ(known.settings.interface, Interface::foreign);
  EXPECT_EQ(known.settings.foreign_interface, "pigeon");
  const auto unknown = read_connector_settings(values, Side::out, {"owl"});
  EXPECT_EQ(unknown.refusal.code, ReturnCode::bad_parameter);
  EXPECT_EQ(unknown.refusal.reason,
            "dataport.interface_type must be corba_cdr, data_service, shared_memory, owl or direct, got \"pigeon\"");
  // Nobody takes the place of ours.
  EXPECT_EQ(read_connector_settings({{"dataport.interface_type", "direct"}, {"dataport.dataflow_type", "push"}}, Side::in, {"direct"})
                .settings.interface,
            Interface::direct);
}

TEST(ConnectorSettings, one_side_overrides_both) {
  const KeyValues values = {{"dataport.buffer.length", "3"}, {"dataport.inport.buffer.length", "5"}};
  EXPECT_EQ(read(values, Side::in).settings.buffer.length, 5u);
  EXPECT_EQ(read(values, Side::out).settings.buffer.length, 3u);
}

TEST(ConnectorSettings, what_must_be_known_is_refused_when_it_is_not) {
  EXPECT_EQ(read({{"dataport.dataflow_type", ""}}).refusal.code, ReturnCode::bad_parameter);
  EXPECT_EQ(read({{"dataport.dataflow_type", "duplex"}}).refusal.code, ReturnCode::bad_parameter);
  EXPECT_EQ(read({{"dataport.interface_type", "corba_any"}}).refusal.code, ReturnCode::bad_parameter);
  EXPECT_EQ(read({{"dataport.serializer.cdr.endian", "middle"}}).refusal.code, ReturnCode::unsupported);
  EXPECT_EQ(read({{"dataport.buffer_type", "ring_buffer"}}).refusal.code, ReturnCode::ok);
  EXPECT_EQ(read({{"dataport.buffer_type", "my_buffer"}}).refusal.code, ReturnCode::error);
  EXPECT_EQ(read({{"dataport.marshaling_type", " xml "}}).settings.marshaling, "xml") << "the port knows which there are";
  for (const char* rate : {"", "0", "-1", "nan", "inf", "1e300", "x"}) {
    EXPECT_EQ(read({{"dataport.subscription_type", "periodic"}, {"dataport.publisher.push_rate", rate}}).refusal.code,
              ReturnCode::bad_parameter)
        << rate;
  }
}

TEST(ConnectorSettings, dataflow_is_read_without_case_and_blanks) {
  EXPECT_EQ(read({{"dataport.dataflow_type", " Pu ll "}}).settings.dataflow, Dataflow::pull);
}

TEST(ConnectorSettings, nonsense_in_the_rest_keeps_the_default_with_a_warning) {
  const auto outcome = read({{"dataport.buffer.length", "-3"},
                             {"dataport.buffer.write.full_policy", "explode"},
                             {"dataport.buffer.read.timeout", "nan"},
                             {"dataport.publisher.skip_count", "99999999999999999999"},
                             {"dataport.allow_dup_connection", "perhaps"}});
  EXPECT_EQ(outcome.refusal.code, ReturnCode::ok);
  EXPECT_EQ(outcome.warnings.size(), 5u);
  EXPECT_EQ(outcome.settings.buffer.length, 8u);
}

TEST(ConnectorSettings, io_mode_names_the_subscription) {
  EXPECT_EQ(read({{"dataport.io_mode", "nonblock"}}).settings.subscription, Subscription::newest);
  EXPECT_EQ(read({{"dataport.io_mode", "block"}, {"dataport.subscription_type", "new"}}).settings.subscription, Subscription::flush);
}

TEST(ConnectorSettings, push_rate_has_an_old_name) {
  const auto outcome = read({{"dataport.subscription_type", "periodic"}, {"dataport.push_rate", "10"}});
  EXPECT_EQ(outcome.settings.publisher.period, std::chrono::milliseconds(100));
  EXPECT_EQ(read({{"dataport.subscription_type", "periodic"}, {"dataport.push_rate", "fast"}}).refusal.reason,
            "dataport.push_rate must be a rate above 0 [Hz] for periodic subscriptions, got \"fast\"");
}

TEST(ConnectorSettings, a_push_rate_that_is_not_used_is_a_number_all_the_same) {
  EXPECT_EQ(read({{"dataport.subscription_type", "new"}, {"dataport.push_rate", "0"}}).warnings, std::vector<std::string>{});
  for (const char* key : {"publisher.push_rate", "push_rate"}) {
    const auto outcome = read({{"dataport.subscription_type", "new"}, {std::string("dataport.") + key, "nan"}});
    EXPECT_EQ(outcome.refusal.code, ReturnCode::ok);
    EXPECT_EQ(outcome.warnings, std::vector<std::string>{std::string("dataport.") + key + " must be a rate [Hz], got \"nan\""});
  }
}

TEST(ConnectorSettings, sizes_have_units) {
  EXPECT_EQ(parse_size("8M"), std::size_t{8} << 20);
  EXPECT_EQ(parse_size("64k"), 65536u);
  EXPECT_EQ(parse_size("99999999999M"), std::nullopt);
  EXPECT_EQ(parse_size("M"), std::nullopt);
}

TEST(ConnectorSettings, types_are_the_same_under_all_their_names) {
  EXPECT_TRUE(are_compatible_types("IDL:RTC/TimedLong:1.0", "RTC::TimedLong"));
  EXPECT_TRUE(are_compatible_types("TimedLong", "IDL:RTC/TimedLong:1.0"));
  EXPECT_TRUE(are_compatible_types("", "IDL:RTC/TimedLong:1.0"));
  EXPECT_TRUE(are_compatible_types("Any", "IDL:RTC/TimedLong:1.0"));
  EXPECT_FALSE(are_compatible_types("IDL:RTC/TimedLong:1.0", "IDL:RTC/TimedShort:1.0"));
  EXPECT_FALSE(are_compatible_types("IDL:RTC/X:1.0", "IDL:Img/X:1.0"));
}

}  // namespace
}  // namespace rt
