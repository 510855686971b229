// A small strict XML reader for tests: enough to say that a picture is well formed and to find its elements.
#pragma once

#include <cctype>
#include <cstddef>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace trilens_test {

struct XmlElement {
    std::string name;
    std::map<std::string, std::string> attributes;  // entities resolved
    std::string text;                               // directly inside, entities resolved

    double number(const std::string& attribute) const { return std::stod(attributes.at(attribute)); }
    bool has_class(const std::string& name_of_class) const {
        const auto found = attributes.find("class");
        return found != attributes.end() &&
               (" " + found->second + " ").find(" " + name_of_class + " ") != std::string::npos;
    }
};

/// Throws std::runtime_error with the place where the text is not well formed.
class XmlReader {
  public:
    explicit XmlReader(std::string_view text) : text_(text) {}

    /// All elements in the order in which they begin.
    std::vector<XmlElement> read() {
        skip_space();
        read_element();
        skip_space();
        if (at_ != text_.size()) fail("something after the root");
        return elements_;
    }

  private:
    [[noreturn]] void fail(const std::string& why) const {
        throw std::runtime_error("XML, byte " + std::to_string(at_) + ": " + why);
    }
    char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
    void expect(std::string_view what) {
        if (text_.substr(at_, what.size()) != what) fail("expected " + std::string(what));
        at_ += what.size();
    }
    void skip_space() {
        while (std::isspace(static_cast<unsigned char>(peek()))) ++at_;
    }
    std::string read_name() {
        const std::size_t start = at_;
        while (std::isalnum(static_cast<unsigned char>(peek())) || peek() == '-' || peek() == ':' ||
               peek() == '_')
            ++at_;
        if (at_ == start) fail("expected a name");
        return std::string(text_.substr(start, at_ - start));
    }
    /// One character or entity of text, up to `end`.
    std::string read_character() {
        if (peek() == '<' || at_ >= text_.size()) fail("unexpected < or end");
        if (static_cast<unsigned char>(peek()) < 0x20 && !std::isspace(static_cast<unsigned char>(peek())))
            fail("forbidden control character");
        if (peek() != '&') return std::string(1, text_[at_++]);
        static const std::map<std::string, std::string> kEntities = {
            {"&amp;", "&"}, {"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&#39;", "'"}};
        for (const auto& [entity, character] : kEntities)
            if (text_.substr(at_, entity.size()) == entity) {
                at_ += entity.size();
                return character;
            }
        fail("unknown entity");
    }
    void read_element() {
        expect("<");
        const std::size_t self = elements_.size();
        elements_.push_back({read_name(), {}, ""});
        for (skip_space(); peek() != '>' && peek() != '/'; skip_space()) {
            const std::string name = read_name();
            expect("=\"");
            std::string value;
            while (peek() != '"') value += read_character();
            expect("\"");
            if (!elements_[self].attributes.emplace(name, value).second) fail("attribute twice: " + name);
        }
        if (peek() == '/') return expect("/>");
        expect(">");
        while (text_.substr(at_, 2) != "</") {
            if (peek() == '<')
                read_element();
            else
                elements_[self].text += read_character();
        }
        expect("</" + elements_[self].name);
        skip_space();
        expect(">");
    }

    std::string_view text_;
    std::size_t at_ = 0;
    std::vector<XmlElement> elements_;
};

inline std::vector<XmlElement> read_xml(std::string_view text) {
    return XmlReader(text).read();
}

}  // namespace trilens_test
