// Data ports against bare calls of the ORB, interleaved in one run, with the limits of the design beside the ratios.
#include <rtm/idl/DataPort_OpenRTMSkel.h>

#include <algorithm>
#include <cstdio>
#include <vector>

#include "ports/support.h"
#include "support/usage.h"

namespace {

using Clock = std::chrono::steady_clock;

double microseconds(Clock::duration time) { return std::chrono::duration<double, std::micro>(time).count(); }

// Alternating bursts of two things, so that both see the same machine. Each burst gives its fastest-half mean and its median.
struct Timing {
  double mean = 1e30;    // [us] of the best burst
  double median = 1e30;  // [us] of the best burst
};

template <class Call>
void burst(Timing& timing, int calls, Call call) {
  std::vector<double> times;
  times.reserve(static_cast<std::size_t>(calls));
  const auto start = Clock::now();
  for (int i = 0; i < calls; ++i) {
    const auto before = Clock::now();
    call();
    times.push_back(microseconds(Clock::now() - before));
  }
  timing.mean = std::min(timing.mean, microseconds(Clock::now() - start) / calls);
  std::ranges::nth_element(times, times.begin() + calls / 2);
  timing.median = std::min(timing.median, times[static_cast<std::size_t>(calls / 2)]);
}

void plain_row(const char* what, double value, const char* unit) {
  std::printf("| %-50s | %9.3f %-5s |            |      |\n", what, value, unit);
}

void row(const char* what, double value, const char* unit, const char* limit, bool is_good) {
  std::printf("| %-50s | %9.3f %-5s | %-10s | %s |\n", what, value, unit, limit, is_good ? "ok  " : "MISS");
}

// What the calls of one size take: of the ORB alone, to a servant that lets go of what it gets and to one that keeps the last sample, as
// the InPort does and anybody who needs the sample; and ours.
struct Comparison {
  Timing nothing_kept;
  Timing kept;
  Timing ours;
};

Comparison measure(ports::Peer& peer, RTC::OutPort<RTC::TimedOctetSeq>& out, CORBA::ULong size) {
  const OpenRTM::InPortCdr_var bare = OpenRTM::InPortCdr::_narrow(peer.reference("bare"));
  const OpenRTM::InPortCdr_var keeping = OpenRTM::InPortCdr::_narrow(peer.reference("keeping"));
  OpenRTM::CdrData octets;
  octets.length(size + 12);
  Comparison result;
  const int calls = size > 100'000 ? 100 : 2000;
  for (int i = 0; i < 25; ++i) {
    burst(result.nothing_kept, calls, [&] { bare->put(octets); });
    burst(result.kept, calls, [&] { keeping->put(octets); });
    burst(result.ours, calls, [&] { out.write(); });
  }
  return result;
}

// A tool that counts what goes by. `looks`: it looks at the octets, too.
class Counter : public RTC::ConnectorDataListener {
 public:
  explicit Counter(bool looks) : looks_(looks) {}
  ReturnCode operator()(RTC::ConnectorInfo&, RTC::ByteData& data, const std::string&) override {
    octets_ += data.getDataLength();
    if (looks_) octets_ += static_cast<const RTC::ByteData&>(data).getBuffer()[0];
    return ConnectorListenerStatus::NO_CHANGE;
  }

