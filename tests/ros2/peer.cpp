// A participant of Cyclone DDS that reads and writes any type as bytes: the peer of another make for tests of ros2-gateway. It knows
// nothing of our encoders. Commands come by standard input, events go to standard output; a line each.
//
//   reader NAME TOPIC TYPE reliable|best_effort DURABILITY USER_DATA   -> "sample NAME WRITER_GUID HEX" for each, with the CDR head
//   writer NAME TOPIC TYPE reliable|best_effort DURABILITY USER_DATA   -> "writer NAME GUID"
//   put NAME HEX
//   matched NAME                                                               -> "matched NAME COUNT"
//   peers                                                                      -> "peer writer|reader TOPIC TYPE GUID USER_DATA", then
//   "end"
//
// DURABILITY is volatile or transient, or a policy of a volatile endpoint: deadline, lease or manual (of liveliness), exclusive. A
// USER_DATA "-" means none. Arguments of the program: the domain, and the user data of the participant.
#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <dds/ddsi/q_radmin.h>
#include <poll.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace {

using Bytes = std::vector<unsigned char>;

struct RawData : ddsi_serdata {
  Bytes bytes;
};
struct RawType : ddsi_sertype {};

extern const ddsi_serdata_ops data_ops;

RawData* new_data(const ddsi_sertype* type, ddsi_serdata_kind kind) {
  auto* data = new RawData;
  ddsi_serdata_init(data, type, kind);
  return data;
}

ddsi_serdata* from_ser(const ddsi_sertype* type, ddsi_serdata_kind kind, const nn_rdata* chain, size_t size) {
  auto* data = new_data(type, kind);
  data->bytes.resize(size);
  uint32_t at = 0;
  for (; chain != nullptr; chain = chain->nextfrag) {
    if (chain->maxp1 <= at) continue;
    const unsigned char* payload = NN_RMSG_PAYLOADOFF(chain->rmsg, NN_RDATA_PAYLOAD_OFF(chain));
    std::memcpy(data->bytes.data() + at, payload + (at - chain->min), chain->maxp1 - at);
    at = chain->maxp1;
  }
  return data;
}

ddsi_serdata* from_ser_iov(const ddsi_sertype* type, ddsi_serdata_kind kind, ddsrt_msg_iovlen_t count, const ddsrt_iovec_t* parts, size_t) {
  auto* data = new_data(type, kind);
  for (ddsrt_msg_iovlen_t i = 0; i < count; ++i) {
    const auto* begin = static_cast<const unsigned char*>(parts[i].iov_base);
    data->bytes.insert(data->bytes.end(), begin, begin + parts[i].iov_len);
  }
  return data;
}

const Bytes& bytes_of(const ddsi_serdata* data) { return static_cast<const RawData*>(data)->bytes; }

void to_ser(const ddsi_serdata* data, size_t offset, size_t size, void* to) {
  Bytes padded = bytes_of(data);
  padded.resize((padded.size() + 3) & ~size_t{3});
  std::memcpy(to, padded.data() + offset, size);
}

ddsi_serdata* to_ser_ref(const ddsi_serdata* data, size_t offset, size_t size, ddsrt_iovec_t* part) {
  auto* bytes = const_cast<Bytes*>(&bytes_of(data));
  bytes->reserve(bytes->size() + 4);
  part->iov_base = bytes->data() + offset;
  part->iov_len = static_cast<ddsrt_iov_len_t>(size);
  return ddsi_serdata_ref(data);
}

const ddsi_serdata_ops data_ops = {
    .eqkey = [](const ddsi_serdata*, const ddsi_serdata*) { return true; },
    .get_size = [](const ddsi_serdata* data) { return static_cast<uint32_t>(bytes_of(data).size()); },
    .from_ser = from_ser,
    .from_ser_iov = from_ser_iov,
    .from_keyhash = [](const ddsi_sertype* type, const ddsi_keyhash*) -> ddsi_serdata* { return new_data(type, SDK_KEY); },
    .from_sample = [](const ddsi_sertype* type, ddsi_serdata_kind kind, const void* sample) -> ddsi_serdata* {
      auto* data = new_data(type, kind);
      if (kind == SDK_DATA) data->bytes = *static_cast<const Bytes*>(sample);
      return data;
    },
    .to_ser = to_ser,
    .to_ser_ref = to_ser_ref,
    .to_ser_unref = [](ddsi_serdata* data, const ddsrt_iovec_t*) { ddsi_serdata_unref(data); },
    .to_sample =
        [](const ddsi_serdata* data, void* sample, void**, void*) {
          *static_cast<Bytes*>(sample) = bytes_of(data);
          return true;
        },
    .to_untyped = [](const ddsi_serdata* data) -> ddsi_serdata* {
      auto* untyped = new_data(data->type, SDK_KEY);
      untyped->type = nullptr;
      return untyped;
    },
    .untyped_to_sample = [](const ddsi_sertype*, const ddsi_serdata*, void*, void**, void*) { return true; },
    .free = [](ddsi_serdata* data) { delete static_cast<RawData*>(data); },
    .print = [](const ddsi_sertype*, const ddsi_serdata*, char* text, size_t size) -> size_t {
      if (size > 0) *text = '\0';
      return 0;
    },
    .get_keyhash = [](const ddsi_serdata*, ddsi_keyhash* hash, bool) { std::memset(hash, 0, sizeof *hash); },
    .get_sample_size = nullptr,
    .from_iox_buffer = nullptr,
};

