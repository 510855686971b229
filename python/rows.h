// Structured arrays: records of C++ as numpy sees them, by names, formats and offsets of their fields.
#pragma once

#include <pybind11/numpy.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <string_view>
#include <utility>
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

/// Memory for records of one size, zero all over: as the system gives it, so that nothing is written twice.
class ZeroedRecords {
  public:
    ZeroedRecords() = default;
    ZeroedRecords(std::size_t count, std::size_t record_size)
        : count_(count),
          bytes_(static_cast<std::byte*>(std::calloc(std::max<std::size_t>(count, 1), record_size))) {
        if (!bytes_) throw std::bad_alloc();
    }
    std::size_t count() const { return count_; }
    std::byte* data() const { return bytes_.get(); }
    std::byte* release() { return bytes_.release(); }

  private:
    struct Free {
        void operator()(std::byte* bytes) const { std::free(bytes); }
    };
    std::size_t count_ = 0;
    std::unique_ptr<std::byte, Free> bytes_;
};

/// The array takes the memory over, without a copy.
inline py::array record_array(const py::dict& type, ZeroedRecords records) {
    const py::object dtype = py::module_::import("numpy").attr("dtype")(type);
    const auto size = type["itemsize"].cast<py::ssize_t>();
    const auto count = static_cast<py::ssize_t>(records.count());
    const void* data = records.data();
    const py::capsule owner(records.release(), [](void* p) { std::free(p); });
    return py::array(py::dtype::from_args(dtype), {count}, {size}, data, owner);
}

/// Records that stand one behind the other; the array takes the list over, without a copy.
template <class Record>
py::array record_array(const py::dict& type, std::vector<Record> records) {
    const py::object dtype = py::module_::import("numpy").attr("dtype")(type);
    const auto size = type["itemsize"].cast<py::ssize_t>();
    const auto count = static_cast<py::ssize_t>(records.size() * sizeof(Record)) / size;
    auto owned = std::make_unique<std::vector<Record>>(std::move(records));
    const void* data = owned->data();
    const py::capsule owner(owned.release(), [](void* p) { delete static_cast<std::vector<Record>*>(p); });
    return py::array(py::dtype::from_args(dtype), {count}, {size}, data, owner);
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

/// Where a path meets an optic, as numpy sees it.
struct EventRow {
    Id optic, face;
    char32_t event[8];
    bool front;
    double uv[2], point[3], normal[3];
};

/// Its fields, in records where it stands at `offset`.
inline void add_event_fields(RecordType& type, std::size_t offset = 0) {
    type.add("optic", "u4", offset + offsetof(EventRow, optic));
    type.add("event", "U8", offset + offsetof(EventRow, event));
    type.add("front", "?", offset + offsetof(EventRow, front));
    type.add("face", "u4", offset + offsetof(EventRow, face));
    type.add("uv", "(2,)f8", offset + offsetof(EventRow, uv));
    type.add("point", "(3,)f8", offset + offsetof(EventRow, point));
    type.add("normal", "(3,)f8", offset + offsetof(EventRow, normal));
}

/// `row` is zero.
inline void fill_event(const PathEvent& event, EventRow& row) {
    row.optic = event.optic, row.face = event.face;
    copy_text(event_name(event.event), row.event);
    row.front = event.front;
    row.uv[0] = event.uv.x, row.uv[1] = event.uv.y;
    copy_vector(event.point, row.point);
    copy_vector(event.normal, row.normal);
}

}  // namespace trilens::python
