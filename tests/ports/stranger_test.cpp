// This thread works for another account, and the peer is a process of ours that is closed (corba/orb/principal.h).
#include <gtest/gtest.h>

#include "corba/orb/principal.h"
#include "ports/support.h"

namespace {

using ports::profile;

class Stranger : public testing::Test {
 protected:
  std::unique_ptr<corba::Orb> orb = ports::start_orb();
  RTC::TimedOctetSeq sent{};
  RTC::OutPort<RTC::TimedOctetSeq> out{"A0.out", sent};
  ports::Peer peer;
  RTC::PortService_var theirs = peer.port("in");
};

TEST_F(Stranger, no_call_is_let_in_and_the_next_one_of_ours_is) {
  {
    const corba::OnBehalfOf stranger(corba::Principal::host);
    EXPECT_THROW(RTC::PortProfile_var(theirs->get_port_profile()), CORBA::NO_PERMISSION);
    EXPECT_FALSE(corba::may_keep(theirs));
    EXPECT_TRUE(corba::may_keep(out.getPortRef()));
    EXPECT_TRUE(corba::may_keep(CORBA::Object::_nil()));
  }
  EXPECT_NO_THROW(RTC::PortProfile_var(theirs->get_port_profile()));
  EXPECT_TRUE(corba::may_keep(theirs));
}

// One of this process is nobody's gift, and one that was refused may be one of ours.
TEST_F(Stranger, only_what_is_taken_from_strangers_is_theirs) {
  {
    const corba::OnBehalfOf stranger(corba::Principal::network);
    EXPECT_TRUE(corba::may_keep(out.getPortRef()));
    EXPECT_FALSE(corba::may_keep(theirs));
  }
  EXPECT_EQ(corba::sender_of(out.getPortRef()), corba::Principal::own);
  EXPECT_EQ(corba::sender_of(theirs), corba::Principal::own);
  EXPECT_EQ(corba::sender_of(CORBA::Object::_nil()), corba::Principal::own);
}

TEST_F(Stranger, no_connection_leads_there) {
  auto plan = profile({out.getPortRef(), theirs});
  auto back = profile({theirs, out.getPortRef()});
  auto told = profile({theirs, out.getPortRef()}, {}, "told");
  {
    const corba::OnBehalfOf stranger(corba::Principal::network);
    EXPECT_NE(out.connect(plan), RTC::RTC_OK);
    EXPECT_NE(out.connect(back), RTC::RTC_OK);
    EXPECT_NE(out.notify_connect(told), RTC::RTC_OK);  // as the last of the chain
  }
  EXPECT_EQ(out.get_connector_profiles()->length(), 0U);
  auto ours = profile({out.getPortRef(), theirs});
  EXPECT_EQ(out.connect(ours), RTC::RTC_OK);
}

// Whoever has seen a connection of ours knows where the other port takes its samples.
TEST_F(Stranger, no_reference_in_a_profile_leads_there) {
  auto ours = profile({out.getPortRef(), theirs});
  ASSERT_EQ(out.connect(ours), RTC::RTC_OK);
  const auto inlet = NVUtil::toString(ours.properties, "dataport.corba_cdr.inport_ior");
  ASSERT_FALSE(inlet.empty());
  RTC::OutPort<RTC::TimedOctetSeq> other("A0.other", sent);
  RTC::TimedOctetSeq received{};
  RTC::InPort<RTC::TimedOctetSeq> in("A0.in", received);
  const auto told = [&](const char* id) {
    auto plan = profile({in.getPortRef(), other.getPortRef()}, {{"corba_cdr.inport_ior", inlet}}, id);
    return other.notify_connect(plan);
  };
  {
    const corba::OnBehalfOf stranger(corba::Principal::certificate);
    EXPECT_NE(told("theirs"), RTC::RTC_OK);
  }
  EXPECT_EQ(told("ours"), RTC::RTC_OK);
}

}  // namespace
