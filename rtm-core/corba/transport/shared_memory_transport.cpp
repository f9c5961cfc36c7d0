// The transport shared_memory: the payload goes through a segment, CORBA calls say when. The sender makes the segment and shows it to the
// receiver with open_memory; from then on the segment needs no name, so none is left behind by a process that is killed.

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <optional>
#include <string>

#include "base/guarded.h"
#include "base/id.h"
#include "base/log.h"
#include "corba/orb/call_timeout.h"
#include "corba/ports/provider.h"
#include "corba/transport/memory_segment.h"
#include "corba/transport/transport.h"
#include "rtm/idl/SharedMemorySkel.h"

namespace corba {
namespace {

// One user of a segment at a time; it may call out while it has its turn. Others wait as long as a call may take, no longer.
class Turns {
 public:
  class Turn {
   public:
    Turn(Turns& turns, std::chrono::milliseconds timeout) : turns_(turns) {
      auto busy = turns_.busy_.lock();
      has_it_ = busy.wait_for(turns_.free_, timeout, [&] { return !*busy; });
      if (has_it_) *busy = true;
    }
    ~Turn() {
      if (!has_it_) return;
      *turns_.busy_.lock() = false;
      turns_.free_.notify_one();
    }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;
    explicit operator bool() const { return has_it_; }

   private:
    Turns& turns_;
    bool has_it_ = false;
  };

 private:
  base::Guarded<bool, base::Rank::connector> busy_;
  std::condition_variable free_;
};

// A segment that is of no use fails with each sample: one line a second.
void complain(const base::Error& error) {
  using Clock = std::chrono::steady_clock;
  constexpr Clock::duration pause = std::chrono::seconds(1);
  static std::atomic<Clock::rep> next{Clock::time_point::min().time_since_epoch().count()};
  static std::atomic<unsigned> others{0};
  const auto now = Clock::now().time_since_epoch().count();
  auto due = next.load();
  if (now < due || !next.compare_exchange_strong(due, now + pause.count())) {
    ++others;
    return;
  }
  const unsigned missed = others.exchange(0);
  base::log(base::Level::error, "data port", "{}{}", error.message, missed > 0 ? "; " + std::to_string(missed) + " like it before" : "");
}

// The writing end of a segment, and the peer that reads it. To be used in turns.
class Outlet {
 public:
  Outlet(std::size_t first_size) : first_size_(first_size) {}

  void set_reader(OpenRTM::PortSharedMemory_ptr reader) {
    reader_ = OpenRTM::PortSharedMemory::_duplicate(reader);
    segment_.reset();
    told_.reset();
  }
  bool has_reader() const { return !CORBA::is_nil(reader_); }
  OpenRTM::PortSharedMemory_ptr reader() const { return reader_.in(); }

  // Puts the sample where the reader finds it; calls the reader when it has to know more. Throws CORBA::SystemException.
  bool put(const Pieces& pieces, rt::ByteOrder order) {
    const std::size_t needed = pieces.size + MemorySegment::header;
    if (!segment_ || segment_->size() < needed) {
      if (segment_) reader_->close_memory(false);
      segment_.reset();
      std::size_t size = std::max(first_size_, MemorySegment::header);
      while (size < needed) size *= 2;
      auto made = MemorySegment::create(base::make_uuid(), size);
      if (!made) return complain(made.error()), false;
      reader_->open_memory(size, (*made)->name().c_str());
      (*made)->unlink();
      segment_ = std::move(made).value();
    }
    if (told_ != order) {
      reader_->setEndian(order == rt::ByteOrder::little);
      told_ = order;
    }
    if (auto written = segment_->write(pieces, order); !written) {
      segment_.reset();  // the next sample gets a new one
      return complain(written.error()), false;
    }
    return true;
  }

 private:
  const std::size_t first_size_;
  OpenRTM::PortSharedMemory_var reader_;
  std::unique_ptr<MemorySegment> segment_;
  std::optional<rt::ByteOrder> told_;
};

// The reading end: what the writer tells about its segment.
class Inlet {
 public:
  explicit Inlet(rt::ByteOrder order) : state_(State{nullptr, order}) {}

  void open(const char* name) {
    auto opened = MemorySegment::open(name);
    if (!opened) {
      complain(opened.error());
      throw CORBA::BAD_PARAM();
    }
    state_.lock()->segment = std::move(opened).value();
  }
  void close(bool unlinks) {
    const auto segment = std::exchange(state_.lock()->segment, nullptr);
    (void)unlinks;  // the one who made the segment takes its name away
  }
  void set_order(rt::ByteOrder order) { state_.lock()->order = order; }