 private:
  const bool looks_;
  std::size_t octets_ = 0;
};

void compare_with_listeners(ports::Peer& peer, RTC::OutPort<RTC::TimedOctetSeq>& out, CORBA::ULong size) {
  char text[80];
  for (const bool looks : {false, true}) {
    auto* counter = new Counter(looks);
    out.addConnectorDataListener(RTC::ON_SEND, counter);
    const auto [nothing_kept, kept, ours] = measure(peer, out, size);
    out.removeConnectorDataListener(RTC::ON_SEND, counter);
    std::snprintf(text, sizeof text, "%u B, listener that %s / bare", size, looks ? "looks" : "counts");
    row(text, kept.mean / ours.mean, "", ">= 0.90", kept.mean / ours.mean >= 0.9);
  }
}

// Nobody reads in the peer: its buffers are full and each sample replaces the oldest. `length`: of the buffer; empty: the default.
void compare(ports::Peer& peer, const char* transport, const char* length) {
  RTC::TimedOctetSeq value{};
  RTC::OutPort<RTC::TimedOctetSeq> out("Bench0.out", value);
  auto plan = ports::profile({out.getPortRef(), peer.port("in")}, {{"subscription_type", "flush"}, {"inport.buffer.length", length}});
  if (out.connect(plan) != RTC::RTC_OK) return void(std::printf("cannot connect\n"));
  std::printf("| buffer length %-69s |\n", *length ? length : "default");
  char text[80];
  const auto named = [&](CORBA::ULong size, const char* what) {
    std::snprintf(text, sizeof text, "%s %u B: %s", transport, size, what);
    return text;
  };
  for (const CORBA::ULong size : {64u, 4096u, 1u << 20}) {
    value.data.length(size);
    const auto [nothing_kept, kept, ours] = measure(peer, out, size);
    plain_row(named(size, "bare two-way, nothing kept"), nothing_kept.median, "us");
    plain_row(named(size, "bare two-way"), kept.median, "us");
    plain_row(named(size, "flush throughput / nothing kept"), nothing_kept.mean / ours.mean, "");
    plain_row(named(size, "flush latency / nothing kept"), ours.median / nothing_kept.median, "");
    row(named(size, "flush throughput / bare"), kept.mean / ours.mean, "", ">= 0.90", kept.mean / ours.mean >= 0.9);
    row(named(size, "flush latency / bare"), ours.median / kept.median, "", "<= 1.15", ours.median / kept.median <= 1.15);
    if (size != 4096u) compare_with_listeners(peer, out, size);
  }
  out.disconnect_all();

  auto shared =
      ports::profile({out.getPortRef(), peer.port("in")}, {{"interface_type", "shared_memory"}, {"inport.buffer.length", length}});
  if (out.connect(shared) != RTC::RTC_OK) return void(std::printf("cannot connect shared_memory\n"));
  const auto [nothing_kept, kept, ours] = measure(peer, out, 1u << 20);
  plain_row(named(1u << 20, "shared_memory throughput / nothing kept"), nothing_kept.mean / ours.mean, "");
  row(named(1u << 20, "shared_memory throughput / bare"), kept.mean / ours.mean, "", "> 1", kept.mean / ours.mean > 1);
}

void direct() {
  RTC::TimedOctetSeq value{};
  RTC::TimedOctetSeq result{};
  value.data.length(64);
  RTC::OutPort<RTC::TimedOctetSeq> out("Bench0.out", value);
  RTC::InPort<RTC::TimedOctetSeq> in("Bench1.in", result);
  auto plan = ports::profile({out.getPortRef(), in.getPortRef()}, {{"interface_type", "direct"}});
  if (out.connect(plan) != RTC::RTC_OK) return void(std::printf("cannot connect direct\n"));
  Timing writes;
  Timing both;
  for (int i = 0; i < 20; ++i) {
    const auto start = Clock::now();
    for (int k = 0; k < 20000; ++k) out.write();
    writes.mean = std::min(writes.mean, microseconds(Clock::now() - start) / 20000);
    const auto middle = Clock::now();
    for (int k = 0; k < 20000; ++k) {
      out.write();
      in.read();
    }
    both.mean = std::min(both.mean, microseconds(Clock::now() - middle) / 20000);
  }
  row("direct 64 B: write", writes.mean, "us", "< 1 us", writes.mean < 1);
  row("direct 64 B: write and read", both.mean, "us", "< 1 us", both.mean < 1);
}

void connecting(ports::Peer& peer) {
  RTC::TimedOctetSeq value{};
  std::vector<std::unique_ptr<RTC::OutPort<RTC::TimedOctetSeq>>> outs;
  std::vector<std::unique_ptr<RTC::InPort<RTC::TimedOctetSeq>>> ins;
  for (int i = 0; i < 1000; ++i) {
    outs.push_back(std::make_unique<RTC::OutPort<RTC::TimedOctetSeq>>("Bench0.out", value));
    ins.push_back(std::make_unique<RTC::InPort<RTC::TimedOctetSeq>>("Bench1.in", value));
    outs.back()->getPortRef();
    ins.back()->getPortRef();
  }
  auto start = Clock::now();
  for (std::size_t i = 0; i < 1000; ++i) {
    auto plan = ports::profile({outs[i]->getPortRef(), ins[i]->getPortRef()});
    if (outs[i]->connect(plan) != RTC::RTC_OK) return void(std::printf("cannot connect pair %zu\n", i));
  }
  double each = microseconds(Clock::now() - start) / 1e6;
  row("connecting 1000 pairs in one process, each", each, "ms", "< 1 ms", each < 1);
  for (auto& out : outs) out->disconnect_all();
  const RTC::PortService_var far = peer.port("in");
  start = Clock::now();
  for (auto& out : outs) {
    auto plan = ports::profile({out->getPortRef(), far});
    if (out->connect(plan) != RTC::RTC_OK) return void(std::printf("cannot connect to the peer\n"));
  }
  each = microseconds(Clock::now() - start) / 1e6;
  row("connecting 1000 OutPorts to another process", each, "ms", "< 1 ms", each < 1);
}

}  // namespace

int main(int argc, char** argv) {
  ::test::answer_help(argc, argv, "ports_bench\nMeasures data ports beside plain calls of the ORB.");
  const auto orb = ports::start_orb();
  std::printf("| measured                                     | value           | limit      |      |\n|---|---|---|---|\n");
  {
    ports::Peer peer;
    for (const char* length : {"", "1"}) compare(peer, "unix", length);
    connecting(peer);
  }
  {
    ports::Peer peer({"--tcp"});
    for (const char* length : {"", "1"}) compare(peer, "tcp", length);
  }
  direct();
  return 0;
}
