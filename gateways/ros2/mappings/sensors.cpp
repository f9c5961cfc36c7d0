#include "mappings/sensors.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/log.h"
#include "base/text.h"

namespace ros2 {

// ---- scans ----

ros::LaserScan RangesAndScan::to_ros(const Data& data) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const auto& config = data.config;
  const auto count = data.ranges.length();
  const auto number = [](double value) { return static_cast<float>(value); };
  ranges_.resize(count);
  for (CORBA::ULong i = 0; i < count; ++i) {
    const double range = data.ranges[i];
    const bool has_limits = config.maxRange > config.minRange;
    ranges_[i] = has_limits && range >= config.maxRange ? infinity : has_limits && range <= config.minRange ? -infinity : number(range);
  }
  // Readers count the ranges by the angles.
  const double last = count > 0 ? count - 1.0 : 0.0;
  return {.header = header(data.tm),
          .angle_min = number(config.minAngle),
          .angle_max = number(config.minAngle + last * config.angularRes),
          .angle_increment = number(config.angularRes),
          .scan_time = config.frequency > 0 ? number(1 / config.frequency) : 0,
          .range_min = number(config.minRange),
          .range_max = number(config.maxRange),
          .ranges = ranges_};
}

void RangesAndScan::from_ros(const Message& scan, Data& data) {
  set_time(data.tm, scan.header.stamp);
  data.geometry = {};
  data.config = {scan.angle_min,
                 scan.angle_max,
                 scan.angle_increment,
                 scan.range_min,
                 scan.range_max,
                 0,
                 scan.scan_time > 0 ? 1.0 / scan.scan_time : 0};
  data.ranges.length(static_cast<CORBA::ULong>(scan.ranges.size()));
  for (CORBA::ULong i = 0; i < data.ranges.length(); ++i) {
    const float range = scan.ranges[i];
    data.ranges[i] = std::isnan(range) ? scan.range_max : std::max(std::min(range, scan.range_max), scan.range_min);
  }
}

// ---- images ----

namespace {

struct PixelFormat {
  std::string_view port, ros;
  std::uint32_t bytes;
};
// Of several lines with one of the names the first counts.
constexpr PixelFormat pixel_formats[] = {
    {"RGB8", "rgb8", 3},
    {"BGR8", "bgr8", 3},
    {"RGBA8", "rgba8", 4},
    {"BGRA8", "bgra8", 4},
    {"MONO8", "mono8", 1},
    {"MONO16", "mono16", 2},
    {"DEPTH32F", "32FC1", 4},
    {"BAYER_RGGB8", "bayer_rggb8", 1},
    {"BAYER_BGGR8", "bayer_bggr8", 1},
    {"BAYER_GBRG8", "bayer_gbrg8", 1},
    {"BAYER_GRBG8", "bayer_grbg8", 1},
    {"MONO8", "8UC1", 1},
    {"MONO16", "16UC1", 2},
    {"BGR8", "8UC3", 3},
    {"BGRA8", "8UC4", 4},
    {"GRAY", "mono8", 1},
    {"GREY", "mono8", 1},
};

const PixelFormat* pixel_format_of(const RTC::CameraImage& image) {
  for (const auto& one : pixel_formats) {
    if (base::equal_ignoring_case(one.port, image.format.in())) return &one;
  }
  const char* usual = image.bpp == 24 ? "RGB8" : image.bpp == 32 ? "RGBA8" : image.bpp == 16 ? "MONO16" : image.bpp == 8 ? "MONO8" : "";
  for (const auto& one : pixel_formats) {
    if (one.port == usual) return &one;
  }
  return nullptr;
}

std::string name_of_compression(const std::string& format) {
  const std::string lower = base::to_lower(format);
  if (lower.find("jpeg") != std::string::npos || lower.find("jpg") != std::string::npos) return "jpeg";
  return lower.find("png") != std::string::npos ? "png" : "";
}

void set_pixels(RTC::CameraImage& image, std::span<const std::uint8_t> bytes) {
  image.pixels.length(static_cast<CORBA::ULong>(bytes.size()));
  if (!bytes.empty()) std::memcpy(image.pixels.get_buffer(), bytes.data(), bytes.size());
}

}  // namespace

