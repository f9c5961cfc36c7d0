#include "dds/participant.h"

#include <arpa/inet.h>
#include <fastdds/rtps/RTPSDomain.h>
#include <fastdds/rtps/attributes/RTPSParticipantAttributes.h>
#include <fastdds/rtps/attributes/ReaderAttributes.h>
#include <fastdds/rtps/attributes/WriterAttributes.h>
#include <fastdds/rtps/history/ReaderHistory.h>
#include <fastdds/rtps/history/WriterHistory.h>
#include <fastdds/rtps/participant/RTPSParticipant.h>
#include <fastdds/rtps/participant/RTPSParticipantListener.h>
#include <fastdds/rtps/reader/RTPSReader.h>
#include <fastdds/rtps/reader/ReaderListener.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/writer/RTPSWriter.h>
#include <fastdds/rtps/writer/WriterListener.h>
#include <fastrtps/attributes/TopicAttributes.h>
#include <fastrtps/qos/ReaderQos.h>
#include <fastrtps/qos/WriterQos.h>
#include <fastrtps/utils/IPLocator.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <fastdds/dds/log/Log.hpp>
#include <fastdds/rtps/interfaces/IReaderDataFilter.hpp>

#include <algorithm>
#include <map>
#include <utility>

#include "base/log.h"
#include "dds/inbox.h"

namespace ros2 {
namespace {

namespace rtps = eprosima::fastrtps::rtps;
namespace dds = eprosima::fastdds::dds;

constexpr std::uint32_t max_payload = std::uint32_t{1} << 30;

Guid to_guid(const rtps::GUID_t& from) {
  Guid guid{};
  std::copy_n(from.guidPrefix.value, 12, guid.begin());
  std::copy_n(from.entityId.value, 4, guid.begin() + 12);
  return guid;
}

rtps::GUID_t from_guid(const Guid& from) {
  rtps::GUID_t guid;
  std::copy_n(from.begin(), 12, guid.guidPrefix.value);
  std::copy_n(from.begin() + 12, 4, guid.entityId.value);
  return guid;
}

rtps::SequenceNumber_t to_sequence(std::int64_t number) {
  return {static_cast<std::int32_t>(number >> 32), static_cast<std::uint32_t>(number & 0xffffffff)};
}

std::int64_t from_sequence(const rtps::SequenceNumber_t& number) { return std::int64_t{number.high} << 32 | number.low; }

// ---- endpoints ----

// Our side of a writer or a reader, for deliver().
struct Endpoint {
  std::vector<Guid> peers;
  std::function<void()> on_match;
  std::function<void(Received&)> on_sample;
};
using Endpoints = std::map<std::uint64_t, Endpoint*>;

eprosima::fastrtps::TopicAttributes topic_of(const EndpointSettings& settings) {
  eprosima::fastrtps::TopicAttributes topic(settings.topic.c_str(), settings.type.c_str(), rtps::NO_KEY);
  topic.auto_fill_type_object = false;  // no type information: a peer that has it would compare
  topic.auto_fill_type_information = false;
  return topic;
}

template <class Qos>
void describe(Qos& qos, const EndpointSettings& settings) {
  qos.m_reliability.kind = settings.is_reliable ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS;
  qos.m_durability.kind = settings.is_transient ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
  const std::vector<rtps::octet> data(settings.user_data.begin(), settings.user_data.end());
  static_cast<dds::GenericDataQosPolicy&>(qos.m_userData) = data;
}

class FastWriter final : public Writer, private rtps::WriterListener, private eprosima::fastdds::rtps::IReaderDataFilter {
 public:
  FastWriter(EndpointSettings settings, Inbox& inbox, Endpoints& endpoints, std::uint64_t id, std::function<void()> on_match)
      : settings_(std::move(settings)),
        capacity_(settings_.is_transient || settings_.is_large || !settings_.is_reliable ? settings_.depth
                                                                                         : std::max(settings_.depth, least_capacity)),
        inbox_(inbox),
        endpoints_(endpoints),
        id_(id) {
    endpoint_.on_match = std::move(on_match);
    endpoints_[id_] = &endpoint_;
  }
  ~FastWriter() override {
    if (writer_ != nullptr) rtps::RTPSDomain::removeRTPSWriter(writer_);
    endpoints_.erase(id_);
  }

