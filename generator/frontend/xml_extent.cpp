#include "frontend/xml_extent.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string_view>

namespace dalembert::frontend {

namespace {

// TinyXML's classes of characters; beyond ASCII everything is a letter.
bool is_letter(unsigned char c) { return c >= 127 || std::isalpha(c) || c == '_'; }
bool is_name_character(unsigned char c) { return is_letter(c) || std::isdigit(c) || c == '-' || c == '.' || c == ':'; }

// Bytes of the UTF-8 character that begins with this one.
size_t length(unsigned char c) { return c < 0xc2 || c > 0xf4 ? 1 : c < 0xe0 ? 2 : c < 0xf0 ? 3 : 4; }

// Every step returns false where TinyXML stops for good.
class Walk {
 public:
  explicit Walk(std::string_view text) : text_(text) {
    if (const size_t zero = text.find('\0'); zero != text.npos)
      throw XmlError("byte 0 is no character", "save the file as text in UTF-8", zero);
  }

  XmlExtent extent() {
    while (skip_blanks() && node()) continue;
    return extent_;
  }

 private:
  bool node() {
    if (peek() == '<' && open_ > 0 && next_is("</")) return end_tag();
    ++extent_.nodes;
    if (peek() != '<') return open_ > 0 && text_until('<');
    if (next_is("<!--")) return behind("-->", 4);
    if (next_is("<![CDATA[")) return behind("]]>", 9);
    if (next_is_word("<?xml")) return declaration();
    if (at_ + 1 < text_.size() && is_letter(static_cast<unsigned char>(text_[at_ + 1]))) return element();
    return behind(">", 1);
  }

  bool element() {
    extent_.depth = std::max(extent_.depth, open_ + 1);
    ++at_;
    if (!skip_blanks() || !name()) return false;
    for (int attributes = 0;; ++attributes) {
      if (!skip_blanks()) return false;
      if (peek() == '>') {
        ++open_;
        ++at_;
        return true;
      }
      if (peek() == '/') {
        at_ += 2;
        return at_ < text_.size() && text_[at_ - 1] == '>';
      }
      if (!attribute()) return false;
      ++extent_.nodes;
      extent_.attributes = std::max(extent_.attributes, attributes + 1);
    }
  }

  // Whether it names the element that is open does not matter: if not, TinyXML stops.
  bool end_tag() {
    --open_;
    return behind(">", 2);
  }

  // <?xml …>: a '>' in the value of one of three attributes does not end it, in any other it does.
  bool declaration() {
    at_ += 5;
    while (at_ < text_.size()) {
      if (peek() == '>') return advance(1);
      if (!skip_blanks()) return false;
      if (next_is_word("version") || next_is_word("encoding") || next_is_word("standalone")) {
        if (!attribute()) return false;
      } else {
        while (at_ < text_.size() && peek() != '>' && !is_blank(peek())) ++at_;
      }
    }
    return false;
  }

  bool attribute() {
    if (!skip_blanks() || !name() || !skip_blanks() || peek() != '=') return false;
    ++at_;
    if (!skip_blanks()) return false;
    if (const char quote = peek(); quote == '"' || quote == '\'') {
      ++at_;
      return text_until(quote) && advance(1);
    }
    while (at_ < text_.size() && !is_blank(peek()) && peek() != '/' && peek() != '>') {
      if (peek() == '"' || peek() == '\'') return false;
      ++at_;
    }
    return at_ < text_.size();
  }

  bool name() {
    if (!is_letter(static_cast<unsigned char>(peek()))) return false;
    while (at_ < text_.size() && is_name_character(static_cast<unsigned char>(text_[at_]))) ++at_;
    return at_ < text_.size();
  }

  // Character by character, as TinyXML does: a stray first byte takes the bytes behind it along.
  bool text_until(char end) {
    while (at_ < text_.size() && peek() != end) {
      if (next_is("&#")) {
        reference();
        continue;
      }
      const size_t bytes = length(static_cast<unsigned char>(peek()));
      if (at_ + bytes > text_.size()) throw XmlError("the text ends inside a character", "save the file as text in UTF-8", at_);
      at_ += bytes;
    }
    return at_ < text_.size();
  }

  // &#38; or &#x26;
  void reference() {
    const bool hexadecimal = at_ + 2 < text_.size() && text_[at_ + 2] == 'x';
    const size_t first = at_ + (hexadecimal ? 3 : 2);
    constexpr unsigned long most = 0x10ffff;  // of all characters there are
    size_t i = first;
    unsigned long means = 0;
    const auto is_digit = [&](unsigned char c) { return hexadecimal ? std::isxdigit(c) : std::isdigit(c); };
    for (; i < text_.size() && is_digit(static_cast<unsigned char>(text_[i])); ++i) {
      const int c = std::tolower(static_cast<unsigned char>(text_[i]));
      means =
          std::min((hexadecimal ? 16 : 10) * means + static_cast<unsigned long>(c <= '9' ? c - '0' : c - 'a' + 10), most + 1);
    }
    if (i == first || i >= text_.size() || text_[i] != ';')
      throw XmlError("a character reference is malformed", "write it like &#38; or &#x26;, and '&' itself as &amp;", at_);
    if (means == 0 || means > most)  // which TinyXML cuts a value off at, or drops
      throw XmlError(fmt::format("{} is no character", text_.substr(at_, std::min<size_t>(i + 1 - at_, 20))), "leave it out",
                     at_);
    at_ = i + 1;
  }

  static bool is_blank(char c) { return std::isspace(static_cast<unsigned char>(c)); }
  // … and byte order marks, wherever they stand. Whether anything is left.
  bool skip_blanks() {
    while (at_ < text_.size()) {
      if (is_blank(peek())) ++at_;
      else if (next_is("\xef\xbb\xbf") || next_is("\xef\xbf\xbe") || next_is("\xef\xbf\xbf")) at_ += 3;
      else break;
    }
    return at_ < text_.size();
  }

  bool next_is(std::string_view words) const { return text_.substr(at_).starts_with(words); }
  // In any case; `word` is lower case.
  bool next_is_word(std::string_view word) const {
    if (text_.size() - at_ < word.size()) return false;
    for (size_t i = 0; i < word.size(); ++i)
      if (std::tolower(static_cast<unsigned char>(text_[at_ + i])) != word[i]) return false;
    return true;
  }
  // Goes behind the next `end`, looked for `skipped` bytes from here.
  bool behind(std::string_view end, size_t skipped) {
    const size_t found = text_.find(end, at_ + skipped);
    if (found == text_.npos) return false;
    at_ = found + end.size();
    return true;
  }
  bool advance(size_t bytes) {
    at_ += bytes;
    return at_ < text_.size();
  }
  char peek() const { return text_[at_]; }

  std::string_view text_;
  size_t at_ = 0;
  int open_ = 0;  // elements open here
  XmlExtent extent_;
};

}  // namespace

XmlExtent xml_extent(const std::string& text) { return Walk(text).extent(); }

}  // namespace dalembert::frontend
