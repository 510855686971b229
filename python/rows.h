// Structured arrays: records of C++ as numpy sees them, by names, formats and offsets of their fields.
#pragma once

#include <pybind11/numpy.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string_view>
#include <vector>

#include "bindings.h"

namespace trilens::python {

/// numpy's type of a record, as it is built field by field; formats as numpy writes them: "f8", "(3,)f8".
class RecordType {
  public:
    void add(const char* name, const py::object& format, std::size_t offset) {
        names_.append(name);
        formats_.append(format);
        offsets_.append(offset);
    }
    void add(const char* name, const char* format, std::size_t offset) { add(name, py::str(format), offset); }

    /// What numpy.dtype makes a type of, for records of so many bytes.
    py::dict of_size(std::size_t size) const {
        py::dict type;
        type["names"] = names_;
        type["formats"] = formats_;
        type["offsets"] = offsets_;
        type["itemsize"] = size;
        return type;
    }

  private:
    py::list names_, formats_, offsets_;
};

/// A copy of records that stand one behind the other.
inline py::array record_array(const py::dict& type, const void* data, std::size_t count) {
    const py::object dtype = py::module_::import("numpy").attr("dtype")(type);
    return py::array(py::dtype::from_args(dtype), {static_cast<py::ssize_t>(count)},
                     {type["itemsize"].cast<py::ssize_t>()}, data);
}

/// A record of zeros, its gaps too: equal records, equal bytes.
template <class Record>
Record empty_record() {
    Record record;
    std::memset(&record, 0, sizeof record);
    return record;
}

/// A text field; `target` has room and is zero.
inline void copy_text(std::string_view text, char32_t* target) {
    std::copy(text.begin(), text.end(), target);
}

inline void copy_vector(const Vec3& v, double* target) {
    for (int k = 0; k < 3; ++k) target[k] = v[k];
}

}  // namespace trilens::python
