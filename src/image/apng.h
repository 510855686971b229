// Several PNGs as one animated PNG.
#pragma once

#include <span>
#include <vector>

namespace trilens {

/// One APNG (Portable Network Graphics, Third Edition, W3C) that shows the pictures one after the other, for
/// 1 / fps seconds each, again and again; a program that knows no APNG shows the first. They are PNG files of
/// one size and colour type, at least one; `fps`: 0.001..1000. Throws UsageError for an fps beyond that,
/// InputError for bytes that are no PNG or pictures that differ in kind.
std::vector<unsigned char> encode_apng(std::span<const std::vector<unsigned char>> pngs, double fps);

}  // namespace trilens
