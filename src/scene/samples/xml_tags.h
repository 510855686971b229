// Tags of XML, one after the other: as far as VTK's files need them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "base/util/error.h"

namespace trilens {

/// One tag, or (`is_end`) the one that closes it.
struct Tag {
    std::string name;
    std::map<std::string, std::string> attributes;
    bool is_end = false;
    std::size_t end = 0;  // of the text: behind its bracket

    std::string attribute(const std::string& key, const std::string& otherwise = "") const {
        const auto found = attributes.find(key);
        return found == attributes.end() ? otherwise : found->second;
    }
};

/// No entities but the five, no CDATA. The text and the file's name must live longer.
class TagScanner {
  public:
    TagScanner(std::string_view text, const std::string& file) : text_(text), file_(file) {}

    [[noreturn]] void fail(const std::string& message) const {
        const auto line =
            1 + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(at_), '\n');
        throw InputError(file_, "line " + std::to_string(line), message);
    }
    /// None at the end of the text.
    std::optional<Tag> next();

  private:
    static bool is_space(char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r'; }
    void skip_spaces() {
        while (at_ < text_.size() && is_space(text_[at_])) ++at_;
    }
    std::string name();
    std::string value();
    bool skip_past(std::string_view begin, std::string_view end);

    std::string_view text_;
    const std::string& file_;
    std::size_t at_ = 0;
};

}  // namespace trilens