  bool open(rtps::RTPSParticipant& participant) {
    const auto most = static_cast<std::int32_t>(capacity_);
    const rtps::HistoryAttributes attributes(rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE, 256, std::min(most, 10), most);
    history_ = std::make_unique<rtps::WriterHistory>(attributes);
    rtps::WriterAttributes wanted;
    wanted.endpoint.reliabilityKind = settings_.is_reliable ? rtps::RELIABLE : rtps::BEST_EFFORT;
    wanted.endpoint.durabilityKind = settings_.is_transient ? rtps::TRANSIENT_LOCAL : rtps::VOLATILE;
    wanted.endpoint.topicKind = rtps::NO_KEY;
    wanted.times.heartbeatPeriod = {0, 50'000'000};
    wanted.mode = settings_.is_large ? rtps::ASYNCHRONOUS_WRITER : rtps::SYNCHRONOUS_WRITER;
    writer_ = rtps::RTPSDomain::createRTPSWriter(&participant, wanted, history_.get(), this);
    if (writer_ == nullptr) return false;
    guid_ = to_guid(writer_->getGuid());
    eprosima::fastrtps::WriterQos qos;
    describe(qos, settings_);
    qos.representation.m_value.push_back(dds::XCDR_DATA_REPRESENTATION);
    return participant.registerWriter(writer_, topic_of(settings_), qos);
  }

  const Guid& guid() const override { return guid_; }
  const EndpointSettings& settings() const override { return settings_; }
  const std::vector<Guid>& readers() const override { return endpoint_.peers; }
  std::uint64_t lost() const override { return lost_; }

  std::chrono::nanoseconds longest_write() const override { return longest_write_; }

  bool write(std::size_t size, const std::function<void(std::span<char>)>& fill, const std::optional<SampleIdentity>& related) override {
    if (!settings_.is_transient && endpoint_.peers.empty()) return true;
    const auto begin = std::chrono::steady_clock::now();
    const bool is_written = add(size, fill, related);
    longest_write_ = std::max<std::chrono::nanoseconds>(longest_write_, std::chrono::steady_clock::now() - begin);
    return is_written || count_lost();
  }

  void separate_by_vendor() override { writer_->reader_data_filter(this); }

 private:
  bool add(std::size_t size, const std::function<void(std::span<char>)>& fill, const std::optional<SampleIdentity>& related) {
    if (size > max_payload) return false;
    make_room();
    rtps::CacheChange_t* change = writer_->new_change([size] { return static_cast<std::uint32_t>(size); }, rtps::ALIVE);
    if (change == nullptr || change->serializedPayload.max_size < size) {
      if (change != nullptr) writer_->release_change(change);
      return false;
    }
    fill({reinterpret_cast<char*>(change->serializedPayload.data), size});
    change->serializedPayload.length = static_cast<std::uint32_t>(size);
    change->serializedPayload.encapsulation = CDR_LE;
    rtps::WriteParams params;
    if (related) {
      params.related_sample_identity().writer_guid(from_guid(related->writer));
      params.related_sample_identity().sequence_number(to_sequence(related->sequence));
    }
    if (history_->add_change(change, params)) return true;
    writer_->release_change(change);
    return false;
  }
  bool count_lost() {
    ++lost_;
    return false;
  }
  // What every reader has confirmed is not needed any more, except by readers that come later.
  void make_room() {
    rtps::CacheChange_t* oldest = nullptr;
    while (history_->get_min_change(&oldest)) {
      const bool is_confirmed = settings_.is_reliable && writer_->is_acked_by_all(oldest);
      const bool is_full = history_->getHistorySize() >= capacity_;
      if (!is_full && (settings_.is_transient || !is_confirmed)) return;
      if (settings_.is_reliable && !is_confirmed) ++lost_;
      if (!history_->remove_min_change()) return;
    }
  }

  // ---- threads of Fast DDS ----
  using rtps::WriterListener::onWriterMatched;
  void onWriterMatched(rtps::RTPSWriter*, rtps::MatchingInfo& info) override {
    inbox_.put(Matched{id_, to_guid(info.remoteEndpointGuid), info.status == rtps::MATCHED_MATCHING});
  }
  bool is_relevant(const rtps::CacheChange_t& change, const rtps::GUID_t& reader) const override {
    const bool has_identity = change.write_params.related_sample_identity().writer_guid() != rtps::GUID_t::unknown();
    return has_identity == is_fast_dds(to_guid(reader));
  }

