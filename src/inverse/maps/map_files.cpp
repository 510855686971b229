#include "inverse/maps/film_map.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <span>

#include "base/util/error.h"
#include "base/util/format.h"
#include "image/zlib_stream.h"

namespace trilens {
namespace {

using Bytes = std::vector<unsigned char>;

void append(Bytes& to, const std::string& text) {
    to.insert(to.end(), text.begin(), text.end());
}

void append_little(Bytes& to, std::uint32_t value, int size) {
    for (int i = 0; i < size; ++i) to.push_back(static_cast<unsigned char>(value >> 8 * i));
}

/// A numpy array (NEP 1, version 1.0) of height x width values.
template <class Value>
Bytes npy_of(const std::vector<Value>& values, const char* type, int width, int height) {
    static_assert(std::endian::native == std::endian::little);
    std::string header =
        fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}, {}), }}", type, height, width);
    header.append(63 - (10 + header.size()) % 64, ' ').push_back('\n');
    Bytes bytes{0x93, 'N', 'U', 'M', 'P', 'Y', 1, 0};
    append_little(bytes, static_cast<std::uint32_t>(header.size()), 2);
    append(bytes, header);
    const std::size_t at = bytes.size();
    bytes.resize(at + values.size() * sizeof(Value));
    std::memcpy(bytes.data() + at, values.data(), values.size() * sizeof(Value));
    return bytes;
}

struct ZipEntry {
    std::string name;
    Bytes bytes;
};

/// A ZIP archive of stored files (PKWARE APPNOTE 4.3), dated 1 January 1980.
Bytes zip_of(const std::vector<ZipEntry>& entries) {
    Bytes zip, directory;
    for (const ZipEntry& entry : entries) {
        const auto offset = static_cast<std::uint32_t>(zip.size());
        Bytes common;
        append_little(common, 20, 2);          // version needed
        append_little(common, 0, 2);           // flags
        append_little(common, 0, 2);           // stored
        append_little(common, 0, 2);           // time
        append_little(common, 1 << 5 | 1, 2);  // date
        append_little(common, png_checksum(entry.bytes), 4);
        append_little(common, static_cast<std::uint32_t>(entry.bytes.size()), 4);
        append_little(common, static_cast<std::uint32_t>(entry.bytes.size()), 4);
        append_little(common, static_cast<std::uint32_t>(entry.name.size()), 2);
        append_little(common, 0, 2);  // extra field
        append_little(zip, 0x04034b50, 4);
        zip.insert(zip.end(), common.begin(), common.end());
        append(zip, entry.name);
        zip.insert(zip.end(), entry.bytes.begin(), entry.bytes.end());

        append_little(directory, 0x02014b50, 4);
        append_little(directory, 20, 2);  // made by
        directory.insert(directory.end(), common.begin(), common.end());
        append_little(directory, 0, 2);  // comment
        append_little(directory, 0, 2);  // disk
        append_little(directory, 0, 2);  // attributes
        append_little(directory, 0, 4);
        append_little(directory, offset, 4);
        append(directory, entry.name);
    }
    const auto start = static_cast<std::uint32_t>(zip.size());
    zip.insert(zip.end(), directory.begin(), directory.end());
    append_little(zip, 0x06054b50, 4);
    append_little(zip, 0, 4);
    append_little(zip, static_cast<std::uint32_t>(entries.size()), 2);
    append_little(zip, static_cast<std::uint32_t>(entries.size()), 2);
    append_little(zip, static_cast<std::uint32_t>(directory.size()), 4);
    append_little(zip, start, 4);
    append_little(zip, 0, 2);
    return zip;
}

}  // namespace

Image stmap_of(const FilmMap& map, bool t_up) {
    Image image;
    image.width = image.data_width = map.width;
    image.height = image.data_height = map.height;
    std::vector<float> s(map.x.size(), -1), t(s), none(map.x.size(), 0), alpha(none);
    for (std::size_t p = 0; p < s.size(); ++p) {
        if (!map.valid[p]) continue;
        s[p] = static_cast<float>(double(map.x[p]) / map.source_width);
        const double down = double(map.y[p]) / map.source_height;
        t[p] = static_cast<float>(t_up ? 1 - down : down);
        alpha[p] = 1;
    }
    image.channels = {
        {"R", std::move(s)}, {"G", std::move(t)}, {"B", std::move(none)}, {"A", std::move(alpha)}};
    const char* names[4] = {"jacobian.XX", "jacobian.XY", "jacobian.YX", "jacobian.YY"};
    for (int k = 0; k < 4; ++k) image.channels.push_back({names[k], map.jacobian[k]});
    return image;
}

std::vector<unsigned char> npz_of(const FilmMap& map) {
    const auto shifted = [&](std::vector<float> values) {
        for (std::size_t p = 0; p < values.size(); ++p) values[p] = map.valid[p] ? values[p] - 0.5f : -1.0f;
        return npy_of(values, "<f4", map.width, map.height);
    };
    return zip_of({{"map_x.npy", shifted(map.x)},
                   {"map_y.npy", shifted(map.y)},
                   {"valid.npy", npy_of(map.valid, "|u1", map.width, map.height)}});
}

std::vector<unsigned char> pgm_of(const FilmMap& map, MapAxis axis) {
    const int side = axis == MapAxis::kX ? map.source_width : map.source_height;
    if (side > 65535) throw InputError("", "", "a PGM map counts pixels in 16 bits: the source has too many");
    Bytes bytes;
    append(bytes, fmt::format("P5\n{} {}\n65535\n", map.width, map.height));
    const std::vector<float>& values = axis == MapAxis::kX ? map.x : map.y;
    for (std::size_t p = 0; p < values.size(); ++p) {
        const double pixel = std::floor(double(values[p]));
        const bool is_on = map.valid[p] && pixel >= 0 && pixel < side;
        const auto value = static_cast<std::uint16_t>(is_on ? pixel : 65535);
        bytes.push_back(static_cast<unsigned char>(value >> 8));
        bytes.push_back(static_cast<unsigned char>(value));
    }
    return bytes;
}

std::string pgm_name(const std::string& file, MapAxis axis) {
    const std::size_t dot = file.rfind('.');
    return file.substr(0, dot) + (axis == MapAxis::kX ? "_x" : "_y") + file.substr(dot);
}

}  // namespace trilens
