// SPDX-License-Identifier: Apache-2.0
#include "truebearing/report/markup.hpp"

#include <cmath>
#include <cstdlib>
#include <fmt/format.h>

#include "truebearing/core/printable.hpp"

namespace truebearing {
namespace {

constexpr const char* kNarrowSpace = "\u202f";
constexpr const char* kMinus = "\u2212";

// Of a number without an exponent.
std::string with_thousands_apart(const std::string& number) {
  const std::size_t end = std::min(number.find('.'), number.size());
  if (end < 5) return number;
  std::string apart;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (i > 0 && i < end && (end - i) % 3 == 0) apart += kNarrowSpace;
    apart += number[i];
  }
  return apart;
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string markup;
  for (const char c : printable(text)) switch (c) {
      case '&':
        markup += "&amp;";
        break;
      case '<':
        markup += "&lt;";
        break;
      case '>':
        markup += "&gt;";
        break;
      case '"':
        markup += "&quot;";
        break;
      case '\'':
        markup += "&#39;";
        break;
      default:
        markup += c;
    }
  return markup;
}

std::string capitalised(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

std::string shown(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  const std::string sign = value < 0.0 ? kMinus : "";
  const double size = std::abs(value);
  const double rounded = std::strtod(fmt::format("{:.{}e}", size, digits - 1).c_str(), nullptr);
  if (rounded == 0.0) return "0";
  constexpr double kLeastPlain = 1e-4, kMostPlain = 1e9;
  if (rounded < kLeastPlain || rounded >= kMostPlain) {
    const std::string text = fmt::format("{:.{}g}", size, digits);
    const std::size_t e = text.find('e');
    return sign + text.substr(0, e) + fmt::format("e{}", std::atoi(text.c_str() + e + 1));
  }
  const int whole = static_cast<int>(std::floor(std::log10(rounded))) + 1;
  std::string text = fmt::format("{:.{}f}", rounded, std::max(0, digits - whole));
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return sign + with_thousands_apart(text);
}

}  // namespace truebearing
