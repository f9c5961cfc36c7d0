// Finds the other end of a connection inside this process, by the ID of the connection, for the transport `direct`. Any thread.
#pragma once

#include <memory>
#include <string>

namespace corba {

class InConnection;
class OutConnection;

void add_local(const std::string& id, const std::shared_ptr<InConnection>& connection);
void add_local(const std::string& id, const std::shared_ptr<OutConnection>& connection);
std::shared_ptr<InConnection> find_local_in(const std::string& id);
std::shared_ptr<OutConnection> find_local_out(const std::string& id);
void remove_local_in(const std::string& id);
void remove_local_out(const std::string& id);

}  // namespace corba