  // Readers confirm samples some heartbeats later: until then there is room for those of a fast topic.
  static constexpr std::size_t least_capacity = 100;

  const EndpointSettings settings_;
  const std::size_t capacity_;
  Inbox& inbox_;
  Endpoints& endpoints_;
  const std::uint64_t id_;
  Endpoint endpoint_;
  Guid guid_{};
  std::uint64_t lost_ = 0;
  std::chrono::nanoseconds longest_write_{0};
  std::unique_ptr<rtps::WriterHistory> history_;
  rtps::RTPSWriter* writer_ = nullptr;
};

class FastReader final : public Reader, private rtps::ReaderListener {
 public:
  FastReader(EndpointSettings settings, Inbox& inbox, Endpoints& endpoints, std::uint64_t id, std::function<void(Received&)> on_sample)
      : settings_(std::move(settings)), inbox_(inbox), endpoints_(endpoints), id_(id) {
    endpoint_.on_sample = std::move(on_sample);
    endpoints_[id_] = &endpoint_;
  }
  ~FastReader() override {
    if (reader_ != nullptr) rtps::RTPSDomain::removeRTPSReader(reader_);
    endpoints_.erase(id_);
  }

  bool open(rtps::RTPSParticipant& participant) {
    const rtps::HistoryAttributes attributes(rtps::DYNAMIC_RESERVE_MEMORY_MODE, 256, 1, 1000);
    history_ = std::make_unique<rtps::ReaderHistory>(attributes);
    rtps::ReaderAttributes wanted;
    wanted.endpoint.reliabilityKind = settings_.is_reliable ? rtps::RELIABLE : rtps::BEST_EFFORT;
    wanted.endpoint.durabilityKind = settings_.is_transient ? rtps::TRANSIENT_LOCAL : rtps::VOLATILE;
    wanted.endpoint.topicKind = rtps::NO_KEY;
    reader_ = rtps::RTPSDomain::createRTPSReader(&participant, wanted, history_.get(), this);
    if (reader_ == nullptr) return false;
    guid_ = to_guid(reader_->getGuid());
    eprosima::fastrtps::ReaderQos qos;
    describe(qos, settings_);
    qos.representation.m_value.push_back(dds::XCDR_DATA_REPRESENTATION);
    return participant.registerReader(reader_, topic_of(settings_), qos);
  }

  const Guid& guid() const override { return guid_; }
  const EndpointSettings& settings() const override { return settings_; }
  const std::vector<Guid>& writers() const override { return endpoint_.peers; }

 private:
  // ---- threads of Fast DDS ----
  using rtps::ReaderListener::onReaderMatched;
  void onReaderMatched(rtps::RTPSReader*, rtps::MatchingInfo& info) override {
    inbox_.put(Matched{id_, to_guid(info.remoteEndpointGuid), info.status == rtps::MATCHED_MATCHING});
  }
  void onNewCacheChangeAdded(rtps::RTPSReader* reader, const rtps::CacheChange_t* const change) override {
    const auto& payload = change->serializedPayload;
    if (change->kind == rtps::ALIVE && payload.data != nullptr) {
      Received sample{{to_guid(change->writerGUID), from_sequence(change->sequenceNumber)}, std::nullopt, {}};
      sample.bytes.assign(payload.data, payload.data + payload.length);
      // Where Fast DDS puts the related identity of what it receives.
      const auto& related = change->write_params.sample_identity();
      if (related.writer_guid() != rtps::GUID_t::unknown())
        sample.related = {to_guid(related.writer_guid()), from_sequence(related.sequence_number())};
      inbox_.put(Sampled{id_, std::move(sample)});
    }
    reader->getHistory()->remove_change(const_cast<rtps::CacheChange_t*>(change));
  }

