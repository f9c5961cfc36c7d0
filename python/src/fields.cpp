#include "python/src/fields.h"

#include <cstring>
#include <string>
#include <vector>

namespace python {
namespace {

using shm::Field;

template <class T>
py::array_t<T> copy_of(const T* values, std::size_t count) {
  return py::array_t<T>(static_cast<py::ssize_t>(count), values);
}

template <class T>
py::object numbers(const void* at, std::size_t count) {
  const auto* values = static_cast<const T*>(at);
  if (count == 1) return py::cast(values[0]);
  return copy_of(values, count);
}

py::str text_of(const void* at, std::size_t size) {
  const auto* text = static_cast<const char*>(at);
  // Names come from files and need not be UTF-8.
  return py::reinterpret_steal<py::str>(PyUnicode_DecodeUTF8(text, static_cast<py::ssize_t>(strnlen(text, size)), "replace"));
}

constexpr std::size_t pose_values = sizeof(shm::Pose) / sizeof(double);

// Numbers of one field of all elements: (count), or (count, values).
py::object column_of(const Field& field, const std::byte* first, std::size_t stride, std::size_t count) {
  if (field.kind == Field::Kind::text) {
    py::list texts;
    for (std::size_t i = 0; i < count; ++i) texts.append(text_of(field.in(first + i * stride), field.count));
    return texts;
  }
  const auto gather = [&]<class T>(T, std::size_t values) {
    std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(count)};
    if (values > 1) shape.push_back(static_cast<py::ssize_t>(values));
    py::array_t<T> array(shape);
    for (std::size_t i = 0; i < count; ++i)
      std::memcpy(array.mutable_data() + i * values, field.in(first + i * stride), values * sizeof(T));
    return py::object(std::move(array));
  };
  switch (field.kind) {
    case Field::Kind::u32:
    case Field::Kind::flag:
      return gather(std::uint32_t{}, field.count);
    case Field::Kind::u64:
      return gather(std::uint64_t{}, field.count);
    case Field::Kind::pose:
      return gather(double{}, pose_values);
    case Field::Kind::f32:
      return gather(float{}, field.count);
    default:
      return gather(double{}, field.count);
  }
}

}  // namespace

py::object value_of(const Field& field, const void* in) {
  const void* at = field.in(in);
  switch (field.kind) {
    case Field::Kind::u32:
      return numbers<std::uint32_t>(at, field.count);
    case Field::Kind::u64:
      return numbers<std::uint64_t>(at, field.count);
    case Field::Kind::f64:
      return numbers<double>(at, field.count);
    case Field::Kind::f32:
      return py::cast(*static_cast<const float*>(at));
    case Field::Kind::text:
      return text_of(at, field.count);
    case Field::Kind::pose:
      return copy_of(static_cast<const double*>(at), pose_values);
    case Field::Kind::flag:
      return py::bool_(*static_cast<const std::uint32_t*>(at) != 0);
    case Field::Kind::nanoseconds:
      return py::float_(static_cast<double>(*static_cast<const std::int64_t*>(at)) / 1e9);
    case Field::Kind::stamp:
    case Field::Kind::followers:
      break;
  }
  return py::none();
}

void stamp_into(py::dict& values, const shm::Stamp& stamp) {
  values["time"] = static_cast<double>(stamp.sim_time_ns) / 1e9;
  values["sequence"] = stamp.sequence;
  values["valid"] = stamp.valid != 0;
}

py::object followers_of(const shm::Tail& tail, const std::byte* first, std::size_t count) {
  if (tail.fields.front().name.empty()) return column_of(tail.fields.front(), first, tail.size, count);
  py::dict columns;
  for (const Field& field : tail.fields) columns[py::str(std::string(field.name))] = column_of(field, first, tail.size, count);
  return columns;
}

py::dict info_of(const shm::Iface& iface) {
  const auto& row = shm::row_of(iface.type());
  py::dict values;
  for (const Field& field : row.info) {
    values[py::str(std::string(field.name))] = field.kind == Field::Kind::followers
                                                   ? followers_of(row.info_tail, iface.info_followers(field.count), iface.count())
                                                   : value_of(field, iface.info_data().data());
  }
  return values;
}

py::dict sample_of(const shm::Iface& iface) {
  const auto& row = shm::row_of(iface.type());
  py::dict values;
  for (const Field& field : row.sample) {
    if (field.kind == Field::Kind::stamp) {
      stamp_into(values, *static_cast<const shm::Stamp*>(field.in(iface.sample_data().data())));
      continue;
    }
    values[py::str(std::string(field.name))] = field.kind == Field::Kind::followers
                                                   ? followers_of(row.sample_tail, iface.sample_followers(field.count), iface.filled())
                                                   : value_of(field, iface.sample_data().data());
  }
  return values;
}

namespace {

struct Pixels {
  py::dtype dtype;
  py::ssize_t channels;
};

Pixels pixels_of(shm::Format format) {
  using shm::Format;
  switch (shm::shown_as(format)) {
    case Format::rgb8:
    case Format::bgr8:
      return {py::dtype::of<std::uint8_t>(), 3};
    case Format::rgba8:
    case Format::bgra8:
      return {py::dtype::of<std::uint8_t>(), 4};
    case Format::mono16:
      return {py::dtype::of<std::uint16_t>(), 1};
    case Format::depth_float:
      return {py::dtype::of<float>(), 1};
    case Format::points_float:
      return {py::dtype::of<float>(), 3};
    case Format::points_intensity_float:
      return {py::dtype::of<float>(), 4};
    default:
      return {py::dtype::of<std::uint8_t>(), 1};
  }
}

}  // namespace

py::array image_of(const shm::HeldFrame& frame) {
  const shm::FrameHead& head = frame.head();
  const auto [dtype, channels] = pixels_of(static_cast<shm::Format>(head.format));
  std::vector<py::ssize_t> shape{head.height, head.width};
  if (channels > 1) shape.push_back(channels);
  py::array image(dtype, shape);
  const std::size_t row = std::size_t{head.width} * static_cast<std::size_t>(channels) * static_cast<std::size_t>(dtype.itemsize());
  auto* to = static_cast<std::byte*>(image.mutable_data());
  for (std::size_t y = 0; y < head.height; ++y) {
    const std::size_t from = y * head.stride;
    if (from + row > frame.data().size()) {
      std::memset(to + y * row, 0, row);  // a cloud that has fewer points than there is room for
    } else {
      std::memcpy(to + y * row, frame.data().data() + from, row);
    }
  }
  return image;
}

}  // namespace python
