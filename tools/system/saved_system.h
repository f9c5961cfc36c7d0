// Saves a running system as a profile, and changes a running system to match a profile. It prints nothing: what was done and what failed
// are values. One thread at a time; calls to components are made on several threads.
#pragma once

#include <string>
#include <vector>

#include "system/profile/matched_system.h"
#include "system/profile/rts_profile.h"
#include "system/session.h"

namespace tools {

// The result of an operation on a system. One failure does not stop the others.
struct Changes {
  std::vector<std::string> actions{};   // what was done or tried; in a dry run, what would be done
  std::vector<std::string> warnings{};  // what is most likely a mistake of the profile
  std::vector<Error> errors{};

  bool ok() const { return errors.empty(); }
};

struct LoadOptions {
  bool dry_run = false;
  bool with_states = false;
  bool force = false;  // also values that the components' own types and constraints forbid
};

// Connects and configures the running components as the profile says.
Changes load(const Session& session, const SavedSystem& system, const LoadOptions& options = {});
// Activates or deactivates the components of the profile, in the order of its StartUp or ShutDown list.
Changes start(const Session& session, const SavedSystem& system, bool dry_run = false);
Changes stop(const Session& session, const SavedSystem& system, bool dry_run = false);
// Removes the connections of the profile.
Changes teardown(const Session& session, const SavedSystem& system, bool dry_run = false);

// The same for components that were read already. In a dry run nothing is called.
Changes load(const Session& session, const Matched& matched, const SavedSystem& system, const LoadOptions& options);
Changes move_all(const Session& session, const Matched& matched, const SavedSystem& system, bool dry_run, Transition transition);
Changes teardown(const Session& session, const Matched& matched, const SavedSystem& system, bool dry_run);

struct SaveOptions {
  std::string name = "RTSystem";
  std::string vendor = "Me";
  std::string version = "0";
  std::string abstract;
};

struct Snapshot {
  SavedSystem system;
  std::vector<Error> left_out;  // components and connections that a profile cannot hold
};

// Fails when the name server does not answer.
Result<Snapshot> save(const Session& session, const SaveOptions& options);

}  // namespace tools
