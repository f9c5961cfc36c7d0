// Octets from a peer, decoded as values of several types: any octets must end in a value or a refusal. Mutates good payloads; prints its
// seed.
//   ports_fuzz [--runs N] [--seed N]
// Built with clang, -fsanitize=fuzzer and RTMSIM_LIBFUZZER it is a target of libFuzzer, whose first octet chooses type and byte order.
#include <rtm/DataType.h>
#include <rtm/idl/BasicDataTypeSkel.h>
#include <rtm/idl/ExtendedDataTypesSkel.h>
#include <rtm/idl/InterfaceDataTypesSkel.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "component/runtime_access.h"
#include "corba/transport/cdr.h"
#include "corba/transport/event_data.h"
#include "support/usage.h"

namespace {

using Octets = std::vector<std::byte>;

template <class T>
void add(std::vector<std::pair<const corba::TypeOps*, Octets>>& seeds, const T& value) {
  const auto block = corba::encode(RTC::RuntimeAccess::ops(RTC::detail::data_type<T>()), &value, rt::ByteOrder::little);
  seeds.emplace_back(&RTC::RuntimeAccess::ops(RTC::detail::data_type<T>()), Octets(block->octets().begin(), block->octets().end()));
}

std::vector<std::pair<const corba::TypeOps*, Octets>> make_seeds() {
  std::vector<std::pair<const corba::TypeOps*, Octets>> seeds;
  add(seeds, RTC::TimedLong{});
  RTC::TimedStringSeq strings{};
  strings.data.length(3);
  for (CORBA::ULong i = 0; i < 3; ++i) strings.data[i] = "text";
  add(seeds, strings);
  RTC::CameraImage image{};
  image.format = "rgb";
  image.pixels.length(100);
  add(seeds, image);
  RTC::TimedWString wide{};
  wide.data = CORBA::wstring_dup(L"wide");
  add(seeds, wide);
  RTC::RangeData range{};
  range.ranges.length(10);
  add(seeds, range);
  RTC::Path2D path{};
  path.waypoints.length(2);
  add(seeds, path);
  return seeds;
}

void mutate(Octets& octets, std::mt19937& random) {
  const auto any_place = [&] { return random() % octets.size(); };
  for (unsigned n = random() % 4 + 1; n > 0 && !octets.empty(); --n) {
    switch (random() % 5) {
      case 0:
        octets[any_place()] = static_cast<std::byte>(random());
        break;
      case 1:
        octets.resize(any_place());
        break;
      case 2:
        octets.resize(octets.size() + random() % 16, static_cast<std::byte>(random()));
        break;
      default: {  // a length
        const std::uint32_t lengths[] = {0,          1,          0x7fffffff, 0x80000000,
                                         0xffffffff, 0xfffffffc, 1u << 20,   static_cast<std::uint32_t>(random())};
        const std::size_t at = any_place() / 4 * 4;
        if (at + 4 <= octets.size()) std::memcpy(&octets[at], &lengths[random() % 8], 4);
      }
    }
  }
}

struct Running {
  CORBA::ORB_var orb;
  std::vector<std::pair<const corba::TypeOps*, Octets>> seeds;

  Running() {
    int no_arguments = 0;
    orb = CORBA::ORB_init(no_arguments, nullptr);  // brings the code sets of strings
    omniORB::traceLevel = 0;                       // it tells of every bad string
    seeds = make_seeds();
  }
};

enum class Verdict { refused, value, cannot_be_encoded, has_no_shape };

Verdict judge(const corba::TypeOps& ops, const Octets& octets, rt::ByteOrder order) {
  const auto value = ops.make();
  const bool fits = ops.shape.fits(octets, order);
  if (!corba::decode_safely(ops, value.get(), octets, order)) return Verdict::refused;
  if (!fits) return Verdict::has_no_shape;
  corba::EventData data(ops, value.get(), order);
  const auto again = data.octets();
  if (again.empty() && !octets.empty() && !ops.has_wide_text) return Verdict::cannot_be_encoded;
  // What we send ourselves we take.
  const auto copy = ops.make();
  if (!again.empty() && !corba::decode_safely(ops, copy.get(), again, order)) return Verdict::cannot_be_encoded;
  return Verdict::value;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Running running;
  if (size == 0) return 0;
  const auto& [ops, original] = running.seeds[(data[0] >> 1) % running.seeds.size()];
  const auto* first = reinterpret_cast<const std::byte*>(data);
  const auto verdict = judge(*ops, Octets(first + 1, first + size), data[0] & 1 ? rt::ByteOrder::little : rt::ByteOrder::big);
  if (verdict == Verdict::cannot_be_encoded || verdict == Verdict::has_no_shape) std::abort();
  return 0;
}

#ifndef RTMSIM_LIBFUZZER
int main(int argc, char** argv) {
  ::test::answer_help(argc, argv,
                      "ports_fuzz [--runs N] [--seed N]\nReads damaged samples and profiles of ports; it must not crash or hang.");
  unsigned long runs = 100'000;
  unsigned seed = std::random_device()();
  for (int i = 1; i + 1 < argc; i += 2) {
    if (std::strcmp(argv[i], "--runs") == 0) runs = std::stoul(argv[i + 1]);
    if (std::strcmp(argv[i], "--seed") == 0) seed = static_cast<unsigned>(std::stoul(argv[i + 1]));
  }
  std::printf("seed %u\n", seed);
  std::fflush(stdout);
  std::mt19937 random(seed);
  const Running running;
  unsigned long good = 0;
  for (unsigned long run = 0; run < runs; ++run) {
    const auto& [ops, original] = running.seeds[random() % running.seeds.size()];
    Octets octets = original;
    mutate(octets, random);
    const auto verdict = judge(*ops, octets, random() % 2 ? rt::ByteOrder::little : rt::ByteOrder::big);
    good += verdict == Verdict::value;
    if (verdict != Verdict::cannot_be_encoded && verdict != Verdict::has_no_shape) continue;
    std::printf("a %s that was decoded %s\n", ops->type_id.c_str(),
                verdict == Verdict::has_no_shape ? "was to be refused" : "cannot be encoded");
    return 1;
  }
  std::printf("%lu of %lu payloads were values\n", good, runs);
  return 0;
}
#endif
