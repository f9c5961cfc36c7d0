// Reads the samples of a recording in the order of their times. A thread of its own reads and decompresses ahead. next() is called on one
// thread.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <thread>

#include "base/guarded.h"
#include "base/result.h"
#include "recording/mcap/mcap.h"

namespace recorder {

class ReadAhead final {
 public:
  struct Sample {
    std::uint16_t channel;
    mcap::Time time;
    std::string data;
  };

  ReadAhead(mcap::Reader reader, mcap::Query query);
  ~ReadAhead();
  ReadAhead(const ReadAhead&) = delete;
  ReadAhead& operator=(const ReadAhead&) = delete;

  // Nothing at the end. After an error there is nothing more.
  base::Result<std::optional<Sample>> next();

 private:
  struct Data {
    std::deque<Sample> samples;
    std::size_t octets = 0;  // of these
    std::optional<base::Error> failure;
    bool is_over = false;    // nothing more comes
    bool is_ending = false;  // nobody wants more
  };
  void run();
  bool hand_over(std::deque<Sample>& samples, std::size_t octets);
  void end(std::optional<base::Error> failure);

  mcap::Reader reader_;  // of the thread
  base::Guarded<Data, base::Rank::queue> data_;
  std::condition_variable changed_;
  std::deque<Sample> ready_;  // of who calls next()
  std::thread thread_;        // last: it uses all of these
};

}  // namespace recorder
