// numpy arrays in and out: checked on the way in, views without a copy on the way out.
#pragma once

#include <pybind11/numpy.h>

#include <memory>
#include <vector>

#include "bindings.h"

namespace trilens::python {

/// Throws UsageError for a numpy array of which values are masked: nothing here could leave them out.
void refuse_masked(py::handle given);

/// Arrays of any real type and layout; what is not float64 in C order is converted. Complex ones and those
/// with masked values are refused with UsageError, where numpy would leave the imaginary part or the mask out;
/// texts with Python's TypeError.
class Doubles : public py::array_t<double, py::array::c_style | py::array::forcecast> {
  public:
    using Plain = py::array_t<double, py::array::c_style | py::array::forcecast>;
    using Plain::Plain;
    Doubles(Plain plain) : Plain(std::move(plain)) {}
};
/// Arrays of whole numbers that are 0 or more.
using Indices = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;

/// An N x 3 array as points. Throws UsageError, naming `name`, for other shapes.
std::vector<Vec3> points_of(const Doubles& array, const std::string& name);

/// Anything that numpy makes an array of; else Python's TypeError. Throws UsageError for masked values.
py::array array_from(const py::object& object, const std::string& name);

/// An array of ids of any shape, in C order. Throws UsageError, naming `name`, for numbers that are none.
std::vector<Id> ids_of(const py::array& array, const std::string& name);
inline std::vector<Id> ids_of(const py::object& object, const std::string& name) {
    return ids_of(array_from(object, name), name);
}

/// An N x 3 array as triples of ids.
std::vector<IdTriple> triples_of(const py::object& object, const std::string& name);

/// Throws UsageError unless the array has these dimensions; -1: any length.
void require_shape(const py::array& array, std::span<const py::ssize_t> shape, const std::string& name);

/// What an array looks at inside a C++ object: `shape` and `strides` (in bytes) over the data.
struct ArrayLayout {
    std::vector<py::ssize_t> shape, strides;
};

/// A view of `data` that keeps `owner` alive; not for writing.
template <class Value>
py::array_t<Value> constant_view(const Value* data, const ArrayLayout& layout, const py::object& owner) {
    py::array_t<Value> view(layout.shape, layout.strides, data, owner);
    view.attr("flags").attr("writeable") = false;
    return view;
}

/// A view of a list of numbers.
template <class Value>
py::array_t<Value> constant_view(const std::vector<Value>& values, const py::object& owner) {
    return constant_view(
        values.data(), {{static_cast<py::ssize_t>(values.size())}, {static_cast<py::ssize_t>(sizeof(Value))}},
        owner);
}

/// N x 3 views of lists of vectors and of id triples.
py::array_t<double> constant_view(const std::vector<Vec3>& values, const py::object& owner);
py::array_t<Id> constant_view(const std::vector<IdTriple>& values, const py::object& owner);

/// An array that takes the list over, without a copy.
template <class Value>
py::array_t<Value> array_of(std::vector<Value> values, std::vector<py::ssize_t> shape) {
    auto owned = std::make_unique<std::vector<Value>>(std::move(values));
    const std::vector<Value>& list = *owned;
    const py::capsule owner(owned.release(), [](void* p) { delete static_cast<std::vector<Value>*>(p); });
    return py::array_t<Value>(std::move(shape), list.data(), owner);
}

template <class Value>
py::array_t<Value> array_of(std::vector<Value> values) {
    const auto size = static_cast<py::ssize_t>(values.size());
    return array_of(std::move(values), {size});
}

}  // namespace trilens::python

/// Arguments of type Doubles.
template <>
struct pybind11::detail::type_caster<trilens::python::Doubles> {
    PYBIND11_TYPE_CASTER(trilens::python::Doubles, type_caster<trilens::python::Doubles::Plain>::name);

    bool load(handle given, bool convert) {
        type_caster<trilens::python::Doubles::Plain> plain;
        const array any = array::ensure(given);
        if (!any) return false;
        if (any.dtype().kind() == 'c')
            throw trilens::UsageError("an array of complex numbers is given for real ones");
        if (any.dtype().kind() == 'U' || any.dtype().kind() == 'S')
            throw type_error("an array of texts is given for numbers");
        trilens::python::refuse_masked(given);
        if (!plain.load(given, convert)) return false;
        value = trilens::python::Doubles(static_cast<trilens::python::Doubles::Plain&>(plain));
        return true;
    }
};
