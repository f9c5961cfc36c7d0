// Functions that work on components, contexts and ports by reference, of this process or another. Any thread; each call may take the ORB's
// call timeout when the peer hangs. CORBA exceptions become BAD_PARAMETER (nil or dead reference) or RTC_ERROR.
#pragma once

#include <rtm/NVUtil.h>
#include <rtm/RTC.h>

#include <coil/Properties.h>
#include <coil/stringutil.h>

#include <string>

namespace CORBA_RTCUtil {

using RTC::ReturnCode_t;
using RTC::UniqueId;

coil::Properties get_component_profile(const RTC::RTObject_ptr rtc);
bool is_existing(const RTC::RTObject_ptr rtc);
// In its context `ec_id`; handles are those of get_actual_ec.
bool is_alive_in_default_ec(const RTC::RTObject_ptr rtc);
// Owned contexts from 0, participating ones from 1000. The caller releases the reference; nil if there is none.
RTC::ExecutionContext_ptr get_actual_ec(const RTC::RTObject_ptr rtc, UniqueId ec_id = 0);
// -1 if the context does not belong to the component.
UniqueId get_ec_id(const RTC::RTObject_ptr rtc, const RTC::ExecutionContext_ptr ec);
ReturnCode_t activate(const RTC::RTObject_ptr rtc, UniqueId ec_id = 0);
ReturnCode_t deactivate(const RTC::RTObject_ptr rtc, UniqueId ec_id = 0);
ReturnCode_t reset(const RTC::RTObject_ptr rtc, UniqueId ec_id = 0);
// False if the context cannot be asked.
bool get_state(RTC::LifeCycleState& state, const RTC::RTObject_ptr rtc, UniqueId ec_id = 0);
bool is_in_inactive(const RTC::RTObject_ptr rtc, UniqueId ec_id = 0);
bool is_in_active(const RTC::RTObject_ptr rtc, UniqueId ec_id = 0);
bool is_in_error(const RTC::RTObject_ptr rtc, UniqueId ec_id = 0);
// -1 if it cannot be asked.
CORBA::Double get_default_rate(const RTC::RTObject_ptr rtc);
ReturnCode_t set_default_rate(const RTC::RTObject_ptr rtc, CORBA::Double rate);
CORBA::Double get_current_rate(const RTC::RTObject_ptr rtc, UniqueId ec_id);
ReturnCode_t set_current_rate(const RTC::RTObject_ptr rtc, UniqueId ec_id, CORBA::Double rate);
ReturnCode_t add_rtc_to_default_ec(const RTC::RTObject_ptr local_rtc, const RTC::RTObject_ptr other_rtc);
ReturnCode_t remove_rtc_to_default_ec(const RTC::RTObject_ptr local_rtc, const RTC::RTObject_ptr other_rtc);
RTC::RTCList get_participants_rtc(const RTC::RTObject_ptr rtc);

coil::vstring get_port_names(const RTC::RTObject_ptr rtc);
coil::vstring get_inport_names(const RTC::RTObject_ptr rtc);
coil::vstring get_outport_names(const RTC::RTObject_ptr rtc);
coil::vstring get_svcport_names(const RTC::RTObject_ptr rtc);
// With or without the instance name in front. The caller releases the reference; nil if there is none.
RTC::PortService_ptr get_port_by_name(const RTC::RTObject_ptr rtc, const std::string& port_name);
// port_url: `<instance>.<port>` of a component of this process's manager, or `rtcname://...` or `rtcloc://...` with `.<port>` at its end.
// The caller releases the reference; nil if there is none.
RTC::PortService_ptr get_port_by_url(const std::string& port_url);
coil::vstring get_connector_names(const RTC::PortService_ptr port);
coil::vstring get_connector_names(const RTC::RTObject_ptr rtc, const std::string& port_name);
coil::vstring get_connector_names_by_portref(const RTC::PortService_ptr port);
coil::vstring get_connector_ids(const RTC::PortService_ptr port);
coil::vstring get_connector_ids(const RTC::RTObject_ptr rtc, const std::string& port_name);
coil::vstring get_connector_ids_by_portref(const RTC::PortService_ptr port);

// A profile for connect: properties become dataport.*, with corba_cdr, push (for data ports) where nothing is said.
RTC::ConnectorProfile_var create_connector(const std::string& name, const coil::Properties& properties, const RTC::PortService_ptr port0,
                                           const RTC::PortService_ptr port1);
RTC::ConnectorProfile_var create_connector(const std::string& name, const coil::Properties& properties, const RTC::PortServiceList& ports);
bool already_connected(const RTC::PortService_ptr port0, const RTC::PortService_ptr port1);
ReturnCode_t connect(const std::string& name, const coil::Properties& properties, const RTC::PortServiceList& ports);
ReturnCode_t connect(const std::string& name, const coil::Properties& properties, const RTC::PortService_ptr port0,
                     const RTC::PortService_ptr port1);
// One connection from the port to each of the others.
ReturnCode_t connect_multi(const std::string& name, const coil::Properties& properties, const RTC::PortService_ptr port,
                           const RTC::PortServiceList& targets);
ReturnCode_t connect_by_name(const std::string& name, const coil::Properties& properties, const RTC::RTObject_ptr rtc0,
                             const std::string& port_name0, const RTC::RTObject_ptr rtc1, const std::string& port_name1);
ReturnCode_t disconnect(const RTC::ConnectorProfile& profile);
// Ports by reference or by URL, as get_port_by_url takes it.
ReturnCode_t disconnect_connector_name(const RTC::PortService_ptr port, const std::string& connector_name);
ReturnCode_t disconnect_connector_name(const std::string& port_url, const std::string& connector_name);
ReturnCode_t disconnect_connector_id(const RTC::PortService_ptr port, const std::string& connector_id);
ReturnCode_t disconnect_connector_id(const std::string& port_url, const std::string& connector_id);
ReturnCode_t disconnect_all(const RTC::PortService_ptr port);
ReturnCode_t disconnect_all(const std::string& port_url);
// The same under the names of other languages.
ReturnCode_t disconnect_by_portref_connector_name(const RTC::PortService_ptr port, const std::string& connector_name);
ReturnCode_t disconnect_by_portref_connector_id(const RTC::PortService_ptr port, const std::string& connector_id);
ReturnCode_t disconnect_all_by_ref(const RTC::PortService_ptr port);
ReturnCode_t disconnect_by_portname_connector_name(const std::string& port_name, const std::string& connector_name);
ReturnCode_t disconnect_by_portname_connector_id(const std::string& port_name, const std::string& connector_id);
ReturnCode_t disconnect_all_by_name(const std::string& port_name);

coil::Properties get_configuration(const RTC::RTObject_ptr rtc, const std::string& set_name);
coil::Properties get_active_configuration(const RTC::RTObject_ptr rtc);
std::string get_parameter_by_key(const RTC::RTObject_ptr rtc, const std::string& set_name, const std::string& key);
std::string get_active_configuration_name(const RTC::RTObject_ptr rtc);
// Sets one value (in the active set) and, where that set is the active one, activates it again.
bool set_configuration(const RTC::RTObject_ptr rtc, const std::string& set_name, const std::string& key, const std::string& value);
bool set_active_configuration(const RTC::RTObject_ptr rtc, const std::string& key, const std::string& value);

}  // namespace CORBA_RTCUtil
