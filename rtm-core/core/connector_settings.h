// The settings of one connection, read once from the texts of its ConnectorProfile. A value; any thread.
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/return_code.h"
#include "core/sample.h"

namespace rt {

using KeyValues = std::map<std::string, std::string, std::less<>>;

enum class Interface { corba_cdr, data_service, shared_memory, direct, foreign };  // foreign: a transport of an author
enum class Dataflow { push, pull };
enum class Subscription { flush, newest, periodic };  // "flush", "new", "periodic"
enum class PushPolicy { all, fifo, skip, newest };    // "all", "fifo", "skip", "new"
enum class FullPolicy { overwrite, do_nothing, block };
enum class EmptyPolicy { readback, do_nothing, block };
enum class StampPolicy { none, on_write, on_send, on_received, on_read };
enum class Side { in, out };

struct BufferSettings {
  std::size_t length = 8;
  FullPolicy full = FullPolicy::overwrite;
  EmptyPolicy empty = EmptyPolicy::readback;
  std::chrono::nanoseconds write_timeout = std::chrono::seconds(1);
  std::chrono::nanoseconds read_timeout = std::chrono::seconds(1);
};

struct PublisherSettings {
  PushPolicy policy = PushPolicy::newest;
  std::size_t skip_count = 0;
  std::chrono::nanoseconds period{};  // of periodic subscriptions only
};

struct ConnectorSettings {
  Interface interface = Interface::corba_cdr;
  std::string foreign_interface{};  // its name
  Dataflow dataflow = Dataflow::push;
  Subscription subscription = Subscription::flush;
  PublisherSettings publisher;
  BufferSettings buffer;  // of the side that was asked for
  ByteOrder order = ByteOrder::little;
  std::string marshaling = "cdr";
  StampPolicy stamp = StampPolicy::none;
  bool allows_duplicate = false;
  bool is_rendezvous = false;                             // dataport.sync_readwrite
  bool comes_back = false;                                // dataport.reconnect: after the other end has hung
  bool is_of_tool = false;                                // dataport.looks_on: the connection of a tool, which is not part of the system
  std::size_t fan_out = 100;                              // connections of the OutPort
  std::optional<std::chrono::milliseconds> call_timeout;  // dataport.call_timeout [s]: of every remote call of this connection
  std::size_t shared_memory_size = std::size_t{2} << 20;  // first size of a segment [octets]
};

// Why a connection is rejected: the code of the wire and one line.
struct Refusal {
  ReturnCode code = ReturnCode::ok;
  std::string reason;
};

struct ConnectorSettingsOutcome {
  ConnectorSettings settings;
  Refusal refusal;                    // settings count only while its code is ok
  std::vector<std::string> warnings;  // one line per value that was not understood and is replaced by its default
};

// Reads the `dataport.*` keys; `dataport.inport.*` or `dataport.outport.*` of that side override them.
// `foreign`: the names of transports of authors.
ConnectorSettingsOutcome read_connector_settings(const KeyValues& properties, Side side, const std::vector<std::string>& foreign = {});

// What that side's buffer does when it is empty, alone: dataport.buffer.read.empty_policy.
EmptyPolicy read_empty_policy(const KeyValues& properties, Side side);

// Octets of "8M", "64k", "1000"; nothing if it is no size.
std::optional<std::size_t> parse_size(std::string_view text);

// False only if both are known and differ. "IDL:RTC/TimedLong:1.0", "RTC::TimedLong" and "TimedLong" are the same; "" and "Any" fit
// everything.
bool are_compatible_types(std::string_view a, std::string_view b);

}  // namespace rt
