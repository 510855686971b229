// Accessor, buffer view, buffer: glTF 2.0 specification, section 3.6.2.
#include "scene/formats/gltf_accessor.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include <tiny_gltf.h>

#include "base/util/error.h"
#include "scene/data/polygons.h"

namespace trilens {
namespace {

constexpr std::size_t kMostEntries = std::size_t{1} << 28;

struct Place {
    const std::string& file;
    int accessor;

    [[noreturn]] void fail(const std::string& message) const {
        throw InputError(file, "/accessors/" + std::to_string(accessor), message);
    }
};

/// Where entries of one type lie: count of them, stride bytes apart.
struct Entries {
    const unsigned char* first = nullptr;
    std::size_t stride = 0;
};

/// Bytes [offset, ...) of a buffer view that must hold `count` entries of `entry_size` bytes.
Entries find_entries(const tinygltf::Model& model, int view_index, std::size_t offset, std::size_t count,
                     std::size_t entry_size, const Place& place) {
    if (view_index < 0 || static_cast<std::size_t>(view_index) >= model.bufferViews.size())
        place.fail("buffer view " + std::to_string(view_index) + " is out of range");
    const tinygltf::BufferView& view = model.bufferViews[static_cast<std::size_t>(view_index)];
    if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= model.buffers.size())
        place.fail("buffer " + std::to_string(view.buffer) + " is out of range");
    const std::vector<unsigned char>& bytes = model.buffers[static_cast<std::size_t>(view.buffer)].data;
    if (view.byteOffset > bytes.size() || view.byteLength > bytes.size() - view.byteOffset)
        place.fail("its buffer view reaches beyond its buffer");

    const std::size_t stride = view.byteStride == 0 ? entry_size : view.byteStride;
    if (stride < entry_size || stride > 252 + entry_size)
        place.fail("its buffer view has an impossible stride");
    if (offset > view.byteLength ||
        (count > 0 && (count - 1) * stride + entry_size > view.byteLength - offset))
        place.fail("reaches beyond its buffer view");
    return {bytes.data() + view.byteOffset + offset, stride};
}

template <class T>
double component(const unsigned char* bytes, bool normalized) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    if (!normalized || !std::numeric_limits<T>::is_integer) return static_cast<double>(value);
    return std::max(static_cast<double>(value) / static_cast<double>(std::numeric_limits<T>::max()), -1.0);
}

double read_component(const unsigned char* bytes, int type, bool normalized, const Place& place) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            return component<std::int8_t>(bytes, normalized);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return component<std::uint8_t>(bytes, normalized);
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            return component<std::int16_t>(bytes, normalized);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return component<std::uint16_t>(bytes, normalized);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return component<std::uint32_t>(bytes, normalized);
        case TINYGLTF_COMPONENT_TYPE_FLOAT:
            return component<float>(bytes, false);
        default:
            place.fail("unknown component type " + std::to_string(type));
    }
}

std::size_t component_size(int type, const Place& place) {
    const int size = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(type));
    if (size <= 0 || type == TINYGLTF_COMPONENT_TYPE_DOUBLE || type == TINYGLTF_COMPONENT_TYPE_INT)
        place.fail("unknown component type " + std::to_string(type));
    return static_cast<std::size_t>(size);
}

std::size_t non_negative(int value, const Place& place) {
    if (value < 0) place.fail("has a negative offset or count");
    return static_cast<std::size_t>(value);
}

void fill_sparse(const tinygltf::Model& model, const tinygltf::Accessor& accessor, std::size_t components,
                 const Place& place, std::vector<double>& numbers) {
    const auto& sparse = accessor.sparse;
    const std::size_t count = non_negative(sparse.count, place);
    if (count > accessor.count) place.fail("has more sparse entries than entries");
    const std::size_t size = component_size(accessor.componentType, place);
    const std::size_t index_size = component_size(sparse.indices.componentType, place);
    const Entries indices =
        find_entries(model, sparse.indices.bufferView, non_negative(sparse.indices.byteOffset, place), count,
                     index_size, place);
    const Entries values =
        find_entries(model, sparse.values.bufferView, non_negative(sparse.values.byteOffset, place), count,
                     size * components, place);
    for (std::size_t i = 0; i < count; ++i) {
        const double index =
            read_component(indices.first + i * indices.stride, sparse.indices.componentType, false, place);
        if (!(index >= 0 && index < static_cast<double>(accessor.count)))
            place.fail("a sparse index is out of range");
        for (std::size_t c = 0; c < components; ++c)
            numbers[static_cast<std::size_t>(index) * components + c] =
                read_component(values.first + i * values.stride + c * size, accessor.componentType,
                               accessor.normalized, place);
    }
}

}  // namespace

std::vector<double> read_gltf_accessor(const tinygltf::Model& model, int index, int components,
                                       const std::string& file) {
    const Place place{file, index};
    if (index < 0 || static_cast<std::size_t>(index) >= model.accessors.size())
        place.fail("is out of range: there are " + std::to_string(model.accessors.size()) + " accessors");
    const tinygltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(index)];
    if (tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type)) != components)
        place.fail("must have entries of " + std::to_string(components) + " components");
    if (accessor.count > kMostEntries) place.fail("has too many entries");

    const auto width = static_cast<std::size_t>(components);
    const std::size_t size = component_size(accessor.componentType, place);
    std::vector<double> numbers;
    if (accessor.bufferView < 0) {
        if (!accessor.sparse.isSparse) place.fail("has no buffer view (its data may be compressed)");
        numbers.assign(accessor.count * width, 0);
    } else {
        const Entries entries = find_entries(model, accessor.bufferView, accessor.byteOffset, accessor.count,
                                             size * width, place);
        numbers.reserve(accessor.count * width);
        for (std::size_t i = 0; i < accessor.count; ++i)
            for (std::size_t c = 0; c < width; ++c)
                numbers.push_back(read_component(entries.first + i * entries.stride + c * size,
                                                 accessor.componentType, accessor.normalized, place));
    }
    if (accessor.sparse.isSparse) fill_sparse(model, accessor, width, place, numbers);
    for (std::size_t i = 0; i < numbers.size(); ++i)
        if (!(std::abs(numbers[i]) <= kLargestCoordinate))
            place.fail("entry " + std::to_string(i / width) +
                       " holds a number that is not finite or beyond 1e30");
    return numbers;
}

}  // namespace trilens
