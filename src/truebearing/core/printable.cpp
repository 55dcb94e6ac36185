// SPDX-License-Identifier: Apache-2.0
#include "truebearing/core/printable.hpp"

#include <cstdint>

namespace truebearing {
namespace {

constexpr std::string_view kCut = "...";

/// A character of UTF-8 at the beginning of a text; no length where there is none.
struct Character {
  std::size_t length = 0;
  std::uint32_t code = 0;
};

bool is_continuation(char byte) {
  return (static_cast<unsigned char>(byte) & 0xC0u) == 0x80u;
}

Character first_character(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text[0]);
  if (lead < 0x80) return {1, lead};
  const std::size_t length = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < length) return {};
  std::uint32_t code = lead & (0xFFu >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    if (!is_continuation(text[i])) return {};
    code = (code << 6) | (static_cast<unsigned char>(text[i]) & 0x3Fu);
  }
  return {length, code};
}

bool is_harmless(std::uint32_t code) {
  const bool control = code < 0x20 || (code >= 0x7F && code < 0xA0);
  const bool directs_lines = (code >= 0x200B && code <= 0x200F) || (code >= 0x2028 && code <= 0x202E) ||
                             (code >= 0x2060 && code <= 0x206F) || code == 0xFEFF;
  return !control && !directs_lines;
}

void append_escaped(std::string& line, char byte) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  switch (byte) {
    case '\n':
      line += "\\n";
      break;
    case '\r':
      line += "\\r";
      break;
    case '\t':
      line += "\\t";
      break;
    default:
      line += "\\x";
      line += kDigits[static_cast<unsigned char>(byte) >> 4];
      line += kDigits[static_cast<unsigned char>(byte) & 0xF];
  }
}

}  // namespace

std::string printable(std::string_view text) {
  std::string line;
  line.reserve(text.size());
  while (!text.empty()) {
    const Character character = first_character(text);
    const std::size_t length = character.length == 0 ? 1 : character.length;
    if (character.length > 0 && is_harmless(character.code))
      line += text.substr(0, length);
    else
      for (const char byte : text.substr(0, length)) append_escaped(line, byte);
    text.remove_prefix(length);
  }
  return line;
}

std::string shortened(std::string_view text, std::size_t most) {
  if (text.size() <= most) return std::string(text);
  std::size_t kept = most - kCut.size();
  while (kept > 0 && is_continuation(text[kept])) --kept;
  return std::string(text.substr(0, kept)).append(kCut);
}

std::string shortened_from_front(std::string_view text, std::size_t most) {
  if (text.size() <= most) return std::string(text);
  std::size_t begin = text.size() - (most - kCut.size());
  while (begin < text.size() && is_continuation(text[begin])) ++begin;
  return std::string(kCut).append(text.substr(begin));
}

std::string as_shown(std::string_view text) {
  constexpr std::size_t kMostShown = 43;
  return '"' + shortened(printable(text.substr(0, 2 * kMostShown)), kMostShown) + '"';
}

}  // namespace truebearing
