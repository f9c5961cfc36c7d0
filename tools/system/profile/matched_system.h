// A saved system beside the running one: which running component and port each entry of the file means. One thread at a time.
#pragma once

#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "system/profile/rts_profile.h"
#include "system/session.h"

namespace tools {

// The path as the file format writes it, without the leading slash.
std::string path_uri(const ComponentView& component);

// Properties with references of objects: of the run that was saved, and of no use in any other.
bool is_reference(const std::string& key, const std::string& value);

// What a saved connection is made with.
Properties connect_properties(const SavedConnector& saved);
// The same for a connection that is made: unless the file says otherwise it comes back when an end has hung (dataport.reconnect).
Properties restored_properties(const SavedConnector& saved);

bool same_connection(const ConnectorView& connector, const PortView& source, const PortView& target);

// The components that a file speaks of, found on the name server by path, else by instance name.
class Matched {
 public:
  Matched(std::vector<ComponentView> components, const SavedSystem& system);
  // All components on the name server. Fails when it does not answer.
  static Result<Matched> read(const Session& session, const SavedSystem& system, Detail detail);

  const ComponentView* find(const std::string& uri, const std::string& instance) const;
  // Fails with a line that names the component, or the ports that it has instead.
  Result<const PortView*> port(const SavedTarget& target) const;
  // Required components that are not there or do not answer.
  const std::vector<Error>& missing() const { return missing_; }
  // The end of a connection is at a component that is not there and that the profile does not require.
  bool leaves_out(const SavedTarget& target) const;
  // A line for each component that is not there or does not answer, and that the profile does not require.
  const std::vector<std::string>& absent() const { return absent_; }

 private:
  void index();

  std::vector<ComponentView> components_;
  std::unordered_map<std::string, std::size_t> by_uri_, by_name_;  // in components_
  std::vector<Error> missing_;
  std::vector<std::string> absent_;
  std::set<std::string> optional_;  // instances that the profile does not require
};

}  // namespace tools
