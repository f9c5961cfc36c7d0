// Recorded payloads of an independent ORB, put into a real InPort in both byte orders, and written by a real OutPort.
#include <gtest/gtest.h>
#include <rtm/idl/DataPort_OpenRTMSkel.h>
#include <rtm/idl/ExtendedDataTypesSkel.h>
#include <rtm/idl/InterfaceDataTypesSkel.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <vector>

#include "base/tick.h"
#include "component/runtime_access.h"
#include "corba/transport/cdr.h"
#include "ports/support.h"
#include "support/paths.h"

namespace {

using Bytes = std::vector<unsigned char>;

Bytes bytes_of(const std::string& hex) {
  Bytes bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes.push_back(static_cast<unsigned char>(std::stoul(hex.substr(i, 2), nullptr, 16)));
  return bytes;
}

const nlohmann::json& golden() {
  static const nlohmann::json all =
      nlohmann::json::parse(std::ifstream(std::string(paths::source_dir) + "/tests/golden/cdr_payloads.json"));
  return all;
}

// Keeps what a hash log would take a hash of.
class OctetsTick final : public ports::LookingTick {
 public:
  void passed(const base::Passage& passage) override {
    for (const auto& part : passage.octets) {
      const auto* first = reinterpret_cast<const unsigned char*>(part.data());
      octets.insert(octets.end(), first, first + part.size());
    }
  }
  bool passed_again(const base::Passage&, std::uint64_t) override { return false; }
  Bytes octets;
};

// The far end of the OutPort: keeps what arrives.
class Keeper : public POA_OpenRTM::InPortCdr {
 public:
  OpenRTM::PortStatus put(const OpenRTM::CdrData& data) override {
    kept.assign(data.get_buffer(), data.get_buffer() + data.length());
    return OpenRTM::PORT_OK;
  }
  Bytes kept;
};

// An InPort that is connected for one byte order to a port that never sends, so that the test can.
template <class T>
class Replay {
 public:
  explicit Replay(const std::string& order) : out_("Golden0.out", sent_), in_("Golden0.in", received_) {
    auto profile = ports::profile({out_.getPortRef(), in_.getPortRef()}, {{"serializer.cdr.endian", order}});
    if (out_.connect(profile) != RTC::RTC_OK) throw std::runtime_error("no connection");
    int argc = 0;
    const CORBA::ORB_var orb = CORBA::ORB_init(argc, nullptr);
    const std::string ior = NVUtil::toString(profile.properties, "dataport.corba_cdr.inport_ior");
    const CORBA::Object_var object = orb->string_to_object(ior.c_str());
    target_ = OpenRTM::InPortCdr::_narrow(object);
  }
  ~Replay() { out_.disconnect_all(); }

  std::optional<T> put(const Bytes& bytes) {
    OpenRTM::CdrData data(static_cast<CORBA::ULong>(bytes.size()), static_cast<CORBA::ULong>(bytes.size()),
                          const_cast<CORBA::Octet*>(bytes.data()), false);
    if (target_->put(data) != OpenRTM::PORT_OK || !in_.isNew() || !in_.read()) return std::nullopt;
    return received_;
  }

 private:
  T sent_{}, received_{};
  RTC::OutPort<T> out_;
  RTC::InPort<T> in_;
  OpenRTM::InPortCdr_var target_;
};

// A foreign InPort: offers the keeper's object when it is connected.
class KeeperPort : public POA_RTC::PortService {
 public:
  explicit KeeperPort(OpenRTM::InPortCdr_ptr keeper) : keeper_(OpenRTM::InPortCdr::_duplicate(keeper)) {}
  RTC::PortProfile* get_port_profile() override { return new RTC::PortProfile(); }
  RTC::ConnectorProfileList* get_connector_profiles() override { return new RTC::ConnectorProfileList(); }
  RTC::ConnectorProfile* get_connector_profile(const char*) override { return new RTC::ConnectorProfile(); }
  RTC::ReturnCode_t connect(RTC::ConnectorProfile&) override { return RTC::UNSUPPORTED; }
  RTC::ReturnCode_t disconnect(const char*) override { return RTC::RTC_OK; }
  RTC::ReturnCode_t disconnect_all() override { return RTC::RTC_OK; }
  RTC::ReturnCode_t notify_connect(RTC::ConnectorProfile& profile) override {
    int argc = 0;
    const CORBA::ORB_var orb = CORBA::ORB_init(argc, nullptr);
    const CORBA::String_var text = orb->object_to_string(keeper_);
    NVUtil::setStringValue(profile.properties, "dataport.corba_cdr.inport_ior", text);
    return RTC::RTC_OK;
  }
  RTC::ReturnCode_t notify_disconnect(const char*) override { return RTC::RTC_OK; }

