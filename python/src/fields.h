// Values of infos and samples as Python objects, by the table of iface types (shm/iface_types.h). Arrays are copies: they never change.
// With the GIL.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <span>

#include "shm/client.h"
#include "shm/iface_types.h"

namespace python {

namespace py = pybind11;

// Numbers, texts, truth values; float64 arrays where there are several numbers; a pose is an array x y z qw qx qy qz; a stamp is not
// in the list, see stamp_into(). `in` is the start of an info, a sample or an element.
py::object value_of(const shm::Field& field, const void* in);
// time [s], sequence, valid.
void stamp_into(py::dict& values, const shm::Stamp& stamp);

py::dict info_of(const shm::Iface& iface);
// Of the sample that was read last.
py::dict sample_of(const shm::Iface& iface);
// The arrays that follow, by the names of the fields: float32 of ranges, else one array for each field of their elements.
py::object followers_of(const shm::Tail& tail, const std::byte* first, std::size_t count);

// The image of a frame: (height, width, channels), without channels where there is one. uint8, uint16 or float32.
py::array image_of(const shm::HeldFrame& frame);

}  // namespace python