  const EndpointSettings settings_;
  Inbox& inbox_;
  Endpoints& endpoints_;
  const std::uint64_t id_;
  Endpoint endpoint_;
  Guid guid_{};
  std::unique_ptr<rtps::ReaderHistory> history_;
  rtps::RTPSReader* reader_ = nullptr;
};

// Policies other than reliability and durability. Endpoints of this process have the defaults of DDS, so a reader that requests more does
// not match.
std::string special_of(const eprosima::fastrtps::ReaderQos& qos) {
  if (qos.m_deadline.period < eprosima::fastrtps::c_TimeInfinite) return "a deadline";
  if (qos.m_liveliness.kind != dds::AUTOMATIC_LIVELINESS_QOS) return "manual liveliness";
  if (qos.m_liveliness.lease_duration < eprosima::fastrtps::c_TimeInfinite) return "a lease of liveliness";
  return qos.m_ownership.kind != dds::SHARED_OWNERSHIP_QOS ? "exclusive ownership" : "";
}
std::string special_of(const eprosima::fastrtps::WriterQos& qos) {
  return qos.m_ownership.kind != dds::SHARED_OWNERSHIP_QOS ? "exclusive ownership" : "";
}

// ---- the participant ----

class LogLines final : public dds::LogConsumer {
 public:
  explicit LogLines(std::string name) : name_(std::move(name)) {}
  // Of one thread of Fast DDS. Damaged packets could fill a disk with lines, so only the first lines are logged.
  void Consume(const dds::Log::Entry& entry) override {
    constexpr int most = 20;
    if (entry.kind == dds::Log::Kind::Info || count_ > most) return;
    const bool is_last = ++count_ > most;
    base::log(base::Level::warn, name_, "DDS: {}{}", entry.message, is_last ? " (no further lines)" : "");
  }

 private:
  const std::string name_;
  int count_ = 0;
};

rtps::Locator_t ipv4(const std::string& address, std::uint32_t port) {
  rtps::Locator_t locator;
  locator.kind = LOCATOR_KIND_UDPv4;
  locator.port = port;
  if (!address.empty()) rtps::IPLocator::setIPv4(locator, address);
  return locator;
}

// Those of this machine, 127.0.0.1 too: Fast DDS leaves it out where there is another one, but some peers use no other.
std::vector<std::string> own_addresses() {
  std::vector<std::string> addresses;
  ifaddrs* all = nullptr;
  if (::getifaddrs(&all) != 0) return addresses;
  for (const ifaddrs* one = all; one != nullptr; one = one->ifa_next) {
    if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_INET || (one->ifa_flags & IFF_UP) == 0) continue;
    std::array<char, INET_ADDRSTRLEN> text{};
    ::inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(one->ifa_addr)->sin_addr, text.data(), text.size());
    addresses.emplace_back(text.data());
  }
  ::freeifaddrs(all);
  return addresses;
}

rtps::RTPSParticipantAttributes attributes_of(const ParticipantSettings& settings) {
  rtps::RTPSParticipantAttributes attributes;
  attributes.setName("/");
  attributes.userData.assign(settings.user_data.begin(), settings.user_data.end());
  attributes.useBuiltinTransports = false;  // no shared memory, which two versions of Fast DDS on a host do not share well
  auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->non_blocking_send = true;
  udp->maxInitialPeersRange = 32;
  udp->TTL = 1;
  if (settings.network == Network::loopback) udp->interfaceWhiteList.emplace_back("127.0.0.1");
  attributes.userTransports.push_back(udp);
  auto& builtin = attributes.builtin;
  builtin.discovery_config.leaseDuration = {10, 0};
  builtin.discovery_config.leaseDuration_announcementperiod = {1, 0};
  // Where there are such lists, no multicast is listened to.
  for (const auto& address : settings.network == Network::loopback ? std::vector<std::string>{"127.0.0.1"} : own_addresses()) {
    builtin.metatrafficUnicastLocatorList.push_back(ipv4(address, 0));
    attributes.defaultUnicastLocatorList.push_back(ipv4(address, 0));
  }
  if (settings.network == Network::lan) {
    const auto group = ipv4("239.255.0.1", 7400 + 250 * settings.domain);
    builtin.metatrafficMulticastLocatorList.push_back(group);
    builtin.initialPeersList.push_back(group);
  }
  builtin.initialPeersList.push_back(ipv4("127.0.0.1", 0));
  return attributes;
}

class FastParticipant final : public Participant, private rtps::RTPSParticipantListener {
 public:
  ~FastParticipant() override {
    if (participant_ != nullptr) rtps::RTPSDomain::removeRTPSParticipant(participant_);
  }

  bool start(const ParticipantSettings& settings) {
    settings_ = settings;
    inbox_.call(settings.on_news);
    participant_ = rtps::RTPSDomain::createParticipant(settings.domain, true, attributes_of(settings), this);
    if (participant_ != nullptr) guid_ = to_guid(participant_->getGuid());
    return participant_ != nullptr;
  }

