#include "scene/samples/xml_tags.h"

#include <utility>

namespace trilens {

bool TagScanner::skip_past(std::string_view begin, std::string_view end) {
    if (!text_.substr(at_).starts_with(begin)) return false;
    const std::size_t found = text_.find(end, at_);
    if (found == std::string_view::npos) fail("the file ends within '" + std::string(begin) + "'");
    at_ = found + end.size();
    return true;
}

std::string TagScanner::name() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && !is_space(text_[at_]) && text_[at_] != '>' && text_[at_] != '/' &&
           text_[at_] != '=')
        ++at_;
    return std::string(text_.substr(begin, at_ - begin));
}

std::string TagScanner::value() {
    const char quote = at_ < text_.size() ? text_[at_] : ' ';
    if (quote != '"' && quote != '\'') fail("a value must stand in quotes");
    const std::size_t end = text_.find(quote, at_ + 1);
    if (end == std::string_view::npos) fail("the file ends within a value");
    std::string value(text_.substr(at_ + 1, end - at_ - 1));
    at_ = end + 1;
    // The ampersand last, so that nothing is taken for another one.
    for (const auto& [entity, letter] :
         {std::pair{"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}, {"&amp;", '&'}})
        for (std::size_t from = 0; (from = value.find(entity, from)) != std::string::npos; ++from)
            value.replace(from, std::string_view(entity).size(), 1, letter);
    return value;
}

std::optional<Tag> TagScanner::next() {
    while (true) {
        at_ = std::min(text_.find('<', at_), text_.size());
        if (at_ == text_.size()) return std::nullopt;
        if (skip_past("<?", "?>") || skip_past("<!--", "-->") || skip_past("<!", ">")) continue;
        break;
    }
    ++at_;
    Tag tag;
    tag.is_end = at_ < text_.size() && text_[at_] == '/';
    if (tag.is_end) ++at_;
    tag.name = name();
    if (tag.name.empty()) fail("a tag without a name");
    while (true) {
        skip_spaces();
        if (at_ >= text_.size()) fail("the file ends within the tag '" + tag.name + "'");
        if (text_[at_] == '>' || text_.substr(at_).starts_with("/>")) break;
        const std::string key = name();
        skip_spaces();
        if (key.empty() || at_ >= text_.size() || text_[at_] != '=')
            fail("an attribute of '" + tag.name + "' must be name=\"value\"");
        ++at_;
        skip_spaces();
        tag.attributes[key] = value();
    }
    at_ += text_[at_] == '/' ? 2 : 1;
    tag.end = at_;
    return tag;
}

}  // namespace trilens