bool ImageComplaint::refuse(const std::string& why) {
  if (!has_complained_) base::log(base::Level::warn, "ros2", "{} (no further lines about images of this connection)", why);
  has_complained_ = true;
  return false;
}

std::optional<ros::Image> ImageAndImage::to_ros(const Data& data) {
  const PixelFormat* format = pixel_format_of(data);
  const std::string size =
      std::to_string(data.width) + "x" + std::to_string(data.height) + " pixels in format " + base::in_quotes(data.format.in());
  if (format == nullptr) {
    refuse("an image of " + size + " is not sent: the format must be RGB8, MONO8, DEPTH32F or another raw one");
    return std::nullopt;
  }
  const std::uint32_t step = data.width * format->bytes;
  if (data.pixels.length() != std::size_t{step} * data.height) {
    refuse("an image of " + size + " is not sent: expected " + std::to_string(std::size_t{step} * data.height) + " bytes, got " +
           std::to_string(data.pixels.length()));
    return std::nullopt;
  }
  return Message{.header = header(data.tm),
                 .height = data.height,
                 .width = data.width,
                 .encoding = std::string(format->ros),
                 .step = step,
                 .data = {data.pixels.get_buffer(), data.pixels.length()}};
}

bool ImageAndImage::from_ros(const Message& image, Data& data) {
  const auto* format = std::ranges::find(pixel_formats, image.encoding, &PixelFormat::ros);
  if (format == std::end(pixel_formats))
    return refuse("a received image is dropped: encoding " + base::printable(base::in_quotes(image.encoding.substr(0, 40))) +
                  " is not known");
  const std::size_t row = std::size_t{image.width} * format->bytes;
  const bool fits = image.width <= 0xffff && image.height <= 0xffff && image.step >= row &&
                    image.data.size() >= std::size_t{image.step} * image.height && (image.is_bigendian == 0 || format->bytes != 2);
  if (!fits)
    return refuse("a received image is dropped: " + std::to_string(image.width) + "x" + std::to_string(image.height) + " pixels, step " +
                  std::to_string(image.step) + ", " + std::to_string(image.data.size()) + " bytes do not fit together");
  set_time(data.tm, image.header.stamp);
  data.width = static_cast<CORBA::UShort>(image.width);
  data.height = static_cast<CORBA::UShort>(image.height);
  data.bpp = static_cast<CORBA::UShort>(8 * format->bytes);
  data.format = std::string(format->port).c_str();
  data.fDiv = 0;
  if (image.step == row) {
    set_pixels(data, image.data.first(row * image.height));
  } else {
    data.pixels.length(static_cast<CORBA::ULong>(row * image.height));
    for (std::size_t y = 0; y < image.height && row > 0; ++y)
      std::memcpy(data.pixels.get_buffer() + y * row, image.data.data() + y * image.step, row);
  }
  return true;
}

std::optional<ros::CompressedImage> ImageAndCompressedImage::to_ros(const Data& data) {
  const std::string format = name_of_compression(data.format.in());
  if (format.empty()) {
    refuse("an image in format " + base::printable(base::in_quotes(data.format.in())) +
           " is not sent as CompressedImage: expected JPEG or PNG");
    return std::nullopt;
  }
  return Message{header(data.tm), format, {data.pixels.get_buffer(), data.pixels.length()}};
}

bool ImageAndCompressedImage::from_ros(const Message& image, Data& data) {
  const std::string format = name_of_compression(image.format);
  if (format.empty())
    return refuse("a received image is dropped: format " + base::printable(base::in_quotes(image.format.substr(0, 40))) +
                  ", expected jpeg or png");
  set_time(data.tm, image.header.stamp);
  data.width = data.height = 0;
  data.bpp = 24;
  data.format = format == "jpeg" ? "JPEG" : "PNG";
  data.fDiv = 0;
  set_pixels(data, image.data);
  return true;
}

// ---- clouds ----

