// Maps as other programs take them: STMap images, OpenCV's remap arrays, ffmpeg's pairs of 16-bit PGM.
#pragma once

#include <string>
#include <vector>

#include "base/image/image.h"
#include "inverse/maps/film_map.h"

namespace trilens {

/// An STMap: R and G are where to look, 0..1 over the source's width and height from its top left (`t_up`: G
/// from its bottom, as Nuke has it), -1 where nothing is; B is 0; A is 1 where something is; jacobian.XX,
/// .XY, .YX, .YY are source pixels per pixel (dx/dx, dx/dy, dy/dx, dy/dy). `oiiotool
/// photo.exr --crop WxH+0+0 map.exr --st_warp` warps by it, WxH the map's size.
Image stmap_of(const FilmMap& map, bool t_up = false);

/// A numpy archive (.npz, stored): map_x and map_y, float32, for cv2.remap (a pixel's centre at whole
/// numbers; -1 where nothing is), and valid, uint8.
std::vector<unsigned char> npz_of(const FilmMap& map);

/// One of the two PGM files (16 bit) of ffmpeg's filter remap: the source's column (or row) for each pixel;
/// 65535 where nothing is. Throws InputError for sources beyond 65535 pixels.
enum class MapAxis { kX, kY };
std::vector<unsigned char> pgm_of(const FilmMap& map, MapAxis axis);

/// "map.pgm" -> "map_x.pgm" or "map_y.pgm".
std::string pgm_name(const std::string& file, MapAxis axis);

}  // namespace trilens
