#include "cleave/core/sha256.hpp"

#include <bit>

namespace cleave {
namespace {

constexpr std::array<std::uint32_t, 64> round_constants{
    0x428a2f98U, 0x71374491U, 0xb5c0fbcfU, 0xe9b5dba5U, 0x3956c25bU, 0x59f111f1U, 0x923f82a4U, 0xab1c5ed5U,
    0xd807aa98U, 0x12835b01U, 0x243185beU, 0x550c7dc3U, 0x72be5d74U, 0x80deb1feU, 0x9bdc06a7U, 0xc19bf174U,
    0xe49b69c1U, 0xefbe4786U, 0x0fc19dc6U, 0x240ca1ccU, 0x2de92c6fU, 0x4a7484aaU, 0x5cb0a9dcU, 0x76f988daU,
    0x983e5152U, 0xa831c66dU, 0xb00327c8U, 0xbf597fc7U, 0xc6e00bf3U, 0xd5a79147U, 0x06ca6351U, 0x14292967U,
    0x27b70a85U, 0x2e1b2138U, 0x4d2c6dfcU, 0x53380d13U, 0x650a7354U, 0x766a0abbU, 0x81c2c92eU, 0x92722c85U,
    0xa2bfe8a1U, 0xa81a664bU, 0xc24b8b70U, 0xc76c51a3U, 0xd192e819U, 0xd6990624U, 0xf40e3585U, 0x106aa070U,
    0x19a4c116U, 0x1e376c08U, 0x2748774cU, 0x34b0bcb5U, 0x391c0cb3U, 0x4ed8aa4aU, 0x5b9cca4fU, 0x682e6ff3U,
    0x748f82eeU, 0x78a5636fU, 0x84c87814U, 0x8cc70208U, 0x90befffaU, 0xa4506cebU, 0xbef9a3f7U, 0xc67178f2U};

constexpr std::uint8_t byte_of(std::uint64_t number, unsigned shift) noexcept {
  return static_cast<std::uint8_t>((number >> shift) & 0xffU);
}

}  // namespace

void Sha256::compress() noexcept {
  std::array<std::uint32_t, 64> w{};
  for (std::size_t i = 0; i < 16; ++i) {
    w[i] = (std::uint32_t{block_[4 * i]} << 24U) | (std::uint32_t{block_[4 * i + 1]} << 16U) |
           (std::uint32_t{block_[4 * i + 2]} << 8U) | std::uint32_t{block_[4 * i + 3]};
  }
  for (std::size_t i = 16; i < 64; ++i) {
    const std::uint32_t s0 = std::rotr(w[i - 15], 7) ^ std::rotr(w[i - 15], 18) ^ (w[i - 15] >> 3U);
    const std::uint32_t s1 = std::rotr(w[i - 2], 17) ^ std::rotr(w[i - 2], 19) ^ (w[i - 2] >> 10U);
    w[i] = w[i - 16] + s0 + w[i - 7] + s1;
  }
  auto [a, b, c, d, e, f, g, h] = state_;
  for (std::size_t i = 0; i < 64; ++i) {
    const std::uint32_t s1 = std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25);
    const std::uint32_t t1 = h + s1 + ((e & f) ^ (~e & g)) + round_constants[i] + w[i];
    const std::uint32_t s0 = std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22);
    const std::uint32_t t2 = s0 + ((a & b) ^ (a & c) ^ (b & c));
    h = g;
    g = f;
    f = e;
    e = d + t1;
    d = c;
    c = b;
    b = a;
    a = t1 + t2;
  }
  const std::array<std::uint32_t, 8> change{a, b, c, d, e, f, g, h};
  for (std::size_t i = 0; i < state_.size(); ++i) state_[i] += change[i];
}

void Sha256::add(std::uint8_t byte) noexcept {
  block_[length_ % block_.size()] = byte;
  ++length_;
  if (length_ % block_.size() == 0) compress();
}

Sha256& Sha256::update(std::span<const std::byte> bytes) noexcept {
  for (const std::byte b : bytes) add(std::to_integer<std::uint8_t>(b));
  return *this;
}

Sha256& Sha256::update(std::string_view text) noexcept { return update(std::as_bytes(std::span{text})); }

Sha256& Sha256::update(std::uint64_t number) noexcept {
  for (unsigned shift = 0; shift < 64; shift += 8) add(byte_of(number, shift));
  return *this;
}

Sha256::Digest Sha256::digest() const noexcept {
  Sha256 last = *this;
  const std::uint64_t bits = length_ * 8;
  last.add(0x80);
  while (last.length_ % 64 != 56) last.add(0);
  for (unsigned shift = 64; shift > 0; shift -= 8) last.add(byte_of(bits, shift - 8));
  Digest out{};
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = byte_of(last.state_[i / 4], 24U - 8U * static_cast<unsigned>(i % 4));
  }
  return out;
}

std::string Sha256::hex() const {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t b : digest()) {
    text += digits[b >> 4U];
    text += digits[b & 0xfU];
  }
  return text;
}

std::string sha256_hex(std::string_view text) { return Sha256{}.update(text).hex(); }

}  // namespace cleave