  const Guid& guid() const override { return guid_; }
  const ParticipantSettings& settings() const override { return settings_; }

  base::Result<std::unique_ptr<Writer>> make_writer(EndpointSettings settings, std::function<void()> on_match) override {
    const std::string topic = settings.topic;
    auto writer = std::make_unique<FastWriter>(std::move(settings), inbox_, endpoints_, ++last_id_, std::move(on_match));
    if (!writer->open(*participant_)) return base::Error{"cannot create the DDS writer of " + topic};
    return std::unique_ptr<Writer>(std::move(writer));
  }

  base::Result<std::unique_ptr<Reader>> make_reader(EndpointSettings settings, std::function<void(Received&)> on_sample) override {
    const std::string topic = settings.topic;
    auto reader = std::make_unique<FastReader>(std::move(settings), inbox_, endpoints_, ++last_id_, std::move(on_sample));
    if (!reader->open(*participant_)) return base::Error{"cannot create the DDS reader of " + topic};
    return std::unique_ptr<Reader>(std::move(reader));
  }

  void watch(std::function<void(const Peer&)> on_peer) override { on_peer_ = std::move(on_peer); }
  int descriptor() const override { return inbox_.descriptor(); }
  std::uint64_t refused() const override { return inbox_.refused(); }

  bool deliver() override {
    bool has_matched = false;
    for (auto& event : inbox_.take()) {
      if (auto* peer = std::get_if<Peer>(&event)) {
        if (on_peer_) on_peer_(*peer);
      } else if (auto* matched = std::get_if<Matched>(&event)) {
        match(*matched);
        has_matched = true;
      } else if (auto* sampled = std::get_if<Sampled>(&event)) {
        const auto found = endpoints_.find(sampled->endpoint);
        if (found != endpoints_.end() && found->second->on_sample) found->second->on_sample(sampled->sample);
      }
    }
    return has_matched;
  }

 private:
  void match(const Matched& matched) {
    const auto found = endpoints_.find(matched.endpoint);
    if (found == endpoints_.end()) return;
    Endpoint& endpoint = *found->second;
    std::erase(endpoint.peers, matched.peer);
    if (matched.is_matched) endpoint.peers.push_back(matched.peer);
    if (endpoint.on_match) endpoint.on_match();
  }

  // ---- threads of Fast DDS ----
  template <class Info>
  void put_peer(const Info& info, bool is_writer, bool is_gone) {
    const Guid guid = to_guid(info.guid());
    if (std::equal(guid.begin(), guid.begin() + 12, guid_.begin())) return;  // one of ours
    const auto& data = info.m_qos.m_userData;
    inbox_.put(Peer{guid, is_writer, is_gone, info.topicName().to_string(), info.typeName().to_string(),
                    std::string(data.begin(), data.end()), info.m_qos.m_reliability.kind == dds::RELIABLE_RELIABILITY_QOS,
                    info.m_qos.m_durability.kind != dds::VOLATILE_DURABILITY_QOS, special_of(info.m_qos)});
  }
  void onReaderDiscovery(rtps::RTPSParticipant*, rtps::ReaderDiscoveryInfo&& info) override {
    put_peer(info.info, false, info.status == rtps::ReaderDiscoveryInfo::REMOVED_READER);
  }
  void onWriterDiscovery(rtps::RTPSParticipant*, rtps::WriterDiscoveryInfo&& info) override {
    put_peer(info.info, true, info.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER);
  }

  ParticipantSettings settings_;
  Inbox inbox_;
  Endpoints endpoints_;
  std::uint64_t last_id_ = 0;
  std::function<void(const Peer&)> on_peer_;
  Guid guid_{};
  rtps::RTPSParticipant* participant_ = nullptr;
};

}  // namespace

base::Result<std::unique_ptr<Participant>> Participant::open(const ParticipantSettings& settings) {
  dds::Log::ClearConsumers();
  dds::Log::RegisterConsumer(std::make_unique<LogLines>(settings.log_name));
  auto participant = std::make_unique<FastParticipant>();
  if (!participant->start(settings))
    return base::Error{"cannot create a DDS participant in domain " + std::to_string(settings.domain) +
                       ": all its ports are in use, or the network cannot be used"};
  return std::unique_ptr<Participant>(std::move(participant));
}

}  // namespace ros2
