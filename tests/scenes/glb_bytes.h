// tests/scenes/glb_bytes.h
//
// GLB files from JSON and bytes.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace lightfit::testing {

inline void AppendWord(uint32_t word, std::string* bytes) {
  for (int i = 0; i < 4; ++i) bytes->push_back(static_cast<char>(word >> 8 * i & 0xFF));
}

inline std::string GlbOf(std::string json, std::string buffer) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  buffer.resize((buffer.size() + 3) / 4 * 4, '\0');
  std::string glb = "glTF";
  AppendWord(2, &glb);
  AppendWord(static_cast<uint32_t>(12 + 8 + json.size() + 8 + buffer.size()), &glb);
  AppendWord(static_cast<uint32_t>(json.size()), &glb);
  glb += "JSON" + json;
  AppendWord(static_cast<uint32_t>(buffer.size()), &glb);
  glb += std::string("BIN\0", 4) + buffer;
  return glb;
}

template <typename T>
std::string BytesOf(const std::vector<T>& values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

}  // namespace lightfit::testing