const ddsi_sertype_ops type_ops = {
    .version = ddsi_sertype_v0,
    .arg = nullptr,
    .free =
        [](ddsi_sertype* type) {
          ddsi_sertype_fini(type);
          delete static_cast<RawType*>(type);
        },
    .zero_samples = [](const ddsi_sertype*, void*, size_t) {},
    .realloc_samples =
        [](void** made, const ddsi_sertype*, void*, size_t, size_t count) {
          for (size_t i = 0; i < count; ++i) made[i] = new Bytes;
        },
    .free_samples =
        [](const ddsi_sertype*, void** made, size_t count, dds_free_op_t) {
          for (size_t i = 0; i < count; ++i) delete static_cast<Bytes*>(made[i]);
        },
    .equal = [](const ddsi_sertype*, const ddsi_sertype*) { return true; },
    .hash = [](const ddsi_sertype*) { return uint32_t{0}; },
    .type_id = nullptr,
    .type_map = nullptr,
    .type_info = nullptr,
    .derive_sertype = nullptr,
    .get_serialized_size = nullptr,
    .serialize_into = nullptr,
};

dds_entity_t make_topic(dds_entity_t participant, const std::string& topic, const std::string& type) {
  auto* raw = new RawType;
  std::memset(static_cast<ddsi_sertype*>(raw), 0, sizeof(ddsi_sertype));
  ddsi_sertype_init_flags(raw, type.c_str(), &type_ops, &data_ops, DDSI_SERTYPE_FLAG_TOPICKIND_NO_KEY);
  raw->allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
  ddsi_sertype* passed = raw;
  return dds_create_topic_sertype(participant, topic.c_str(), &passed, nullptr, nullptr, nullptr);
}

std::string hex_of(const void* from, size_t size) {
  std::string text;
  char two[3];
  for (size_t i = 0; i < size; ++i) {
    std::snprintf(two, sizeof two, "%02x", static_cast<const unsigned char*>(from)[i]);
    text += two;
  }
  return text;
}

Bytes bytes_in(const std::string& hex) {
  Bytes bytes;
  for (size_t i = 0; i + 1 < hex.size(); i += 2) bytes.push_back(static_cast<unsigned char>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  return bytes;
}

dds_qos_t* make_qos(const std::string& reliability, const std::string& durability, const std::string& user_data) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, reliability == "reliable" ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT, DDS_SECS(1));
  dds_qset_durability(qos, durability == "transient" ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  if (durability == "deadline") dds_qset_deadline(qos, DDS_MSECS(100));
  if (durability == "lease") dds_qset_liveliness(qos, DDS_LIVELINESS_AUTOMATIC, DDS_SECS(1));
  if (durability == "manual") dds_qset_liveliness(qos, DDS_LIVELINESS_MANUAL_BY_TOPIC, DDS_INFINITY);
  if (durability == "exclusive") dds_qset_ownership(qos, DDS_OWNERSHIP_EXCLUSIVE);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 1000);
  dds_qset_writer_data_lifecycle(qos, false);
  if (user_data != "-") dds_qset_userdata(qos, user_data.data(), user_data.size());
  return qos;
}

class Peer {
 public:
  Peer(dds_domainid_t domain, const std::string& user_data) {
    dds_qos_t* qos = make_qos("reliable", "volatile", user_data);
    participant_ = dds_create_participant(domain, qos, nullptr);
    dds_delete_qos(qos);
    publications_ = dds_create_reader(participant_, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr);
    subscriptions_ = dds_create_reader(participant_, DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION, nullptr, nullptr);
  }
  ~Peer() { dds_delete(participant_); }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  bool is_good() const { return participant_ > 0; }

  void obey(const std::string& line) {
    std::istringstream words(line);
    std::string verb, name;
    words >> verb >> name;
    if (verb == "reader" || verb == "writer") make(verb == "writer", name, words);
    if (verb == "put") put(name, words);
    if (verb == "matched") tell_matched(name);
    if (verb == "peers") tell_peers();
    std::fflush(stdout);
  }

