#include "corba/ports/local_connections.h"

#include <map>

#include "base/guarded.h"

namespace corba {
namespace {

// The process is what the two ends have in common, so this is a global. Never destroyed: ports may die after it otherwise.
template <class Connection>
class Connections {
 public:
  void add(const std::string& id, const std::shared_ptr<Connection>& connection) { (*entries_.lock())[id] = connection; }
  void remove(const std::string& id) { entries_.lock()->erase(id); }
  std::shared_ptr<Connection> find(const std::string& id) {
    auto entries = entries_.lock();
    const auto it = entries->find(id);
    return it == entries->end() ? nullptr : it->second.lock();
  }
  static Connections& instance() {
    static Connections& table = *new Connections;
    return table;
  }

 private:
  base::Guarded<std::map<std::string, std::weak_ptr<Connection>>, base::Rank::objects> entries_;
};

}  // namespace

void add_local(const std::string& id, const std::shared_ptr<InConnection>& connection) {
  Connections<InConnection>::instance().add(id, connection);
}
void add_local(const std::string& id, const std::shared_ptr<OutConnection>& connection) {
  Connections<OutConnection>::instance().add(id, connection);
}
std::shared_ptr<InConnection> find_local_in(const std::string& id) { return Connections<InConnection>::instance().find(id); }
std::shared_ptr<OutConnection> find_local_out(const std::string& id) { return Connections<OutConnection>::instance().find(id); }
void remove_local_in(const std::string& id) { Connections<InConnection>::instance().remove(id); }
void remove_local_out(const std::string& id) { Connections<OutConnection>::instance().remove(id); }

}  // namespace corba
