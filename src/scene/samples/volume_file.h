// Files of volumes: VTK's legacy and XML formats, NRRD, and samples as they lie in a file.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "scene/data/scene_inputs.h"
#include "scene/samples/binary_numbers.h"
#include "volume/tet_mesh.h"

namespace trilens {

/// What a file of a volume holds.
struct VolumeFile {
    std::variant<CellSoup, RegularGrid> cells;
    std::string field;                  // the scalars' name; empty: they have none
    std::vector<std::string> warnings;  // without the file's name
};

/// Parses a legacy VTK file (versions 1 to 5.1, ASCII or binary): DATASET UNSTRUCTURED_GRID of tetrahedra,
/// pyramids, wedges, hexahedra and voxels (cells of other shapes are left out, with a warning), or
/// STRUCTURED_POINTS; of POINT_DATA the field of that name (SCALARS, or an array of FIELD, with one
/// component; empty: the first one). Throws InputError(file, "line n") for what is malformed, of another
/// kind, or larger than the file, and where no field of that name, or none at all, is there; numbers that are
/// not finite are told by point. Source: The VTK User's Guide, "VTK File Formats".
VolumeFile parse_vtk(const std::string& bytes, const std::string& file, const std::string& field);

/// Parses an unstructured grid in VTK's XML format (.vtu; serial, of one piece or several): the same cells
/// and fields. Its arrays are ASCII, base64, or appended (base64 or raw), of either byte order, as they are
/// or packed by zlib. Throws as parse_vtk does. Source: The VTK User's Guide, "VTK File Formats", XML.
VolumeFile parse_vtu(const std::string& bytes, const std::string& file, const std::string& field,
                     const Inflate& inflate);

/// As numpy and NRRD name them: "uint8", ..., "float", "double", "uint64", "int64".
const std::vector<std::string>& sample_type_names();

/// How samples lie in a file.
struct SampleLayout {
    SampleType type = SampleType::kUint8;
    bool big_endian = false;
    std::size_t skip = 0;  // bytes before the first sample
};

/// The samples of a grid of that size, x fastest, out of a file's bytes. Throws InputError(file, "") where
/// there are fewer than that, or more when nothing was skipped, or one is not finite.
std::vector<double> decode_samples(std::string_view bytes, const std::string& file,
                                   const std::array<std::size_t, 3>& size, const SampleLayout& layout);

/// The number of points of a grid. Throws InputError(file, place) where a side is below 2, or its cells are
/// more than kMostCells: before anything is read.
std::size_t checked_point_count(const std::array<std::size_t, 3>& size, const std::string& file,
                                const std::string& place);

/// Reads another file, named from the folder of the first.
using ReadBeside = std::function<std::string(const std::string& name)>;

/// Parses an NRRD of three dimensions, attached or detached, its samples raw, packed by gzip, or as text,
/// with spacings or space directions, and its origin. Throws InputError(file, "line n") for what is malformed
/// or of another kind. Source: Kindlmann, Definition of NRRD File Format, teem.sourceforge.net/nrrd.
RegularGrid parse_nrrd(const std::string& bytes, const std::string& file, const ReadBeside& read_beside,
                       const Inflate& inflate);

}  // namespace trilens