  void take() {
    for (const auto& [name, reader] : readers_) {
      ddsi_serdata* samples[100];
      dds_sample_info_t infos[100];
      const int count = dds_takecdr(reader, samples, 100, infos, DDS_ANY_STATE);
      for (int i = 0; i < count; ++i) {
        if (infos[i].valid_data) {
          const auto& bytes = bytes_of(samples[i]);
          std::printf("sample %s %s\n", name.c_str(), hex_of(bytes.data(), bytes.size()).c_str());
        }
        ddsi_serdata_unref(samples[i]);
      }
      if (count > 0) std::fflush(stdout);
    }
  }

 private:
  void make(bool is_writer, const std::string& name, std::istringstream& words) {
    std::string topic, type, reliability, durability, user_data;
    words >> topic >> type >> reliability >> durability >> user_data;
    const dds_entity_t made = make_topic(participant_, topic, type);
    dds_qos_t* qos = make_qos(reliability, durability, user_data);
    const dds_entity_t endpoint =
        is_writer ? dds_create_writer(participant_, made, qos, nullptr) : dds_create_reader(participant_, made, qos, nullptr);
    dds_delete_qos(qos);
    (is_writer ? writers_ : readers_)[name] = endpoint;
    dds_guid_t guid;
    dds_get_guid(endpoint, &guid);
    std::printf("%s %s %s\n", is_writer ? "writer" : "reader", name.c_str(),
                endpoint > 0 ? hex_of(guid.v, 16).c_str() : dds_strretcode(endpoint));
  }

  void put(const std::string& name, std::istringstream& words) {
    std::string hex;
    words >> hex;
    const Bytes bytes = bytes_in(hex);
    const int done = dds_write(writers_[name], &bytes);
    if (done < 0) std::printf("failed %s %s\n", name.c_str(), dds_strretcode(done));
  }

  void tell_matched(const std::string& name) {
    const bool is_writer = writers_.contains(name);
    dds_instance_handle_t handles[100];
    const int count = is_writer ? dds_get_matched_subscriptions(writers_[name], handles, 100)
                                : dds_get_matched_publications(readers_[name], handles, 100);
    std::printf("matched %s %d\n", name.c_str(), count);
  }

  void tell_peers() {
    for (const bool is_writer : {true, false}) {
      constexpr std::size_t most = 20000;
      std::vector<void*> samples(most);
      std::vector<dds_sample_info_t> infos(most);
      const dds_entity_t reader = is_writer ? publications_ : subscriptions_;
      const int count = dds_read(reader, samples.data(), infos.data(), most, most);
      for (int i = 0; i < count; ++i) {
        if (!infos[i].valid_data || infos[i].instance_state != DDS_IST_ALIVE) continue;
        const auto* endpoint = static_cast<const dds_builtintopic_endpoint_t*>(samples[i]);
        void* data = nullptr;
        size_t size = 0;
        dds_qget_userdata(endpoint->qos, &data, &size);
        std::printf("peer %s %s %s %s %s\n", is_writer ? "writer" : "reader", endpoint->topic_name, endpoint->type_name,
                    hex_of(endpoint->key.v, 16).c_str(), size > 0 ? std::string(static_cast<char*>(data), size).c_str() : "-");
        dds_free(data);
      }
      if (count > 0) dds_return_loan(reader, samples.data(), count);
    }
    std::printf("end\n");
  }

  dds_entity_t participant_ = 0, publications_ = 0, subscriptions_ = 0;
  std::map<std::string, dds_entity_t> readers_, writers_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    const bool is_asked = argc == 2 && std::strcmp(argv[1], "--help") == 0;
    std::fprintf(is_asked ? stdout : stderr,
                 "usage: ros2_peer DOMAIN USER_DATA|-    read and write topics of DDS, as standard input says\n");
    return is_asked ? 0 : 2;
  }
  Peer peer(static_cast<dds_domainid_t>(std::atoi(argv[1])), argv[2]);
  if (!peer.is_good()) {
    std::fprintf(stderr, "ros2_peer: no participant\n");
    return 1;
  }
  std::printf("ready\n");
  std::fflush(stdout);
  std::string text;
  while (true) {
    pollfd input{0, POLLIN, 0};
    if (::poll(&input, 1, 2) > 0) {
      char chunk[65536];
      const auto size = ::read(0, chunk, sizeof chunk);
      if (size <= 0) return 0;  // the test has ended
      text.append(chunk, static_cast<size_t>(size));
      for (auto end = text.find('\n'); end != std::string::npos; end = text.find('\n')) {
        peer.obey(text.substr(0, end));
        text.erase(0, end + 1);
      }
    }
    peer.take();
  }
}