namespace {

constexpr std::array<std::uint32_t, 9> size_of_field = {0, 1, 1, 2, 2, 4, 4, 4, 8};  // by PointField.datatype

const ros::PointField* field_of(const ros::PointCloud2& cloud, std::string_view name) {
  const auto found = std::ranges::find(cloud.point_fields, name, &ros::PointField::field);
  return found == cloud.point_fields.end() ? nullptr : &*found;
}

template <class T>
T swapped(T value, bool is_swapped) {
  auto bytes = std::bit_cast<std::array<std::uint8_t, sizeof(T)>>(value);
  if (is_swapped) std::ranges::reverse(bytes);
  return std::bit_cast<T>(bytes);
}

// A number of a point, where floats of either size or a packed colour are expected.
class FieldReader {
 public:
  FieldReader(const ros::PointCloud2& cloud, std::string_view name) : field_(field_of(cloud, name)), is_swapped_(cloud.is_bigendian) {
    constexpr std::uint8_t uint32 = 6, float64 = 8;
    if (field_ == nullptr) return;
    is_wide_ = field_->datatype == float64;
    const bool is_known = is_wide_ || field_->datatype == ros::PointField::float32 || field_->datatype == uint32;
    const std::uint64_t end = std::uint64_t{field_->offset} + size_of_field[is_known ? field_->datatype : 0];
    if (!is_known || end > cloud.point_step) field_ = nullptr;
  }
  bool is_there() const { return field_ != nullptr; }
  double number(const std::uint8_t* point) const {
    if (!is_wide_) return std::bit_cast<float>(bits(point));
    double value = 0;
    std::memcpy(&value, point + field_->offset, sizeof value);
    return swapped(value, is_swapped_);
  }
  std::uint32_t bits(const std::uint8_t* point) const {
    std::uint32_t value = 0;
    std::memcpy(&value, point + field_->offset, sizeof value);
    return swapped(value, is_swapped_);
  }

 private:
  const ros::PointField* field_;
  const bool is_swapped_;
  bool is_wide_ = false;
};

std::uint32_t packed(const RTC::RGBColour& colour) {
  const auto part = [](double value) { return static_cast<std::uint32_t>(std::lround(255 * (value > 0 ? std::min(value, 1.0) : 0))); };
  return part(colour.r) << 16 | part(colour.g) << 8 | part(colour.b);
}
RTC::RGBColour unpacked(std::uint32_t rgb) {
  const auto part = [rgb](int shift) { return (rgb >> shift & 255) / 255.0; };
  return {part(16), part(8), part(0)};
}

// Every point is inside of the bytes.
bool is_whole(const ros::PointCloud2& cloud) {
  if (cloud.width == 0 || cloud.height == 0) return true;
  const std::uint64_t row = std::uint64_t{cloud.width} * cloud.point_step;
  return cloud.point_step > 0 && row <= cloud.row_step && (cloud.height - 1) * std::uint64_t{cloud.row_step} + row <= cloud.data.size();
}

}  // namespace

ros::PointCloud2 PointsAndCloud::to_ros(const Data& data) {
  constexpr std::uint32_t step = 16;
  const auto count = data.points.length();
  bytes_.resize(std::size_t{step} * count);
  bool is_dense = true;
  for (CORBA::ULong i = 0; i < count; ++i) {
    const auto& [at, colour] = data.points[i];
    const std::array<float, 3> place = {static_cast<float>(at.x), static_cast<float>(at.y), static_cast<float>(at.z)};
    const std::uint32_t rgb = packed(colour);
    std::memcpy(&bytes_[std::size_t{step} * i], place.data(), sizeof place);
    std::memcpy(&bytes_[std::size_t{step} * i + sizeof place], &rgb, sizeof rgb);
    is_dense = is_dense && std::isfinite(at.x) && std::isfinite(at.y) && std::isfinite(at.z);
  }
  return {.header = header(data.tm),
          .height = 1,
          .width = count,
          .point_fields = {{"x", 0}, {"y", 4}, {"z", 8}, {"rgb", 12}},
          .point_step = step,
          .row_step = step * count,
          .data = bytes_,
          .is_dense = is_dense};
}