 private:
  OpenRTM::InPortCdr_var keeper_;
};

// An OutPort whose octets are kept.
template <class T>
class Writer {
 public:
  Writer() : out_("Golden0.writer", value_) {
    const RTC::PortService_var port = port_._this();
    auto profile = ports::profile({out_.getPortRef(), port});
    if (out_.connect(profile) != RTC::RTC_OK) throw std::runtime_error("no connection");
  }
  ~Writer() { out_.disconnect_all(); }
  Bytes write(const T& value) {
    keeper_.kept.clear();
    value_ = value;
    out_.write();
    return keeper_.kept;
  }

 private:
  ports::Local<Keeper> keeper_;
  OpenRTM::InPortCdr_var reference_ = keeper_._this();
  ports::Local<KeeperPort> port_{reference_};
  T value_{};
  RTC::OutPort<T> out_;
};

template <class T>
class GoldenPayload : public testing::Test {
 protected:
  std::unique_ptr<corba::Orb> orb_ = ports::start_orb();
};

using Types =
    testing::Types<RTC::TimedBoolean, RTC::TimedChar, RTC::TimedOctet, RTC::TimedShort, RTC::TimedLong, RTC::TimedUShort, RTC::TimedULong,
                   RTC::TimedFloat, RTC::TimedDouble, RTC::TimedString, RTC::TimedBooleanSeq, RTC::TimedOctetSeq, RTC::TimedShortSeq,
                   RTC::TimedLongSeq, RTC::TimedFloatSeq, RTC::TimedDoubleSeq, RTC::TimedStringSeq, RTC::TimedVelocity2D, RTC::TimedPose2D,
                   RTC::TimedPose3D, RTC::RangeData, RTC::CameraImage, RTC::Path2D, RTC::PointCloud>;
TYPED_TEST_SUITE(GoldenPayload, Types);

std::string type_id(CORBA::TypeCode_ptr type) { return type->id(); }

TYPED_TEST(GoldenPayload, is_read_and_written_by_ports) {
  CORBA::Any any;
  any <<= TypeParam{};
  const CORBA::TypeCode_var type = any.type();
  const std::string id = type_id(type);
  int found = 0;
  Replay<TypeParam> little("little"), big("big");
  Writer<TypeParam> writer;
  for (const auto& entry : golden()) {
    if (entry["type"] != id) continue;
    ++found;
    const Bytes wanted = bytes_of(entry["little_endian"]);
    const auto from_little = little.put(wanted);
    const auto from_big = big.put(bytes_of(entry["big_endian"]));
    ASSERT_TRUE(from_little && from_big) << id;
    for (std::size_t size = 0; size < wanted.size(); ++size) {
      Bytes cut(wanted.begin(), wanted.begin() + static_cast<std::ptrdiff_t>(size));
      EXPECT_FALSE(
          RTC::RuntimeAccess::ops(RTC::detail::data_type<TypeParam>()).shape.fits(std::as_bytes(std::span(cut)), rt::ByteOrder::little))
          << id << " cut to " << size;
      EXPECT_FALSE(little.put(cut)) << id << " cut to " << size;
    }
    const Bytes written = writer.write(*from_little);
    EXPECT_EQ(writer.write(*from_big), written) << id;
    ASSERT_EQ(written.size(), wanted.size()) << id;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      if (written[i] == wanted[i]) continue;
      // Only padding may differ: another octet there makes no other value.
      Bytes changed = wanted;
      changed[i] = static_cast<unsigned char>(~changed[i]);
      OctetsTick tick;
      std::optional<TypeParam> value;
      {
        const base::ScopedTick in_tick(tick);
        value = little.put(changed);
      }
      ASSERT_TRUE(value) << id << " octet " << i;
      EXPECT_EQ(tick.octets, written) << id << ": another octet that says nothing makes another hash";
      EXPECT_EQ(writer.write(*value), written) << id << " octet " << i;
    }
  }
  EXPECT_GT(found, 0) << id;
}

}  // namespace
