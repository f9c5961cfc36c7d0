// The PortService object: makes and ends connections along the daisy chain of the ports of a ConnectorProfile. Any thread. No lock is held
// while another port, a hook or the log is called; every call to another port has a timeout.
#pragma once

#include <atomic>
#include <condition_variable>
#include <memory>
#include <string>
#include <vector>

#include "base/guarded.h"
#include "corba/orb/call_timeout.h"
#include "corba/orb/gate.h"
#include "corba/ports/loss_handler.h"
#include "core/connector_settings.h"
#include "rtm/idl/RTCSkel.h"

namespace corba {

// What a port wants to know about a connection from its first step to its last, read once from the profile as it is when the port hears of
// it. Derived classes add their own.
struct ConnectionTerms {
  virtual ~ConnectionTerms() = default;
  bool allows_duplicate = false;  // beside another connection between the same ports
};

class PortServant : public virtual POA_RTC::PortService, public virtual PortableServer::RefCountServantBase {
 public:
  ~PortServant() override;
  PortServant(const PortServant&) = delete;
  PortServant& operator=(const PortServant&) = delete;

  RTC::PortProfile* get_port_profile() override;
  RTC::ConnectorProfileList* get_connector_profiles() override;
  // An empty profile if there is no such connection.
  RTC::ConnectorProfile* get_connector_profile(const char* connector_id) override;
  RTC::ReturnCode_t connect(RTC::ConnectorProfile& connector_profile) override;
  RTC::ReturnCode_t disconnect(const char* connector_id) override;
  RTC::ReturnCode_t disconnect_all() override;
  RTC::ReturnCode_t notify_connect(RTC::ConnectorProfile& connector_profile) override;
  RTC::ReturnCode_t notify_disconnect(const char* connector_id) override;

  // The port's reference; activates the port in its POA at the first call. Nil while there is no ORB. Borrowed, good as long as the port.
  RTC::PortService_ptr reference();
  // No call from outside is accepted after this; connections stay.
  void deactivate();
  // The same, and none is running when it returns. Connections stay. Classes that end the line of derivation call it
  // first in their destructors. Not to be called from inside a hook.
  void shut();

  // Counts those who hold the servant besides its owner: the POA until the last call has wholly ended, and whoever looks it up there.
  void _add_ref() override;
  void _remove_ref() override;

  // Removes the connection on this side without calling anyone, because the other end is gone. False if it is not there (any more).
  bool drop_connection(const char* connector_id);

  std::string port_name() const;

 protected:
  explicit PortServant(std::string name);

  // The steps of a connection, in the order in which they come; each is called without locks.
  enum class Step {
    notify_connect,
    published,
    next_connected,
    subscribed,
    connected,
    notify_disconnect,
    next_disconnected,
    unsubscribed,
    disconnected
  };
  // Fills in what the connecting client may leave out. Only the first port of a chain is asked.
  virtual void complete_profile(RTC::ConnectorProfile&) {}
  // Comes first in notify_connect; the result goes to the hooks that follow. Never null.
  virtual std::shared_ptr<ConnectionTerms> read_terms(const RTC::ConnectorProfile&) { return std::make_shared<ConnectionTerms>(); }
  // Rejects (any code but RTC_OK) or adds what the others should know.
  virtual RTC::ReturnCode_t prepare(RTC::ConnectorProfile&, const ConnectionTerms&) { return RTC::RTC_OK; }
  virtual RTC::ReturnCode_t publish(RTC::ConnectorProfile& profile, const ConnectionTerms& terms) = 0;
  virtual RTC::ReturnCode_t subscribe(const RTC::ConnectorProfile& profile, const ConnectionTerms& terms) = 0;
  // Undoes publish and subscribe, also after only one of them. `is_lost`: the other end is gone.
  virtual void unsubscribe(const RTC::ConnectorProfile& profile, bool is_lost) = 0;
  virtual void on_step(Step, RTC::ConnectorProfile&, RTC::ReturnCode_t) {}
  // Once, on the thread that has made the port an object.
  virtual void activated(RTC::PortService_ptr) {}
  // Adds to the PortProfile what may change while the port is there.
  virtual void complete(RTC::PortProfile&) const {}

  void set_port_name(const std::string& name);
  void set_owner(RTC::RTObject_ptr owner);
  void set_reference(RTC::PortService_ptr reference);
  // Sets or replaces one property of the PortProfile.
  void set_profile_property(const std::string& key, const std::string& value);
  std::string profile_property(const std::string& key) const;
  // False if there is one of that instance name, type and polarity already.
  bool add_interface(const std::string& instance, const std::string& type, RTC::PortInterfacePolarity polarity);
  bool remove_interface(const std::string& instance, RTC::PortInterfacePolarity polarity);
  RTC::PortProfile profile() const;
  // The same object, as far as can be told without calling it.
  static bool is_same(CORBA::Object_ptr a, CORBA::Object_ptr b);
  // Most connections at a time; negative: any number.
  void set_connection_limit(int limit) { connection_limit_.store(limit, std::memory_order_relaxed); }
  std::vector<RTC::ConnectorProfile> connections() const;

 private:
  struct Connection {
    RTC::ConnectorProfile profile;
    bool is_established = false;
    bool is_leaving = false;
    std::string gives_way_to{};  // the connection between the same ports that came from the other side meanwhile
  };
  struct State {
    std::string name;
    RTC::RTObject_var owner;
    RTC::PortService_var reference;
    RTC::PortInterfaceProfileList interfaces;
    RTC::NVList properties;
    std::vector<Connection> connections;

    Connection* find(std::string_view id);
  };

  // Where this port stands in the list, -1 if nowhere.
  int position(const RTC::PortServiceList& ports);
  // `starts_the_chain`: nobody waits for this port to have joined.
  RTC::ReturnCode_t join(RTC::ConnectorProfile& profile, bool starts_the_chain);
  RTC::ReturnCode_t reserve(const RTC::ConnectorProfile& profile, bool allows_duplicate);
  bool gives_way(std::string_view connector_id);
  struct Next {
    RTC::ReturnCode_t code = RTC::RTC_OK;
    bool is_silent = false;  // it has taken its whole time-out
  };
  Next join_next(RTC::ConnectorProfile& profile, int self, bool starts_the_chain);
  RTC::ReturnCode_t leave(std::string_view connector_id, bool tells_next, bool is_lost);
  // `has_waited`: see disconnect_deadline.
  RTC::ReturnCode_t leave_next(const RTC::ConnectorProfile& profile, bool has_waited = false);
  void tell_lost(const RTC::ConnectorProfile& profile);
  // Tells the ports of a connection to take it apart, in order, until one answers; its answer.
  RTC::ReturnCode_t break_up(const RTC::ConnectorProfile& profile, bool has_waited = false);
  void tell(Step step, RTC::ConnectorProfile& profile, RTC::ReturnCode_t code);

  base::Guarded<State, base::Rank::port> state_;
  std::atomic<int> connection_limit_{-1};
  Gate gate_;
  const std::shared_ptr<LossHandler> loss_ =
      std::make_shared<LossHandler>([this](const std::string& id) { drop_connection(id.c_str()); });  // for PeerWatch
  base::Guarded<int, base::Rank::noted> holders_{1};
  std::condition_variable released_;
};

}  // namespace corba