bool PointsAndCloud::from_ros(const Message& cloud, Data& data) {
  const FieldReader x(cloud, "x"), y(cloud, "y"), z(cloud, "z"), rgb(cloud, "rgb"), intensity(cloud, "intensity");
  if (!is_whole(cloud) || !x.is_there() || !y.is_there() || !z.is_there()) return false;
  set_time(data.tm, cloud.header.stamp);
  data.points.length(cloud.width * cloud.height);
  CORBA::ULong i = 0;
  for (std::size_t row = 0; row < cloud.height; ++row) {
    const std::uint8_t* point = cloud.data.data() + row * cloud.row_step;
    for (std::size_t column = 0; column < cloud.width; ++column, point += cloud.point_step) {
      RTC::RGBColour colour{0, 0, 0};
      if (rgb.is_there()) {
        colour = unpacked(rgb.bits(point));
      } else if (intensity.is_there()) {
        colour.r = colour.g = colour.b = intensity.number(point);
      }
      data.points[i++] = {{x.number(point), y.number(point), z.number(point)}, colour};
    }
  }
  return true;
}

// The numbers of the types are lower by one in PointCloudTypes, and count is in bytes there.
std::optional<ros::PointCloud2> CloudAndCloud::to_ros(const Data& data) const {
  Message cloud{.header = header(data.tm),
                .height = data.height,
                .width = data.width,
                .is_bigendian = data.is_bigendian,
                .point_step = data.point_step,
                .row_step = data.row_step,
                .data = {data.data.get_buffer(), data.data.length()},
                .is_dense = data.is_dense};
  for (CORBA::ULong i = 0; i < data.fields.length(); ++i) {
    const auto& field = data.fields[i];
    const auto type = static_cast<std::uint8_t>(static_cast<int>(field.data_type) + 1);
    if (type >= size_of_field.size()) return std::nullopt;
    cloud.point_fields.push_back({field.name.in(), field.offset, type, std::max(field.count / size_of_field[type], CORBA::ULong{1})});
  }
  return is_whole(cloud) ? std::optional(std::move(cloud)) : std::nullopt;
}

bool CloudAndCloud::from_ros(const Message& cloud, Data& data) {
  if (!is_whole(cloud)) return false;
  set_time(data.tm, cloud.header.stamp);
  data.seq = 0;
  data.height = cloud.height;
  data.width = cloud.width;
  data.fields.length(static_cast<CORBA::ULong>(cloud.point_fields.size()));
  std::string type;  // "xyz", "xyzrgb", "xyzi"
  for (CORBA::ULong i = 0; i < data.fields.length(); ++i) {
    const auto& field = cloud.point_fields[i];
    if (field.datatype == 0 || field.datatype >= size_of_field.size()) return false;
    data.fields[i].name = field.field.c_str();
    data.fields[i].offset = field.offset;
    data.fields[i].data_type = static_cast<PointCloudTypes::DataType>(field.datatype - 1);
    data.fields[i].count = field.count * size_of_field[field.datatype];
    type += field.field.starts_with("rgb") ? field.field : field.field.substr(0, 1);
  }
  data.type = type.c_str();
  data.is_bigendian = cloud.is_bigendian;
  data.point_step = cloud.point_step;
  data.row_step = cloud.row_step;
  data.is_dense = cloud.is_dense;
  data.data.length(static_cast<CORBA::ULong>(cloud.data.size()));
  if (!cloud.data.empty()) std::memcpy(data.data.get_buffer(), cloud.data.data(), cloud.data.size());
  return true;
}

// ---- joints ----

void JointNames::init(const coil::Properties& connection) { names_ = base::split_list(property_of(connection, "joint_names")); }

std::vector<std::string> JointNames::first(std::size_t count) const {
  std::vector<std::string> names(names_.begin(), names_.begin() + static_cast<std::ptrdiff_t>(std::min(count, names_.size())));
  while (names.size() < count) names.push_back("joint_" + std::to_string(names.size()));
  return names;
}

std::optional<std::vector<std::size_t>> JointNames::places(const ros::JointState& message) const {
  std::vector<std::size_t> places;
  if (names_.empty()) {
    for (std::size_t i = 0; i < std::max(message.names.size(), message.position.size()); ++i) places.push_back(i);
    return places;
  }
  for (const std::string& name : names_) {
    const auto found = std::ranges::find(message.names, name);
    if (found == message.names.end()) return std::nullopt;
    places.push_back(static_cast<std::size_t>(found - message.names.begin()));
  }
  return places;
}

