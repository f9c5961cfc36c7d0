#include <gtest/gtest.h>
#include <rtm/InPort.h>
#include <rtm/OutPort.h>
#include <rtm/NVUtil.h>
#include <rtm/CORBA_SeqUtil.h>
#include <rtm/idl/BasicDataTypeSkel.h>
#include "corba/orb.h"
TEST(First, flush) {
  auto orb = corba::Orb::start();
  ASSERT_TRUE(orb.ok());
  (*orb)->activate();
  for (std::string interface : {"corba_cdr", "data_service", "direct", "shared_memory"}) for (std::string flow : {"push", "pull"}) {
    SCOPED_TRACE(interface + flow);
    RTC::TimedLong a{}, b{};
    RTC::OutPort<RTC::TimedLong> out("a0.out", a);
    RTC::InPort<RTC::TimedLong> in("b0.in", b);
    RTC::ConnectorProfile p;
    p.name = "c"; p.connector_id = "";
    p.ports.length(2);
    p.ports[0] = RTC::PortService::_duplicate(out.getPortRef());
    p.ports[1] = RTC::PortService::_duplicate(in.getPortRef());
    CORBA_SeqUtil::push_back(p.properties, NVUtil::newNV("dataport.dataflow_type", flow.c_str()));
    CORBA_SeqUtil::push_back(p.properties, NVUtil::newNV("dataport.interface_type", interface.c_str()));
    ASSERT_EQ(out.connect(p), RTC::RTC_OK);
    EXPECT_FALSE(in.isNew());
    a.data = 42;
    EXPECT_TRUE(out.write());
    EXPECT_TRUE(in.isNew());
    EXPECT_TRUE(in.read());
    EXPECT_EQ(b.data, 42);
    std::cout << NVUtil::toString(p.properties);
    EXPECT_EQ(in.disconnect(p.connector_id), RTC::RTC_OK);
    EXPECT_FALSE(out.write());
    EXPECT_EQ(in.disconnect(p.connector_id), RTC::BAD_PARAMETER);
  }
}