  // Nothing if there is no sample.
  std::optional<rt::Sample> read(rt::BlockPool& pool) {
    std::shared_ptr<MemorySegment> segment;
    rt::Sample sample;
    {
      auto state = state_.lock();
      segment = state->segment;
      sample.order = state->order;
    }
    if (!segment) return std::nullopt;
    auto block = segment->read(sample.order, pool);
    if (!block) return complain(block.error()), std::nullopt;
    sample.block = std::move(block).value();
    return sample;
  }

 private:
  struct State {
    std::shared_ptr<MemorySegment> segment;
    rt::ByteOrder order;
  };
  base::Guarded<State, base::Rank::connector> state_;
};

OpenRTM::PortStatus to_shared_status(rt::PortStatus status) {
  switch (status) {
    case rt::PortStatus::ok:
      return OpenRTM::PORT_OK;
    case rt::PortStatus::buffer_full:
      return OpenRTM::BUFFER_FULL;
    case rt::PortStatus::buffer_empty:
      return OpenRTM::BUFFER_EMPTY;
    case rt::PortStatus::buffer_timeout:
      return OpenRTM::BUFFER_TIMEOUT;
    case rt::PortStatus::unknown_error:
      return OpenRTM::UNKNOWN_ERROR;
    default:
      return OpenRTM::PORT_ERROR;
  }
}

// What every PortSharedMemory object answers alike: the reading end.
class ReadingServant : public POA_OpenRTM::PortSharedMemory, public PortableServer::RefCountServantBase {
 public:
  explicit ReadingServant(rt::ByteOrder order) : inlet(order) {}
  void open_memory(CORBA::ULongLong, const char* name) override { inlet.open(name); }
  // The writer makes the segment; a reader that is told to make one opens it.
  void create_memory(CORBA::ULongLong, const char* name) override { inlet.open(name); }
  void close_memory(CORBA::Boolean unlinks) override { inlet.close(unlinks); }
  void setInterface(OpenRTM::PortSharedMemory_ptr) override {}
  void setEndian(CORBA::Boolean is_little) override { inlet.set_order(is_little ? rt::ByteOrder::little : rt::ByteOrder::big); }
  OpenRTM::PortStatus put() override { return OpenRTM::UNKNOWN_ERROR; }
  OpenRTM::PortStatus get() override { return OpenRTM::UNKNOWN_ERROR; }

  Inlet inlet;
};

// The InPort of a push connection.
class SharedInServant final : public ReadingServant {
 public:
  SharedInServant(std::shared_ptr<Receiver> receiver, rt::ByteOrder order) : ReadingServant(order), receiver_(std::move(receiver)) {}
  OpenRTM::PortStatus put() override {
    auto sample = inlet.read(receiver_->pool());
    return sample ? to_shared_status(receiver_->receive(std::move(*sample))) : OpenRTM::PORT_ERROR;
  }

 private:
  std::shared_ptr<Receiver> receiver_;
};

// The OutPort of a push connection.
class SharedMemorySender final : public Sender {
 public:
  SharedMemorySender(OpenRTM::PortSharedMemory_ptr in_port, const Line& line) : line_(line), outlet_(line.shared_memory_size) {
    outlet_.set_reader(in_port);
  }

  rt::PortStatus send(Payload& payload) override {
    const Turns::Turn turn(turns_, line_.call_timeout);
    if (!turn) return rt::PortStatus::send_timeout;
    try {
      if (!outlet_.put(payload.pieces(line_.order), line_.order)) return rt::PortStatus::error;
      switch (outlet_.reader()->put()) {
        case OpenRTM::PORT_OK:
          return rt::PortStatus::ok;
        case OpenRTM::BUFFER_FULL:
          return rt::PortStatus::send_full;
        case OpenRTM::BUFFER_TIMEOUT:
          return rt::PortStatus::send_timeout;
        case OpenRTM::UNKNOWN_ERROR:
          return rt::PortStatus::unknown_error;
        default:
          return rt::PortStatus::error;
      }
    } catch (const CORBA::SystemException& e) {
      return status_of(e, line_);
    }
  }

 private:
  const Line line_;
  Turns turns_;
  Outlet outlet_;
};

// The OutPort of a pull connection.
class SharedOutServant final : public POA_OpenRTM::PortSharedMemory, public PortableServer::RefCountServantBase {
 public:
  SharedOutServant(std::shared_ptr<Source> source, const Line& line)
      : source_(std::move(source)), line_(line), outlet_(line.shared_memory_size) {}

