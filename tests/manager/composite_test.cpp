// Composites: from rtc.conf, and over the wire as rtcomp and RTSystemEditor make them, with members in another process.
#include <gtest/gtest.h>
#include <rtm/CORBA_RTCUtil.h>
#include <rtm/NVUtil.h>

#include <fstream>

#include "manager/rtcd_fixture.h"
#include "support/silence.h"

namespace manager_test {
namespace {

using namespace std::chrono_literals;
using Strings = std::set<std::string>;

Strings port_names(RTC::RTObject_ptr component) {
  const auto names = CORBA_RTCUtil::get_port_names(component);
  return {names.begin(), names.end()};
}

RTC::ExecutionContext_var own_context(RTC::RTObject_ptr component) {
  RTC::ExecutionContextList_var list = component->get_owned_contexts();
  return list->length() > 0 ? RTC::ExecutionContext::_duplicate(list[0]) : RTC::ExecutionContext::_nil();
}

RTC::LifeCycleState state_in(RTC::ExecutionContext_ptr context, RTC::RTObject_ptr component) {
  return context->get_component_state(component);
}

SDOPackage::SDOList sdos(std::initializer_list<RTC::RTObject_ptr> components) {
  SDOPackage::SDOList list;
  list.length(static_cast<CORBA::ULong>(components.size()));
  CORBA::ULong i = 0;
  for (RTC::RTObject_ptr component : components) list[i++] = SDOPackage::SDO::_duplicate(component);
  return list;
}

SDOPackage::Organization_var organization_of(RTC::RTObject_ptr composite) {
  SDOPackage::OrganizationList_var list = composite->get_owned_organizations();
  return list->length() == 1 ? SDOPackage::Organization::_duplicate(list[0]) : SDOPackage::Organization::_nil();
}

Strings member_ids(SDOPackage::Organization_ptr organization) {
  SDOPackage::SDOList_var list = organization->get_members();
  Strings ids;
  for (CORBA::ULong i = 0; i < list->length(); ++i)
    ids.insert(CORBA::String_var(SDOPackage::SDO_var(SDOPackage::SDO::_duplicate(list[i]))->get_sdo_id()).in());
  return ids;
}

// As tools change the exported ports: the value of the active set, then the set made active again.
void export_ports(RTC::RTObject_ptr composite, const std::string& ports) {
  SDOPackage::Configuration_var configuration = composite->get_configuration();
  SDOPackage::ConfigurationSet_var set = configuration->get_active_configuration_set();
  CORBA::Any value;
  value <<= ports.c_str();
  NVUtil::setValue(set->configuration_data, "exported_ports", value);
  ASSERT_TRUE(configuration->set_configuration_set_values(set));
  ASSERT_TRUE(configuration->activate_configuration_set(set->id));
}

class Composite : public Rtcd {
 protected:
  std::vector<std::string> members_command(const std::vector<std::string>& further) const {
    auto words = command({"-o", "manager.instance_name:members", "-o", "manager.naming_formats:members.mgr"});
    words.insert(words.end(), further.begin(), further.end());
    return words;
  }
  RTC::RTObject_var wait_for(const std::string& name) const {
    EXPECT_TRUE(eventually([&] { return has(name); })) << name;
    return component(name);
  }
};

TEST_F(Composite, rtc_conf_makes_one_of_local_and_of_distant_members) {
  support::TemporaryFolder folder;
  support::Process far(members_command({"SourceAll?instance_name=Far"}));
  wait_for("Far.rtc");
  const auto file = (folder.path() / "rtc.conf").string();
  std::ofstream(file) << "corba.nameservers: " << names_.address() << "\nnaming.formats: %n.rtc\nmanager.modules.load_path: " << modules
                      << "\nmanager.components.precreate: SourceAll?instance_name=Near, SinkAll?instance_name=Sink,"
                         "PeriodicECSharedComposite?instance_name=Both\n"
                         "composite.PeriodicECShared.Both.conf.default.members: Near, rtcname://*/Far\n"
                         "composite.PeriodicECShared.Both.conf.default.exported_ports: Near.long, Far.double\n"
                         "composite.PeriodicECShared.Both.exec_cxt.periodic.rate: 100\n"
                         "manager.components.preconnect: Both.Near.long?port=Sink.long, Both.Far.double?port=Sink.double\n"
                         "manager.components.preactivation: Sink, Both\n";
  support::Process rtcd({program, "-f", file});
  ASSERT_TRUE(rtcd.wait_for_output("long: 2")) << rtcd.output();
  ASSERT_TRUE(rtcd.wait_for_output("double: 2")) << rtcd.output();
  RTC::RTObject_var both = component("Both.rtc");
  EXPECT_EQ(port_names(both), (Strings{"Near.long", "Far.double"}));
  EXPECT_EQ(member_ids(organization_of(both)), (Strings{"Near", "Far"}));
  RTC::RTObject_var member = component("Far.rtc");
  EXPECT_EQ(state_in(own_context(both), member), RTC::ACTIVE_STATE);
  EXPECT_FALSE(own_context(member)->is_running());
  EXPECT_EQ(rtcd.stop(), 0) << rtcd.output();
  // Its life is its own again.
  EXPECT_TRUE(own_context(member)->is_running());
  RTC::ExecutionContextList_var foreign = member->get_participating_contexts();
  EXPECT_EQ(foreign->length(), 0u);
  EXPECT_EQ(far.stop(), 0) << far.output();
}

TEST_F(Composite, tools_make_change_and_take_one_apart_over_the_wire) {
  const int port = support::free_port();
  support::Process boss(command({"-p", std::to_string(port)}));
  support::Process far(members_command({"SourceAll?instance_name=A", "FailOnRequest?instance_name=F", "SinkAll?instance_name=Sink"}));
  RTM::Manager_var manager = manager_at(port);
  ASSERT_FALSE(CORBA::is_nil(manager)) << boss.output();
  RTC::RTObject_var a = wait_for("A.rtc");
  RTC::RTObject_var f = wait_for("F.rtc");
  RTC::RTObject_var sink = wait_for("Sink.rtc");
  RTC::RTObject_var composite = manager->create_component("PeriodicECSharedComposite?&instance_name=Whole&exec_cxt.periodic.rate=100");
  ASSERT_FALSE(CORBA::is_nil(composite)) << boss.output();
  SDOPackage::Organization_var organization = organization_of(composite);
  ASSERT_FALSE(CORBA::is_nil(organization));
  SDOPackage::SDOSystemElement_var owner = organization->get_owner();
  EXPECT_TRUE(owner->_is_equivalent(composite));
  RTC::ExecutionContext_var shared = own_context(composite);

  // Members come: their own contexts stop, they take part in the composite's, and know where they belong.
  EXPECT_TRUE(organization->add_members(sdos({a, f})));
  EXPECT_EQ(member_ids(organization), (Strings{"A", "F"}));
  for (RTC::RTObject_ptr member : {a.in(), f.in()}) {
    EXPECT_FALSE(own_context(member)->is_running());
    SDOPackage::OrganizationList_var organizations = member->get_organizations();
    EXPECT_EQ(organizations->length(), 1u);
    RTC::ExecutionContextList_var foreign = member->get_participating_contexts();
    ASSERT_EQ(foreign->length(), 1u);
    EXPECT_TRUE(foreign[0]->_is_equivalent(shared));
    EXPECT_EQ(state_in(shared, member), RTC::INACTIVE_STATE);
  }
  EXPECT_TRUE(organization->add_members(sdos({a})));  // again: nothing changes
  EXPECT_EQ(member_ids(organization).size(), 2u);

  // Ports are lent, also while everything runs.
  EXPECT_EQ(port_names(composite), Strings());
  export_ports(composite, "A.long,A.double");
  EXPECT_EQ(port_names(composite), (Strings{"A.long", "A.double"}));
  RTC::PortService_var out = CORBA_RTCUtil::get_port_by_name(composite, "A.long");
  RTC::PortService_var in = CORBA_RTCUtil::get_port_by_name(sink, "long");
  EXPECT_EQ(CORBA_RTCUtil::connect("x", {}, out, in), RTC::RTC_OK);
  EXPECT_EQ(CORBA_RTCUtil::activate(sink), RTC::RTC_OK);
  EXPECT_EQ(CORBA_RTCUtil::activate(composite), RTC::RTC_OK);
  EXPECT_TRUE(eventually([&] { return state_in(shared, a) == RTC::ACTIVE_STATE && state_in(shared, f) == RTC::ACTIVE_STATE; }));
  EXPECT_TRUE(far.wait_for_output("long: 2")) << far.output();
  export_ports(composite, "A.float,A.long");
  EXPECT_EQ(port_names(composite), (Strings{"A.float", "A.long"}));
  EXPECT_EQ(CORBA_RTCUtil::get_connector_names_by_portref(out).size(), 1u);  // what stays exported stays connected
  EXPECT_EQ(state_in(shared, a), RTC::ACTIVE_STATE);

  // A member that fails is in its error state alone, and is reset in the composite's context.
  CORBA_RTCUtil::set_configuration(f, "default", "fail_in", "onExecute");
  EXPECT_TRUE(eventually([&] { return state_in(shared, f) == RTC::ERROR_STATE; })) << far.output();
  EXPECT_EQ(state_in(shared, a), RTC::ACTIVE_STATE);
  EXPECT_EQ(state_in(shared, composite), RTC::ACTIVE_STATE);
  CORBA_RTCUtil::set_configuration(f, "default", "fail_in", "");
  EXPECT_EQ(shared->reset_component(f), RTC::RTC_OK);
  EXPECT_TRUE(eventually([&] { return state_in(shared, f) == RTC::INACTIVE_STATE; }));

  // Members go.
  EXPECT_TRUE(organization->remove_member("F"));
  EXPECT_THROW(organization->remove_member("F"), SDOPackage::InvalidParameter);
  EXPECT_TRUE(own_context(f)->is_running());
  EXPECT_EQ(member_ids(organization), Strings{"A"});
  EXPECT_TRUE(organization->set_members(sdos({f})));
  EXPECT_EQ(member_ids(organization), Strings{"F"});
  EXPECT_TRUE(own_context(a)->is_running());
  EXPECT_FALSE(own_context(f)->is_running());
  EXPECT_EQ(state_in(shared, a), RTC::CREATED_STATE);
  EXPECT_EQ(port_names(composite), Strings());
  SDOPackage::OrganizationList_var organizations = a->get_organizations();
  EXPECT_EQ(organizations->length(), 0u);
  EXPECT_THROW(organization->add_members(sdos({RTC::RTObject::_nil()})), SDOPackage::InvalidParameter);

  EXPECT_EQ(CORBA_RTCUtil::deactivate(composite), RTC::RTC_OK);
  EXPECT_EQ(manager->delete_component("Whole"), RTC::RTC_OK);
  EXPECT_TRUE(own_context(f)->is_running());
  EXPECT_TRUE(eventually([&] { return !has("Whole.rtc"); }));
  EXPECT_EQ(far.stop(), 0) << far.output();
}

TEST_F(Composite, rtc_conf_makes_none_that_is_a_member_of_itself) {
  support::Process rtcd(command({"SourceAll?instance_name=Near", "SinkAll?instance_name=Other",
                                 "PeriodicECSharedComposite?instance_name=Whole&conf.default.members=Near|Whole|Other"}));
  RTC::RTObject_var whole = wait_for("Whole.rtc");
  EXPECT_EQ(member_ids(organization_of(whole)), (Strings{"Near", "Other"})) << rtcd.output();
  EXPECT_TRUE(own_context(whole)->is_running());
  EXPECT_EQ(CORBA_RTCUtil::activate(whole), RTC::RTC_OK);
  EXPECT_TRUE(rtcd.wait_for_output("no component \"Whole\" that could be a member")) << rtcd.output();
  EXPECT_EQ(rtcd.stop(), 0) << rtcd.output();
}

TEST_F(Composite, one_that_would_contain_itself_is_refused_however_long_the_way) {
  support::Process boss(command({"PeriodicECSharedComposite?instance_name=A", "PeriodicECSharedComposite?instance_name=B",
                                 "SourceAll?instance_name=S", "SourceAll?instance_name=T"}));
  support::Process far(members_command({"PeriodicECSharedComposite?instance_name=C", "SourceAll?instance_name=U"}));
  RTC::RTObject_var a = wait_for("A.rtc");
  RTC::RTObject_var b = wait_for("B.rtc");
  RTC::RTObject_var c = wait_for("C.rtc");
  RTC::RTObject_var s = wait_for("S.rtc");
  RTC::RTObject_var t = wait_for("T.rtc");
  RTC::RTObject_var u = wait_for("U.rtc");
  const auto refuses = [&](RTC::RTObject_ptr composite, const SDOPackage::SDOList& members) {
    SDOPackage::Organization_var organization = organization_of(composite);
    const Strings before = member_ids(organization);
    EXPECT_THROW(organization->add_members(members), SDOPackage::InvalidParameter);
    EXPECT_THROW(organization->set_members(members), SDOPackage::InvalidParameter);
    EXPECT_EQ(member_ids(organization), before);
    SDOPackage::OrganizationList_var organizations = t->get_organizations();
    EXPECT_EQ(organizations->length(), 0u) << "nobody of the list has joined";
    EXPECT_TRUE(own_context(t)->is_running());
  };
  EXPECT_TRUE(organization_of(a)->add_members(sdos({s})));
  refuses(a, sdos({a}));
  refuses(a, sdos({t, a}));
  EXPECT_TRUE(organization_of(c)->add_members(sdos({u})));
  EXPECT_TRUE(organization_of(b)->add_members(sdos({c})));
  refuses(c, sdos({b}));
  EXPECT_TRUE(organization_of(a)->add_members(sdos({b})));
  refuses(b, sdos({t, a}));
  refuses(c, sdos({t, a}));
  EXPECT_EQ(member_ids(organization_of(a)), (Strings{"S", "B"}));
  EXPECT_TRUE(own_context(a)->is_running());
  // Out of the way it is no circle any more.
  EXPECT_TRUE(organization_of(a)->set_members(sdos({s})));
  EXPECT_EQ(CORBA_RTCUtil::activate(a), RTC::RTC_OK);
  EXPECT_TRUE(eventually([&] { return state_in(own_context(a), s) == RTC::ACTIVE_STATE; }));
  EXPECT_EQ(CORBA_RTCUtil::deactivate(a), RTC::RTC_OK);
  EXPECT_TRUE(organization_of(b)->set_members(sdos({a})));
  EXPECT_EQ(boss.stop(), 0) << boss.output();
  EXPECT_EQ(far.stop(), 0) << far.output();
}

TEST_F(Composite, two_that_take_each_other_at_the_same_time_do_not_both_succeed) {
  support::Process boss(command({"PeriodicECSharedComposite?instance_name=A"}));
  support::Process far(members_command({"PeriodicECSharedComposite?instance_name=B"}));
  RTC::RTObject_var a = wait_for("A.rtc");
  RTC::RTObject_var b = wait_for("B.rtc");
  const auto add = [](SDOPackage::Organization_ptr organization, RTC::RTObject_ptr member) {
    try {
      organization->add_members(sdos({member}));
    } catch (const SDOPackage::InvalidParameter&) {
    }
  };
  SDOPackage::Organization_var of_a = organization_of(a);
  SDOPackage::Organization_var of_b = organization_of(b);
  for (int round = 0; round < 50; ++round) {
    std::thread other([&] { add(of_b, a); });
    add(of_a, b);
    other.join();
    ASSERT_TRUE(member_ids(of_a).empty() || member_ids(of_b).empty()) << round;
    EXPECT_TRUE(of_a->set_members(sdos({})));
    EXPECT_TRUE(of_b->set_members(sdos({})));
  }
  EXPECT_TRUE(own_context(a)->is_running());
  EXPECT_TRUE(own_context(b)->is_running());
  EXPECT_EQ(boss.stop(), 0) << boss.output();
  EXPECT_EQ(far.stop(), 0) << far.output();
}

TEST_F(Composite, a_member_that_exits_leaves_and_one_that_is_killed_costs_nothing) {
  support::Process boss(command({"PeriodicECSharedComposite?instance_name=Whole", "SourceAll?instance_name=A"}));
  support::Process far(members_command({"SourceAll?instance_name=B", "SourceAll?instance_name=C"}));
  RTC::RTObject_var composite = wait_for("Whole.rtc");
  RTC::RTObject_var a = wait_for("A.rtc");
  RTC::RTObject_var b = wait_for("B.rtc");
  RTC::RTObject_var c = wait_for("C.rtc");
  SDOPackage::Organization_var organization = organization_of(composite);
  EXPECT_TRUE(organization->set_members(sdos({a, b, c})));
  export_ports(composite, "A.long,B.long,C.long");
  EXPECT_EQ(CORBA_RTCUtil::activate(composite), RTC::RTC_OK);
  EXPECT_EQ(b->exit(), RTC::RTC_OK);
  EXPECT_TRUE(eventually([&] { return member_ids(organization) == Strings{"A", "C"}; })) << boss.output();
  EXPECT_TRUE(eventually([&] { return port_names(composite) == Strings{"A.long", "C.long"}; }));
  far.kill();
  EXPECT_TRUE(organization->remove_member("C"));
  EXPECT_EQ(member_ids(organization), Strings{"A"});
  EXPECT_EQ(port_names(composite), Strings{"A.long"});
  EXPECT_EQ(state_in(own_context(composite), a), RTC::ACTIVE_STATE);
  EXPECT_EQ(boss.stop(), 0) << boss.output();
}

TEST_F(Composite, members_live_on_when_the_composite_is_killed) {
  support::Process boss(command({"PeriodicECSharedComposite?instance_name=Whole"}));
  support::Process far(members_command({"SourceAll?instance_name=A", "SinkAll?instance_name=Sink"}));
  RTC::RTObject_var composite = wait_for("Whole.rtc");
  RTC::RTObject_var a = wait_for("A.rtc");
  SDOPackage::Organization_var organization = organization_of(composite);
  EXPECT_TRUE(organization->set_members(sdos({a})));
  EXPECT_EQ(CORBA_RTCUtil::activate(composite), RTC::RTC_OK);
  EXPECT_TRUE(eventually([&] { return state_in(own_context(composite), a) == RTC::ACTIVE_STATE; }));
  boss.kill();
  EXPECT_TRUE(eventually([&] { return own_context(a)->is_running(); })) << far.output();
  SDOPackage::OrganizationList_var organizations = a->get_organizations();
  EXPECT_EQ(organizations->length(), 0u);
  RTC::ExecutionContextList_var foreign = a->get_participating_contexts();
  EXPECT_EQ(foreign->length(), 0u);
  EXPECT_EQ(CORBA_RTCUtil::activate(a), RTC::RTC_OK);
  EXPECT_EQ(far.stop(), 0) << far.output();
}

// Whether they have died is asked of each, in the background; the end of the process waits for that.
TEST_F(Composite, members_of_many_contexts_that_hang_do_not_keep_the_process_from_ending) {
  const int port = support::free_port();
  support::Process rtcd(command({"-p", std::to_string(port), "SinkAll"}));
  ASSERT_TRUE(eventually([&] { return has("SinkAll0.rtc"); })) << rtcd.output();
  RTC::RTObject_var sink = component("SinkAll0.rtc");
  const support::Silence silence;
  for (int i = 0; i < 60; ++i) {
    const CORBA::Object_var object = silence.object(orb_->orb(), "IDL:omg.org/RTC/ExecutionContextService:1.0", i);
    ASSERT_GE(sink->attach_context(RTC::ExecutionContext_var(RTC::ExecutionContext::_unchecked_narrow(object))), 1000);
  }
  ASSERT_TRUE(silence.wait_for_caller());
  EXPECT_EQ(rtcd.stop(), 0) << rtcd.output();
}

}  // namespace
}  // namespace manager_test
