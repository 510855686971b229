// Text files of Windows programs: UTF-16 with its byte order mark, or bytes as they are.
#pragma once

#include <string>

namespace trilens {

inline bool is_utf16(const std::string& bytes) {
    return bytes.size() >= 2 &&
           ((bytes[0] == '\xff' && bytes[1] == '\xfe') || (bytes[0] == '\xfe' && bytes[1] == '\xff'));
}

/// UTF-16 with its byte order mark as UTF-8; halves of pairs become '?'.
inline std::string utf8_of_utf16(const std::string& bytes) {
    const bool little = bytes[0] == '\xff';
    std::string text;
    for (std::size_t i = 2; i + 1 < bytes.size(); i += 2) {
        const auto low = static_cast<unsigned char>(bytes[little ? i : i + 1]);
        const auto high = static_cast<unsigned char>(bytes[little ? i + 1 : i]);
        const unsigned unit = high * 256u + low;
        if (unit < 0x80) {
            text += static_cast<char>(unit);
        } else if (unit < 0x800) {
            text += static_cast<char>(0xc0 | (unit >> 6));
            text += static_cast<char>(0x80 | (unit & 0x3f));
        } else if (unit >= 0xd800 && unit < 0xe000) {
            text += '?';
        } else {
            text += static_cast<char>(0xe0 | (unit >> 12));
            text += static_cast<char>(0x80 | ((unit >> 6) & 0x3f));
            text += static_cast<char>(0x80 | (unit & 0x3f));
        }
    }
    return text;
}

/// Without its byte order mark.
inline std::string text_of(const std::string& bytes) {
    if (is_utf16(bytes)) return utf8_of_utf16(bytes);
    return bytes.starts_with("\xef\xbb\xbf") ? bytes.substr(3) : bytes;
}

}  // namespace trilens
