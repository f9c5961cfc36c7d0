// One viewer's position on the time line of a recording, and the values at that time. Playing continues in the file; a jump reads the
// chunks before it that are needed, for any length of the file. One thread at a time.
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "recording/mcap/mcap.h"
#include "recording/sample_text.h"
#include "studio/late_models.h"
#include "studio/outbox.h"
#include "studio/pose_board.h"
#include "studio/recorded_scene.h"
#include "studio/recording_facts.h"
#include "studio/signals.h"

namespace studio {

class Playhead {
 public:
  // What a viewer is to be shown, and the key under which a newer one takes its place.
  struct Shown {
    std::string key;
    Frame frame;
  };
  using News = std::vector<Shown>;

  static base::Result<std::unique_ptr<Playhead>> open(std::shared_ptr<const RecordingFacts> facts);

  // Chunks of the file that could not be read so far: what they have is not shown.
  const std::vector<mcap::Reader::BrokenChunk>& broken_chunks() const { return reader_.broken_chunks(); }
  // Poses are shown from then on.
  void set_scene(std::shared_ptr<const RecordedScene> scene);
  // What is another than this viewer was shown last; with `is_whole` all of it.
  base::Result<News> look(std::chrono::nanoseconds time, bool is_whole = false);
  // Takes the place of one of that number; its value of now is among the news. A topic that is not recorded is said as an event.
  base::Result<News> watch(std::uint32_t watch, const WatchOrder& order);
  base::Result<News> watch_picture(std::uint32_t watch, const std::string& iface);
  void unwatch(std::uint32_t watch);
  // Parameters of a component as they are now: name and value, of its active set.
  base::Result<std::map<std::string, std::string>> parameters(const std::string& instance);

 private:
  using Channel = std::uint16_t;
  struct Newest {
    std::chrono::nanoseconds time{0};
    std::uint64_t number = 0;  // of all that was taken: another number is another sample
    std::string octets;
  };
  struct Watch {
    std::vector<Channel> channels;     // of a ring of sonars one for each
    std::vector<std::string> members;  // none: whole samples
    bool is_picture = false;
    std::uint64_t shown = 0;  // number
  };

  Playhead(std::shared_ptr<const RecordingFacts> facts, mcap::Reader reader);
  std::optional<Channel> channel_of(const std::string& topic) const;
  std::vector<Channel> wanted() const;
  base::Result<News> begin(std::uint32_t number, Watch watch);
  base::Result<void> move(std::chrono::nanoseconds time);
  base::Result<void> find(std::vector<Channel> channels, std::chrono::nanoseconds time);
  void take(const mcap::Message& message);
  const Newest* newest(Channel channel) const;
  base::Result<Json> value_of(Channel channel);
  base::Result<void> read_first_shapes();
  base::Result<bool> show_late(News& news);
  base::Result<void> show_poses(News& news);
  base::Result<void> show(std::uint32_t number, Watch& watch, News& news);
  base::Result<std::string> picture(std::uint32_t number, Channel channel);

  const std::shared_ptr<const RecordingFacts> facts_;
  mcap::Reader reader_;
  recorder::SampleValues values_{reader_};
  std::map<std::string, Channel> topics_;
  std::map<Channel, Newest> newest_;
  std::map<std::uint32_t, Watch> watches_;
  std::chrono::nanoseconds now_{-1};
  bool is_reading_on_ = false;  // the reader stands behind `now_`, for what is wanted
  std::optional<Channel> tf_, tf_static_;
  std::optional<Channel> shapes_;  // where models come or go
  std::uint64_t taken_ = 0, shown_tf_ = 0, shown_static_ = 0, seen_poses_ = 0;
  std::optional<std::pair<Channel, Newest>> ahead_;  // read, and later than `now_`
  std::shared_ptr<const RecordedScene> scene_;
  RecordedPlaces places_;
  LateModels late_;
  bool has_first_shapes_ = false;
  std::optional<std::chrono::nanoseconds> shown_shapes_;  // their time
  PoseBoard board_;
};

}  // namespace studio
