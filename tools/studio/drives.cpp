#include "studio/drives.h"

namespace studio {
namespace {

constexpr std::chrono::milliseconds timeout{500};
constexpr std::size_t most_handles = 256;

}  // namespace

base::Result<void> Drives::drive(std::uint64_t viewer, const std::string& iface, const std::vector<double>& velocity) {
  const auto type = velocity.size() == 6 ? shm::IfaceType::position3d : shm::IfaceType::position2d;
  const auto handle = handle_of(viewer, iface, type);
  if (!handle) return handle.error();
  (*handle)->renewed = Clock::now();
  const auto done = (*handle)->iface.command(shm::CommandKind::velocity, velocity);
  if (!done) release(viewer, iface);  // it may be there again next time
  return done;
}

base::Result<Drives::Handle*> Drives::handle_of(std::uint64_t viewer, const std::string& name, shm::IfaceType type) {
  const auto key = std::pair(viewer, name);
  const auto known = handles_.find(key);
  if (known != handles_.end() && known->second.iface.type() == type && known->second.iface.status() == shm::Status::live)
    return &known->second;
  handles_.erase(key);
  if (handles_.size() >= most_handles) return base::Error{"iface " + name + ": 256 robots are driven by hand already"};
  auto opened = shm::Iface::open(server_id_, type, name);
  if (!opened) return opened.error();
  return &handles_.emplace(key, Handle{std::move(*opened), Clock::now()}).first->second;
}

void Drives::release(std::uint64_t viewer, const std::string& iface) { handles_.erase({viewer, iface}); }

void Drives::release_all(std::uint64_t viewer) {
  std::erase_if(handles_, [&](const auto& entry) { return entry.first.first == viewer; });
}

void Drives::tend() {
  const auto now = Clock::now();
  std::erase_if(handles_, [&](const auto& entry) { return now - entry.second.renewed > timeout; });
}

}  // namespace studio