  void setInterface(OpenRTM::PortSharedMemory_ptr reader) override {
    const Turns::Turn turn(turns_, line_.call_timeout);
    if (!turn) throw CORBA::TIMEOUT();
    limit_calls(reader, line_.call_timeout);
    outlet_.set_reader(reader);
  }
  OpenRTM::PortStatus get() override {
    const Turns::Turn turn(turns_, line_.call_timeout);
    if (!turn) return OpenRTM::BUFFER_TIMEOUT;
    if (!outlet_.has_reader()) return OpenRTM::PORT_ERROR;
    rt::Sample sample;
    const rt::PortStatus status = source_->give(sample);
    if (status != rt::PortStatus::ok) return to_shared_status(status);
    try {
      const Pieces pieces{{sample.block->octets()}, sample.block->size()};
      return outlet_.put(pieces, sample.order) ? OpenRTM::PORT_OK : OpenRTM::PORT_ERROR;
    } catch (const CORBA::SystemException&) {
      return OpenRTM::PORT_ERROR;
    }
  }
  void setEndian(CORBA::Boolean) override {}
  void open_memory(CORBA::ULongLong, const char*) override {}
  void create_memory(CORBA::ULongLong, const char*) override {}
  void close_memory(CORBA::Boolean) override {}
  OpenRTM::PortStatus put() override { return OpenRTM::UNKNOWN_ERROR; }

 private:
  std::shared_ptr<Source> source_;
  const Line line_;
  Turns turns_;
  Outlet outlet_;
};

// The InPort of a pull connection.
class SharedMemoryFetcher final : public Fetcher {
 public:
  SharedMemoryFetcher(OpenRTM::PortSharedMemory_ptr out_port, const Line& line)
      : out_port_(OpenRTM::PortSharedMemory::_duplicate(out_port)),
        line_(line),
        servant_(new ReadingServant(line.order)),
        active_(servant_) {
    const OpenRTM::PortSharedMemory_var self = OpenRTM::PortSharedMemory::_unchecked_narrow(active_.reference());
    out_port_->setInterface(self);
  }

  rt::PortStatus fetch(rt::Sample& sample) override {
    const Turns::Turn turn(turns_, line_.call_timeout);
    if (!turn) return rt::PortStatus::recv_timeout;
    try {
      switch (out_port_->get()) {
        case OpenRTM::PORT_OK:
          break;
        case OpenRTM::BUFFER_EMPTY:
          return rt::PortStatus::buffer_empty;
        case OpenRTM::BUFFER_TIMEOUT:
          return rt::PortStatus::recv_timeout;
        case OpenRTM::UNKNOWN_ERROR:
          return rt::PortStatus::unknown_error;
        default:
          return rt::PortStatus::error;
      }
    } catch (const CORBA::SystemException& e) {
      return status_of(e, line_);
    }
    auto read = servant_->inlet.read(*pool_);
    if (!read) return rt::PortStatus::error;
    sample = std::move(*read);
    return rt::PortStatus::ok;
  }

 private:
  OpenRTM::PortSharedMemory_var out_port_;
  const Line line_;
  Turns turns_;
  const std::shared_ptr<rt::BlockPool> pool_ = rt::BlockPool::make();
  ReadingServant* servant_;  // kept alive by active_
  ActiveServant<OpenRTM::PortSharedMemory> active_;
};

// nil if it is another interface or does not answer when asked for it.
OpenRTM::PortSharedMemory_ptr narrow_shared(CORBA::Object_ptr object, const Line& line) {
  limit_calls(object, std::min(line.call_timeout, port_call_timeout()));
  try {
    OpenRTM::PortSharedMemory_var narrowed = OpenRTM::PortSharedMemory::_narrow(object);
    limit_calls(narrowed, line.call_timeout);
    return narrowed._retn();
  } catch (const CORBA::Exception&) {
    return OpenRTM::PortSharedMemory::_nil();
  }
}

}  // namespace

std::unique_ptr<Sender> make_shared_memory_sender(CORBA::Object_ptr in_port, const Line& line) {
  const OpenRTM::PortSharedMemory_var port = narrow_shared(in_port, line);
  if (CORBA::is_nil(port)) return nullptr;
  return std::make_unique<SharedMemorySender>(port.in(), line);
}

std::unique_ptr<Fetcher> make_shared_memory_fetcher(CORBA::Object_ptr out_port, const Line& line) {
  const OpenRTM::PortSharedMemory_var port = narrow_shared(out_port, line);
  if (CORBA::is_nil(port)) return nullptr;
  try {
    return std::make_unique<SharedMemoryFetcher>(port.in(), line);
  } catch (const CORBA::Exception&) {
    return nullptr;
  }
}

std::unique_ptr<Provider> make_shared_memory_in_provider(std::shared_ptr<Receiver> receiver, const Line& line) {
  return std::make_unique<ActiveServant<OpenRTM::PortSharedMemory>>(new SharedInServant(std::move(receiver), line.order));
}

std::unique_ptr<Provider> make_shared_memory_out_provider(std::shared_ptr<Source> source, const Line& line) {
  return std::make_unique<ActiveServant<OpenRTM::PortSharedMemory>>(new SharedOutServant(std::move(source), line));
}

}  // namespace corba
