#include "cleave/exchange/json.hpp"

#include <cmath>
#include <utility>

#include "cleave/core/assert.hpp"
#include "cleave/exchange/text.hpp"

namespace cleave::report {

void JsonWriter::separate() {
  if (std::exchange(after_key_, false) || levels_.empty()) return;
  if (!levels_.back().empty) out_ += ',';
  levels_.back().empty = false;
  new_line();
}

void JsonWriter::new_line() {
  if (layout_ == JsonLayout::compact) return;
  out_ += '\n';
  out_.append(2 * levels_.size(), ' ');
}

void JsonWriter::literal(std::string_view text) {
  separate();
  out_ += text;
}

void JsonWriter::begin_object() {
  literal("{");
  levels_.push_back({.array = false});
}

void JsonWriter::begin_array() {
  literal("[");
  levels_.push_back({.array = true});
}

void JsonWriter::close(char bracket) {
  CLEAVE_ASSERT(!levels_.empty() && !after_key_ && levels_.back().array == (bracket == ']'));
  const bool empty = levels_.back().empty;
  levels_.pop_back();
  if (!empty) new_line();
  out_ += bracket;
}

void JsonWriter::end_object() { close('}'); }
void JsonWriter::end_array() { close(']'); }

void JsonWriter::key(std::string_view name) {
  CLEAVE_ASSERT(!levels_.empty() && !levels_.back().array && !after_key_);
  separate();
  append_json_string(out_, name);
  out_ += layout_ == JsonLayout::compact ? ":" : ": ";
  after_key_ = true;
}

void JsonWriter::value(std::string_view text) {
  separate();
  append_json_string(out_, text);
}

void JsonWriter::base64(std::span<const std::byte> bytes) {
  separate();
  out_ += '"';
  append_base64(out_, bytes);
  out_ += '"';
}

void JsonWriter::value(double number) {
  if (!std::isfinite(number)) return null();
  separate();
  append_number(out_, number);
}

void JsonWriter::value(Short number) {
  const double v = number.value;
  separate();
  if (!std::isfinite(v) || std::abs(v) < 1e-99) {  // far below, powers of ten overflow
    out_ += '0';
    return;
  }
  const double power = std::floor(std::log10(std::abs(v))) - 6;
  // 10^-power is a whole power of ten: multiplying and dividing by it gives short decimals.
  append_number(out_, power < 0 ? std::round(v * std::pow(10, -power)) / std::pow(10, -power)
                                : std::round(v / std::pow(10, power)) * std::pow(10, power));
}

std::string JsonWriter::finish() && {
  CLEAVE_ASSERT(levels_.empty() && !after_key_);
  out_ += '\n';
  return std::move(out_);
}

}  // namespace cleave::report