namespace {

ros::JointState positions_message(const RTC::Time& tm, const auto& positions, const JointNames& names) {
  ros::JointState message{.header = {stamp_of(tm), ""}, .names = names.first(positions.length())};
  for (CORBA::ULong i = 0; i < positions.length(); ++i) message.position.push_back(positions[i]);
  return message;
}

bool take_positions(const ros::JointState& message, const JointNames& names, RTC::Time& tm, auto& positions) {
  const auto places = names.places(message);
  if (!places || std::ranges::any_of(*places, [&](std::size_t place) { return place >= message.position.size(); })) return false;
  set_time(tm, message.header.stamp);
  positions.length(static_cast<CORBA::ULong>(places->size()));
  for (CORBA::ULong i = 0; i < positions.length(); ++i) positions[i] = message.position[(*places)[i]];
  return true;
}

}  // namespace

ros::JointState ActuatorsAndJoints::to_ros(const Data& data) const {
  Message message{.header = {stamp_of(data.tm), ""}, .names = first(data.actuators.length())};
  for (CORBA::ULong i = 0; i < data.actuators.length(); ++i) {
    message.position.push_back(data.actuators[i].position);
    message.velocity.push_back(data.actuators[i].speed);
    message.effort.push_back(data.actuators[i].current);
  }
  return message;
}

bool ActuatorsAndJoints::from_ros(const Message& message, Data& data) const {
  const auto places = this->places(message);
  if (!places) return false;
  const auto value = [](const std::vector<double>& values, std::size_t i) { return i < values.size() ? values[i] : 0; };
  set_time(data.tm, message.header.stamp);
  data.actuators.length(static_cast<CORBA::ULong>(places->size()));
  for (CORBA::ULong i = 0; i < data.actuators.length(); ++i) {
    const std::size_t at = (*places)[i];
    const double speed = value(message.velocity, at);
    data.actuators[i] = {value(message.position, at), speed, 0, value(message.effort, at),
                         speed != 0 ? RTC::ACTUATOR_STATUS_MOVING : RTC::ACTUATOR_STATUS_IDLE};
  }
  return true;
}

ros::JointState NumbersAndJoints::to_ros(const Data& data) const { return positions_message(data.tm, data.data, *this); }
bool NumbersAndJoints::from_ros(const Message& message, Data& data) const { return take_positions(message, *this, data.tm, data.data); }
ros::JointState JointPosAndJoints::to_ros(const Data& data) const { return positions_message(data.tm, data.pos, *this); }
bool JointPosAndJoints::from_ros(const Message& message, Data& data) const { return take_positions(message, *this, data.tm, data.pos); }

// ---- positions on the earth ----

ros::NavSatFix GpsAndFix::to_ros(const Data& data) const {
  const double flat = data.horizontalError * data.horizontalError, up = data.verticalError * data.verticalError;
  Message fix{.header = header(data.tm), .latitude = data.latitude, .longitude = data.longitude, .altitude = data.altitude};
  fix.status.status = static_cast<std::int8_t>(data.fixType == RTC::GPS_FIX_NONE ? -1 : data.fixType == RTC::GPS_FIX_DGPS ? 2 : 0);
  fix.position_covariance = {flat, 0, 0, 0, flat, 0, 0, 0, up};
  fix.position_covariance_type = 2;
  return fix;
}

void GpsAndFix::from_ros(const Message& fix, Data& data) {
  const auto error = [&](std::size_t i) {
    return fix.position_covariance_type != 0 ? std::sqrt(std::max(fix.position_covariance[i], 0.0)) : 0;
  };
  set_time(data.tm, fix.header.stamp);
  data.timeFromGPS = {data.tm.sec, data.tm.nsec / 1'000'000};
  data.latitude = fix.latitude;
  data.longitude = fix.longitude;
  data.altitude = fix.altitude;
  data.horizontalError = error(0);
  data.verticalError = error(8);
  data.heading = data.horizontalSpeed = data.verticalSpeed = 0;
  data.numSatellites = 0;
  data.fixType = fix.status.status < 0 ? RTC::GPS_FIX_NONE : fix.status.status > 0 ? RTC::GPS_FIX_DGPS : RTC::GPS_FIX_NORMAL;
}

}  // namespace ros2
