// Collects the samples and images of a recording in parts for a page. Each part begins with the newest earlier sample of each signal, so
// that a viewer needs one part for one time. One thread at a time.
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "base/result.h"
#include "recording/mcap/mcap.h"
#include "recording/sample_text.h"
#include "studio/recording_facts.h"

namespace page {

using studio::Json;

// One JSON object. Its samples are text, since their JSON takes up to ten times as much memory.
struct PagePart {
  std::string samples;  // "[TOPIC, s, sample],..." in the order of time, so that a scan and the sample of the port that carries it compress
                        // together
  Json members;         // the other members of the object
  std::string second;   // text of the part of a second recording; empty: none

  std::string text() const;
};

class PageSamples {
 public:
  // `camera_rate`: images of each camera per simulated second.
  static base::Result<std::unique_ptr<PageSamples>> open(std::shared_ptr<const studio::RecordingFacts> facts, double camera_rate);

  // The samples up to and without `to`, and "images":{TOPIC:[[s, JPEG in base64]]}. Call with growing times.
  base::Result<PagePart> part_until(std::chrono::nanoseconds to);
  // Continues after the file has grown: with its new facts, and the samples from the end of the last part on.
  base::Result<void> resume(std::shared_ptr<const studio::RecordingFacts> facts, std::chrono::nanoseconds from);
  // Chunks of the file that could not be read so far.
  const std::vector<mcap::Reader::BrokenChunk>& broken_chunks() const { return reader_.broken_chunks(); }
  // A line for each signal with omitted or rounded samples.
  std::vector<std::string> left_out() const;

 private:
  using Channel = std::uint16_t;
  struct Signal {
    std::string topic;
    bool is_image = false;
    std::size_t of_ring = 0;  // 0: one channel; else the number of sonars of a ring
    std::size_t number = 0;   // in the ring
    std::chrono::nanoseconds next{0};
  };

  PageSamples(std::shared_ptr<const studio::RecordingFacts> facts, double camera_rate, mcap::Reader reader);
  void find_channels(std::chrono::nanoseconds from);
  base::Result<void> add_message(const mcap::Message& message, PagePart& part);
  base::Result<void> add_image(const mcap::Message& message, Signal& signal, PagePart& part);
  void add_sample(const std::string& topic, double time, Json value, PagePart& part);

  std::shared_ptr<const studio::RecordingFacts> facts_;
  const double camera_rate_;
  mcap::Reader reader_;
  recorder::SampleValues values_{reader_};
  std::map<Channel, Signal> signals_;
  std::map<std::string, std::string> newest_;                     // samples as in a part, by topic
  std::map<std::string, Json> rings_;                             // the ranges of a ring of sonars
  std::map<std::string, std::pair<double, std::string>> images_;  // the newest
  std::map<std::string, std::uint64_t> thinned_, too_large_;      // samples
  std::set<std::string> rounded_;
  std::unique_ptr<std::pair<mcap::Message, std::string>> ahead_;  // read already, but belongs to the next part
  bool is_at_end_ = false;
};

}  // namespace page
