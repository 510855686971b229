#include "image/library_reason.h"

namespace trilens {

std::string library_reason(const std::string& report) {
    std::string line;
    for (const char c : report) {
        if (c != '\n' && c != '\r')
            line += c;
        else if (!line.empty() && line.back() != ' ')
            line += ' ';
    }
    while (!line.empty() && (line.back() == ' ' || line.back() == '.')) line.pop_back();
    return line.empty() ? "unknown reason" : line;
}

}  // namespace trilens
