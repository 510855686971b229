// WebP's container: what must be known of it beside what OpenImageIO reads. Source: WebP Container
// Specification, and Specification for WebP Lossless Bitstream (Google).
#pragma once

#include <span>
#include <vector>

namespace trilens {

/// Whether bytes start as a WebP's do.
bool is_webp(std::span<const unsigned char> encoded);

/// The same picture, said to be opaque. OpenImageIO 2.4 multiplies colours by alpha with 8 bits, whatever it
/// is asked for: of this it gives them as the file has them. Damaged chunks stay as they are.
std::vector<unsigned char> webp_without_alpha(std::span<const unsigned char> encoded);

}  // namespace trilens
