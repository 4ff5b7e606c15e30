#include "cleave/exchange/text.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <system_error>

#include "cleave/core/text.hpp"

namespace cleave::report {
namespace {

constexpr std::string_view replacement = "\xEF\xBF\xBD";  // U+FFFD
constexpr std::string_view thin_space = "\xE2\x80\x89";   // U+2009

// Groups the digits before the decimal mark by three, from four digits... "1234" stays, "12 345" is grouped.
std::string grouped(std::string_view digits) {
  std::string out;
  if (digits.size() < 5) return std::string{digits};
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) out += thin_space;
    out += digits[i];
  }
  return out;
}

template <class Escape>
void for_each_character(std::string_view text, const Escape& escape) {
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    if (length == 0) {
      escape(replacement);
      text.remove_prefix(1);
    } else {
      escape(text.substr(0, length));
      text.remove_prefix(length);
    }
  }
}

}  // namespace

void append_number(std::string& out, double value) {
  std::array<char, 32> buffer;
  const auto result = std::to_chars(buffer.begin(), buffer.end(), value == 0.0 ? 0.0 : value);
  out.append(buffer.begin(), result.ptr);
}

std::string number(double value) {
  std::string out;
  append_number(out, value);
  return out;
}

std::string display(double value, int digits) {
  if (std::isnan(value)) return "–";
  if (std::isinf(value)) return value > 0 ? "∞" : "−∞";
  if (value == 0.0) return "0";
  std::array<char, 64> buffer;
  const double magnitude = std::abs(value);
  std::string body;
  if (magnitude >= 1e9 || magnitude < 1e-4) {
    const auto end =
        std::to_chars(buffer.begin(), buffer.end(), magnitude, std::chars_format::scientific, digits - 1).ptr;
    body.assign(buffer.begin(), end);
    const std::size_t e = body.find('e');
    std::string mantissa = body.substr(0, e);
    if (mantissa.find('.') != std::string::npos) {
      while (mantissa.back() == '0') mantissa.pop_back();
      if (mantissa.back() == '.') mantissa.pop_back();
    }
    std::string exponent = body.substr(e + 1);
    const bool negative = exponent.front() == '-';
    exponent.erase(0, 1);
    while (exponent.size() > 1 && exponent.front() == '0') exponent.erase(0, 1);
    body = mantissa + "e" + (negative ? "−" : "") + exponent;
  } else {
    const int before = magnitude < 1 ? 1 : static_cast<int>(std::floor(std::log10(magnitude))) + 1;
    const int leading = magnitude < 1 ? static_cast<int>(std::floor(-std::log10(magnitude))) : 0;
    const int after = magnitude < 1 ? digits + leading : (digits > before ? digits - before : 0);
    const auto end = std::to_chars(buffer.begin(), buffer.end(), magnitude, std::chars_format::fixed, after).ptr;
    body.assign(buffer.begin(), end);
    const std::size_t point = body.find('.');
    std::string fraction = point == std::string::npos ? std::string{} : body.substr(point + 1);
    while (!fraction.empty() && fraction.back() == '0') fraction.pop_back();
    body = grouped(std::string_view{body}.substr(0, point));
    if (!fraction.empty()) body += "." + fraction;
  }
  return value < 0 ? "−" + body : body;
}

std::string display_count(std::uint64_t value) { return grouped(std::to_string(value)); }

void append_json_string(std::string& out, std::string_view text) {
  constexpr std::string_view hex = "0123456789abcdef";
  out += '"';
  for_each_character(text, [&](std::string_view c) {
    const auto code = static_cast<unsigned char>(c.front());
    if (c == "\"") {
      out += "\\\"";
    } else if (c == "\\") {
      out += "\\\\";
    } else if (c == "\n") {
      out += "\\n";
    } else if (c == "\t") {
      out += "\\t";
    } else if (c == "\r") {
      out += "\\r";
    } else if (code < 0x20 || code == 0x7F || c == "<") {
      out += "\\u00";
      out += hex[code >> 4U];
      out += hex[code & 15U];
    } else {
      out += c;
    }
  });
  out += '"';
}

std::string escape_xml(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for_each_character(text, [&](std::string_view c) {
    const auto code = static_cast<unsigned char>(c.front());
    if (c == "&") {
      out += "&amp;";
    } else if (c == "<") {
      out += "&lt;";
    } else if (c == ">") {
      out += "&gt;";
    } else if (c == "\"") {
      out += "&quot;";
    } else if (c == "'") {
      out += "&#39;";
    } else if (code < 0x20 && c != "\n" && c != "\t") {
      out += replacement;
    } else {
      out += c;
    }
  });
  return out;
}

void append_base64(std::string& out, std::span<const std::byte> bytes) {
  constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const std::size_t start = out.size();
  out.resize(start + (bytes.size() + 2) / 3 * 4);
  std::size_t to = start;
  const auto at = [&](std::size_t i) { return i < bytes.size() ? std::to_integer<std::uint32_t>(bytes[i]) : 0U; };
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::uint32_t three = at(i) << 16U | at(i + 1) << 8U | at(i + 2);
    out[to] = alphabet[three >> 18U];
    out[to + 1] = alphabet[three >> 12U & 63U];
    out[to + 2] = i + 1 < bytes.size() ? alphabet[three >> 6U & 63U] : '=';
    out[to + 3] = i + 2 < bytes.size() ? alphabet[three & 63U] : '=';
    to += 4;
  }
}

}  // namespace cleave::report
