#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace cleave::report {

/// A number of seven digits: enough for a picture, half of the bytes. Not finite: 0.
struct Short {
  double value = 0;
};

enum class JsonLayout : std::uint8_t { lines, compact };

/// Writes JSON with the keys in the order of the calls, two blanks a level, numbers as the shortest round trip.
///
/// There is no NaN or infinity in JSON: they are written as null (say why in a key beside it).
class JsonWriter final {
 public:
  explicit JsonWriter(JsonLayout layout = JsonLayout::lines) noexcept : layout_{layout} {}

  void begin_object();
  void end_object();
  void begin_array();
  void end_array();
  void key(std::string_view name);
  void value(std::string_view text);
  void value(const char* text) { value(std::string_view{text}); }
  void value(double number);
  void value(Short number);
  void value(std::same_as<bool> auto flag) { literal(flag ? "true" : "false"); }
  void value(std::unsigned_integral auto count)
    requires(!std::same_as<decltype(count), bool>)
  {
    literal(std::to_string(count));
  }
  void null() { literal("null"); }
  /// The bytes as one string of base64.
  void base64(std::span<const std::byte> bytes);

  void member(std::string_view name, const auto& content) {
    key(name);
    value(content);
  }

  /// The text, ending with a line feed. All objects and arrays must be closed.
  [[nodiscard]] std::string finish() &&;
  /// Room for that many bytes in all, to spare copies of long texts.
  void reserve(std::size_t bytes) { out_.reserve(bytes); }

 private:
  struct Level {
    bool array;
    bool empty = true;
  };
  void separate();
  void literal(std::string_view text);
  void close(char bracket);

  void new_line();

  JsonLayout layout_;
  std::string out_;
  std::vector<Level> levels_;
  bool after_key_ = false;
};

}  // namespace cleave::report
