// SPDX-License-Identifier: Apache-2.0
// Is a text well-formed XML, as an SVG has to be and our pages are too? And what is in it.
#pragma once

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace truebearing::testing {

struct Markup {
  std::string error;                     ///< where it is not well-formed; empty where it is
  std::map<std::string, int> elements;   ///< how many of each name
  std::string text;                      ///< outside of tags, references resolved
  std::vector<std::string> ids, labels;  ///< of id="..." and aria-labelledby="..."
  std::set<std::string> attributes;      ///< all their names
};

class MarkupReader {
 public:
  explicit MarkupReader(const std::string& text) : text_(text) {}

  Markup read() {
    if (text_.starts_with("<!DOCTYPE html>")) at_ = std::string("<!DOCTYPE html>").size();
    while (at_ < text_.size() && found_.error.empty()) text_[at_] == '<' ? read_tag() : read_text();
    if (found_.error.empty() && !open_.empty()) fail("<" + open_.back() + "> is not closed");
    return found_;
  }

 private:
  void fail(const std::string& what) {
    found_.error = what + " at " + std::to_string(at_) + ": " + text_.substr(at_, 60);
  }
  static bool is_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == ':'; }
  std::string name() {
    const std::size_t from = at_;
    while (at_ < text_.size() && is_name(text_[at_])) ++at_;
    return text_.substr(from, at_ - from);
  }
  void skip_space() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
  }

  void read_text() {
    const std::size_t end = std::min(text_.find('<', at_), text_.size());
    found_.text += resolved(text_.substr(at_, end - at_));
    if (found_.error.empty()) at_ = end;
  }

  std::string resolved(const std::string& raw) {
    static const std::map<std::string, char> known{
        {"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&#39;", '\''}};
    std::string text;
    for (std::size_t i = 0; i < raw.size(); ++i) {
      if (static_cast<unsigned char>(raw[i]) < 0x20 && raw[i] != '\n') fail("a control character");
      if (raw[i] != '&') {
        text += raw[i];
        continue;
      }
      const std::string reference = raw.substr(i, raw.find(';', i) - i + 1);
      if (!known.contains(reference)) return fail("no reference: " + reference), text;
      text += known.at(reference);
      i += reference.size() - 1;
    }
    return text;
  }

  void read_tag() {
    ++at_;
    if (text_[at_] == '/') {
      ++at_;
      const std::string closed = name();
      if (open_.empty() || open_.back() != closed || text_[at_] != '>') return fail("closes what is not open");
      open_.pop_back();
      ++at_;
      return;
    }
    const std::string element = name();
    if (element.empty()) return fail("no element");
    ++found_.elements[element];
    std::set<std::string> seen;
    for (skip_space(); at_ < text_.size() && text_[at_] != '>' && text_[at_] != '/'; skip_space()) {
      const std::string attribute = name();
      if (attribute.empty() || !seen.insert(attribute).second) return fail("no attribute, or one twice");
      found_.attributes.insert(attribute);
      if (text_.compare(at_, 2, "=\"") != 0) return fail("an attribute without a value");
      at_ += 2;
      const std::size_t end = text_.find('"', at_);
      if (end == std::string::npos) return fail("a value without an end");
      const std::string raw = text_.substr(at_, end - at_);
      if (raw.find('<') != std::string::npos) return fail("< in a value");
      const std::string value = resolved(raw);
      if (!found_.error.empty()) return;
      if (attribute == "id") found_.ids.push_back(value);
      if (attribute == "aria-labelledby") found_.labels.push_back(value);
      at_ = end + 1;
    }
    const bool empty = at_ < text_.size() && text_[at_] == '/';
    if (empty) ++at_;
    if (at_ >= text_.size() || text_[at_] != '>') return fail("a tag without an end");
    if (!empty) open_.push_back(element);
    ++at_;
  }

  const std::string& text_;
  std::size_t at_ = 0;
  std::vector<std::string> open_;
  Markup found_;
};

inline Markup read_markup(const std::string& text) {
  return MarkupReader(text).read();
}

/// How often `part` stands in the text.
inline int count_of(const std::string& text, const std::string& part) {
  int count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++count;
  return count;
}

/// From the first `from` to the next `to`, both apart; empty where there is none.
inline std::string between(const std::string& text, const std::string& from, const std::string& to) {
  const std::size_t begin = text.find(from);
  if (begin == std::string::npos) return {};
  const std::size_t first = begin + from.size();
  return text.substr(first, text.find(to, first) - first);
}

}  // namespace truebearing::testing
